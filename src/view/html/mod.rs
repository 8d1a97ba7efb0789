//! One self-contained HTML file: `packed` compresses and encodes what a page carries, `page` puts it together with the viewer's program.

pub(crate) mod packed;
pub(crate) mod page;
