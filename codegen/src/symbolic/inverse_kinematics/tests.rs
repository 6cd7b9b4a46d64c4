use super::{Derivation, derive};
use crate::model::{Angle, JointKind, Linear, Model, Problem, Target};
use crate::symbolic::fixtures::{angle, mycobot, puma560, robot, ur5};
use crate::model::Convention;

/// Constraints of (row, coefficient) and a constant in degrees.
fn problem(target: Target, constraints: &[(&[(usize, f64)], f64)]) -> Problem {
    let linear = |(terms, degrees): &(&[(usize, f64)], f64)| Linear {
        terms: terms.to_vec(),
        constant: angle(*degrees),
        text: String::new(),
        span: 0..0,
    };
    Problem {
        name: "test".to_string(),
        target,
        constraints: constraints.iter().map(linear).collect(),
        filters: Vec::new(),
        free: Vec::new(),
        span: 0..0,
        line: 1,
    }
}

fn show(derivation: &Derivation) -> String {
    let mut lines = Vec::new();
    for stage in &derivation.stages {
        for (name, text) in &stage.definitions {
            lines.push(format!("  {name} = {text}"));
        }
        lines.push(format!("{}: {} [{}] m^{}", stage.unknown, stage.text, stage.origin, stage.dimension));
    }
    for (index, joint) in derivation.joints.iter().enumerate() {
        lines.push(format!("q{} = {:?} + {}", index + 1, joint.terms, joint.constant));
    }
    lines.join("\n")
}

#[test]
fn dbg_all() {
    let tool_down: &[(&[(usize, f64)], f64)] =
        &[(&[(3, 1.0), (1, 1.0), (2, 1.0)], 90.0), (&[(4, 1.0)], -90.0), (&[(5, 1.0), (0, -1.0)], 0.0)];
    let show_it = |name: &str, model: &Model, problem: &Problem| {
        let t = std::time::Instant::now();
        let d = derive(model, problem);
        println!("--- {name} {:?}", t.elapsed());
        match d { Ok(d) => println!("{}", show(&d)), Err(e) => println!("{e:?}") }
    };
    show_it("mycobot tool down", &mycobot(), &problem(Target::Position, tool_down));
    show_it("mycobot yaw", &mycobot(), &problem(Target::PositionYaw, &tool_down[..2]));
    show_it("ur5 down", &ur5(), &problem(Target::Position, &[(&[(3, 1.0), (1, 1.0), (2, 1.0)], -90.0), (&[(4, 1.0)], -90.0), (&[(5, 1.0)], 0.0)]));
    let planar = robot(Convention::Standard, &[[0.0, 0.16, 0.0, 0.0], [0.0, 0.12, 0.0, 0.0]]);
    show_it("planar", &planar, &problem(Target::Xy, &[]));
    let planar3 = robot(Convention::Standard, &[[0.0, 0.16, 0.0, 0.0], [0.0, 0.12, 0.0, 0.0], [0.0, 0.05, 0.0, 0.0]]);
    show_it("planar3", &planar3, &problem(Target::XyYaw, &[]));
    let mut scara = robot(Convention::Standard, &[[0.3, 0.25, 0.0, 0.0], [0.0, 0.2, 180.0, 0.0], [0.0, 0.0, 0.0, 0.0], [0.1, 0.0, 0.0, 0.0]]);
    scara.rows[2].kind = JointKind::Prismatic;
    show_it("scara", &scara, &problem(Target::PositionYaw, &[]));
    let elbow = robot(Convention::Standard, &[[0.3, 0.0, 90.0, 0.0], [0.1, 0.2, 0.0, 0.0], [0.0, 0.25, 0.0, 0.0]]);
    show_it("elbow", &elbow, &problem(Target::Position, &[]));
    let mut elbow = robot(Convention::Standard, &[[0.3, 0.05, 90.0, 0.0], [0.1, 0.2, 0.0, 0.0], [0.0, 0.25, 0.0, 0.0]]);
    show_it("elbow with shoulder offset", &elbow, &problem(Target::Position, &[]));
    let wrist = robot(Convention::Standard, &[[0.3, 0.0, 90.0, 0.0], [0.0, 0.0, -90.0, 0.0], [0.0, 0.0, 0.0, 0.0]]);
    show_it("wrist rotation", &wrist, &problem(Target::Rotation, &[]));
    let wrist = robot(Convention::Standard, &[[0.3, 0.0, 60.0, 10.0], [0.0, 0.0, -50.0, 0.0], [0.0, 0.0, 0.0, 0.0]]);
    show_it("skew wrist rotation", &wrist, &problem(Target::Rotation, &[]));
    show_it("puma wrist by constraints", &puma560(), &problem(Target::Rotation, &[(&[(0, 1.0)], 10.0), (&[(1, 1.0)], 30.0), (&[(2, 1.0)], 0.0)]));
    show_it("puma position", &puma560(), &problem(Target::Position, &[(&[(3, 1.0)], 0.0), (&[(4, 1.0)], 0.0), (&[(5, 1.0)], 0.0)]));
    let pan = robot(Convention::Standard, &[[0.3, 0.1, 90.0, 0.0], [0.0, 0.0, 90.0, 0.0]]);
    show_it("pan tilt", &pan, &problem(Target::Direction, &[]));
    elbow.rows[2].terms = vec![(2, 1.0), (1, -1.0)];
    show_it("coupled elbow", &elbow, &problem(Target::Position, &[]));
    let mut stanford = robot(Convention::Standard, &[[0.4, 0.0, -90.0, 0.0], [0.15, 0.0, 90.0, 0.0], [0.0, 0.0, 0.0, 0.0]]);
    stanford.rows[2].kind = JointKind::Prismatic;
    show_it("stanford position", &stanford, &problem(Target::Position, &[]));
}
