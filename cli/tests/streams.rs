//! Lines of JSON in and out.

#![allow(clippy::unwrap_used, clippy::expect_used, reason = "an answer that cannot be read is a failure")]

mod common;

use common::{command, dhc, dhc_reading, numbers};
use std::io::{BufRead, BufReader, Write};
use std::process::Stdio;
use std::sync::mpsc;
use std::time::Duration;

#[test]
fn every_line_has_an_answer_in_order() {
    let input = b"[0,0,0,0,0,0]\n[1]\n\nnonsense\n[0,0,0,0,0,\"0\"]\n{\"q\":1}\n[1e999,0,0,0,0,0]\n\xff\xfe\n[90,0,0,0,0,0]";
    let run = dhc_reading("fk mycobot --stdin", input);
    assert_eq!((run.status, run.stderr.as_str()), (1, ""));
    let answers: Vec<serde_json::Value> =
        run.stdout.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    assert_eq!(answers.len(), 9);
    let kinds: Vec<&str> =
        answers.iter().map(|answer| answer["error"]["kind"].as_str().unwrap_or("")).collect();
    let bad = "malformed";
    assert_eq!(kinds, ["", "length", bad, bad, bad, bad, bad, bad, ""]);
    assert_eq!(answers[1]["error"]["expected"], 6);
    for (line, joints) in [(0, "0,0,0,0,0,0"), (8, "90,0,0,0,0,0")] {
        let one = dhc(&format!("fk mycobot --json --joints {joints}")).good();
        assert_eq!(run.stdout.lines().nth(line), Some(one.trim_end()));
    }
}

#[test]
fn a_target_without_solution_is_no_mistake() {
    let input = b"{\"position\":[150,-100,70]}\n{\"position\":[450,-100,70]}\n{\"position\":[0,0,300]}\n";
    let run = dhc_reading("ik mycobot --problem tool_down --stdin", input);
    assert_eq!((run.status, run.stderr.as_str()), (0, ""));
    let kinds: Vec<String> = run
        .stdout
        .lines()
        .map(|line| serde_json::from_str::<serde_json::Value>(line).unwrap()["error"]["kind"].to_string())
        .collect();
    assert_eq!(kinds, ["null", "\"unreachable\"", "\"singular\""]);
    // An answer without solution is its error and nothing else.
    assert!(run.stdout.lines().skip(1).all(|line| line.starts_with("{\"error\":{")), "{}", run.stdout);
    let first: serde_json::Value = serde_json::from_str(run.stdout.lines().next().unwrap()).unwrap();
    let solution = &first["solutions"][0];
    assert_eq!(solution["within_limits"], true);
    assert!(solution["position_error"].as_f64().unwrap() < 1e-9);
    let one = dhc("ik mycobot --problem tool_down --json --position 150,-100,70").json();
    assert_eq!(first, one);
}

/// A line may say what it is to be near to; else what the flags say counts.
#[test]
fn what_to_be_near_to_may_change_from_line_to_line() {
    let command = "ik planar2r --problem xy --all";
    let flags = ["--near 0.2,1.5", "--near 1.4,-1.5", "--near 0.2,1.5"];
    let wanted = flags.map(|near| dhc(&format!("{command} --json --position 0.2,0.1 {near}")).json());
    assert_ne!(wanted[0], wanted[1]);
    let input =
        b"{\"position\":[0.2,0.1]}\n{\"position\":[0.2,0.1],\"near\":[1.4,-1.5]}\n{\"position\":[0.2,0.1]}\n";
    let run = dhc_reading(&format!("{command} --stdin {}", flags[0]), input);
    let answers: Vec<serde_json::Value> =
        run.good().lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    assert_eq!(answers, wanted);
    let wrong = b"{\"position\":[0.2,0.1],\"near\":[1]}\n{\"position\":[0.2,0.1],\"near\":1}\n";
    let run = dhc_reading(&format!("{command} --stdin"), wrong);
    assert_eq!(run.status, 1);
    assert!(run.stdout.contains("1 joint values where 2 are needed"), "{}", run.stdout);
    assert!(run.stdout.contains("`near` is not a list of numbers"), "{}", run.stdout);
}

/// Solutions come in the order of the measure that was asked for.
#[test]
fn what_counts_as_nearest_may_be_said() {
    let near = [0.3, -1.2, 0.8, 0.1, 0.5, 0.2];
    let command = "ik ur5e --json --position 0.4,0.2,0.5 --rpy 0.3,-0.2,1 --near 0.3,-1.2,0.8,0.1,0.5,0.2";
    let ways = |flags: &str, way: &dyn Fn([f64; 6]) -> f64| -> Vec<f64> {
        let answer = dhc(&format!("{command} {flags}")).json();
        let solutions = answer["solutions"].as_array().unwrap().iter();
        let apart = |solution: &serde_json::Value| {
            std::array::from_fn(|joint| solution["q"][joint].as_f64().unwrap() - near[joint])
        };
        solutions.map(|solution| way(apart(solution))).collect()
    };
    let greatest = |apart: [f64; 6]| apart.iter().fold(0.0, |most: f64, way| most.max(way.abs()));
    let last = |apart: [f64; 6]| apart[5].abs();
    for all in ["", "--all"] {
        let sorted = ways(&format!("--norm greatest {all}"), &greatest);
        assert!(sorted.len() == 8 && sorted.is_sorted(), "{sorted:?}");
        assert!(!ways(all, &greatest).is_sorted(), "another order than by squares");
        let sorted = ways(&format!("--weights 0,0,0,0,0,2 {all}"), &last);
        assert!(sorted.len() == 8 && sorted.is_sorted(), "{sorted:?}");
    }
}

#[test]
fn targets_that_are_not_written_as_they_must_be() {
    let lines = [
        ("{\"pos\":[1,2,3]}", "unknown key `pos`; a target of kind position_yaw has position and yaw"),
        ("{\"position\":[1,2,3]}", "yaw is missing"),
        ("{\"position\":[1,2],\"yaw\":0}", "position has 2 numbers where 3 are needed"),
        ("{\"position\":[1,2,\"3\"],\"yaw\":0}", "`position` is not a list of numbers"),
        ("{\"position\":[1,2,3],\"yaw\":[0]}", "`yaw` is not a number"),
        ("{\"position\":[1,2,3],\"yaw\":0,\"direction\":[0,0,1]}", "direction has no meaning"),
        ("[1,2,3]", "not an object"),
    ];
    let input = lines.map(|(line, _)| line).join("\n");
    let run = dhc_reading("ik scara --problem place --stdin", input.as_bytes());
    assert_eq!(run.status, 1);
    assert_eq!(run.stdout.lines().count(), lines.len());
    for (answer, (line, says)) in run.stdout.lines().zip(lines) {
        let answer: serde_json::Value = serde_json::from_str(answer).unwrap();
        assert_eq!(answer["error"]["kind"], "malformed", "{line}");
        assert!(answer["error"]["message"].as_str().unwrap().contains(says), "{line}: {answer}");
    }
}

#[test]
fn solutions_come_back_to_the_pose_they_were_asked_from() {
    let mut input = Vec::new();
    let mut asked = Vec::new();
    for k in 0..50 {
        let q = [f64::from(k) * 1.7 - 40.0, f64::from(k % 7) * 9.0 - 20.0, 0.004 * f64::from(k), 11.0];
        input.push(serde_json::json!(q).to_string());
        asked.push(q);
    }
    let poses = dhc_reading("fk scara --stdin", input.join("\n").as_bytes()).good();
    let targets: Vec<String> = poses
        .lines()
        .map(|line| {
            let pose: serde_json::Value = serde_json::from_str(line).unwrap();
            let turn = |row: usize| pose["matrix"][row][0].as_f64().unwrap();
            let yaw = turn(1).atan2(turn(0)).to_degrees();
            serde_json::json!({"position": pose["position"], "yaw": yaw}).to_string()
        })
        .collect();
    let answers = dhc_reading("ik scara --problem place --all --stdin", targets.join("\n").as_bytes()).good();
    for (line, q) in answers.lines().zip(asked) {
        let answer: serde_json::Value = serde_json::from_str(line).unwrap();
        let near = |solution: &serde_json::Value| {
            numbers(&solution["q"]).iter().zip(q).all(|(found, asked)| (found - asked).abs() < 1e-6)
        };
        assert!(answer["solutions"].as_array().unwrap().iter().any(near), "{q:?}: {line}");
    }
}

#[test]
fn an_answer_does_not_wait_for_the_next_question() {
    let mut child = command("fk planar2r --stdin").stdin(Stdio::piped()).spawn().unwrap();
    let mut stdin = child.stdin.take().unwrap();
    let stdout = BufReader::new(child.stdout.take().unwrap());
    let (sender, receiver) = mpsc::channel();
    let reader = std::thread::spawn(move || {
        for line in stdout.lines() {
            sender.send(line.unwrap()).unwrap();
        }
    });
    for _ in 0..3 {
        stdin.write_all(b"[0, 0]\n").unwrap();
        let answer = receiver.recv_timeout(Duration::from_secs(20)).expect("an answer while stdin is open");
        assert!(answer.starts_with("{\"position\":["), "{answer}");
    }
    drop(stdin);
    reader.join().unwrap();
    assert!(child.wait().unwrap().success());
}

#[test]
fn a_line_without_end_is_refused_and_the_next_one_answered() {
    let mut input = vec![b'1'; 1 << 20];
    input.extend_from_slice(b"\n[0, 0]\n");
    let run = dhc_reading("fk planar2r --stdin", &input);
    assert_eq!(run.status, 1);
    let lines: Vec<&str> = run.stdout.lines().collect();
    assert_eq!(lines.len(), 2);
    assert!(lines[0].contains("has more than") && lines[1].starts_with("{\"position\""), "{lines:?}");
}

#[test]
fn memory_does_not_grow_with_the_stream() {
    const LINES: usize = 200_000;
    let mut child = command("fk planar2r --stdin").stdin(Stdio::piped()).spawn().unwrap();
    let mut stdin = child.stdin.take().unwrap();
    let stdout = BufReader::new(child.stdout.take().unwrap());
    let reader = std::thread::spawn(move || stdout.lines().count());
    let block = "[0.1, -0.2]\n".repeat(1000);
    let mut early = None;
    for round in 0..LINES / 1000 {
        stdin.write_all(block.as_bytes()).unwrap();
        if round == 20 {
            early = resident(child.id());
        }
    }
    let late = resident(child.id());
    drop(stdin);
    assert_eq!(reader.join().unwrap(), LINES);
    assert!(child.wait().unwrap().success());
    if let (Some(early), Some(late)) = (early, late) {
        assert!(late < early + 2048, "{early} KiB, then {late} KiB");
    }
}

/// KiB that a process has in memory, where the system says so.
fn resident(process: u32) -> Option<usize> {
    let status = std::fs::read_to_string(format!("/proc/{process}/status")).ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:"))?;
    line.trim().trim_end_matches(" kB").parse().ok()
}

#[test]
fn a_reader_that_has_seen_enough_is_no_error() {
    let mut child = command("fk planar2r --stdin").stdin(Stdio::piped()).spawn().unwrap();
    let mut stdin = child.stdin.take().unwrap();
    let mut stdout = BufReader::new(child.stdout.take().unwrap());
    stdin.write_all(b"[0, 0]\n").unwrap();
    stdout.read_line(&mut String::new()).unwrap();
    drop(stdout);
    // The answers have nowhere to go; writing on may fail once the program has ended.
    let block = "[0, 0]\n".repeat(10_000);
    let _ = stdin.write_all(block.as_bytes());
    drop(stdin);
    let output = child.wait_with_output().unwrap();
    assert_eq!((output.status.code(), output.stderr.as_slice()), (Some(0), &b""[..]));
}
