//! What stands behind the options of `foliate certify`.

use crate::certify::{Attachment, Rates, find_coordinate, find_joint};
use crate::cli::console::print::Refusal;
use crate::components::problem::Problem;
use crate::components::robot::Robot;

/// `OBJECT@LINK[:TIME]` and `OBJECT[:TIME]`; without a time it is from the start.
pub(crate) fn attachments(attach: &[String], detach: &[String]) -> Result<Vec<Attachment>, Refusal> {
    let timed = |text: &str| match text.rsplit_once(':') {
        None => Ok((text.to_owned(), f64::NEG_INFINITY)),
        Some((name, time)) => match time.parse::<f64>().ok().filter(|t| t.is_finite()) {
            Some(time) => Ok((name.to_owned(), time)),
            None => Err(Refusal(format!("`{}` is no time", time.escape_debug()))),
        },
    };
    let mut attachments = Vec::new();
    for text in attach {
        let Some((object, link)) = text.split_once('@') else {
            let shown = text.escape_debug();
            return Err(Refusal(format!("--attach `{shown}`: write OBJECT@LINK or OBJECT@LINK:TIME")));
        };
        let (link, time) = timed(link)?;
        attachments.push(Attachment { object: object.to_owned(), link: Some(link), time });
    }
    for text in detach {
        let (object, time) = timed(text)?;
        attachments.push(Attachment { object, link: None, time });
    }
    Ok(attachments)
}

pub(crate) fn touch(pairs: &[String]) -> Result<Vec<(String, String)>, Refusal> {
    let split = |text: &String| match text.split_once(',') {
        Some((a, b)) => Ok((a.trim().to_owned(), b.trim().to_owned())),
        None => Err(Refusal(format!("--touch `{}`: write two names, A,B", text.escape_debug()))),
    };
    pairs.iter().map(split).collect()
}

fn number(option: &str, text: &str) -> Result<f64, Refusal> {
    let value = text.parse::<f64>().ok().filter(|x| x.is_finite());
    value.ok_or_else(|| Refusal(format!("{option}: `{}` is no finite number", text.escape_debug())))
}

fn positive(option: &str, text: &str) -> Result<f64, Refusal> {
    let value = number(option, text)?;
    if value > 0.0 { Ok(value) } else { Err(Refusal(format!("{option}: {value} is not more than 0"))) }
}

/// `JOINT=VALUE`: where joints stand that the motion does not move.
pub(crate) fn start(problem: &mut Problem, given: &[String]) -> Result<(), Refusal> {
    for text in given {
        let Some((name, value)) = text.split_once('=') else {
            return Err(Refusal(format!("--start `{}`: write JOINT=VALUE", text.escape_debug())));
        };
        let index = find_coordinate(&problem.robot, name.trim()).map_err(|e| Refusal(format!("--start: {e}")))?;
        problem.start[index] = number("--start", value.trim())?;
    }
    Ok(())
}

pub(crate) fn rates(robot: &Robot, velocity: &[String], acceleration: &[String]) -> Result<Rates, Refusal> {
    let mut rates = Rates::default();
    for text in velocity {
        match text.split_once('=') {
            Some((name, limit)) => rates.velocity.push(own(robot, "--velocity-limit", name, limit)?),
            None => rates.velocity_scale = positive("--velocity-limit", text)?,
        }
    }
    for text in acceleration {
        match text.split_once('=') {
            Some((name, limit)) => rates.accelerations.push(own(robot, "--acceleration-limit", name, limit)?),
            None => rates.acceleration = Some(positive("--acceleration-limit", text)?),
        }
    }
    Ok(rates)
}

fn own(robot: &Robot, option: &str, name: &str, limit: &str) -> Result<(String, f64), Refusal> {
    let joint = find_joint(robot, name.trim()).map_err(|e| Refusal(format!("{option}: {e}")))?;
    Ok((joint, positive(option, limit.trim())?))
}
