//! The cache directories of the user: that of installed models, and any other that an environment variable may name.

use std::path::PathBuf;

/// Where `foliate models --install` unpacks published packages: `FOLIATE_MODEL_CACHE`, or `foliate/models` in the user's
/// cache directory.
#[must_use]
pub fn model_cache() -> Option<PathBuf> {
    user_cache("FOLIATE_MODEL_CACHE", "models")
}

/// The directory that a variable names, or one of ours in the user's cache directory.
pub(crate) fn user_cache(variable: &str, name: &str) -> Option<PathBuf> {
    let from = |variable: &str| std::env::var_os(variable).filter(|v| !v.is_empty()).map(PathBuf::from);
    from(variable).or_else(|| {
        let cache = from("XDG_CACHE_HOME").filter(|p| p.is_absolute()).or_else(|| {
            from("HOME")
                .map(|home| if cfg!(target_os = "macos") { home.join("Library/Caches") } else { home.join(".cache") })
        });
        cache.or_else(|| from("LOCALAPPDATA")).map(|cache| cache.join("foliate").join(name))
    })
}
