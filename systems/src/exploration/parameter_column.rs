//! The values of one constraint, leaf by leaf, and which of them there are.

use foliate_components::graph::leaf::ParameterId;

/// Values in order of leaf. Most leaves have some value that no other has, so a comparison of many leaves with one first tests
/// whether the value exists.
#[derive(Clone, Debug, Default)]
pub struct ParameterColumn {
    values: Vec<ParameterId>,
    /// Sorted, each once: there are many columns, most with few values.
    present: Vec<ParameterId>,
}

impl ParameterColumn {
    /// By leaf.
    #[must_use]
    pub fn values(&self) -> &[ParameterId] {
        &self.values
    }

    /// Whether any leaf has a value.
    #[must_use]
    pub fn has(&self, value: ParameterId) -> bool {
        self.present.binary_search(&value).is_ok()
    }

    /// Inserts a value and moves those behind it.
    pub(crate) fn insert(&mut self, at: usize, value: ParameterId) {
        self.values.insert(at, value);
        if let Err(at) = self.present.binary_search(&value) {
            self.present.insert(at, value);
        }
    }

    /// Adds the value of another leaf.
    pub(crate) fn push(&mut self, value: ParameterId) {
        self.insert(self.values.len(), value);
    }
}
