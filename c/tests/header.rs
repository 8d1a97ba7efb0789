//! The header is that of the source.

use std::path::Path;

#[test]
fn the_header_is_that_of_the_source() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    let config = cbindgen::Config::from_root_or_default(folder);
    let sources = ["error", "scene", "solve", "path", "check"];
    let mut builder = cbindgen::Builder::new().with_config(config);
    for source in sources {
        builder = builder.with_src(folder.join("src").join(format!("{source}.rs")));
    }
    let mut made = Vec::new();
    builder.generate().expect("a header").write(&mut made);
    let made = String::from_utf8(made).expect("text");
    let kept = folder.join("include/foliate.h");
    if std::env::var_os("FOLIATE_HEADER").is_some_and(|value| value == "write") {
        std::fs::write(&kept, &made).expect("the header is written");
    }
    let kept = std::fs::read_to_string(kept).unwrap_or_default();
    assert!(
        kept == made,
        "include/foliate.h is not that of the source: run FOLIATE_HEADER=write cargo test -p foliate_c"
    );
}
