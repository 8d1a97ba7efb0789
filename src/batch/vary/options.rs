//! What varies from instance to instance.

use std::fmt::Write;

/// From a value to another, both included: metres or radians.
pub type Span = (f64, f64);

/// Some of the objects.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Which {
    /// None of them.
    #[default]
    None,
    /// All that lie on a support that is fixed in the world.
    All,
    /// These parts.
    These(Vec<String>),
}

/// How instances of a problem differ from it. What is not said stays as it is.
#[derive(Clone, Debug, PartialEq)]
pub struct Vary {
    /// How many instances. Instances of the same number are the same, however many there are.
    pub instances: u64,
    /// Seed of all that is drawn.
    pub seed: u64,
    /// Draws of an instance after which there is none.
    pub tries: u32,
    /// Objects that start elsewhere on the supports.
    pub starts: Which,
    /// Objects that shall end elsewhere on the supports, of goals that give them poses.
    pub goals: Which,
    /// Whether objects may come to lie on other faces than they do in the scene. Few hands can turn an object over.
    pub any_face: bool,
    /// Bounds of the places that are drawn, of the origins of the objects' root links in the world: x, y and z, metres.
    pub within: [Option<Span>; 3],
    /// How many of the movable objects there are, from fewest to most. Which ones is drawn.
    pub objects: Option<(usize, usize)>,
    /// Parts that stand elsewhere.
    pub moves: Vec<MovedPart>,
    /// Parts of other sizes.
    pub sizes: Vec<SizedPart>,
    /// Further obstacles.
    pub obstacles: Option<Obstacles>,
}

/// A part that is fixed in the world (an environment, the base of a robot) and stands elsewhere.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MovedPart {
    /// Its name.
    pub part: String,
    /// How far it is shifted along the world's x, y and z, metres.
    pub shift: [Span; 3],
    /// By how much it is turned about the vertical through its own origin, radians.
    pub turn: Span,
}

/// A part with a `shape`, whose sizes are multiplied.
#[derive(Clone, Debug, PartialEq)]
pub struct SizedPart {
    /// Its name.
    pub part: String,
    /// The factor. Each side of a box has its own, and so have radius and length of a cylinder; a mesh has one for all.
    pub factor: Span,
}

/// Boxes that are put somewhere.
#[derive(Clone, Debug, PartialEq)]
pub struct Obstacles {
    /// How many, from fewest to most.
    pub count: (usize, usize),
    /// Sides along x, y and z, metres.
    pub sides: [Span; 3],
    /// Their middles in the world, metres.
    pub middle: [Span; 3],
    /// By how much they are turned about the vertical, radians.
    pub turn: Span,
}

impl Vary {
    /// So many instances, of which nothing varies yet; at most 100 draws each.
    #[must_use]
    pub fn new(instances: u64, seed: u64) -> Self {
        Self {
            instances,
            seed,
            tries: 100,
            starts: Which::None,
            goals: Which::None,
            any_face: false,
            within: [None; 3],
            objects: None,
            moves: Vec::new(),
            sizes: Vec::new(),
            obstacles: None,
        }
    }

    /// Whether the scene itself varies, so that it has to be read again.
    #[must_use]
    pub fn changes_scene(&self) -> bool {
        self.objects.is_some() || !self.moves.is_empty() || !self.sizes.is_empty() || self.obstacles.is_some()
    }

    /// What decides an instance of a number: all but how many there are.
    pub(crate) fn text(&self) -> String {
        let mut text = String::new();
        let _cannot_fail = write!(text, "{:?}", Self { instances: 0, ..self.clone() });
        text
    }

    /// What is wrong with the numbers, if anything: the key and the reason.
    pub(crate) fn fault(&self) -> Option<(&'static str, String)> {
        let spans = |key: &'static str, spans: &[Span]| {
            let wrong = spans.iter().find(|(low, high)| !(low.is_finite() && high.is_finite() && low <= high))?;
            Some((key, format!("{} is not from a number to one that is as large or larger", span_text(*wrong))))
        };
        let counts = |key: &'static str, count: (usize, usize), fewest: usize| {
            let is_wrong = count.0 > count.1 || count.0 < fewest || count.1 > MOST;
            is_wrong.then(|| (key, format!("{} to {} are not from {fewest} to {MOST}", count.0, count.1)))
        };
        let positive = |key: &'static str, spans: &[Span]| {
            let wrong = spans.iter().find(|(low, _)| *low <= 0.0)?;
            Some((key, format!("{} is not above 0", span_text(*wrong))))
        };
        if self.instances == 0 {
            return Some(("vary.instances", "is 0".into()));
        }
        if self.tries == 0 {
            return Some(("vary.tries", "is 0".into()));
        }
        let within: Vec<Span> = self.within.iter().copied().flatten().collect();
        let of_move =
            |moved: &MovedPart| spans("vary.move", &moved.shift).or_else(|| spans("vary.move", &[moved.turn]));
        let of_size =
            |size: &SizedPart| spans("vary.size", &[size.factor]).or_else(|| positive("vary.size", &[size.factor]));
        let of_obstacles = |obstacles: &Obstacles| {
            counts("vary.obstacles.count", obstacles.count, 0)
                .or_else(|| spans("vary.obstacles.sides", &obstacles.sides))
                .or_else(|| positive("vary.obstacles.sides", &obstacles.sides))
                .or_else(|| spans("vary.obstacles", &obstacles.middle))
                .or_else(|| spans("vary.obstacles.turn", &[obstacles.turn]))
        };
        spans("vary.within", &within)
            .or_else(|| counts("vary.objects", self.objects?, 1))
            .or_else(|| self.moves.iter().find_map(of_move))
            .or_else(|| self.sizes.iter().find_map(of_size))
            .or_else(|| of_obstacles(self.obstacles.as_ref()?))
    }
}

/// Most objects or obstacles.
const MOST: usize = 100;

fn span_text((low, high): Span) -> String {
    format!("[{low}, {high}]")
}

#[cfg(test)]
mod tests {
    use super::{Obstacles, SizedPart, Vary};

    #[test]
    fn numbers_that_cannot_be_are_told() {
        let good = Vary::new(3, 1);
        assert_eq!(good.fault(), None);
        let size = |factor| vec![SizedPart { part: "a".into(), factor }];
        let obstacles = |count| Obstacles { count, sides: [(0.1, 0.2); 3], middle: [(0.0, 1.0); 3], turn: (0.0, 0.0) };
        let cases = [
            (Vary { instances: 0, ..good.clone() }, "vary.instances"),
            (Vary { tries: 0, ..good.clone() }, "vary.tries"),
            (Vary { within: [Some((1.0, 0.0)), None, None], ..good.clone() }, "vary.within"),
            (Vary { objects: Some((0, 2)), ..good.clone() }, "vary.objects"),
            (Vary { sizes: size((0.0, 1.0)), ..good.clone() }, "vary.size"),
            (Vary { sizes: size((f64::NAN, 1.0)), ..good.clone() }, "vary.size"),
            (Vary { obstacles: Some(obstacles((2, 1))), ..good.clone() }, "vary.obstacles.count"),
        ];
        for (vary, key) in cases {
            assert_eq!(vary.fault().map(|(key, _)| key), Some(key), "{vary:?}");
        }
    }
}
