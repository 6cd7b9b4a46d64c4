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

/// `d` of a row whose d is written like this.
fn length(expression: &str) -> f64 {
    model_of(&format!("{MILLIMETRES}[[joint]]\nd = {expression}\n")).rows[0].d
}

fn angle(head: &str, expression: &str) -> Angle {
    model_of(&format!("{head}[[joint]]\nalpha = {expression}\n")).rows[0].alpha
}

#[test]
fn numbers_are_in_the_units_of_the_table_unless_they_bring_their_own() {
    for (written, metres) in [
        ("140", 0.14),
        ("140.0", 0.14),
        ("0x8c", 0.14),
        ("1_40", 0.14),
        ("1.4e2", 0.14),
        ("\"140\"", 0.14),
        ("\"140 mm\"", 0.14),
        ("\"0.14 m\"", 0.14),
        ("\"100 + 40\"", 0.14),
        ("\"100 + 40 mm\"", 0.14),
        ("\"2 * (50 + 20)\"", 0.14),
        ("\"280/2 mm\"", 0.14),
        ("\"100 mm + 0.04 m\"", 0.14),
        ("\"140mm\"", 0.14),
        ("\"--140\"", 0.14),
        ("\"280 * sin(30)\"", 0.14),
        ("\"280 * cos(pi/3)\"", 0.14),
        ("\"sqrt(3*3 + 4*4) * 28\"", 0.14),
        ("\"28 * (pi / (pi/5))\"", 0.14),
        ("'140'", 0.14),
        ("\"\"\"140\"\"\"", 0.14),
    ] {
        assert!((length(written) - metres).abs() < 1e-15, "{written} is {}", length(written));
    }
}

#[test]
fn angles_that_are_multiples_of_15_degrees_are_exact() {
    for (written, fifteenths) in [
        ("90", 6),
        ("-90.0", -6),
        ("\"pi/2\"", 6),
        ("\"1.5707963267948966 rad\"", 6),
        ("\"pi/2 + 90 deg\"", 12),
        ("\"90 deg + pi/2\"", 12),
        ("\"45 + 45\"", 6),
        ("\"pi/2 rad\"", 6),
        ("\"acos(0)\"", 6),
        ("\"asin(0.5)\"", 2),
        ("\"atan(1)\"", 3),
        ("\"atan2(-1, -1)\"", -9),
        ("\"-2*pi/3\"", -8),
        ("\"pi - 2*pi\"", -12),
        ("\"360/24\"", 1),
    ] {
        assert_eq!(angle(MILLIMETRES, written).fifteenths, Some(fifteenths), "{written}");
    }
    assert_eq!(angle(METRES, "1.5707963267948966").fifteenths, Some(6));
    assert_eq!(angle(METRES, "\"sin(pi/6) * pi\"").fifteenths, Some(6));
    let not_quite = angle(METRES, "1.57079");
    assert_eq!((not_quite.value, not_quite.fifteenths), (1.57079, None));
}

#[test]
fn calibrated_and_other_numbers_get_no_warning() {
    for written in ["1.570796", "1.57", "1.5708", "1.571", "3.14159"] {
        let (_, said) = checked(&format!("{METRES}[[joint]]\nalpha = {written}\n"));
        assert!(said.starts_with("warning[rounded-angle]"), "{written}");
    }
    for written in
        ["1.5707", "1.572", "1.6", "2.88", "0.26", "1.5712345", "1.570796326794", "0.0", "0.0001", "7.85e-1"]
    {
        model_of(&format!("{METRES}[[joint]]\nalpha = {written}\n"));
    }
    // In degrees no multiple of 15 needs rounding.
    model_of(&format!("{MILLIMETRES}[[joint]]\nalpha = 1.5708\n[[joint]]\nalpha = 89.98\n"));
}

#[test]
fn base_and_tool_are_exact_too() {
    let rotation = |line: &str| model_of(&format!("{METRES}[[joint]]\n[tool]\n{line}\n")).tool.rotation;
    let rpy = |roll: i32, pitch: i32, yaw: i32| Rotation::Rpy([roll, pitch, yaw].map(Angle::from_fifteenths));
    assert_eq!(rotation("rpy = [0, \"pi/2\", \"-45 deg\"]"), rpy(0, 6, -3));
    assert_eq!(rotation("quaternion = [0, 0, 0, 1]"), rpy(0, 0, 0));
    assert_eq!(rotation("quaternion = [0, 0, 0, -2]"), rpy(0, 0, 0));
    assert_eq!(rotation("quaternion = [0, 0, 0.7071, 0.7071]"), rpy(0, 0, 6));
    assert_eq!(rotation("quaternion = [0, 1, 0, 1]"), rpy(0, 6, 0));
    assert_eq!(rotation("quaternion = [1, 0, 0, 0]"), rpy(12, 0, 0));
    assert_eq!(rotation("quaternion = [1e-200, 0, 0, 1e-200]"), rpy(6, 0, 0));
    let Rotation::Matrix(rows) = rotation("quaternion = [0.1, 0.2, 0.3, 0.9]") else { panic!("not exact") };
    for (i, one) in rows.iter().enumerate() {
        for (j, two) in rows.iter().enumerate() {
            let product: f64 = one.iter().zip(two).map(|(x, y)| x * y).sum();
            assert!((product - if i == j { 1.0 } else { 0.0 }).abs() < 1e-15);
        }
    }
}

#[test]
fn every_quaternion_is_the_rotation_that_it_names() {
    for [x, y, z, w] in [
        [0.1, 0.2, 0.3, 0.9],
        [0.5, 0.5, 0.5, 0.5],
        [0.0, 1.0, 0.0, 1.0],
        [0.0, 1.0, 1.0, 0.0],
        [1.0, -1.0, 0.0, 0.0],
    ] {
        let text = format!("{METRES}[[joint]]\n[tool]\nquaternion = [{x}, {y}, {z}, {w}]\n");
        let tool = product::frames(&model_of(&text), &[0.0]).tool;
        // v + 2 u x (u x v + w v), for a unit quaternion (u, w)
        let length = f64::sqrt(x * x + y * y + z * z + w * w);
        let ([x, y, z], w) = ([x / length, y / length, z / length], w / length);
        let cross = |a: [f64; 3], b: [f64; 3]| {
            [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
        };
        for column in 0..3 {
            let mut v = [0.0; 3];
            v[column] = 1.0;
            let u = [x, y, z];
            let inner = cross(u, v);
            let outer = cross(u, [0, 1, 2].map(|i| inner[i] + w * v[i]));
            for row in 0..3 {
                assert!((tool[row][column] - (v[row] + 2.0 * outer[row])).abs() < 1e-15);
            }
        }
    }
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
fn constraints_in_q_and_names_are_turned_into_theta() {
    let text = format!(
        "{MILLIMETRES}[[joint]]\nname = \"base\"\ndirection = -1\noffset = 90\n[[joint]]\nname = \"lower\"\noffset = 30\n\
         [[joint]]\ncouple = {{ lower = -1 }}\noffset = 10\n[[joint]]\ntype = \"prismatic\"\noffset = 5\n[[ik]]\n\
         name = \"held\"\ntarget = \"direction\"\nconstraints = [\"base = 20\", \"q4 = 30\"]\n\
         where = [\"J3 >= 0\", \"2*lower < pi\", \"d4 > 20 mm\"]\n"
    );
    let problem = &model_of(&text).problems[0];
    // theta1 = -q1 + 90 deg, so q1 = 20 deg is -theta1 = 20 deg - 90 deg.
    assert_eq!(problem.constraints[0].terms, [(0, -1.0)]);
    assert!((problem.constraints[0].constant.value + 70.0 / 180.0 * PI).abs() < 1e-15);
    // d4 = q4 + 5 mm
    assert_eq!(problem.constraints[1].terms, [(3, 1.0)]);
    assert!((problem.constraints[1].constant.value - 0.035).abs() < 1e-15);
    // theta3 = q3 - q2 + 10, theta2 = q2 + 30: q3 = theta3 - 10 + theta2 - 30, and 0 - q3 <= 0.
    let [third, second, slide] = problem.filters.as_slice() else { panic!("three filters") };
    assert_eq!(third.form.terms, [(1, -1.0), (2, -1.0)]);
    assert!((third.form.constant.value - 40.0 / 180.0 * PI).abs() < 1e-15);
    assert!(!third.strict);
    assert_eq!((second.form.terms.as_slice(), second.strict), (&[(1, 2.0)][..], true));
    assert!((second.form.constant.value - (-PI / 3.0 - PI)).abs() < 1e-15);
    assert_eq!((slide.form.terms.as_slice(), slide.form.constant.value), (&[(3, -1.0)][..], 0.02));
}

#[test]
fn a_bare_addend_is_in_units_of_the_table() {
    let problem = |constraint: &str| {
        let text = format!(
            "{MILLIMETRES}[[joint]]\n[[joint]]\n[[joint]]\n[[ik]]\nname = \"x\"\ntarget = \"xy\"\nconstraints = [\"{constraint}\"]\n"
        );
        model_of(&text).problems[0].constraints[0].constant.fifteenths
    };
    assert_eq!(problem("theta1 = 90 - theta2"), Some(6));
    assert_eq!(problem("theta1 + theta2 - 90 = 0"), Some(6));
    assert_eq!(problem("theta1 = pi/2 - theta2"), Some(6));
    assert_eq!(problem("theta1 = 90 deg - theta2"), Some(6));
    assert_eq!(problem("theta1 - pi/2 = 0"), Some(6));
    assert_eq!(problem("theta1 / 2 = 45 deg"), Some(3));
}

#[test]
fn held_joints_may_be_coupled() {
    // A palletiser: the wrist stays level.
    let text = format!(
        "{METRES}[[joint]]\nalpha = \"pi/2\"\n[[joint]]\na = 0.2\n[[joint]]\na = 0.2\ncouple = {{ J2 = -1 }}\n[[joint]]\n\
         a = 0.05\nfixed = 0\ncouple = {{ J3 = -1 }}\n[[joint]]\n[[ik]]\nname = \"level\"\ntarget = \"position_yaw\"\n[[ik]]\n\
         name = \"straight\"\ntarget = \"position\"\nconstraints = [\"theta4 = theta2\"]\n"
    );
    let model = model_of(&text);
    assert_eq!(model.joints, [0, 1, 2, 4]);
    assert_eq!(model.rows[3].terms, [(2, -1.0)]);
    assert_eq!(model.problems[1].constraints[0].terms, [(1, -1.0), (3, 1.0)]);
    assert_eq!(model.windings.len(), 4);
    assert!(model.windings.iter().all(|winding| winding.turn == TAU && winding.carries.is_empty()));
}

#[test]
fn windings_leave_every_frame_where_it_is() {
    let tables = [
        "[[joint]]\n[[joint]]\n[[joint]]\ncouple = { J2 = 0.5 }\n",
        "[[joint]]\n[[joint]]\nfixed = 0\ncouple = { J1 = 0.25 }\n[[joint]]\ncouple = { J1 = -1 }\ndirection = -1\n",
        "[[joint]]\ncouple = { J3 = 0.5 }\n[[joint]]\ncouple = { J1 = 0.5 }\n[[joint]]\n",
        "[[joint]]\n[[joint]]\ntype = \"prismatic\"\ncouple = { J1 = 0.01 }\n[[joint]]\ncouple = { J2 = 3 }\n",
    ];
    for (rows, count) in tables.into_iter().zip([3, 2, 3, 2]) {
        let rows = rows.replace("[[joint]]\n", "[[joint]]\na = 0.2\nalpha = 0.4\n");
        let model = model_of(&format!("{METRES}{rows}"));
        assert_eq!(model.windings.len(), count, "{rows}");
        let q: Vec<f64> = (0..model.joints.len()).map(|joint| 0.3 + 0.4 * joint as f64).collect();
        let before = product::frames(&model, &q);
        let mut seen: Vec<usize> = Vec::new();
        for winding in &model.windings {
            assert!(winding.turn > 0.0);
            seen.push(winding.joint);
            let mut wound = q.clone();
            wound[winding.joint] += winding.turn;
            for &(joint, by) in &winding.carries {
                wound[joint] += by;
                assert!(!seen.contains(&joint), "{rows}: joint {joint} is carried after its own turn");
            }
            let after = product::frames(&model, &wound);
            for (one, two) in before.rows.iter().zip(&after.rows) {
                let difference = one.iter().flatten().zip(two.iter().flatten()).map(|(x, y)| (x - y).abs());
                assert!(difference.fold(0.0, f64::max) < 1e-12, "{rows}: {winding:?}");
            }
        }
    }
    let halves = model_of(&format!("{METRES}[[joint]]\n[[joint]]\n[[joint]]\ncouple = {{ J2 = 0.5 }}\n"));
    assert_eq!(halves.windings[1].carries, [(2, PI)]);
}

#[test]
fn problems_that_come_out_even() {
    let joints = |count: usize| format!("{METRES}{}", "[[joint]]\nalpha = \"pi/2\"\na = 0.1\n".repeat(count));
    for (count, target, more) in [
        (2, "xy", ""),
        (2, "direction", ""),
        (2, "lookat", ""),
        (3, "xy_yaw", ""),
        (3, "position", ""),
        (3, "rotation", ""),
        (4, "position_yaw", ""),
        (4, "ray", ""),
        (5, "position_direction", ""),
        (6, "pose", ""),
        (4, "pose", ""),
        (6, "pose", "constraints = [\"q1 = 0\"]"),
        (7, "pose", "free = [\"J3\"]"),
        (7, "position", "constraints = [\"q1 = 0\", \"q2 = q3\"]\nfree = [\"J4\", \"J5\"]"),
    ] {
        let text = format!("{}[[ik]]\nname = \"x\"\ntarget = \"{target}\"\n{more}\n", joints(count));
        let problem = &model_of(&text).problems[0];
        assert_eq!(problem.target.name(), target);
    }
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
