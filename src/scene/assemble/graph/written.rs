//! `everywhere`, `while_held`, `state` and `transition` of `[graph]`: states that the problem itself writes down, such as stances.

use crate::scene::reading::error::{SceneError, did_you_mean, quoted};
use crate::scene::reading::keys::{Item, Keys};
use foliate_components::Pose;
use foliate_components::constraint::Constraint;
use foliate_components::problem::{
    GraphOptions, NamedConstraint, WhileHeld, WrittenLeg, WrittenState, WrittenTransition,
};
use foliate_components::robot::{PartIndex, Robot};
use foliate_kernels::constraints::residual;
use foliate_kernels::kinematics::Kinematics;

/// Most states, and most legs of a transition.
const STATES: usize = 1000;
/// A start may be off by a little: it is moved onto a state. Beyond this, metres and radians, no tolerance is meant.
const HOLDS: f64 = 0.05;
/// Most transitions.
const TRANSITIONS: usize = 10_000;

/// Reads what names constraints; the constraints themselves are in `options` already.
pub(super) fn read(keys: &mut Keys<'_>, robot: &Robot, options: &mut GraphOptions) -> Result<(), SceneError> {
    let constraints =
        |item: &Item<'_>, known: &[NamedConstraint]| several(item, known.iter().map(|c| c.name.as_str()), "constraint");
    if let Some(item) = keys.optional("everywhere") {
        options.everywhere = constraints(&item, &options.constraints)?;
    }
    if let Some(item) = keys.optional("while_held") {
        options.while_held = while_held(&item, robot, options)?;
    }
    let items = capped(keys.optional("state"), STATES)?;
    for item in &items {
        let mut keys = item.keys()?;
        let name = keys.required("name")?;
        if options.states.iter().any(|s| Ok(s.name.as_str()) == name.string()) {
            return Err(name.error("two states have this name"));
        }
        let listed = keys.optional("constraints");
        let constraints = listed.map_or(Ok(Vec::new()), |item| constraints(&item, &options.constraints))?;
        keys.finish()?;
        options.states.push(WrittenState { name: name.string()?.to_owned(), constraints });
    }
    for item in capped(keys.optional("transition"), TRANSITIONS)? {
        let transition = transition(&item, options)?;
        if options.transitions.iter().any(|t| t.name == transition.name) {
            return Err(item
                .error(format!("two transitions are called `{}`", quoted(&transition.name)))
                .hint("give each a `name`"));
        }
        options.transitions.push(transition);
    }
    Ok(())
}

/// `while_held = { object = ["constraint", …] }`.
fn while_held(item: &Item<'_>, robot: &Robot, options: &GraphOptions) -> Result<Vec<WhileHeld>, SceneError> {
    let name_of = |part: PartIndex| robot[part].name.as_str();
    let mut rules = Vec::new();
    for (name, item) in item.keys()?.entries() {
        let Some(object) = options.objects.iter().find(|object| name_of(object.part) == name) else {
            let known = options.objects.iter().map(|object| name_of(object.part));
            return Err(item.error("there is no object of this name").hint(did_you_mean(name, known)));
        };
        let constraints = several(&item, options.constraints.iter().map(|c| c.name.as_str()), "constraint")?;
        if let Some(&number) = constraints.iter().find(|&&n| options.constraints[n as usize].constraint.foliates()) {
            let name = quoted(&options.constraints[number as usize].name);
            let hint = "what holds while an object is held must be the same for every grasp: give it a value";
            return Err(item.error(format!("`{name}` has parameters")).hint(hint));
        }
        rules.push(WhileHeld { object: object.part, constraints });
    }
    Ok(rules)
}

/// Says which constraints of held objects do not hold where the start has the object, whatever robots do: it cannot be grasped there.
pub(in crate::scene::assemble) fn remarks(
    scene: &str,
    robot: &Robot,
    options: &GraphOptions,
    start: &[f64],
) -> Vec<SceneError> {
    let mut remarks = Vec::new();
    let mut bodies = vec![Pose::identity(); robot.joints.len()];
    if !options.while_held.is_empty() {
        Kinematics::new(robot).forward(start, &mut bodies);
    }
    for rule in &options.while_held {
        let part = &robot[rule.object];
        for NamedConstraint { name, constraint } in rule.constraints.iter().map(|&n| &options.constraints[n as usize]) {
            let is_its_own = constraint.bodies().into_iter().flatten().all(|body| part.joints.contains(&body.at()));
            let off = residual(robot, constraint, start, &bodies);
            if is_its_own && off > HOLDS {
                let (name, object) = (quoted(name), &part.name);
                let message =
                    format!("`{name}` does not hold where the start has `{object}`: it cannot be taken there");
                let remark = SceneError::new(scene, format!("graph.while_held.{object}"), message);
                remarks.push(match constraint {
                    Constraint::Tilt(_) => {
                        remark.hint("the z axis of `frame` is what points up; a `pose` in it turns it")
                    }
                    _ => remark,
                });
            }
        }
    }
    remarks
}

fn transition(item: &Item<'_>, options: &GraphOptions) -> Result<WrittenTransition, SceneError> {
    let mut keys = item.keys()?;
    let (from, to) = (keys.required("from")?, keys.required("to")?);
    let name = match keys.optional("name") {
        Some(item) => item.string()?.to_owned(),
        None => format!("{} → {}", from.string()?, to.string()?),
    };
    let (from, to) = (state(&from, options)?, state(&to, options)?);
    let mut legs = Vec::new();
    for item in capped(keys.optional("legs"), STATES)? {
        legs.push(leg(&item, options)?);
    }
    keys.finish()?;
    Ok(WrittenTransition { name, from, to, legs })
}

fn leg(item: &Item<'_>, options: &GraphOptions) -> Result<WrittenLeg, SceneError> {
    let mut keys = item.keys()?;
    let within = state(&keys.required("within")?, options)?;
    let names = || options.constraints.iter().map(|c| c.name.as_str());
    let until = keys.optional("until").map_or(Ok(Vec::new()), |item| several(&item, names(), "constraint"))?;
    let short = keys.optional("short").map_or(Ok(false), |item| item.boolean())?;
    keys.finish()?;
    Ok(WrittenLeg { within, until, short })
}

fn state(item: &Item<'_>, options: &GraphOptions) -> Result<u32, SceneError> {
    number(item, options.states.iter().map(|s| s.name.as_str()), "state")
}

/// The items of a list that is not too long.
fn capped<'f>(item: Option<Item<'f>>, most: usize) -> Result<Vec<Item<'f>>, SceneError> {
    let Some(item) = item else { return Ok(Vec::new()) };
    let items = item.list()?;
    match items.len() > most {
        true => Err(item.error(format!("there are {} of them, at most {most} are read", items.len()))),
        false => Ok(items),
    }
}

/// Numbers of names, each at most once.
pub(crate) fn several<'a>(
    item: &Item<'_>,
    known: impl Iterator<Item = &'a str> + Clone,
    what: &str,
) -> Result<Vec<u32>, SceneError> {
    let mut found = Vec::new();
    for item in item.list()? {
        let index = number(&item, known.clone(), what)?;
        if found.contains(&index) {
            return Err(item.error("is named a second time"));
        }
        found.push(index);
    }
    Ok(found)
}

fn number<'a>(item: &Item<'_>, known: impl Iterator<Item = &'a str> + Clone, what: &str) -> Result<u32, SceneError> {
    let name = item.string()?;
    let position = known.clone().position(|n| n == name).map(|i| i as u32);
    position.ok_or_else(|| item.error(format!("there is no {what} `{}`", quoted(name))).hint(did_you_mean(name, known)))
}
