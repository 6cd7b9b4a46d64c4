//! The chain against the plain product of the rows.

use super::chain::{Chain, Element};
use super::*;

type Matrix = product::Matrix;

pub(crate) fn row(d: f64, a: f64, alpha: Angle, index: usize) -> Row {
    Row {
        name: format!("J{}", index + 1),
        kind: JointKind::Revolute,
        d,
        a,
        alpha,
        beta: Angle::ZERO,
        theta: Angle::ZERO,
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

fn robot(convention: Convention, mut rows: Vec<Row>) -> Model {
    recentre::recentre(convention, &mut rows);
    let joints = (0..rows.len()).filter(|&index| rows[index].variable.is_some()).collect();
    let still = Placement { xyz: [0.0; 3], rotation: Rotation::Rpy([Angle::ZERO; 3]) };
    Model {
        name: "test".into(),
        manufacturer: None,
        source: None,
        convention,
        units: Units { length: LengthUnit::Metre, angle: AngleUnit::Radian },
        rows,
        joints,
        base: still.clone(),
        tool: still,
        workspace: Workspace::default(),
        sums: vec![],
        poses: vec![],
        problems: vec![],
        windings: vec![],
        servos: vec![],
        device: None,
        fingerprint: 0,
    }
}

const IDENTITY: Matrix = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]];

fn times(left: &Matrix, right: &Matrix) -> Matrix {
    let mut result = IDENTITY;
    for (i, row) in left.iter().enumerate() {
        for j in 0..4 {
            result[i][j] =
                (0..3).map(|k| row[k] * right[k][j]).sum::<f64>() + if j == 3 { row[3] } else { 0.0 };
        }
    }
    result
}

fn turn(axis: usize, (sine, cosine): (f64, f64)) -> Matrix {
    let (j, k) = ((axis + 1) % 3, (axis + 2) % 3);
    let mut matrix = IDENTITY;
    (matrix[j][j], matrix[k][k], matrix[j][k], matrix[k][j]) = (cosine, cosine, -sine, sine);
    matrix
}

fn slide(axis: usize, value: f64) -> Matrix {
    let mut matrix = IDENTITY;
    matrix[axis][3] = value;
    matrix
}

fn element(element: &Element) -> Matrix {
    match element {
        Element::Translate { axis, value, .. } => slide(*axis, *value),
        Element::Rotate { axis, angle, .. } => turn(*axis, angle.sin_cos()),
        Element::Matrix { rows, .. } => rows.map(|[x, y, z]| [x, y, z, 0.0]),
    }
}

/// Frames of the rows and of the tool by the chain.
fn by_chain(model: &Model, chain: &Chain, q: &[f64]) -> (Vec<Matrix>, Matrix) {
    let mut frame = IDENTITY;
    let mut frames = Vec::new();
    for (index, link) in chain.links.iter().enumerate() {
        if let Some(joint) = index.checked_sub(1).map(|before| &chain.joints[before]) {
            let row = &model.rows[joint.row];
            let varies: f64 = row.terms.iter().map(|&(index, c)| c * q[index]).sum();
            let moved = match joint.kind {
                JointKind::Revolute => turn(2, libm::sincos(row.theta.value + varies)),
                JointKind::Prismatic => slide(2, row.d + varies),
            };
            frame = times(&frame, &moved);
        }
        for place in 0..=link.elements.len() {
            for stands in link.frames.iter().filter(|stands| stands.after == place) {
                frames.push(times(&frame, &slide(2, stands.along_z)));
            }
            if let Some(next) = link.elements.get(place) {
                frame = times(&frame, &element(next));
            }
        }
    }
    (frames, frame)
}

fn difference(one: &Matrix, two: &Matrix) -> f64 {
    one.iter().flatten().zip(two.iter().flatten()).map(|(x, y)| (x - y).abs()).fold(0.0, f64::max)
}

fn agrees(model: &Model, q: &[f64], tolerance: f64) {
    let chain = model.chain();
    assert_eq!(chain.links.len(), chain.joints.len() + 1);
    let (frames, tool) = by_chain(model, &chain, q);
    let expected = product::frames(model, q);
    assert_eq!(frames.len(), expected.rows.len());
    let error = difference(&tool, &expected.tool);
    assert!(error < tolerance, "tool off by {error:e}: {tool:?} {:?}", expected.tool);
    for (index, (frame, expected)) in frames.iter().zip(&expected.rows).enumerate() {
        // A frame of the table itself may lie kilometres away.
        let away = expected.iter().map(|row| row[3].abs()).fold(1.0, f64::max);
        let error = difference(frame, expected);
        assert!(error < tolerance * away, "frame {index} off by {error:e}");
    }
}

const Q: [f64; 7] = [0.3, -0.8, 1.1, 2.0, -0.4, 0.9, -2.5];

fn mixed() -> Vec<Row> {
    let mut rows = vec![
        row(0.14, 0.02, Angle::from_degrees(90.0), 0),
        row(0.0, -0.11, Angle::ZERO, 1),
        row(0.03, 0.1, Angle::from_radians(0.02), 2),
        row(0.06, 0.0, Angle::from_degrees(-90.0), 3),
        row(0.01, 0.05, Angle::from_radians(1.1), 4),
        row(0.02, 0.03, Angle::from_degrees(60.0), 5),
    ];
    rows[1].theta = Angle::from_degrees(-90.0);
    rows[2].beta = Angle::from_radians(0.3);
    rows[4].kind = JointKind::Prismatic;
    rows[4].theta = Angle::from_degrees(30.0);
    rows[2].terms = vec![(1, -1.0), (2, 1.0)];
    // A held row that is coupled, and one that isn't.
    rows[3].variable = None;
    rows[3].terms = vec![(1, 1.0), (2, -1.0)];
    rows[5].variable = None;
    rows[5].terms = vec![];
    rows[5].theta = Angle::from_radians(0.7);
    rows
}

#[test]
fn chain_is_the_product_of_the_rows() {
    for convention in [Convention::Standard, Convention::Modified] {
        let mut model = robot(convention, mixed());
        model.base = Placement {
            xyz: [0.1, -0.2, 0.3],
            rotation: Rotation::Rpy([0.1, 0.2, 0.3].map(Angle::from_radians)),
        };
        let (s, c) = libm::sincos(0.4);
        model.tool = Placement {
            xyz: [0.0, 0.0, 0.05],
            rotation: Rotation::Matrix([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]]),
        };
        assert!(model.rows.iter().all(|row| row.shift == 0.0));
        agrees(&model, &Q, 1e-15);
    }
}

/// A calibrated arm in the manner of a UR: axes 2, 3 and 4 all but parallel.
fn calibrated(tilt: f64) -> Vec<Row> {
    let (second, third) = (0.4 / tilt * 0.01, -0.3 / tilt * 0.01);
    let mut rows = vec![
        row(0.1521, 0.0, Angle::from_degrees(90.0), 0),
        row(second, -0.244, Angle::from_radians(tilt), 1),
        row(-second + third, -0.213, Angle::from_radians(-0.7 * tilt), 2),
        row(-third + 0.112, 0.0, Angle::from_degrees(90.0), 3),
        row(0.0854, 0.0, Angle::from_degrees(-90.0), 4),
        row(0.0819, 0.0, Angle::ZERO, 5),
    ];
    rows[1].theta = Angle::from_radians(0.01);
    rows
}

/// The same axes in the modified convention, whose twists stand a row later.
fn modified(rows: &[Row]) -> Vec<Row> {
    (0..rows.len())
        .map(|index| {
            let (a, alpha) = match index.checked_sub(1) {
                Some(before) => (rows[before].a, rows[before].alpha),
                None => (0.0, Angle::ZERO),
            };
            Row { a, alpha, ..rows[index].clone() }
        })
        .collect()
}

#[test]
fn offsets_of_kilometres_cancel_without_loss() {
    for tilt in [1e-4, 1e-5, -1e-6, 1e-7] {
        let standard = calibrated(tilt);
        for (convention, rows) in
            [(Convention::Modified, modified(&standard)), (Convention::Standard, standard)]
        {
            let model = robot(convention, rows);
            assert!(model.rows.iter().any(|row| row.shift != 0.0), "{tilt}");
            for link in model.chain().links {
                for element in link.elements {
                    if let Element::Translate { value, .. } = element {
                        assert!(value.abs() < 1.0, "{value} at a tilt of {tilt}");
                    }
                }
            }
            agrees(&model, &Q, 1e-14);
        }
    }
}

#[test]
fn axes_that_point_against_each_other_are_recentred_too() {
    for convention in [Convention::Standard, Convention::Modified] {
        let nearly_opposite = Angle::from_radians(core::f64::consts::PI - 1e-5);
        let mut rows = vec![
            row(0.1, 0.0, Angle::from_degrees(90.0), 0),
            row(2000.0, 0.3, nearly_opposite, 1),
            row(2000.1, 0.2, Angle::from_degrees(90.0), 2),
            row(0.1, 0.0, Angle::ZERO, 3),
        ];
        rows[1].beta = Angle::from_radians(2e-5);
        if convention == Convention::Modified {
            let beta = rows[1].beta;
            rows = modified(&rows);
            rows[1].beta = Angle::ZERO;
            rows[2].beta = beta;
        }
        let model = robot(convention, rows);
        assert!(model.rows.iter().any(|row| row.shift != 0.0));
        agrees(&model, &Q, 1e-14);
    }
}

#[test]
fn ordinary_tables_are_not_recentred() {
    // A SCARA arm that folds back on itself, and an arm whose axes are parallel to within its calibration.
    let scara = vec![
        row(0.4, 0.3, Angle::ZERO, 0),
        row(-0.1, 0.2, Angle::from_degrees(180.0), 1),
        row(0.2, 0.0, Angle::from_radians(1e-4), 2),
        row(-0.2, 0.0, Angle::ZERO, 3),
    ];
    for convention in [Convention::Standard, Convention::Modified] {
        assert!(robot(convention, scara.clone()).rows.iter().all(|row| row.shift == 0.0));
    }
}

#[test]
fn names_are_those_of_the_field() {
    let chain = robot(Convention::Standard, mixed()).chain();
    let names: Vec<Vec<&str>> = chain
        .links
        .iter()
        .map(|link| {
            link.elements
                .iter()
                .map(|element| match element {
                    Element::Translate { name, .. }
                    | Element::Rotate { name, .. }
                    | Element::Matrix { name, .. } => name.as_str(),
                })
                .collect()
        })
        .collect();
    assert_eq!(names[0], [""; 0]);
    assert_eq!(names[1], ["d1", "a1", "alpha1"]);
    assert_eq!(names[2], ["a2"]);
    assert_eq!(names[3], ["d3", "a3", "alpha3", "beta3"]);
    assert_eq!(names[5], ["theta5", "a5", "alpha5", "theta6", "d6", "a6", "alpha6"]);
}
