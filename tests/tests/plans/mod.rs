//! Robots whose plans are written by hand, to exercise what reads plans without what makes them.

use dh_codegen::model::{
    Angle, AngleUnit, Bound, Convention, Filter, JointKind, LengthUnit, Limits, Linear, Model, NamedPose,
    NamedServo, Placement, Problem, Rotation, Row, Servo, Target, Units, Winding, Workspace,
};
use dh_codegen::plan::{
    self, ConstantId, Counts, Equation, Function, FunctionKind, Measure, Plan, Scalar, Stage, Step, ValueId,
};

/// A planar arm of two turning joints (0.5 m and 0.4 m) with the problem `xy`, elbow either way, and `elbow_up`.
pub(crate) fn planar() -> (Model, Plan) {
    let rows = vec![turning(0, 0.5), turning(1, 0.4)];
    let mut model = robot("Planar 2R", rows);
    model.manufacturer = Some("None [of them]".to_owned());
    model.source = Some("drawn by hand, https://example.org/planar_2r.".to_owned());
    model.workspace.bounds = vec![Bound { axis: 1, is_min: true, value: -0.6 }];
    model.poses = vec![NamedPose { name: "rest".to_owned(), q: vec![0.0, 1.57], safe: true }];
    model.servos = vec![NamedServo { name: "hand".to_owned(), servo: servo() }];
    let elbow_up = Filter { form: linear(1, "theta2 <= 0"), q: Vec::new(), strict: false };
    let mut plan = plan::build(&model).0;
    model.problems = vec![problem("xy", Vec::new()), problem("elbow_up", vec![elbow_up])];
    let (a1, a2) = (constant(&plan, "a1"), constant(&plan, "a2"));
    plan.functions.extend([planar_inverse(0, &a1, &a2), planar_inverse(1, &a1, &a2)]);
    (model, plan)
}

/// A turning joint and a sliding one along its own x axis, with the problem `xy` by a step that is linear.
pub(crate) fn polar() -> (Model, Plan) {
    let mut rows = vec![turning(0, 0.0), turning(1, 0.25)];
    rows[0].alpha = Angle::from_degrees(90.0);
    rows[0].theta = Angle::from_degrees(90.0);
    rows[1].kind = JointKind::Prismatic;
    rows[1].limits = Some(Limits { min: 0.0, max: 0.8 });
    let mut model = robot("Polar", rows);
    let mut plan = plan::build(&model).0;
    model.problems = vec![problem("xy", Vec::new())];
    let a2 = constant(&plan, "a2");
    plan.functions.push(polar_inverse(a2));
    (model, plan)
}

/// The planar arm with a problem of every kind of target, each with one candidate made of the target's first number
/// and its last: for signatures. The problem `given` leaves the second joint to the caller.
pub(crate) fn every_target() -> (Model, Plan) {
    let kinds = [
        ("position", Target::Position),
        ("position_direction", Target::PositionDirection),
        ("position_yaw", Target::PositionYaw),
        ("rotation", Target::Rotation),
        ("direction", Target::Direction),
        ("ray", Target::Ray),
        ("lookat", Target::Lookat),
        ("xy", Target::Xy),
        ("xy_yaw", Target::XyYaw),
    ];
    let mut model = robot("Every target", vec![turning(0, 0.5), turning(1, 0.4)]);
    let mut plan = plan::build(&model).0;
    plan.functions.retain(|function| !matches!(function.kind, FunctionKind::Inverse(_)));
    model.problems =
        kinds.iter().map(|(name, target)| Problem { target: *target, ..problem(name, Vec::new()) }).collect();
    model.problems.push(Problem { free: vec![1], ..problem("given", Vec::new()) });
    let every = [(None, Target::Pose)]
        .into_iter()
        .chain(kinds.iter().enumerate().map(|(i, (_, kind))| (Some(i), *kind)));
    let mut add = |problem, inputs: &[&str], free: &[usize]| {
        let q = [0, inputs.len() - 1].map(|i| Scalar::Value(ValueId(i))).to_vec();
        plan.functions.push(Function {
            kind: FunctionKind::Inverse(problem),
            inputs: inputs.len(),
            free: free.to_vec(),
            values: inputs.iter().map(|name| (*name).to_owned()).collect(),
            steps: vec![accept(q)],
            outputs: Vec::new(),
            counts: Counts::default(),
            stages: Vec::new(),
            unknowns: Vec::new(),
            motions: Vec::new(),
            constraints: Vec::new(),
            branch: Vec::new(),
            agreement: None,
        });
    };
    every.for_each(|(problem, target)| add(problem, target.input_names(), &[]));
    add(Some(kinds.len()), &["px", "py", "q2"], &[1]);
    (model, plan)
}

/// A candidate that forward kinematics judges.
fn accept(q: Vec<Scalar>) -> Step {
    Step::Accept { q, tool: Vec::new(), polish: false }
}

/// theta2 from the distance, then theta1 from both rows of the position.
fn planar_inverse(problem: usize, a1: &Scalar, a2: &Scalar) -> Function {
    let values = ["px", "py", "theta2", "s2", "c2", "k1", "k2", "theta1", "unused"];
    let [px, py, theta2, _, c2, k1, k2, theta1, unused] = [0, 1, 2, 3, 4, 5, 6, 7, 8].map(ValueId);
    let v = Scalar::Value;
    let square = |x: &Scalar| mul(x.clone(), x.clone());
    let distance = sub(sub(add(square(&v(px)), square(&v(py))), square(a1)), square(a2));
    let body = vec![
        Step::SinCos { sin: ValueId(3), cos: c2, angle: v(theta2) },
        Step::Let { name: k1, value: add(a1.clone(), mul(a2.clone(), v(c2))) },
        Step::Let { name: k2, value: mul(a2.clone(), v(ValueId(3))) },
        Step::Let { name: unused, value: mul(v(k1), v(k2)) },
        Step::Solve {
            stage: 1,
            root: theta1,
            sin_cos: None,
            equation: Equation::TrigPair {
                first: [v(k1), Scalar::Neg(Box::new(v(k2))), v(px)],
                second: [v(k2), v(k1), v(py)],
            },
            body: vec![accept(vec![v(theta1), v(theta2)])],
        },
    ];
    let trig = Equation::Trig {
        a: mul(mul(Scalar::Number(2.0), a1.clone()), a2.clone()),
        b: Scalar::Number(0.0),
        c: distance,
    };
    Function {
        kind: FunctionKind::Inverse(Some(problem)),
        values: values.map(str::to_owned).to_vec(),
        inputs: 2,
        free: Vec::new(),
        steps: vec![Step::Solve { stage: 0, root: theta2, sin_cos: None, equation: trig, body }],
        outputs: Vec::new(),
        counts: Counts { mul: 8, add: 4, sincos: 1, angle_add: 0 },
        stages: vec![
            stage(
                0b10,
                "theta2",
                Measure::Area,
                "2 a1 a2 c2 = px^2 + py^2 - a1^2 - a2^2",
                "the distance of the tool point",
            ),
            stage(
                0b01,
                "theta1",
                Measure::Length,
                "k1 c1 - k2 s1 = px, k2 c1 + k1 s1 = py",
                "rows 1 and 2 of the position",
            ),
        ],
        unknowns: Vec::new(),
        motions: Vec::new(),
        constraints: Vec::new(),
        branch: Vec::new(),
        agreement: None,
    }
}

/// theta1 from the direction, then d2: the tool point is d2 (-s.., c..) + a2 across.
fn polar_inverse(a2: Scalar) -> Function {
    let values = ["px", "py", "theta1", "s1", "c1", "d2"];
    let [px, py, theta1, s1, c1, d2] = [0, 1, 2, 3, 4, 5].map(ValueId);
    let v = Scalar::Value;
    // With theta1 = q1 + pi/2: px = a2 c1 + d2 s1, py = a2 s1 - d2 c1.
    let along = sub(mul(v(px), v(s1)), mul(v(py), v(c1)));
    let q1 = sub(v(theta1), Scalar::Number(core::f64::consts::FRAC_PI_2));
    let body = vec![
        Step::SinCos { sin: s1, cos: c1, angle: v(theta1) },
        Step::Solve {
            stage: 1,
            root: d2,
            sin_cos: None,
            equation: Equation::Linear { a: Scalar::Number(1.0), c: along },
            body: vec![accept(vec![q1, v(d2)])],
        },
    ];
    Function {
        kind: FunctionKind::Inverse(Some(0)),
        values: values.map(str::to_owned).to_vec(),
        inputs: 2,
        free: Vec::new(),
        steps: vec![Step::Solve {
            stage: 0,
            root: theta1,
            sin_cos: None,
            equation: Equation::Trig { a: v(px), b: v(py), c: a2 },
            body,
        }],
        outputs: Vec::new(),
        counts: Counts { mul: 2, add: 2, sincos: 1, angle_add: 0 },
        stages: vec![
            stage(0b01, "theta1", Measure::Length, "px c1 + py s1 = a2", "row 1 of the position in frame 1"),
            stage(0b10, "d2", Measure::Length, "d2 = px s1 - py c1", "row 3 of the position in frame 1"),
        ],
        unknowns: Vec::new(),
        motions: Vec::new(),
        constraints: Vec::new(),
        branch: Vec::new(),
        agreement: None,
    }
}

fn robot(name: &str, rows: Vec<Row>) -> Model {
    let nowhere = Placement { xyz: [0.0; 3], rotation: Rotation::Rpy([Angle::ZERO; 3]) };
    let turns = rows.iter().enumerate().filter(|(_, row)| row.kind == JointKind::Revolute);
    let winding =
        |(joint, _): (usize, &Row)| Winding { joint, turn: core::f64::consts::TAU, carries: Vec::new() };
    Model {
        name: name.to_owned(),
        manufacturer: None,
        source: None,
        convention: Convention::Standard,
        units: Units { length: LengthUnit::Millimetre, angle: AngleUnit::Degree },
        joints: (0..rows.len()).collect(),
        windings: turns.map(winding).collect(),
        rows,
        base: nowhere.clone(),
        tool: nowhere,
        workspace: Workspace::default(),
        sums: Vec::new(),
        poses: Vec::new(),
        problems: Vec::new(),
        servos: Vec::new(),
        device: None,
        fingerprint: 0x0123_4567_89ab_cdef,
    }
}

fn turning(index: usize, a: f64) -> Row {
    Row {
        name: format!("J{}", index + 1),
        kind: JointKind::Revolute,
        d: 0.0,
        a,
        alpha: Angle::ZERO,
        beta: Angle::ZERO,
        theta: Angle::ZERO,
        shift: 0.0,
        terms: vec![(index, 1.0)],
        variable: Some(index),
        #[allow(clippy::approx_constant, reason = "tables say this")]
        limits: Some(Limits { min: -3.14, max: 3.14 }),
        max_velocity: Some(2.0),
        max_acceleration: None,
        max_jerk: None,
        servo: Some(servo()),
        span: 0..0,
        line: index + 1,
    }
}

fn servo() -> Servo {
    Servo {
        id: Some(1),
        scale: 651.898_646_904_403_9,
        zero: 2048.0,
        range: Some(Limits { min: 0.0, max: 4095.0 }),
        model: Some("STS3215".to_owned()),
    }
}

fn problem(name: &str, filters: Vec<Filter>) -> Problem {
    Problem {
        name: name.to_owned(),
        target: Target::Xy,
        constraints: Vec::new(),
        filters,
        free: Vec::new(),
        span: 0..0,
        line: 1,
    }
}

fn linear(row: usize, text: &str) -> Linear {
    Linear { terms: vec![(row, 1.0)], constant: Angle::ZERO, text: text.to_owned(), span: 0..0 }
}

fn stage(rows: u32, unknown: &str, measure: Measure, equation: &str, origin: &str) -> Stage {
    Stage {
        rows,
        unknown: unknown.to_owned(),
        measure,
        equation: equation.to_owned(),
        definitions: Vec::new(),
        origin: origin.to_owned(),
        plus: None,
    }
}

fn constant(plan: &Plan, name: &str) -> Scalar {
    let index = plan.constants.iter().position(|constant| constant.name == name);
    Scalar::Constant(ConstantId(index.unwrap_or(usize::MAX)))
}

fn add(x: Scalar, y: Scalar) -> Scalar {
    Scalar::Add(Box::new(x), Box::new(y))
}

fn sub(x: Scalar, y: Scalar) -> Scalar {
    Scalar::Sub(Box::new(x), Box::new(y))
}

fn mul(x: Scalar, y: Scalar) -> Scalar {
    Scalar::Mul(Box::new(x), Box::new(y))
}
