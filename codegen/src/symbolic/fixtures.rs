//! Robots by hand, for the tests of this stage.
#![allow(clippy::unwrap_used, reason = "test code")]

use crate::model::{
    Angle, AngleUnit, Convention, JointKind, LengthUnit, Model, Placement, Rotation, Row, Units, Workspace,
};

pub(crate) fn angle(degrees: f64) -> Angle {
    let fifteenths = degrees / 15.0;
    Angle {
        value: degrees.to_radians(),
        fifteenths: (fifteenths == fifteenths.round()).then_some(fifteenths as i32),
    }
}

/// Rows of d, a, alpha (deg), offset (deg).
pub(crate) fn robot(convention: Convention, rows: &[[f64; 4]]) -> Model {
    let none = Placement { xyz: [0.0; 3], rotation: Rotation::Rpy([angle(0.0); 3]) };
    let row = |(index, [d, a, alpha, offset]): (usize, &[f64; 4])| Row {
        name: format!("J{}", index + 1),
        kind: JointKind::Revolute,
        d: *d,
        a: *a,
        alpha: angle(*alpha),
        beta: angle(0.0),
        theta: angle(*offset),
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
    };
    Model {
        name: "robot".to_string(),
        manufacturer: None,
        source: None,
        convention,
        units: Units { length: LengthUnit::Metre, angle: AngleUnit::Degree },
        rows: rows.iter().enumerate().map(row).collect(),
        joints: (0..rows.len()).collect(),
        base: none.clone(),
        tool: none,
        workspace: Workspace::default(),
        sums: Vec::new(),
        poses: Vec::new(),
        problems: Vec::new(),
        windings: (0..rows.len())
            .map(|joint| crate::model::Winding { joint, turn: std::f64::consts::TAU, carries: Vec::new() })
            .collect(),
        servos: Vec::new(),
        device: None,
        fingerprint: 0,
    }
}

pub(crate) fn ur5() -> Model {
    robot(
        Convention::Standard,
        &[
            [0.089_159, 0.0, 90.0, 0.0],
            [0.0, -0.425, 0.0, 0.0],
            [0.0, -0.392_25, 0.0, 0.0],
            [0.109_15, 0.0, 90.0, 0.0],
            [0.094_65, 0.0, -90.0, 0.0],
            [0.0823, 0.0, 0.0, 0.0],
        ],
    )
}

pub(crate) fn mycobot() -> Model {
    robot(
        Convention::Standard,
        &[
            [0.14, 0.0, 90.0, 0.0],
            [0.0, 0.1104, 0.0, 90.0],
            [0.0, 0.096, 0.0, 0.0],
            [0.066_39, 0.0, 90.0, 90.0],
            [0.073_18, 0.0, 90.0, -90.0],
            [0.0436, 0.0, 0.0, 0.0],
        ],
    )
}

pub(crate) fn puma560() -> Model {
    robot(
        Convention::Standard,
        &[
            [0.0, 0.0, 90.0, 0.0],
            [0.0, 0.4318, 0.0, 0.0],
            [0.150_05, 0.0203, -90.0, 0.0],
            [0.4318, 0.0, 90.0, 0.0],
            [0.0, 0.0, -90.0, 0.0],
            [0.0, 0.0, 0.0, 0.0],
        ],
    )
}

pub(crate) fn panda() -> Model {
    let mut model = robot(
        Convention::Modified,
        &[
            [0.333, 0.0, 0.0, 0.0],
            [0.0, 0.0, -90.0, 0.0],
            [0.316, 0.0, 90.0, 0.0],
            [0.0, 0.0825, 90.0, 0.0],
            [0.384, -0.0825, -90.0, 0.0],
            [0.0, 0.0, 90.0, 0.0],
            [0.0, 0.088, 90.0, 0.0],
        ],
    );
    model.tool.xyz = [0.0, 0.0, 0.107];
    model
}

/// Frames of all rows by plain 4x4 products, then the tool.
pub(crate) fn product(model: &Model, q: &[f64]) -> Vec<[[f64; 4]; 4]> {
    let multiply = |a: [[f64; 4]; 4], b: [[f64; 4]; 4]| {
        let mut c = [[0.0; 4]; 4];
        for i in 0..4 {
            for j in 0..4 {
                c[i][j] = (0..4).map(|k| a[i][k] * b[k][j]).sum();
            }
        }
        c
    };
    let screw = |angle: f64, along: f64, about_x: bool| {
        let (s, c) = angle.sin_cos();
        if about_x {
            [[1.0, 0.0, 0.0, along], [0.0, c, -s, 0.0], [0.0, s, c, 0.0], [0.0, 0.0, 0.0, 1.0]]
        } else {
            [[c, -s, 0.0, 0.0], [s, c, 0.0, 0.0], [0.0, 0.0, 1.0, along], [0.0, 0.0, 0.0, 1.0]]
        }
    };
    let mut pose = screw(0.0, 0.0, true);
    let mut frames = vec![pose];
    for row in &model.rows {
        let added: f64 = row.terms.iter().map(|(k, c)| c * q[*k]).sum();
        let (theta, d) = match row.kind {
            JointKind::Revolute => (row.theta.value + added, row.d),
            JointKind::Prismatic => (row.theta.value, row.d + added),
        };
        let (z, x) = (screw(theta, d, false), screw(row.alpha.value, row.a, true));
        let step = match model.convention {
            Convention::Standard => multiply(z, x),
            Convention::Modified => multiply(x, z),
        };
        pose = multiply(pose, step);
        frames.push(pose);
    }
    frames.push(multiply(pose, screw(0.0, model.tool.xyz[2], false)));
    frames
}
