//! Near misses and their neighbours, on tables whose deviations are known.

use super::*;
use crate::diagnostic::Diagnostics;

fn model(text: &str) -> Model {
    let mut diagnostics = Diagnostics::new();
    let table = crate::table::parse(text, &mut diagnostics);
    let model = crate::model::check(&table, &mut diagnostics);
    assert!(!diagnostics.has_errors(), "{text}");
    model.unwrap()
}

/// An arm of these rows: (d, a, alpha in rad).
fn arm(convention: &str, rows: &[(f64, f64, f64)]) -> Model {
    let joints =
        rows.iter().map(|(d, a, alpha)| format!("[[joint]]\nd = {d:?}\na = {a:?}\nalpha = {alpha:?}\n"));
    model(&format!("[robot]\nname = \"t\"\nconvention = {convention:?}\n{}", joints.collect::<String>()))
}

const QUARTER: f64 = core::f64::consts::FRAC_PI_2;

/// A UR5 with this twist between axes 2 and 3.
fn ur5(tilt: f64) -> Model {
    arm(
        "standard",
        &[
            (0.089, 0.0, QUARTER),
            (0.0, -0.425, tilt),
            (0.0, -0.392, 0.0),
            (0.109, 0.0, QUARTER),
            (0.095, 0.0, -QUARTER),
            (0.082, 0.0, 0.0),
        ],
    )
}

#[test]
fn an_angle_off_parallel_is_told_with_its_number() {
    assert_eq!(ur5(0.0).geometry().near_misses(), Vec::<String>::new());
    for tilt in [1e-9, 1e-4, -1e-2, core::f64::consts::PI - 1e-3] {
        let geometry = ur5(tilt).geometry();
        let near: Vec<&Relation> = geometry.near().collect();
        let [relation] = near[..] else { panic!("{near:?}") };
        assert_eq!((relation.kind, &relation.axes[..]), (RelationKind::Parallel, &[1, 2][..]));
        let off = tilt.abs().min((core::f64::consts::PI - tilt).abs());
        assert!((relation.off - off).abs() < 1e-15, "{relation:?}");
        assert_eq!(relation.numbers[0].name, "alpha2");
    }
    assert_eq!(ur5(1e-4).geometry().near_misses(), ["axes 2 and 3 are 1.0e-4 rad off parallel (alpha2)"]);
    // A degree is meant.
    assert_eq!(ur5(0.0175).geometry().near().count(), 0);
}

#[test]
fn the_neighbour_of_a_tilted_arm_is_the_arm_without_the_tilt() {
    let exact = ur5(0.0);
    for tilt in [1e-9, 1e-4, 1e-2] {
        let nominal = ur5(tilt).nominal().unwrap();
        assert_eq!(nominal.geometry, exact.geometry());
        let change = Change { row: 1, key: "alpha", from: tilt, to: 0.0 };
        assert_eq!(nominal.changes, [change]);
    }
    assert!(exact.nominal().is_none());
}

#[test]
fn a_wrist_off_its_centre_by_a_length_or_an_offset() {
    let puma = |a4: f64, d5: f64, convention| {
        let mut rows = vec![
            (0.672, 0.0, QUARTER),
            (0.0, 0.43, 0.0),
            (0.15, 0.02, -QUARTER),
            (0.43, a4, QUARTER),
            (d5, 0.0, -QUARTER),
            (0.1, 0.0, 0.0),
        ];
        if convention == "modified" {
            // The same links, a row later.
            let twists: Vec<(f64, f64)> = rows.iter().map(|(_, a, alpha)| (*a, *alpha)).collect();
            for (index, row) in rows.iter_mut().enumerate() {
                let (a, alpha) = if index == 0 { (0.0, 0.0) } else { twists[index - 1] };
                (row.1, row.2) = (a, alpha);
            }
        }
        arm(convention, &rows)
    };
    for convention in ["standard", "modified"] {
        let (exact, off) = (puma(0.0, 0.0, convention), puma(3e-4, -2e-4, convention));
        assert_eq!(exact.geometry().class(), "6R, spherical wrist, axes 2 and 3 parallel, axes 1 and 2 meet");
        let class = off.geometry().class();
        assert_eq!(class, "general 6R: axes 2 and 3 parallel, axes 1 and 2, 5 and 6 meet", "{convention}");
        let names = if convention == "standard" { "a4, d5" } else { "a5, d5" };
        assert_eq!(
            off.geometry().near_misses(),
            [format!("axes 4, 5 and 6 are 3.0e-4 m off meeting in one point ({names})")]
        );
        let nominal = off.nominal().unwrap();
        assert_eq!(nominal.geometry.class(), exact.geometry().class());
        assert_eq!(nominal.changes.len(), 2);
    }
}

#[test]
fn a_held_joint_is_part_of_a_link() {
    let panda = model(include_str!("../../../../robots/panda.toml"));
    let class = |held: &[(usize, f64)]| panda.geometry_holding(held).class();
    assert_eq!(class(&[]), "7R, spherical shoulder, axes 5 and 6 meet");
    assert_eq!(class(&[(6, 0.3)]), "6R, spherical shoulder, axes 5 and 6 meet");
    assert_eq!(class(&[(2, 0.0)]), "general 6R: axes 2 and 4 parallel, axes 1 and 2, 5 and 6 meet");
    assert_eq!(class(&[(2, 0.3)]), "general 6R: axes 1 and 2, 5 and 6 meet");
    // Held so that the axes on both sides are nearly parallel.
    assert_eq!(
        panda.geometry_holding(&[(2, 1e-3)]).near_misses(),
        ["axes 2 and 4 are 1.0e-3 rad off parallel (theta3)"]
    );
}

#[test]
fn a_coupled_row_is_an_axis_and_slides_keep_directions() {
    let uarm = model(include_str!("../../../../robots/uarm_swift_pro.toml"));
    assert_eq!(uarm.geometry().class(), "5R, axes 2, 3 and 4 parallel, axis 4 follows other joints");
    // A slide across two parallel axes.
    let crossed = "[robot]\nname = \"t\"\nconvention = \"standard\"\nunits = { length = \"m\", angle = \"deg\" }\n\
        [[joint]]\nalpha = 90\n[[joint]]\ntype = \"prismatic\"\nalpha = -90\n[[joint]]\n";
    assert_eq!(model(crossed).geometry().class(), "RPR, axes 1 and 3 parallel");
}

#[test]
fn arms_with_a_slide_have_the_names_of_the_field() {
    let class = |twists: [&str; 4], more: &str| {
        let rows = [(0.3, ""), (0.25, ""), (0.0, "type = \"prismatic\"\nlimits = [0, 0.2]\n"), (0.0, "")];
        let rows = rows
            .iter()
            .zip(twists)
            .map(|((a, kind), alpha)| format!("[[joint]]\na = {a}\nalpha = {alpha}\n{kind}"));
        let rows: String = rows.collect();
        let text = format!("[robot]\nname = \"slide\"\nconvention = \"standard\"\n{rows}{more}");
        model(&text).geometry().class()
    };
    assert!(class(["0", "0", "0", "0"], "").starts_with("SCARA (RRPR)"));
    assert!(class(["1e-4", "0", "0", "0"], "").starts_with("nearly SCARA (RRPR)"));
    let tilt = class(["0", "0", "0", "\"pi/2\""], "[[joint]]\nd = 0.1\n");
    assert!(tilt.starts_with("SCARA-like (RRPRR)"), "{tilt}");
    let polar = class(["\"pi/2\"", "\"pi/2\"", "0", "0"], "");
    assert!(polar.starts_with("polar (RRPR)"), "{polar}");
    // Turning a slide about its own axis does not point it anywhere.
    for along in ["0", "1e-4"] {
        let lift = class(["\"pi/2\"", along, "0", "0"], "");
        assert!(lift.starts_with("RRPR, "), "{lift}");
    }
}
