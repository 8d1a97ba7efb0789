//! Which grippers share handles: those of one size.

use crate::setup::grippers::FoundGripper;
use crate::setup::grippers::GripperKind::{Jaws, Tool};
use crate::setup::handles::handle::FoundHandle;

/// Grippers by size.
pub(crate) struct Kinds {
    /// The first gripper of each size.
    firsts: Vec<usize>,
    /// By gripper the number of its size.
    of: Vec<usize>,
}

impl Kinds {
    /// Sorts grippers by size.
    pub(crate) fn of(grippers: &[FoundGripper]) -> Self {
        let mut kinds = Self { firsts: Vec::new(), of: Vec::new() };
        for (at, gripper) in grippers.iter().enumerate() {
            let same = kinds.firsts.iter().position(|&first| alike(&grippers[first], gripper));
            kinds.of.push(same.unwrap_or(kinds.firsts.len()));
            if same.is_none() {
                kinds.firsts.push(at);
            }
        }
        kinds
    }

    /// Whether there are several sizes, so that not every gripper may hold every handle.
    pub(crate) fn differ(&self) -> bool {
        self.firsts.len() > 1
    }

    /// The handles of an object by the number of the gripper; `find` finds those for one gripper of each size. Where sizes differ, names
    /// end in the number of the size.
    pub(crate) fn handles<E>(
        &self,
        mut find: impl FnMut(usize) -> Result<Vec<FoundHandle>, E>,
    ) -> Result<Vec<(usize, FoundHandle)>, E> {
        let mut handles = Vec::new();
        for (kind, &first) in self.firsts.iter().enumerate() {
            let mut found = find(first)?;
            if self.differ() {
                found.iter_mut().for_each(|handle| handle.name = format!("{}_{}", handle.name, kind + 1));
            }
            for (gripper, _) in self.of.iter().enumerate().filter(|(_, of)| **of == kind) {
                handles.extend(found.iter().map(|handle| (gripper, handle.clone())));
            }
        }
        Ok(handles)
    }
}

/// The handles of all grippers, each name once.
pub(crate) fn distinct(handles: &[(usize, FoundHandle)]) -> Vec<&FoundHandle> {
    let mut kept: Vec<&FoundHandle> = Vec::new();
    for (_, handle) in handles {
        if kept.iter().all(|other| other.name != handle.name) {
            kept.push(handle);
        }
    }
    kept
}

/// Whether two grippers have the same size to within a millimetre.
fn alike(a: &FoundGripper, b: &FoundGripper) -> bool {
    match (a.kind, b.kind) {
        (Tool, Tool) => true,
        (
            Jaws { opening: o, shut: s, depth: d, tip: t, one_moves: m },
            Jaws { opening, shut, depth, tip, one_moves },
        ) => {
            m == one_moves && [(o, opening), (s, shut), (d, depth), (t, tip)].iter().all(|(x, y)| (x - y).abs() < 1e-3)
        }
        _ => false,
    }
}
