//! The sign of a root: the same on both sides of everything that is no singularity of its equation.

#![allow(clippy::unwrap_used, clippy::indexing_slicing, reason = "a test fails by panicking")]

use dh_core::{Branch, BranchBit, BranchWord, Float, Measure, Search, Solutions, Step};

const ANGLE: Step = Step::new(0, 0b1, false, Measure::Length);
const SLIDE: Step = Step::new(0, 0b1, true, Measure::Area);
const BIT: BranchBit = BranchBit::new(0, BranchWord::Joint, 0);

/// Roots of a x² + b x + c in an arm of 1 m.
fn quadratic<S: Float>([a, b, c]: [f64; 3]) -> Solutions<1, S> {
    let mut search = Search::<1, S>::new(S::ONE, &[]);
    let [a, b, c] = [a, b, c].map(S::from_f64);
    let mut roots = search.quadratic(SLIDE, a, b, c);
    while let Some(x) = search.next(&mut roots) {
        search.accept([x], S::ZERO, S::ZERO);
    }
    search.finish().unwrap()
}

/// Roots of a cos x + b sin x = c.
fn angles<S: Float>([a, b, c]: [f64; 3]) -> Solutions<1, S> {
    let mut search = Search::<1, S>::new(S::ONE, &[]);
    let [a, b, c] = [a, b, c].map(S::from_f64);
    let mut roots = search.trig(ANGLE, a, b, c);
    while let Some((x, _, _)) = search.next_angle(&mut roots) {
        search.accept([x], S::ZERO, S::ZERO);
    }
    search.finish().unwrap()
}

fn plus(branch: Branch) -> bool {
    branch.is_plus(&BIT).unwrap()
}

fn numbers() -> impl Iterator<Item = [f64; 3]> {
    let mut state = 1_u64;
    let mut next = move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        f64::from((state >> 40) as u32) / f64::from(1_u32 << 23) - 1.0
    };
    (0..5000).map(move |_| [next(), next(), next()])
}

#[test]
fn the_sign_of_a_quadratic_root_is_that_of_the_derivative() {
    fn all<S: Float>() {
        let mut tried = 0;
        for [a, b, c] in numbers().filter(|[a, b, c]| b * b - 4.0 * a * c > 1e-2 && a.abs() > 1e-2) {
            let found = quadratic::<S>([a, b, c]);
            assert_eq!(found.len(), 2, "{a} {b} {c}");
            for one in &found {
                let slope = 2.0 * a * one.q[0].to_f64() + b;
                assert_eq!(plus(one.branch), slope > 0.0, "{a} {b} {c}: {}", one.q[0]);
            }
            tried += 1;
        }
        assert!(tried > 1000);
    }
    all::<f64>();
    all::<f32>();
}

#[test]
fn a_quadratic_root_keeps_its_sign_where_the_other_goes_through_infinity() {
    for b in [0.5, -0.5] {
        for a in [1e-3, 1e-9, 1e-16, 0.0, -1e-16, -1e-9, -1e-3] {
            let found = quadratic::<f64>([a, b, 0.1]);
            let near = found.nearest(&[-0.1 / b]);
            assert!((near.q[0] + 0.1 / b).abs() < 1e-2);
            assert_eq!(plus(near.branch), b > 0.0, "{a} {b}");
        }
    }
}

#[test]
fn a_quadratic_root_keeps_its_sign_where_the_middle_coefficient_changes_its_own() {
    for b in [1e-3, 1e-9, 0.0, -1e-9, -1e-3] {
        let found = quadratic::<f64>([1.0, b, -0.25]);
        assert!(found.iter().all(|one| plus(one.branch) == (one.q[0] > 0.0)), "{b}: {found:?}");
    }
}

#[test]
fn the_sign_of_an_angle_is_that_of_its_derivative() {
    fn all<S: Float>() {
        let mut tried = 0;
        for [a, b, c] in numbers().filter(|[a, b, c]| a.hypot(*b) - c.abs() > 1e-2) {
            // Well inside, next to the edge of the fast way, and with a sine or cosine only.
            for [a, b, c] in [[a, b, c], [a, 0.0, 0.9 * a], [0.0, b, -0.5 * b], [a, b, 0.999 * a.hypot(b)]] {
                if a.hypot(b) < 1e-2 {
                    continue;
                }
                let found = angles::<S>([a, b, c]);
                assert_eq!(found.len(), 2, "{a} {b} {c}");
                for one in &found {
                    let (sin, cos) = one.q[0].to_f64().sin_cos();
                    assert_eq!(plus(one.branch), a * sin - b * cos > 0.0, "{a} {b} {c}");
                }
                tried += 1;
            }
        }
        assert!(tried > 1000);
    }
    all::<f64>();
    all::<f32>();
}

#[test]
fn a_step_without_a_sign_leaves_none() {
    let mut search = Search::<1>::new(1.0, &[]);
    let mut roots = search.trig(ANGLE.unsigned(), 1.0, 0.0, 0.5);
    while let Some((x, _, _)) = search.next_angle(&mut roots) {
        search.accept([x], 0.0, 0.0);
    }
    let found = search.finish().unwrap();
    assert_eq!((found.len(), found[0].branch), (2, found[1].branch));
    assert_eq!(found.on_branch(found[0].branch).count(), 2);
}
