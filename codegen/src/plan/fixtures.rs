//! Robots with plans by hand: a planar arm of two joints, and a SCARA.

mod notation;

pub(crate) use notation::plan;

use crate::model::{
    Angle, AngleUnit, Bound, Convention, Filter, JointKind, LengthUnit, Limits, Linear, Model, Placement,
    Problem, Rotation, Row, Target, Units, Winding, Workspace,
};
use std::f64::consts::TAU;

pub(crate) fn angle(degrees: i32) -> Angle {
    Angle { value: f64::from(degrees).to_radians(), fifteenths: Some(degrees / 15) }
}

/// A revolute row whose joint is number `index`: theta = q.
pub(crate) fn row(index: usize, d: f64, a: f64, alpha: i32) -> Row {
    Row {
        name: format!("J{}", index + 1),
        kind: JointKind::Revolute,
        d,
        a,
        alpha: angle(alpha),
        beta: angle(0),
        theta: angle(0),
        shift: 0.0,
        terms: vec![(index, 1.0)],
        variable: Some(index),
        limits: None,
        max_velocity: None,
        max_acceleration: None,
        max_jerk: None,
        servo: None,
        span: 0..0,
        line: index + 1,
    }
}

/// A robot of standard rows, every one with a joint.
pub(crate) fn robot(rows: Vec<Row>) -> Model {
    let still = Placement { xyz: [0.0; 3], rotation: Rotation::Rpy([angle(0); 3]) };
    let turns = rows.iter().enumerate().filter(|(_, row)| row.kind == JointKind::Revolute);
    Model {
        name: "hand-made".to_owned(),
        manufacturer: None,
        source: None,
        convention: Convention::Standard,
        units: Units { length: LengthUnit::Metre, angle: AngleUnit::Radian },
        joints: (0..rows.len()).collect(),
        base: still.clone(),
        tool: still,
        workspace: Workspace::default(),
        sums: Vec::new(),
        poses: Vec::new(),
        problems: Vec::new(),
        windings: turns.map(|(joint, _)| Winding { joint, turn: TAU, carries: Vec::new() }).collect(),
        servos: Vec::new(),
        device: None,
        fingerprint: 42,
        rows,
    }
}

pub(crate) fn linear(terms: &[(usize, f64)], constant: Angle) -> Linear {
    Linear { terms: terms.to_vec(), constant, text: String::new(), span: 0..0 }
}

pub(crate) fn problem(name: &str, target: Target, constraints: Vec<Linear>, filters: Vec<Filter>) -> Problem {
    Problem { name: name.to_owned(), target, constraints, filters, free: Vec::new(), span: 0..0, line: 1 }
}

/// Two parallel axes, links of 0.3 m and 0.2 m.
pub(crate) fn planar_2r() -> Model {
    let mut model = robot(vec![row(0, 0.0, 0.3, 0), row(1, 0.0, 0.2, 0)]);
    model.problems = vec![problem("point", Target::Xy, Vec::new(), Vec::new())];
    model.rows[0].limits = Some(Limits { min: -2.0, max: 2.5 });
    model.workspace.bounds = vec![Bound { axis: 0, is_min: true, value: -0.4 }];
    model
}

pub(crate) const PLANAR_2R_CONSTANTS: &[(&str, f64)] = &[("a1", 0.3), ("a2", 0.2)];

pub(crate) const PLANAR_2R: &str = "
fk: q1 q2
  s1 c1 = sincos q1
  s12 c12 = sincos q1 + q2
  px = a1 * c1 + a2 * c12
  py = a1 * s1 + a2 * s12
  out c12, -s12, 0, px, s12, c12, 0, py, 0, 0, 1, 0
fk_flange: q1 q2
  s1 c1 = sincos q1
  s12 c12 = sincos q1 + q2
  px = a1 * c1 + a2 * c12
  py = a1 * s1 + a2 * s12
  out c12, -s12, 0, px, s12, c12, 0, py, 0, 0, 1, 0
jacobian: q1 q2
  s1 c1 = sincos q1
  s12 c12 = sincos q1 + q2
  out -(a1 * s1) - a2 * s12, a1 * c1 + a2 * c12, 0, 0, 0, 1
  out -(a2 * s12), a2 * c12, 0, 0, 0, 1
fk_jacobian: q1 q2
  s1 c1 = sincos q1
  s12 c12 = sincos q1 + q2
  px2 = a2 * c12
  py2 = a2 * s12
  px = a1 * c1 + px2
  py = a1 * s1 + py2
  out c12, -s12, 0, px, s12, c12, 0, py, 0, 0, 1, 0
  out -py, px, 0, 0, 0, 1, -py2, px2, 0, 0, 0, 1
frames: q1 q2
  s1 c1 = sincos q1
  s12 c12 = sincos q1 + q2
  x1 = a1 * c1
  y1 = a1 * s1
  out 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0
  out c1, -s1, 0, x1, s1, c1, 0, y1, 0, 0, 1, 0
  out c12, -s12, 0, x1 + a2 * c12, s12, c12, 0, y1 + a2 * s12, 0, 0, 1, 0
inverse 0: px py
  for theta2 = trig area(2 * a1 * a2, 0, px * px + py * py - a1 * a1 - a2 * a2)
    s2 c2 = sincos theta2
    x = a1 + a2 * c2
    y = a2 * s2
    for theta1 = pair length(x, -y, px, y, x, py)
      accept theta1, theta2
";

/// The usual SCARA: two parallel axes, a slide downwards, a turn about it. Its problems: a position with q4 = q1 + q2,
/// and the same with the elbow on one side.
pub(crate) fn scara() -> Model {
    let mut rows =
        vec![row(0, 0.4, 0.325, 0), row(1, 0.0, 0.275, 180), row(2, 0.0, 0.0, 0), row(3, 0.05, 0.0, 0)];
    rows[2].kind = JointKind::Prismatic;
    rows[2].limits = Some(Limits { min: 0.0, max: 0.25 });
    let mut model = robot(rows);
    let turned = || vec![linear(&[(3, 1.0), (0, -1.0), (1, -1.0)], angle(0))];
    let elbow = Filter { form: linear(&[(1, 1.0)], angle(0)), q: Vec::new(), strict: false };
    model.problems = vec![
        problem("point", Target::Position, turned(), Vec::new()),
        problem("point_left", Target::Position, turned(), vec![elbow]),
    ];
    model
}

pub(crate) const SCARA_CONSTANTS: &[(&str, f64)] = &[("d1", 0.4), ("a1", 0.325), ("a2", 0.275), ("d4", 0.05)];

pub(crate) const SCARA: &str = "
fk: q1 q2 q3 q4
  s1 c1 = sincos q1
  s12 c12 = sincos q1 + q2
  syaw cyaw = sincos q1 + q2 - q4
  px = a1 * c1 + a2 * c12
  py = a1 * s1 + a2 * s12
  pz = d1 - q3 - d4
  out cyaw, syaw, 0, px, syaw, -cyaw, 0, py, 0, 0, -1, pz
fk_flange: q1 q2 q3 q4
  s1 c1 = sincos q1
  s12 c12 = sincos q1 + q2
  syaw cyaw = sincos q1 + q2 - q4
  out cyaw, syaw, 0, a1 * c1 + a2 * c12, syaw, -cyaw, 0, a1 * s1 + a2 * s12, 0, 0, -1, d1 - q3 - d4
jacobian: q1 q2 q3 q4
  s1 c1 = sincos q1
  s12 c12 = sincos q1 + q2
  out -(a1 * s1) - a2 * s12, a1 * c1 + a2 * c12, 0, 0, 0, 1
  out -(a2 * s12), a2 * c12, 0, 0, 0, 1
  out 0, 0, -1, 0, 0, 0, 0, 0, 0, 0, 0, -1
frames: q1 q2 q3 q4
  s1 c1 = sincos q1
  s12 c12 = sincos q1 + q2
  syaw cyaw = sincos q1 + q2 - q4
  x1 = a1 * c1
  y1 = a1 * s1
  px = x1 + a2 * c12
  py = y1 + a2 * s12
  z3 = d1 - q3
  out 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0
  out c1, -s1, 0, x1, s1, c1, 0, y1, 0, 0, 1, d1
  out c12, s12, 0, px, s12, -c12, 0, py, 0, 0, -1, d1
  out c12, s12, 0, px, s12, -c12, 0, py, 0, 0, -1, z3
  out cyaw, syaw, 0, px, syaw, -cyaw, 0, py, 0, 0, -1, z3 - d4
inverse pose: r11 r12 r13 px r21 r22 r23 py r31 r32 r33 pz
  for d3 = linear length(1, d1 - d4 - pz)
    for theta2 = trig area(2 * a1 * a2, 0, px * px + py * py - a1 * a1 - a2 * a2)
      s2 c2 = sincos theta2
      x = a1 + a2 * c2
      y = a2 * s2
      for theta1 = pair length(x, -y, px, y, x, py)
        s12 c12 = sincos theta1 + theta2
        for theta4 = pair ratio(c12, s12, r11, s12, -c12, r21)
          accept theta1, theta2, d3, theta4
inverse 0: px py pz
  for d3 = linear length(1, d1 - d4 - pz)
    for theta2 = trig area(2 * a1 * a2, 0, px * px + py * py - a1 * a1 - a2 * a2)
      s2 c2 = sincos theta2
      x = a1 + a2 * c2
      y = a2 * s2
      for theta1 = pair length(x, -y, px, y, x, py)
        accept theta1, theta2, d3, theta1 + theta2
inverse 1: px py pz
  for d3 = linear length(1, d1 - d4 - pz)
    for theta2 = trig area(2 * a1 * a2, 0, px * px + py * py - a1 * a1 - a2 * a2)
      s2 c2 = sincos theta2
      x = a1 + a2 * c2
      y = a2 * s2
      for theta1 = pair length(x, -y, px, y, x, py)
        accept theta1, theta2, d3, theta1 + theta2
";
