//! The numbers behind the head of a recording: columns of little-endian numbers, end to end, whose lengths the head gives.

use crate::planner::recording::document::{Recording, RecordingHead};
use crate::planner::search_record::{EDGE_BYTES, EdgeKind, NODE_BYTES, RecordedEdges, RecordedNodes};

/// How many bytes the columns take that a head announces; none where that is beyond numbers.
pub(crate) fn announced(head: &RecordingHead) -> Option<u64> {
    let row = (head.width as u64).checked_mul(4)?;
    let nodes = head.nodes.checked_mul(row.checked_add(NODE_BYTES)?)?;
    let edges = head.edges.checked_mul(EDGE_BYTES)?;
    nodes.checked_add(edges)?.checked_add(head.collisions.checked_mul(row)?)
}

/// Appends the columns of a recording.
pub(crate) fn append(recording: &Recording, bytes: &mut Vec<u8>) {
    let Recording { nodes, edges, collisions, .. } = recording;
    append_reals(&nodes.configurations, bytes);
    for column in [&nodes.states, &nodes.leaves, &nodes.trees, &nodes.sides, &nodes.steps] {
        append_counts(column, bytes);
    }
    for column in [&edges.from, &edges.to, &edges.transitions, &edges.steps] {
        append_counts(column, bytes);
    }
    bytes.extend(edges.kinds.iter().map(|kind| kind.code()));
    append_reals(collisions, bytes);
}

fn append_reals(column: &[f32], bytes: &mut Vec<u8>) {
    bytes.extend(column.iter().flat_map(|x| x.to_le_bytes()));
}

fn append_counts(column: &[u32], bytes: &mut Vec<u8>) {
    bytes.extend(column.iter().flat_map(|x| x.to_le_bytes()));
}

impl EdgeKind {
    pub(crate) fn code(self) -> u8 {
        match self {
            Self::Certified => 0,
            Self::NotValidated => 1,
            Self::Refused => 2,
        }
    }

    fn of_code(code: u8) -> Option<Self> {
        [Self::Certified, Self::NotValidated, Self::Refused].into_iter().find(|kind| kind.code() == code)
    }
}

/// Takes columns from the front of what is left.
struct Rest<'a>(&'a [u8]);

impl<'a> Rest<'a> {
    /// # Panics
    /// Where so many bytes are not left; the caller has compared the length with what is [`announced`].
    fn take(&mut self, bytes: usize) -> &'a [u8] {
        let (front, rest) = self.0.split_at(bytes);
        self.0 = rest;
        front
    }

    fn reals(&mut self, count: usize) -> Vec<f32> {
        self.take(4 * count).chunks_exact(4).map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]])).collect()
    }

    fn counts(&mut self, count: usize) -> Vec<u32> {
        self.take(4 * count).chunks_exact(4).map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]])).collect()
    }
}

/// The columns that a head announces, of bytes of that length; what is wrong with them, and where.
pub(crate) fn split(
    head: &RecordingHead,
    bytes: &[u8],
) -> Result<(RecordedNodes, RecordedEdges, Vec<f32>), (String, String)> {
    let mut rest = Rest(bytes);
    let (width, count) = (head.width, head.nodes as usize);
    let nodes = RecordedNodes {
        configurations: rest.reals(count * width),
        states: rest.counts(count),
        leaves: rest.counts(count),
        trees: rest.counts(count),
        sides: rest.counts(count),
        steps: rest.counts(count),
    };
    let count = head.edges as usize;
    let (from, to) = (rest.counts(count), rest.counts(count));
    let (transitions, steps) = (rest.counts(count), rest.counts(count));
    let kind = |(edge, &code): (usize, &u8)| {
        EdgeKind::of_code(code).ok_or_else(|| (format!("edge {edge}"), format!("{code} is no kind of edge")))
    };
    let kinds = rest.take(count).iter().enumerate().map(kind).collect::<Result<_, _>>()?;
    let collisions = rest.reals(head.collisions as usize * width);
    Ok((nodes, RecordedEdges { from, to, transitions, steps, kinds }, collisions))
}
