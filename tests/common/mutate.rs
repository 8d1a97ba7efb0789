//! Random changes of small files, for tests that hostile input is refused or read and never a panic, a hang or a flood.
//!
//! A run is a number of inputs from a seed, so that a failure comes again; `FOLIATE_FUZZ_SECONDS` makes it a time, and
//! `FOLIATE_FUZZ_SEED` another run. What a failing input was is kept in the temporary folder, and its name said.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::{Duration, Instant};

/// Inputs of a short run.
const SHORT: u64 = 1500;
/// Longest input, bytes.
const LONGEST: usize = 64 << 10;
/// Processor time that any input may take.
const MOST_TIME: Duration = Duration::from_secs(1);
/// Memory that any input may take at once, bytes.
const MOST_BYTES: u64 = 96 << 20;

/// Texts that readers stumble over, whatever the format.
const WORDS: [&str; 28] = [
    "nan",
    "inf",
    "-0",
    "1e308",
    "1e-320",
    "-1",
    "4294967295",
    "18446744073709551616",
    "0x10",
    "1e9",
    "99999999",
    "\"",
    "<",
    ">",
    "/>",
    "</",
    "<!--",
    "]]>",
    "{",
    "}",
    "[",
    "]",
    ",",
    "\u{0}",
    "\u{feff}",
    "../../../etc/passwd",
    "file:///dev/zero",
    "  ",
];

/// How a run went.
pub struct Run {
    /// Inputs.
    pub inputs: u64,
    /// The most processor time of one.
    pub slowest: Duration,
    /// The most memory of one, bytes.
    pub largest: u64,
}

/// A seed from a name.
fn hash(sum: u64, byte: u8) -> u64 {
    sum.wrapping_mul(31).wrapping_add(u64::from(byte))
}

/// Changes good files at random and has each result read.
///
/// # Panics
/// Where reading one panics, takes more than a second of processor time, or more than 96 MiB.
pub fn fuzz(name: &str, good: &[Vec<u8>], read: impl Fn(&[u8])) -> Run {
    let variable = |name: &str| std::env::var(name).ok().and_then(|value| value.parse::<u64>().ok());
    let seconds = variable("FOLIATE_FUZZ_SECONDS");
    let seed = variable("FOLIATE_FUZZ_SEED").unwrap_or(1);
    let mut random = ChaCha8Rng::seed_from_u64(seed ^ name.bytes().fold(0, hash));
    let started = Instant::now();
    let mut run = Run { inputs: 0, slowest: Duration::ZERO, largest: 0 };
    let goes_on = |inputs: u64| match seconds {
        Some(seconds) => started.elapsed().as_secs() < seconds,
        None => inputs < SHORT,
    };
    while goes_on(run.inputs) {
        let bad = changed(good, &mut random);
        let before = processor_time();
        let mut panicked = false;
        let taken = allocation_counter::measure(|| panicked = catch_unwind(AssertUnwindSafe(|| read(&bad))).is_err());
        let time = processor_time().saturating_sub(before);
        let kept = std::env::temp_dir().join(format!("foliate-fuzz-{name}-{seed}-{}", run.inputs));
        if panicked || time > MOST_TIME || taken.bytes_max > MOST_BYTES {
            std::fs::write(&kept, &bad).expect("the input that failed is kept");
            let bytes = taken.bytes_max;
            panic!("{}: panicked: {panicked}, {time:?} of processor time, {bytes} bytes at once", kept.display());
        }
        run.inputs += 1;
        run.slowest = run.slowest.max(time);
        run.largest = run.largest.max(taken.bytes_max);
    }
    let Run { inputs, slowest, largest } = run;
    println!("{name}: {inputs} inputs, at most {slowest:?} and {largest} bytes each");
    run
}

/// Processor time of this thread, where the system tells it; else the time on the clock.
fn processor_time() -> Duration {
    let told = std::fs::read_to_string("/proc/thread-self/schedstat").ok();
    let told = told.and_then(|text| text.split(' ').next()?.parse().ok()).map(Duration::from_nanos);
    told.unwrap_or_else(|| std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH).unwrap_or_default())
}

fn below(random: &mut ChaCha8Rng, end: usize) -> usize {
    random.next_u64() as usize % end.max(1)
}

/// One to six changes of one of the files.
fn changed(good: &[Vec<u8>], random: &mut ChaCha8Rng) -> Vec<u8> {
    let mut bad = good[below(random, good.len())].clone();
    for _ in 0..=below(random, 6) {
        let at = below(random, bad.len());
        let end = (at + 1 + below(random, 40)).min(bad.len());
        match random.next_u32() % 9 {
            0 if !bad.is_empty() => bad[at] ^= 1 << (random.next_u32() % 8),
            1 if !bad.is_empty() => bad[at] = random.next_u32() as u8,
            2 => drop(bad.drain(at..end)),
            // A number in the place of another.
            3 | 4 => {
                let word = WORDS[below(random, WORDS.len())];
                let digit = |byte: &u8| byte.is_ascii_digit() || b".-+eE".contains(byte);
                let from = (at..bad.len()).find(|&i| digit(&bad[i])).unwrap_or(at);
                let to = (from..bad.len()).find(|&i| !digit(&bad[i])).unwrap_or(from);
                bad.splice(from..to, word.bytes());
            }
            5 => drop(bad.splice(at..at, WORDS[below(random, WORDS.len())].bytes())),
            // A part again and again.
            6 => {
                let part = bad[at.min(end)..end].to_vec();
                let times = 1 << (random.next_u32() % 11);
                bad.splice(at..at, part.iter().copied().cycle().take(part.len() * times));
            }
            // The head of one file, the tail of another.
            7 => {
                let other = &good[below(random, good.len())];
                bad.truncate(at);
                bad.extend(&other[below(random, other.len())..]);
            }
            _ => bad.truncate(at),
        }
        bad.truncate(LONGEST);
    }
    bad
}
