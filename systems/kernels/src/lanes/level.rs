//! Which instructions the lanes use: found once, or forced by name.

use super::scalar::Portable;
use super::vector::Isa;
#[cfg(any(target_arch = "x86", target_arch = "x86_64", target_arch = "aarch64", target_arch = "wasm32"))]
use fearless_simd::Level as Detected;
use fearless_simd::Simd;

/// A set of instructions for the lanes that this machine has. Results are equal bit for bit only at one level.
#[derive(Clone, Copy, Debug)]
pub struct Level(Kind);

#[derive(Clone, Copy, Debug)]
enum Kind {
    Scalar,
    #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
    Avx2(fearless_simd::x86::Avx2),
    #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
    Avx512(fearless_simd::x86::Avx512),
    #[cfg(target_arch = "aarch64")]
    Neon(fearless_simd::aarch64::Neon),
    #[cfg(all(target_arch = "wasm32", target_feature = "simd128"))]
    Simd128(fearless_simd::wasm32::WasmSimd128),
}

/// What runs at a level: a value with the data it works on.
pub trait Kernel {
    /// What it answers.
    type Output;

    /// The work; implementations are `#[inline(always)]`, or they are compiled without the level's instructions.
    fn run<I: Isa>(self, isa: I) -> Self::Output;
}

/// A level that this machine does not have, or that does not exist.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("there is no SIMD level `{name}` here; this machine has {}", here.join(", "))]
pub struct UnknownLevel {
    /// What was asked for.
    pub name: String,
    /// What this machine has, best first.
    pub here: Vec<&'static str>,
}

impl Level {
    /// The best that this machine has.
    #[must_use]
    pub fn detected() -> Self {
        Self::best().unwrap_or_else(Self::scalar)
    }

    #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
    fn best() -> Option<Self> {
        let detected = Detected::new();
        let wide = detected.as_avx512().map(|isa| Self(Kind::Avx512(isa)));
        wide.or_else(|| detected.as_avx2().map(|isa| Self(Kind::Avx2(isa))))
    }

    #[cfg(target_arch = "aarch64")]
    fn best() -> Option<Self> {
        Detected::new().as_neon().map(|isa| Self(Kind::Neon(isa)))
    }

    #[cfg(all(target_arch = "wasm32", target_feature = "simd128"))]
    fn best() -> Option<Self> {
        Detected::new().as_wasm_simd128().map(|isa| Self(Kind::Simd128(isa)))
    }

    #[cfg(not(any(
        target_arch = "x86",
        target_arch = "x86_64",
        target_arch = "aarch64",
        all(target_arch = "wasm32", target_feature = "simd128")
    )))]
    fn best() -> Option<Self> {
        None
    }

    /// One lane after another, on every machine.
    #[must_use]
    pub fn scalar() -> Self {
        Self(Kind::Scalar)
    }

    /// All that this machine has, best first; `scalar` is the last.
    #[must_use]
    pub fn available() -> Vec<Self> {
        let mut levels: Vec<Self> = Self::best().into_iter().collect();
        #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
        if matches!(levels.as_slice(), [Self(Kind::Avx512(_))]) {
            levels.extend(Detected::new().as_avx2().map(|isa| Self(Kind::Avx2(isa))));
        }
        levels.push(Self::scalar());
        levels
    }

    /// The level of that name: `scalar`, `avx2`, `avx512`, `neon` or `simd128`.
    ///
    /// # Errors
    /// A name that is unknown or that this machine does not have.
    pub fn named(name: &str) -> Result<Self, UnknownLevel> {
        let levels = Self::available();
        let found = levels.iter().find(|level| level.name() == name).copied();
        found.ok_or_else(|| UnknownLevel {
            name: name.to_owned(),
            here: levels.iter().map(|level| level.name()).collect(),
        })
    }

    /// What the level is called, in options and in results.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self.0 {
            Kind::Scalar => "scalar",
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            Kind::Avx2(_) => "avx2",
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            Kind::Avx512(_) => "avx512",
            #[cfg(target_arch = "aarch64")]
            Kind::Neon(_) => "neon",
            #[cfg(all(target_arch = "wasm32", target_feature = "simd128"))]
            Kind::Simd128(_) => "simd128",
        }
    }

    /// Runs a kernel with this level's instructions.
    #[inline]
    pub fn run<K: Kernel>(self, kernel: K) -> K::Output {
        match self.0 {
            Kind::Scalar => kernel.run(Portable),
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            Kind::Avx2(isa) => with(isa, kernel),
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            Kind::Avx512(isa) => with(isa, kernel),
            #[cfg(target_arch = "aarch64")]
            Kind::Neon(isa) => with(isa, kernel),
            #[cfg(all(target_arch = "wasm32", target_feature = "simd128"))]
            Kind::Simd128(isa) => with(isa, kernel),
        }
    }
}

#[inline(always)]
fn with<S: Simd, K: Kernel>(isa: S, kernel: K) -> K::Output {
    isa.vectorize(
        #[inline(always)]
        || kernel.run(isa),
    )
}

impl Default for Level {
    fn default() -> Self {
        Self::detected()
    }
}

impl PartialEq for Level {
    fn eq(&self, other: &Self) -> bool {
        self.name() == other.name()
    }
}

impl Eq for Level {}

impl std::fmt::Display for Level {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name())
    }
}

impl std::str::FromStr for Level {
    type Err = UnknownLevel;

    fn from_str(name: &str) -> Result<Self, UnknownLevel> {
        Self::named(name)
    }
}
