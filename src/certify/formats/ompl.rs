//! Path matrices of OMPL (`PathGeometric::printAsMatrix`): numbers between blanks, one state a line, no names.
//!
//! States of compound spaces stand one after the other: SO(2) as an angle in (−π, π], of which the shortest way is meant; SE(2) as x y
//! yaw; SE(3) as x y z and a quaternion x y z w, as our coordinates stand.

use crate::certify::formats::table::{COLUMNS, Table};
use crate::certify::motion::piecewise::{POINTS, Point};
use crate::scene::reading::error::{SceneError, quoted};

pub(super) fn read(file: &str, text: &str) -> Result<Table, SceneError> {
    let mut table = Table { element: "state", shortest: true, ..Table::default() };
    for (index, line) in text.lines().enumerate() {
        let number = index as u32 + 1;
        if line.trim().is_empty() {
            continue;
        }
        let fail =
            |message: String| SceneError::new(file, format!("state[{}]", table.points.len()), message).at(number);
        if table.points.len() == POINTS {
            return Err(fail(format!("more than {POINTS} states")));
        }
        let mut positions = Vec::new();
        for word in line.split_whitespace() {
            let value = word.parse::<f64>().ok().filter(|x| x.is_finite());
            let value = value.ok_or_else(|| {
                fail(format!("`{}` is no finite number", quoted(word)))
                    .hint("a path matrix has numbers and blanks only")
            })?;
            if positions.len() == COLUMNS {
                return Err(fail(format!("more than {COLUMNS} numbers")));
            }
            positions.push(value);
        }
        table.points.push(Point { positions, ..Point::default() });
        table.lines.push(number);
    }
    Ok(table)
}
