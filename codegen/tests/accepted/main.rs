//! What tables mean: the model that comes of them, in SI.
#![allow(clippy::expect_used, reason = "a test fails with it")]
#![allow(clippy::approx_constant, reason = "rounded numbers are what is tested")]

use core::f64::consts::{FRAC_PI_2, PI, TAU};
use dh_codegen::diagnostic::{Diagnostics, Style};
use dh_codegen::model::{self, Angle, Convention, JointKind, Limits, Model, Rotation, Target, product};
use dh_codegen::table;

/// The model of a table about which nothing is to be said.
fn model_of(text: &str) -> Model {
    let (model, said) = checked(text);
    assert_eq!(said, "", "{text}");
    model
}

fn checked(text: &str) -> (Model, String) {
    let mut diagnostics = Diagnostics::new();
    let table = table::parse(text, &mut diagnostics);
    let model = model::check(&table, &mut diagnostics).expect("the rows can be read");
    (model, diagnostics.render(text, "test.toml", Style::Plain))
}

mod numbers;
mod problems;

const METRES: &str = "[robot]\nname = \"test\"\nconvention = \"standard\"\n";
const MILLIMETRES: &str =
    "[robot]\nname = \"test\"\nconvention = \"standard\"\nunits = { length = \"mm\", angle = \"deg\" }\n";

/// The table that the reference of the format shows.
const REFERENCE: &str = include_str!("reference.toml");

/// Its `rest` is outside its own example of a `[[limit]]`, which is a doubt and no mistake.
fn reference(text: &str) -> Model {
    let (model, said) = checked(text);
    assert_eq!(said.matches("warning[pose-outside-limits]").count(), 1, "{said}");
    assert!(!said.contains("error"), "{said}");
    model
}

#[test]
fn the_table_of_the_reference() {
    let model = reference(REFERENCE);
    assert_eq!(model.name, "myCobot 280 Pi");
    assert_eq!(model.manufacturer.as_deref(), Some("Elephant Robotics"));
    assert_eq!(model.convention, Convention::Standard);
    assert_eq!((model.rows.len(), model.joints.len()), (6, 6));
    let first = &model.rows[0];
    assert_eq!((first.d, first.a, first.kind), (0.14, 0.0, JointKind::Revolute));
    assert_eq!(first.alpha.fifteenths, Some(6));
    assert_eq!(first.limits, Some(Limits { min: -FRAC_PI_2, max: FRAC_PI_2 }));
    assert!((first.max_velocity.unwrap() - 160.0 / 180.0 * PI).abs() < 1e-15);
    assert_eq!(&REFERENCE[first.span.clone()][..9], "[[joint]]");
    assert!(REFERENCE[first.span.clone()].ends_with("zero = -90 }"));
    assert_eq!(
        REFERENCE.lines().nth(first.line - 1).unwrap().trim_end(),
        "[[joint]]                    # one entry a joint, base to tip"
    );
    let servo = first.servo.as_ref().unwrap();
    assert_eq!((servo.id, servo.zero, servo.range), (Some(1), -90.0, None));
    assert!((servo.scale * FRAC_PI_2 + servo.zero).abs() < 1e-12);
    assert_eq!(model.rows[1].theta.fifteenths, Some(6));
    assert_eq!(model.workspace.bounds.len(), 1);
    assert_eq!((model.workspace.bounds[0].axis, model.workspace.bounds[0].is_min), (2, true));
    assert_eq!(model.workspace.bounds[0].value, 0.015);
    assert_eq!(model.workspace.keep_out[0].min, [-0.05, -0.05, 0.0]);
    assert_eq!(model.sums[0].terms, [(1, 1.0), (2, 1.0)]);
    assert_eq!(
        model.poses.iter().map(|pose| (pose.name.as_str(), pose.safe)).collect::<Vec<_>>(),
        [("zero", false), ("rest", true)]
    );
    assert_eq!(model.device.as_ref().unwrap().keys, [("baud".to_owned(), "1000000".to_owned())]);
    assert_eq!(model.problems.len(), 2);
    let down = &model.problems[0];
    assert_eq!((down.name.as_str(), down.target), ("tool_down", Target::Position));
    // theta2 + theta3 + theta4 = pi/2, theta5 = -pi/2, theta6 - theta1 = 0
    assert_eq!(down.constraints[0].terms, [(1, 1.0), (2, 1.0), (3, 1.0)]);
    assert_eq!(down.constraints[0].constant.fifteenths, Some(6));
    assert_eq!(down.constraints[1].terms, [(4, 1.0)]);
    assert_eq!(down.constraints[1].constant.fifteenths, Some(-6));
    assert_eq!(down.constraints[2].terms, [(0, -1.0), (5, 1.0)]);
    assert_eq!(down.constraints[2].constant.fifteenths, Some(0));
    let up = &model.problems[1].filters[0];
    assert_eq!((up.form.terms.as_slice(), up.form.constant.value, up.strict), (&[(2, 1.0)][..], 0.0, false));
    assert_eq!(model.windings.len(), 6);
    assert!(model.windings.iter().all(|winding| winding.turn == TAU && winding.carries.is_empty()));
}

#[test]
fn prismatic_joints_slide_and_held_joints_stay() {
    let model = model_of(&format!(
        "{MILLIMETRES}[[joint]]\ntype = \"prismatic\"\ntheta = 90\noffset = 20\ndirection = -1\nlimits = [0, 100]\n\
         servo = {{ counts_per_unit = 10 }}\n[[joint]]\nfixed = 30\noffset = 60\ndirection = -1\n[[joint]]\n\
         couple = {{ J1 = 0.5 }}\n[poses]\nhome = [50, \"pi/4\"]\n"
    ));
    assert_eq!(model.joints, [0, 2]);
    let [slide, held, turn] = model.rows.as_slice() else { panic!("three rows") };
    assert_eq!((slide.d, slide.theta.fifteenths, slide.terms.as_slice()), (0.02, Some(6), &[(0, -1.0)][..]));
    assert_eq!(slide.limits, Some(Limits { min: 0.0, max: 0.1 }));
    assert!((slide.servo.as_ref().unwrap().scale - 10_000.0).abs() < 1e-9);
    assert_eq!((held.variable, held.terms.len(), held.theta.fifteenths), (None, 0, Some(2)));
    // Half a degree per millimetre.
    assert_eq!(turn.terms[1], (1, 1.0));
    assert!((turn.terms[0].1 - 0.5 * PI / 180.0 * 1000.0).abs() < 1e-12);
    assert_eq!(model.poses[0].q, [0.05, PI / 4.0]);
    assert_eq!(model.windings.len(), 1);
}

#[test]
fn a_list_of_rows_is_as_good_as_headers() {
    let model = model_of(
        "joint = [{ a = 0.3 }, { a = 0.2, name = \"elbow\" }]\n[robot]\nname = \"x\"\nconvention = \"modified\"\n",
    );
    assert_eq!(
        model.rows.iter().map(|row| (row.name.as_str(), row.line)).collect::<Vec<_>>(),
        [("J1", 1), ("elbow", 1)]
    );
    // The servo after [[joint]] rows belongs to the last one.
    let model = model_of(&format!("{METRES}[[joint]]\n[[joint]]\n[joint.servo]\nid = 4\n"));
    assert_eq!(model.rows[1].servo.as_ref().and_then(|servo| servo.id), Some(4));
    assert!(model.rows[0].servo.is_none());
}

#[test]
fn the_fingerprint_follows_what_is_computed_and_nothing_else() {
    let fingerprint = |text: &str| reference(text).fingerprint;
    let reference = fingerprint(REFERENCE);
    for (from, to) in [
        ("d = 140.0 ", "d = \"0.14 m\" "),
        ("name = \"myCobot 280 Pi\"", "name = \"another\"\n\n# a remark"),
        ("alpha = 90\n", "alpha = \"pi/2\"\n"),
        ("convention = \"standard\"", "\tconvention = 'standard'"),
        ("\n", "\r\n"),
    ] {
        assert!(REFERENCE.contains(from));
        assert_eq!(fingerprint(&REFERENCE.replace(from, to)), reference, "{from} -> {to}");
    }
    let mut others = vec![reference];
    for (from, to) in [
        ("d = 140.0 ", "d = 141 "),
        ("a = 0\n", "a = -1\n"),
        ("convention = \"standard\"", "convention = \"modified\""),
        ("direction = 1 ", "direction = -1 "),
        ("limits = [-90, 90]  ", "limits = [-90, 91]  "),
        ("max_velocity = 160 ", "max_velocity = 161 "),
        ("zero = -90", "zero = -91"),
        ("z_min = 15", "z_min = 16"),
        ("range = [-190, 10]", "range = [-191, 10]"),
        ("safe = true", "safe = false"),
        ("where = [\"theta3 <= 0\"]", "where = [\"theta3 < 0\"]"),
        ("baud = 1000000", "baud = 115200"),
    ] {
        assert!(REFERENCE.contains(from), "{from}");
        let other = fingerprint(&REFERENCE.replace(from, to));
        assert!(!others.contains(&other), "{from} -> {to}");
        others.push(other);
    }
}

#[test]
fn a_table_of_more_than_256_kib_is_refused() {
    let mut diagnostics = Diagnostics::new();
    let text = format!("{METRES}[[joint]]\n{}", "# \n".repeat(100_000));
    let table = table::parse(&text, &mut diagnostics);
    assert!(model::check(&table, &mut diagnostics).is_none());
    expect_test::expect![[r"
        error[too-large]: the table has 293 KiB, more than the 256 KiB that a table may have
        --> large.toml
         = help: leave out what is not part of the robot"]]
    .assert_eq(&diagnostics.render(&text, "large.toml", Style::Plain));
}

#[test]
fn there_is_a_model_in_spite_of_mistakes_for_what_else_is_generated() {
    let (model, said) = checked(&format!("{METRES}[[joint]]\nalpah = 1\n[[joint]]\nd = \"1 +\"\n"));
    assert_eq!(model.joints.len(), 2);
    assert_eq!(said.matches("error[").count(), 2, "{said}");
}
