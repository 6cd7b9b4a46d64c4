//! Couplings, constraints and inverse problems.

use super::*;

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
    // Inequalities keep their variables: theta and q are each taken in (-pi, pi].
    let [third, second, slide] = problem.filters.as_slice() else { panic!("three filters") };
    assert_eq!((third.form.terms.as_slice(), third.q.as_slice()), (&[][..], &[(2, -1.0)][..]));
    assert!(third.form.constant.value == 0.0 && !third.strict);
    assert_eq!((second.form.terms.as_slice(), second.q.as_slice()), (&[][..], &[(1, 2.0)][..]));
    assert!((second.form.constant.value + PI).abs() < 1e-15 && second.strict);
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
