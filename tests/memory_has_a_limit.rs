//! Promise: a search that needs more memory than it may have ends with outcome `memory_limit`, in time; a limit only ever turns an
//! answer into none. Each case runs in a process of its own, whose memory is measured.
#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used, reason = "what a test expects and does not find fails it")]

use foliate::components::outcome::SearchOutcome;
use foliate::components::problem::{Goal, Problem};
use foliate::components::samples::{boxes_on_a_table, crowd, swap_two_boxes};
use foliate::memory::{MemoryLimit, peak, resident};
use foliate::planner::outcome_name;
use foliate::{NoSolutionReason, Planner};
use std::process::Command;
use std::time::{Duration, Instant};

/// Tells a process of this test which case it is.
const CASE: &str = "FOLIATE_TEST_MEMORY_CASE";

/// Runs a case in a process of its own; whether this is that process.
fn alone(name: &str) -> bool {
    if std::env::var(CASE).is_ok_and(|case| case == name) {
        return true;
    }
    let mut command = Command::new(std::env::current_exe().unwrap());
    let output =
        command.args(["--exact", name, "--nocapture", "--test-threads", "1"]).env(CASE, name).output().unwrap();
    let told = [output.stdout, output.stderr].map(|text| String::from_utf8_lossy(&text).into_owned()).concat();
    assert!(output.status.success(), "{told}");
    false
}

/// Sixteen arms and sixty boxes, each of which has to change places with another: not solved in minutes.
fn hopeless_crowd() -> Problem {
    let mut problem = crowd(16, 60).unwrap();
    let mut goal = problem.start.clone();
    let first = goal.len() - 60 * 7;
    (0..30).for_each(|pair| (0..7).for_each(|k| goal.swap(first + 14 * pair + k, first + 14 * pair + 7 + k)));
    problem.goals = vec![Goal::Configuration(goal)];
    problem
}

#[test]
fn a_crowd_ends_in_time() {
    if !alone("a_crowd_ends_in_time") {
        return;
    }
    let limit = MemoryLimit::bytes(192 << 20);
    let planner = Planner::new(hopeless_crowd()).unwrap().memory_limit(limit).time_limit(Duration::from_secs(300));
    let before = resident().unwrap();
    let started = Instant::now();
    let mut search = planner.search();
    assert_eq!(search.run(), SearchOutcome::MemoryLimit);
    assert!(started.elapsed() < Duration::from_secs(200));
    let (counted, grown) = (search.bytes(), resident().unwrap() - before);
    // What was counted is what was taken: neither far less, so that the limit would not hold, nor far more.
    assert!(counted >= limit.counted(1), "{counted} bytes counted");
    assert!(grown < counted + counted / 3 && counted < 3 * grown, "{counted} bytes counted, {grown} taken");
    assert!(peak().unwrap() < limit.get(), "{} bytes of {limit}", peak().unwrap());
}

#[test]
fn an_endless_search_ends_too() {
    if !alone("an_endless_search_ends_too") {
        return;
    }
    for scheduler in ["sequence", "mrrt", "portfolio"] {
        // Out of reach: only a limit ends it.
        let problem = boxes_on_a_table(&[(0.6, 0.1)], &[(1.25, 0.0)]).unwrap();
        let limit = MemoryLimit::bytes(resident().unwrap() + (8 << 20));
        let planner = Planner::new(problem).unwrap().scheduler_named(scheduler).unwrap();
        let answer = planner.memory_limit(limit).time_limit(Duration::from_secs(120)).solve();
        assert_eq!(outcome_name(&answer), "memory_limit", "{scheduler}");
        assert!(resident().unwrap() < limit.get() + (4 << 20), "{scheduler}: {} of {limit}", resident().unwrap());
    }
}

#[test]
fn a_limit_changes_no_answer_but_into_none() {
    let planner = |limit: u64| Planner::new(swap_two_boxes().unwrap()).unwrap().memory_limit(MemoryLimit::bytes(limit));
    let (ample, scarce) = (planner(8 << 30).solve(), planner(16 << 20).solve());
    let ample = ample.expect("a path");
    // This process has more than 16 MiB already, or has not and then the answer is the same.
    match scarce {
        Ok(scarce) => assert_eq!(ample.report.fingerprint, scarce.report.fingerprint),
        Err(none) => assert!(matches!(none.reason, NoSolutionReason::MemoryLimit), "{none}"),
    }
    let again = planner(8 << 30).solve().expect("a path");
    assert_eq!(again.report.fingerprint, ample.report.fingerprint);
}

#[test]
fn reading_keeps_the_limit_too() {
    let folder = std::env::temp_dir().join(format!("foliate-memory-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    // Some ten million numbers in a path file of 30 MB.
    let mut text = String::from("{\"format\":\"foliate.path/1\",\"segments\":[");
    text.push_str(&"[0,1,2,3,4,5,6,7,8,9],".repeat(1_400_000));
    text.push_str("0]}");
    let path = folder.join("path.json");
    std::fs::write(&path, text).unwrap();
    let foliate = |arguments: &[&str]| Command::new(env!("CARGO_BIN_EXE_foliate")).args(arguments).output().unwrap();
    let output = foliate(&["check", path.to_str().unwrap(), "--memory-limit", "24MiB"]);
    let told = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{told}");
    let output = foliate(&["solve", "demo", "--memory-limit", "1"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("no amount of memory"));
    let output = foliate(&["solve", "demo", "--memory-limit", "1GiB"]);
    assert_eq!(output.status.code(), Some(0));
    let _gone = std::fs::remove_dir_all(&folder);
}
