//! Tables with a header: commas, semicolons or tabs; one column a joint, and `time` where there are times.
//!
//! A column `NAME.velocity` or `NAME.acceleration` holds the derivatives of `NAME`; `NAME.position` is `NAME`.

use crate::certify::formats::table::{COLUMNS, Table};
use crate::certify::motion::piecewise::{POINTS, Point};
use crate::scene::reading::error::{SceneError, quoted};

/// What columns of times are called.
const TIMES: [&str; 3] = ["time", "t", "time_from_start"];

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Time,
    Position,
    Velocity,
    Acceleration,
}

/// A column: what it holds, and of which joint.
#[derive(Clone, Copy, Debug)]
struct Column {
    kind: Kind,
    joint: usize,
}

pub(super) fn read(file: &str, text: &str) -> Result<Table, SceneError> {
    let mut lines = text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty());
    let Some((number, header)) = lines.next() else { return Err(SceneError::new(file, "file", "is empty")) };
    let fail = |message: String| SceneError::new(file, "header", message).at(number as u32 + 1);
    let separator = [',', ';', '\t'].into_iter().max_by_key(|&s| header.matches(s).count()).unwrap_or(',');
    // numpy.savetxt puts a `#` before its header.
    let names = header.trim().trim_start_matches('#').split(separator).map(cell).collect::<Vec<_>>();
    if names.len() > COLUMNS {
        return Err(fail(format!("{} columns, at most {COLUMNS} are read", names.len())));
    }
    if names.iter().all(|name| name.parse::<f64>().is_ok()) {
        let message = String::from("the first line holds numbers, not names of columns");
        return Err(fail(message).hint("put a line `time,joint,joint,…` before it"));
    }
    let (columns, joints) = columns(&names).map_err(|(message, hint)| fail(message).hint(hint))?;
    let mut table = Table { element: "row", ..Table::default() };
    for (number, line) in lines {
        let number = number as u32 + 1;
        let row = table.points.len();
        if row == POINTS {
            return Err(SceneError::new(file, format!("row[{row}]"), format!("more than {POINTS} rows")).at(number));
        }
        let point = point(line, separator, &names, &columns, joints.len());
        let point = point.map_err(|(column, message)| {
            SceneError::new(file, format!("row[{row}], column `{}`", quoted(&column)), message).at(number)
        })?;
        table.points.push(point);
        table.lines.push(number);
    }
    table.joints = Some(joints);
    Ok(table)
}

/// What is between two separators, without quotes.
fn cell(text: &str) -> &str {
    let text = text.trim();
    text.strip_prefix('"').and_then(|t| t.strip_suffix('"')).unwrap_or(text).trim()
}

/// What each column holds; joints stand in the order of their positions.
fn columns(names: &[&str]) -> Result<(Vec<Column>, Vec<String>), (String, String)> {
    let split = |name: &str| match name.rsplit_once('.') {
        Some((joint, "velocity")) => (joint.to_owned(), Kind::Velocity),
        Some((joint, "acceleration")) => (joint.to_owned(), Kind::Acceleration),
        Some((joint, "position")) => (joint.to_owned(), Kind::Position),
        _ if TIMES.contains(&name) => (String::new(), Kind::Time),
        _ => (name.to_owned(), Kind::Position),
    };
    let all: Vec<(String, Kind)> = names.iter().map(|name| split(name)).collect();
    let joints: Vec<String> = all.iter().filter(|(_, k)| *k == Kind::Position).map(|(n, _)| n.clone()).collect();
    let mut columns: Vec<Column> = Vec::with_capacity(all.len());
    for (index, (joint, kind)) in all.iter().enumerate() {
        if all[..index].contains(&all[index]) {
            return Err((format!("column `{}` stands there twice", quoted(names[index])), String::new()));
        }
        let place = match kind {
            Kind::Time => 0,
            _ => joints.iter().position(|j| j == joint).ok_or_else(|| {
                let hint = format!("add a column `{}`", quoted(joint));
                (format!("column `{}` has no positions beside it", quoted(names[index])), hint)
            })?,
        };
        columns.push(Column { kind: *kind, joint: place });
    }
    for kind in [Kind::Velocity, Kind::Acceleration] {
        let count = columns.iter().filter(|c| c.kind == kind).count();
        if count != 0 && count != joints.len() {
            let message = format!("{count} of {} joints have a column of their {kind:?}", joints.len()).to_lowercase();
            return Err((message, String::from("give it for all, or for none")));
        }
    }
    Ok((columns, joints))
}

fn point(
    line: &str,
    separator: char,
    names: &[&str],
    columns: &[Column],
    joints: usize,
) -> Result<Point, (String, String)> {
    let has = |kind: Kind| columns.iter().any(|c| c.kind == kind).then(|| vec![0.0; joints]);
    let (velocities, accelerations) = (has(Kind::Velocity), has(Kind::Acceleration));
    let mut point = Point { time: None, positions: vec![0.0; joints], velocities, accelerations };
    let mut count = 0;
    for (index, text) in line.split(separator).map(cell).enumerate() {
        count += 1;
        let Some(column) = columns.get(index) else { continue };
        let name = || names[index].to_owned();
        let value = text.parse::<f64>().ok().filter(|x| x.is_finite());
        let value = value.ok_or_else(|| (name(), format!("`{}` is no finite number", quoted(text))))?;
        let row = match column.kind {
            Kind::Time => {
                point.time = Some(value);
                continue;
            }
            Kind::Position => Some(&mut point.positions),
            Kind::Velocity => point.velocities.as_mut(),
            Kind::Acceleration => point.accelerations.as_mut(),
        };
        if let Some(row) = row {
            row[column.joint] = value;
        }
    }
    if count != columns.len() {
        let last = names.last().copied().unwrap_or_default().to_owned();
        return Err((last, format!("the row has {count} cells, the header {}", columns.len())));
    }
    Ok(point)
}
