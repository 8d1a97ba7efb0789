//! The keys of a part that may be `"auto"`.

use crate::scene::assemble::names::frame::one_of;
use crate::scene::reading::error::SceneError;
use crate::scene::reading::keys::{Item, Keys};
use foliate_components::robot::PartKind;

/// What a part leaves to be found.
#[derive(Default)]
pub(crate) struct Auto<'f> {
    pub grippers: Option<Item<'f>>,
    pub handles: Option<Item<'f>>,
    pub surfaces: Option<Item<'f>>,
}

impl<'f> Auto<'f> {
    /// Reads the keys of a part.
    pub(super) fn read(keys: &mut Keys<'f>, kind: PartKind) -> Result<Self, SceneError> {
        let mut asked = |key: &'static str, is_of_kind: bool, whose: &str| {
            let Some(item) = keys.optional(key) else { return Ok(None) };
            one_of(&item, &[("auto", ())])?;
            match is_of_kind {
                true => Ok(Some(item)),
                false => Err(item.error(format!("`{key}` are found of {whose}"))),
            }
        };
        Ok(Self {
            grippers: asked("grippers", kind == PartKind::Robot, "robots")?,
            handles: asked("handles", kind == PartKind::Object, "objects")?,
            surfaces: asked("surfaces", kind != PartKind::Robot, "objects and environments")?,
        })
    }
}
