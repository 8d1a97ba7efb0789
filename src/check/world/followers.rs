//! Joints that follow others, through any chain of leaders.

use crate::check::world::models::{Value, World};

/// What a joint of one coordinate is made of: `factor` times a column of a knot, plus `offset`; without a column the offset alone.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Led {
    pub column: Option<usize>,
    pub factor: f64,
    pub offset: f64,
}

impl World {
    pub(crate) fn led(&self, index: usize) -> Led {
        let (mut index, mut factor, mut offset) = (index, 1.0, 0.0);
        for _ in 0..=self.bodies.len() {
            match &self.bodies[index].value {
                Value::Columns(columns) => return Led { column: Some(columns[0]), factor, offset },
                Value::Still => return Led { column: None, factor: 0.0, offset },
                Value::Follows { leader, multiplier, offset: shift } => {
                    offset += factor * shift;
                    factor *= multiplier;
                    index = *leader;
                }
            }
        }
        // Models whose joints follow each other in a circle are refused when they are read.
        Led { column: None, factor: 0.0, offset: f64::NAN }
    }

    /// Value of a joint of one coordinate.
    pub(crate) fn scalar(&self, index: usize, number: impl Fn(usize) -> f64) -> f64 {
        let led = self.led(index);
        led.column.map_or(led.offset, |column| led.factor * number(column) + led.offset)
    }
}
