//! Bad input: status, place and remedy on stderr, nothing on stdout.

#![allow(clippy::unwrap_used, clippy::expect_used, reason = "an answer that cannot be read is a failure")]

mod common;

use common::{dhc, dhc_reading, file};

#[test]
fn wrong_usage() {
    for (arguments, says) in [
        ("", "Usage"),
        ("fly mycobot", "unrecognized subcommand"),
        ("fk mycobot", "--joints"),
        ("fk mycobot --joints 1,2,x", "`x` is not a number"),
        ("fk mycobot --joints 1,2 --stdin", "cannot be used with"),
        ("fk mycobot --joints 0,0,0,0,0,0 --json --trace", "cannot be used with"),
        ("equations mycobot --part all --format docx", "possible values: text"),
        ("equations mycobot --part arm", "fk, jacobian, ik, all"),
        ("generate mycobot --lang cobol", "possible values: rust"),
        ("generate mycobot --check", "--output"),
        ("generate mycobot --name 3arm", "a name that Rust takes"),
        ("generate mycobot --name Self", "a name that Rust takes"),
        ("ik mycobot --problem tool_down", "--position is missing; a target of kind position has --position"),
        ("ik mycobot --problem tool_down --position 1,2", "--position has 2 numbers where 3 are needed"),
        ("ik mycobot --problem tool_down --position 1,2,3 --yaw 4", "--yaw has no meaning"),
        (
            "ik mycobot --problem tool_down --position 1,2,3 --weights 1,2",
            "--weights has 2 numbers where 6 are needed",
        ),
        ("ik scara --problem place --position 0.4,0.2,0.3 --yaw 30 --weights 1,1,1,nan", "not negative"),
        ("ik scara --problem place --position 0.4,0.2,0.3 --yaw 30 --weights -1,1,1,1", "--weights has -1;"),
        ("ik scara --problem place --position 0.4,0.2,0.3 --yaw 30 --norm most", "squares, greatest"),
        ("ik scara --problem place --position 1,2,3", "--yaw is missing"),
        ("ik scara --problem place --stdin --yaw 3", "the targets are read"),
    ] {
        let stderr = dhc(arguments).failed(2);
        assert!(stderr.contains(says), "{arguments}: {stderr}");
    }
}

#[test]
fn wrong_input() {
    for (arguments, says) in [
        ("fk mycobt --joints 0", "there is a shipped table `mycobot`"),
        ("fk no/such.toml --joints 0", "no file no/such.toml"),
        ("check mycobt", "there is a shipped table `mycobot`"),
        ("fk mycobot --joints 1,2", "2 joint values where 6 are needed\nhelp: the joints are J1, J2"),
        ("fk mycobot --joints 0,0,nan,0,0,0", "joint 3 (J3) is not finite"),
        ("jacobian mycobot --joints 0,0,0,0,0,1e999", "joint 6 (J6) is not finite"),
        ("check-pose scara --joints 0", "the joints are J1, J2, J3, J4"),
        (
            "ik mycobot --problem up --position 1,2,3",
            "no inverse problem `up`\nhelp: --problem takes pose, tool_down",
        ),
        ("ik mycobot --problem tool_down --position 1,inf,3", "infinite or NaN"),
        ("ik mycobot --problem tool_down --position 1e308,2,3", "so far away that the squares"),
        ("ik mycobot --problem tool_down --position 1,2,3 --near 0", "1 joint values where 6 are needed"),
        ("explain nonsense", "lists all"),
        ("explain round-angle", "there is `rounded-angle`"),
    ] {
        let stderr = dhc(arguments).failed(1);
        assert!(stderr.contains(says), "{arguments}: {stderr}");
    }
}

#[test]
fn refusals_of_targets_have_their_numbers_in_the_units_of_the_table() {
    // Beyond the outstretched arm: the elbow's cosine would be more than 1.
    let far = "ik mycobot --problem tool_down --position 350,-100,70";
    assert!(dhc(far).failed(1).contains("step 2 (theta3, joint J3) has no root"));
    let error = &dhc(&format!("{far} --json")).json()["error"];
    assert_eq!((&error["kind"], &error["step"]), (&"unreachable".into(), &2.into()));
    assert_eq!((&error["joints"][0], &error["unit"]), (&"J3".into(), &"ratio".into()));
    assert!(error["excess"].as_f64().unwrap() > 1.0);

    // Between the axis and the offset of 66.39 mm: nothing to turn about.
    let near = "ik mycobot --problem tool_down --position 30,40,70 --json";
    let error = &dhc(near).json()["error"];
    assert_eq!(
        (&error["kind"], &error["step"], &error["unit"]),
        (&"unreachable".into(), &1.into(), &"mm".into())
    );
    assert!((error["excess"].as_f64().unwrap() - 16.39).abs() < 1e-9, "{error}");

    let axis = dhc("ik mycobot --problem tool_down --position 0,0,300 --json");
    assert_eq!(axis.status, 1);
    let error = &axis.json()["error"];
    assert_eq!(
        (&error["kind"], &error["name"], &error["unit"]),
        (&"singular".into(), &"J1".into(), &"mm".into())
    );
    assert!((error["gap"].as_f64().unwrap() - 66.39).abs() < 1e-9, "{error}");

    // Behind the arm.
    let behind = "ik mycobot --problem tool_down --position -150,-100,70";
    let stderr = dhc(behind).failed(1);
    assert!(stderr.contains("outside its limits -90.000000 to 90.000000"), "{stderr}");
    let error = &dhc(&format!("{behind} --json")).json()["error"];
    assert_eq!((&error["kind"], &error["max"]), (&"outside_limits".into(), &90.0.into()));
    let excess = error["excess"].as_f64().unwrap();
    let beyond = error["value"].as_f64().unwrap().abs() - 90.0;
    assert!(excess > 0.0 && (excess - beyond).abs() < 1e-9, "{error}");

    // Under the floor.
    let low = "ik mycobot --problem tool_down --position 150,-100,10";
    assert!(dhc(low).failed(1).contains("below z_min = 15.000000"));
    let error = &dhc(&format!("{low} --json")).json()["error"];
    assert_eq!(
        (&error["kind"], &error["rule"], &error["axis"]),
        (&"forbidden".into(), &"bound".into(), &"z".into())
    );
    assert!((error["value"].as_f64().unwrap() - 10.0).abs() < 1e-9);
    assert!(dhc(&format!("{low} --all")).good().contains("breaks limits or rules"));
}

#[test]
fn a_traced_refusal_shows_its_steps_on_stderr() {
    let stderr = dhc("ik mycobot --problem tool_down --position 350,-100,70 --trace").failed(1);
    assert!(stderr.contains("no root: this branch ends here"), "{stderr}");
    assert!(stderr.trim_end().lines().rev().any(|line| line.starts_with("error: out of reach")), "{stderr}");
}

/// On its axis the arm may turn as it likes, as far as another joint that follows lets it.
#[test]
fn a_trace_comes_with_the_same_answer() {
    let table = "[robot]\nname = \"A\"\nconvention = \"standard\"\nunits = { length = \"mm\", angle = \"deg\" }\n\
        [[joint]]\nalpha = 90\nd = 200\nlimits = [-170, 170]\n[[joint]]\na = 300\nlimits = [-170, 170]\n\
        [[joint]]\na = 300\nalpha = -90\nlimits = [-150, 150]\n[[joint]]\nlimits = [-90, 90]\n\
        [[ik]]\nname = \"p\"\ntarget = \"position\"\nconstraints = [\"q4 = q1 + 170\"]\n";
    let path = file("aside.toml", table);
    let question = format!("ik {} --problem p --position 0,0,600", path.display());
    let plain = dhc(&question).good();
    let traced = dhc(&format!("{question} --trace")).good();
    assert!(plain.contains("2 solutions within limits and rules"), "{plain}");
    assert!(traced.ends_with(&plain), "{traced}");
}

#[test]
fn every_violation_is_listed() {
    let broken = "check-pose mycobot --joints 100,-90,155,0,0,0";
    let stderr = dhc(broken).failed(1);
    assert!(stderr.contains("joint 1 (J1) at 100.000000 deg is 10.000000 deg outside"), "{stderr}");
    assert!(stderr.contains("joint 3 (J3)"), "{stderr}");
    let answer = dhc(&format!("{broken} --json")).json();
    assert_eq!(answer["allowed"], false);
    assert!(answer["violations"].as_array().unwrap().len() >= 2);
    assert_eq!(answer["violations"][0]["value"], 100.0);
    let sum = dhc("check-pose uarm_swift_pro --joints 90,10,10,90").failed(1);
    assert!(sum.contains("lower + upper at 20.000000 deg is 9.000000 deg outside its range"), "{sum}");
}

#[test]
fn json_answers_have_the_error_on_stdout() {
    let run = dhc("fk mycobot --joints 1,2 --json");
    assert_eq!((run.status, run.stderr.as_str()), (1, ""));
    let error = &run.json()["error"];
    assert_eq!((&error["kind"], &error["expected"], &error["got"]), (&"length".into(), &6.into(), &2.into()));
    let run = dhc("fk mycobt --joints 1,2 --json");
    assert_eq!((run.status, &run.json()["error"]["kind"]), (1, &"table".into()));
    let run = dhc("ik mycobot --problem tool_down --position 350,0,0 --json");
    assert_eq!((run.status, run.stderr.as_str()), (1, ""));
    assert_eq!(run.json()["solutions"], serde_json::json!([]));
}

const BROKEN: &str =
    "[robot]\nname = \"x\"\nconvention = \"standard\"\n\n[[joint]]\nd = 1\nlimits = [2, 1]\nalhpa = 0\n";

#[test]
fn tables_with_mistakes_are_drawn_with_place_and_remedy() {
    let path = file("broken.toml", BROKEN);
    let path = path.to_str().unwrap();
    for command in [
        "check",
        "equations",
        "generate",
        "fk --joints 0",
        "jacobian --joints 0",
        "check-pose --joints 0",
        "ik --position 1,2,3",
        "fk --stdin",
    ] {
        let (name, flags) = command.split_once(' ').unwrap_or((command, ""));
        let run = dhc_reading(&format!("{name} {path} {flags}"), b"[0]\n");
        let stderr = run.failed(1);
        for says in ["broken.toml:7:", "limits-order", "broken.toml:8:1", "unknown-key", "alpha"] {
            assert!(stderr.contains(says), "{command}: {stderr}");
        }
    }
}

#[test]
fn one_bad_table_does_not_keep_the_others_from_being_checked() {
    let path = file("broken_too.toml", BROKEN);
    let run = dhc(&format!("check scara {} planar2r", path.display()));
    assert_eq!(run.status, 1);
    assert!(run.stdout.contains("Cobra 600 (scara)") && run.stdout.contains("(planar2r)"), "{}", run.stdout);
    assert!(run.stderr.contains("limits-order"));
}

#[test]
fn warnings_are_drawn_where_tables_are_judged() {
    let table = "[robot]\nname = \"x\"\nconvention = \"standard\"\n\n[[joint]]\na = 1\nalpha = 1.571\n";
    let path = file("rounded.toml", table);
    let checked = dhc(&format!("check {}", path.display()));
    assert_eq!(checked.status, 0, "{}", checked.stderr);
    assert!(checked.stderr.contains("warning[rounded-angle]"), "{}", checked.stderr);
    dhc(&format!("fk {} --joints 0", path.display())).good();
}
