//! How much memory the process has, and may have.

use foliate_systems::events::MemoryGuard;
use std::fmt;
use std::str::FromStr;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// Most bytes that the default allows, whatever the machine has.
const MOST: u64 = 16 << 30;
/// What is assumed of a machine that does not tell.
const UNKNOWN: u64 = 4 << 30;
/// How long what was read counts: to read it takes some tens of microseconds.
const FRESH: Duration = Duration::from_millis(10);

/// A limit of the memory of the whole process, bytes.
///
/// Of what a search counts ([`foliate_systems::exploration::memory`]) three quarters of it are allowed, so that the same search
/// ends at the same step on every machine; the rest is room for models and for what is not counted. Beyond that the resident
/// memory of the process is
/// checked while the search runs. Either can only replace an answer by none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MemoryLimit(u64);

/// What is no amount of memory.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("`{0}` is no amount of memory; write bytes, or a number with kB, MB, GB, KiB, MiB or GiB, at least 16 MiB")]
pub struct MemoryLimitError(String);

impl MemoryLimit {
    /// Least that is allowed: the program alone takes half of it.
    const LEAST: u64 = 16 << 20;

    /// So many bytes, at least 16 MiB.
    #[must_use]
    pub fn bytes(bytes: u64) -> Self {
        Self(bytes.max(Self::LEAST))
    }

    /// Three quarters of what the machine, or the control group of the process, has; at most 16 GiB.
    #[must_use]
    pub fn of_machine() -> Self {
        let machine = [total(), group()].into_iter().flatten().min().unwrap_or(UNKNOWN);
        Self::bytes((machine / 4 * 3).min(MOST))
    }

    /// The limit.
    #[must_use]
    pub fn get(self) -> u64 {
        self.0
    }

    /// What each of so many searches side by side may count.
    #[must_use]
    pub fn counted(self, searches: usize) -> u64 {
        self.0 / 4 * 3 / searches.max(1) as u64
    }

    /// Watches over the memory of the process; of systems that do not tell it, nothing.
    #[must_use]
    pub fn guard(self) -> MemoryGuard {
        let started = Instant::now();
        // Most solves end before it is worth a look.
        let next = AtomicU64::new(FRESH.as_millis() as u64);
        MemoryGuard::new(move || {
            let now = started.elapsed().as_millis() as u64;
            let due = next.load(Ordering::Relaxed);
            // One thread reads, the others go on.
            let is_mine = now >= due
                && next
                    .compare_exchange(due, now + FRESH.as_millis() as u64, Ordering::Relaxed, Ordering::Relaxed)
                    .is_ok();
            is_mine && resident().is_some_and(|bytes| bytes > self.0)
        })
    }
}

impl FromStr for MemoryLimit {
    type Err = MemoryLimitError;

    fn from_str(text: &str) -> Result<Self, MemoryLimitError> {
        const UNITS: [(&str, u64); 8] = [
            ("", 1),
            ("B", 1),
            ("kB", 1000),
            ("MB", 1_000_000),
            ("GB", 1_000_000_000),
            ("KiB", 1 << 10),
            ("MiB", 1 << 20),
            ("GiB", 1 << 30),
        ];
        let refused = || MemoryLimitError(text.escape_debug().to_string());
        let digits = text.bytes().take_while(|byte| byte.is_ascii_digit() || *byte == b'.').count();
        let (number, unit) = text.split_at(digits);
        let unit = UNITS.iter().find(|(name, _)| *name == unit.trim()).ok_or_else(refused)?.1;
        let bytes = number.parse::<f64>().map_err(|_| refused())? * unit as f64;
        match bytes.is_finite() && bytes >= Self::LEAST as f64 {
            true => Ok(Self(bytes as u64)),
            false => Err(refused()),
        }
    }
}

impl fmt::Display for MemoryLimit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} MiB", self.0 >> 20)
    }
}

/// Bytes of this process in memory; none where the system does not tell.
#[must_use]
pub fn resident() -> Option<u64> {
    kilobytes("/proc/self/status", "VmRSS:")
}

/// The most that it ever was.
#[must_use]
pub fn peak() -> Option<u64> {
    kilobytes("/proc/self/status", "VmHWM:")
}

fn total() -> Option<u64> {
    kilobytes("/proc/meminfo", "MemTotal:")
}

fn kilobytes(file: &str, key: &str) -> Option<u64> {
    let text = std::fs::read_to_string(file).ok()?;
    let line = text.lines().find_map(|line| line.strip_prefix(key))?;
    line.trim().trim_end_matches("kB").trim().parse::<u64>().ok()?.checked_mul(1024)
}

/// What the control groups of this process allow, the tightest (versions 2 and 1).
fn group() -> Option<u64> {
    let groups = std::fs::read_to_string("/proc/self/cgroup").ok()?;
    let limit = |file: String| std::fs::read_to_string(file).ok()?.trim().parse::<u64>().ok();
    let mut limits = Vec::new();
    for line in groups.lines() {
        let (_, rest) = line.split_once(':')?;
        let (controllers, path) = rest.split_once(':')?;
        let (root, file) = match controllers {
            "" => ("/sys/fs/cgroup", "memory.max"),
            named if named.split(',').any(|name| name == "memory") => {
                ("/sys/fs/cgroup/memory", "memory.limit_in_bytes")
            }
            _ => continue,
        };
        // Inside a container the root is what the container is allowed.
        let mut path = path.trim_end_matches('/');
        loop {
            limits.extend(limit(format!("{root}{path}/{file}")));
            match path.rfind('/') {
                Some(at) => path = &path[..at],
                None => break,
            }
        }
    }
    limits.into_iter().min()
}

#[cfg(test)]
mod tests {
    use super::MemoryLimit;

    #[test]
    fn amounts_have_units() {
        let bytes = |text: &str| text.parse::<MemoryLimit>().map(MemoryLimit::get);
        assert_eq!(bytes("67108864"), Ok(64 << 20));
        assert_eq!(bytes("64MiB"), Ok(64 << 20));
        assert_eq!(bytes("1.5 GiB"), Ok(3 << 29));
        assert_eq!(bytes("2GB"), Ok(2_000_000_000));
        for text in ["", "1", "GiB", "-1GiB", "1TB", "1e9", "infGiB", "NaN", "1.2.3GB", "1 GiB more"] {
            assert!(bytes(text).is_err(), "{text}");
        }
    }

    #[test]
    fn the_machine_has_some_memory() {
        let limit = MemoryLimit::of_machine().get();
        assert!((64 << 20..=super::MOST).contains(&limit), "{limit}");
        assert!(super::resident().is_none_or(|now| now > 1 << 20 && super::peak() >= Some(now)));
    }
}
