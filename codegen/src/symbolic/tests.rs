use super::expression::{Arena, Expr, Leaf, Node};
use super::fixtures::{mycobot, panda, product, puma560, ur5};
use crate::model::Model;

fn value(arena: &Arena, q: &[f64], x: Expr) -> f64 {
    let form = |index: usize| {
        let (_, form) = arena.angle_at(index).unwrap();
        form.turn.value() + form.terms.iter().map(|(k, c)| c * q[*k]).sum::<f64>()
    };
    match arena.node(x) {
        Node::Number(number) => number.value(),
        Node::Leaf(index) => match arena.leaf_at(index).unwrap().1 {
            Leaf::Parameter { value, .. } => *value,
            Leaf::Slide { terms, constant } => constant + terms.iter().map(|(k, c)| c * q[*k]).sum::<f64>(),
            Leaf::Known => unreachable!(),
        },
        Node::Sin(index) => form(index).sin(),
        Node::Cos(index) => form(index).cos(),
        Node::Neg(a) => -value(arena, q, a),
        Node::Add(a, b) => value(arena, q, a) + value(arena, q, b),
        Node::Mul(a, b) => value(arena, q, a) * value(arena, q, b),
    }
}

fn check(model: &Model, pose_limit: (usize, usize), both_limit: (usize, usize)) {
    let q: Vec<f64> = (0..model.joints.len()).map(|k| 0.3 + 0.7 * k as f64 - 0.1 * (k * k) as f64).collect();
    let frames = product(model, &q);
    let tool = frames.last().unwrap();
    let pose = super::pose(model, true);
    for (index, x) in pose.outputs.iter().enumerate() {
        let error = value(&pose.arena, &q, *x) - tool[index / 4][index % 4];
        assert!(error.abs() < 1e-14, "entry {index}: {error}");
    }
    let table = super::frames(model);
    for (index, x) in table.outputs.iter().enumerate() {
        let error = value(&table.arena, &q, *x) - frames[index / 12][index % 12 / 4][index % 4];
        assert!(error.abs() < 1e-14, "frame {}: {error}", index / 12);
    }
    assert_eq!(table.outputs.len(), 12 * (model.rows.len() + 1));
    let both = super::pose_and_jacobian(model);
    for (index, x) in both.outputs.iter().skip(12).enumerate() {
        let (joint, entry) = (index / 6, index % 6);
        let mut ahead = q.clone();
        ahead[joint] += 1e-6;
        let mut behind = q.clone();
        behind[joint] -= 1e-6;
        if entry < 3 {
            let p = |q: &[f64]| product(model, q).last().unwrap()[entry][3];
            let expected = (p(&ahead) - p(&behind)) / 2e-6;
            assert!((value(&both.arena, &q, *x) - expected).abs() < 1e-8, "v{entry} of joint {joint}");
        }
    }
    let counts = pose.arena.operations(&pose.outputs);
    let both_counts = both.arena.operations(&both.outputs);
    println!("{counts:?} {both_counts:?}");
    assert!(counts.0 <= pose_limit.0 && counts.1 <= pose_limit.1, "pose {counts:?} against {pose_limit:?}");
    assert!(
        both_counts.0 <= both_limit.0 && both_counts.1 <= both_limit.1,
        "{both_counts:?} against {both_limit:?}"
    );
}

#[test]
fn ur5_and_mycobot_take_few_operations() {
    check(&ur5(), (40, 21), (60, 41));
    check(&mycobot(), (40, 21), (60, 41));
}

#[test]
fn puma560_takes_few_operations() {
    check(&puma560(), (49, 24), (61, 35));
}

#[test]
fn panda_takes_few_operations() {
    check(&panda(), (80, 44), (114, 73));
}
