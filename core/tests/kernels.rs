//! The numeric kernels: roots recovered, edges, vanishing coefficients, input that is no number.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

mod random;

use dh_core::{Float, IkError, Measure, Roots, Search, Step};
use random::Random;

const RATIO: Step = Step::new(0, 0b10, false, Measure::Ratio);
const LENGTH: Step = Step::new(0, 0b10, false, Measure::Length);
const AREA: Step = Step::new(0, 0b10, false, Measure::Area);
const SLIDE: Step = Step::new(0, 0b100, true, Measure::Area);
const REACH: f64 = 0.8;

fn search<S: Float>() -> Search<'static, 1, S> {
    Search::new(S::from_f64(REACH), &[])
}

/// Why there are no roots: what a search says that tried this and nothing else.
fn refusal<S: Float>(solve: impl FnOnce(&mut Search<'static, 1, S>) -> Roots<S>) -> IkError<S> {
    let mut search = search();
    let roots = solve(&mut search);
    assert!(roots.is_empty(), "{roots:?}");
    search.finish().expect_err("no roots, no solutions")
}

/// Whether the roots leave the joint free: one root, 0 first, and a mark on what is accepted.
fn is_free<S: Float>(solve: impl FnOnce(&mut Search<'static, 1, S>) -> Roots<S>) -> Option<usize> {
    let mut search = search();
    let mut roots = solve(&mut search);
    assert_eq!(roots.len(), 1);
    assert_eq!(search.next(&mut roots), Some(S::ZERO));
    search.accept([S::ZERO], S::ZERO, S::ZERO);
    assert_eq!(search.next(&mut roots), None);
    search.finish().expect("one was accepted")[0].free
}

fn roots_of<S: Float>(root: S) -> Roots<S> {
    search::<S>().linear(RATIO, S::ONE, root)
}

/// The distance on the circle of the nearest root.
fn miss<S: Float>(roots: Roots<S>, wanted: S) -> S {
    roots.into_iter().map(|root| (root - wanted).wrap_angle().abs()).fold(S::INFINITY, Float::min)
}

fn trig_recovers<S: Float>() {
    let mut random = Random(1);
    for _ in 0..2000 {
        let (a, b, x): (S, S, S) =
            (random.between(-0.5, 0.5), random.between(-0.5, 0.5), random.between(-3.1, 3.1));
        let (sin, cos) = x.sin_cos();
        let h = a.hypot(b);
        let roots = search().trig(LENGTH, a, b, a * cos + b * sin);
        // How fast the left-hand side changes at x says how well x is determined.
        let slope = (b * cos - a * sin).abs() / h;
        let bound = S::from_f64(16.0) * S::EPSILON / slope.max(S::SQRT_EPSILON) / h;
        assert!(miss(roots, x) <= bound, "a {a} b {b} x {x}: {roots:?} off by {} of {bound}", miss(roots, x));
        for root in roots {
            let (sin, cos) = root.sin_cos();
            let (sin_x, cos_x) = x.sin_cos();
            let left_over = (a * cos + b * sin - (a * cos_x + b * sin_x)).abs();
            assert!(left_over <= S::from_f64(16.0) * S::EPSILON, "{left_over}");
        }
    }
}

#[test]
fn trig_finds_random_roots() {
    trig_recovers::<f64>();
    trig_recovers::<f32>();
}

fn trig_at_the_edge<S: Float>() {
    let (a, b) = (S::from_f64(0.3), S::from_f64(0.4));
    let h = a.hypot(b);
    for (c, wanted) in [(h, b.atan2(a)), (-h, (-b).atan2(-a))] {
        let roots = search().trig(LENGTH, a, b, c);
        assert_eq!(roots.len(), 1, "a double root is one root");
        assert_eq!(miss(roots, wanted), S::ZERO);
    }
    // Just beyond the edge, by what rounding may add, the nearest angle still comes out.
    assert_eq!(search().trig(LENGTH, a, b, h + S::from_f64(2.0) * S::EPSILON).len(), 1);
    // Well inside there are two, as far apart as theory has it: cos(delta) = 1 - e, delta = sqrt(2 e).
    let e = S::from_f64(1e5) * S::EPSILON;
    let roots = search().trig(RATIO, S::ONE, S::ZERO, S::ONE - e);
    let delta = (S::TWO * e).sqrt();
    assert_eq!(roots.len(), 2);
    assert!((miss(roots, delta) / delta) < S::from_f64(0.01));
}

#[test]
fn trig_keeps_its_digits_at_the_edge() {
    trig_at_the_edge::<f64>();
    trig_at_the_edge::<f32>();
    // c is exact here, and so must the root be: an arc cosine would be off by 1e-9.
    let c = 1.0 - 2f64.powi(-40);
    let mut one = search::<f64>();
    let roots = one.trig(RATIO, 1.0, 0.0, c);
    let e = 2f64.powi(-40);
    let exact = (2.0 * e).sqrt() * (1.0 + e / 12.0);
    assert!(miss(roots, exact) < 1e-21, "{}", miss(roots, exact));
}

/// 2 cos x = 1 and 0 = 0, in either order, and in a size in which the other row is no more than rounding.
fn trig_of_the_larger_row<S: Float>() {
    let (row, third) = ([S::TWO, S::ZERO, S::ONE], S::PI / S::from_f64(3.0));
    for other in [[S::ZERO; 3], [S::EPSILON, S::EPSILON, -S::EPSILON], [-S::ONE, S::ZERO, -S::ONE / S::TWO]] {
        for (first, second) in [(row, other), (other, row)] {
            let roots = search().trig_either(RATIO, first, second);
            assert_eq!(roots.len(), 2);
            let off = miss(roots, third).max(miss(roots, -third));
            assert!(off <= S::from_f64(4.0) * S::EPSILON, "{off}");
        }
    }
    let noise = S::from_f64(4.0) * S::EPSILON;
    assert_eq!(is_free(|s| s.trig_either(RATIO, [noise, noise, S::ZERO], [S::ZERO; 3])), Some(1));
}

#[test]
fn of_two_rows_that_say_the_same_the_larger_one_is_solved() {
    trig_of_the_larger_row::<f64>();
    trig_of_the_larger_row::<f32>();
}

fn trig_beyond<S: Float>() {
    let (a, b, c) = (S::from_f64(0.3), S::from_f64(0.4), S::from_f64(-0.6));
    let tolerance = S::from_f64(8.0) * S::EPSILON;
    for (step, wanted) in [(LENGTH, 0.1), (RATIO, 0.2), (AREA, 0.2)] {
        let IkError::Unreachable { step: at, excess } = refusal(|s| s.trig(step, a, b, c)) else { panic!() };
        assert_eq!(at, step);
        assert!((excess - S::from_f64(wanted)).abs() < tolerance, "{excess}");
    }
}

#[test]
fn trig_says_by_how_much_it_is_beyond_the_edge() {
    trig_beyond::<f64>();
    trig_beyond::<f32>();
}

fn vanishing<S: Float>() {
    let (zero, noise) = (S::ZERO, S::from_f64(4.0) * S::EPSILON);
    let gap = S::from_f64(0.25);
    assert_eq!(is_free(|s| s.trig(RATIO, noise, -noise, noise)), Some(1));
    assert_eq!(is_free(|s| s.trig_pair(RATIO, [noise, zero, noise], [zero, noise, zero])), Some(1));
    assert_eq!(is_free(|s| s.linear(SLIDE, noise, noise)), Some(2));
    assert_eq!(is_free(|s| s.quadratic(SLIDE, noise, zero, noise)), Some(2));
    let singular = IkError::Singular { joint: 1, gap };
    assert_eq!(refusal(|s| s.trig(RATIO, noise, zero, gap)), singular);
    assert_eq!(refusal(|s| s.trig_pair(RATIO, [noise, zero, gap], [zero, noise, zero])), singular);
    assert_eq!(refusal(|s| s.trig_pair(RATIO, [S::ONE, zero, gap], [zero, zero, gap])), singular);
    assert_eq!(refusal(|s| s.linear(LENGTH, noise, -gap)), singular);
    assert_eq!(refusal(|s| s.quadratic(SLIDE, zero, noise, gap)), IkError::Singular { joint: 2, gap });
}

#[test]
fn vanishing_coefficients_leave_the_joint_free_or_are_singular() {
    vanishing::<f64>();
    vanishing::<f32>();
}

#[test]
fn a_wrist_that_is_straight_to_rounding_leaves_its_joint_free() {
    // What the sine of the wrist angle is where its cosine is 1 - epsilon: half the digits of 0.
    let sine = 1.5e-8;
    assert_eq!(is_free::<f64>(|s| s.trig_pair(RATIO, [sine, 0.0, 1e-17], [0.0, sine, -2e-17])), Some(1));
    // A sine that is really that small comes with right-hand sides of its size, and they know the angle.
    let roots =
        search::<f64>().trig_pair(RATIO, [sine, 0.0, 1e-9 * 0.5], [0.0, sine, 1e-9 * 0.75_f64.sqrt()]);
    assert!(miss(roots, core::f64::consts::FRAC_PI_3) < 1e-12, "{roots:?}");
}

fn pair_recovers<S: Float>(ratio: f64) {
    let mut random = Random(2);
    for _ in 0..2000 {
        let x: S = random.between(-3.1, 3.1);
        let mut row = |size: f64| -> [S; 3] {
            let size = S::from_f64(size);
            let (a, b): (S, S) = (random.between(-0.5, 0.5), random.between(-0.5, 0.5));
            let (sin, cos) = x.sin_cos();
            [a * size, b * size, a * size * cos + b * size * sin]
        };
        let (first, second) = (row(1.0), row(ratio));
        let [[a1, b1, _], [a2, b2, _]] = [first, second];
        let roots = search().trig_pair(RATIO, first, second);
        // An error of one rounding in both rows moves x by as much as both slopes together allow.
        let (sin, cos) = x.sin_cos();
        let slope = (b1 * cos - a1 * sin).hypot(b2 * cos - a2 * sin);
        let bound = S::from_f64(16.0) * S::EPSILON / slope.max(S::SQRT_EPSILON);
        assert!(miss(roots, x) <= bound, "{first:?} {second:?} x {x}: {roots:?}");
    }
}

#[test]
fn pairs_find_random_roots() {
    pair_recovers::<f64>(1.0);
    pair_recovers::<f32>(1.0);
    pair_recovers::<f64>(1e-6);
    pair_recovers::<f32>(1e-2);
}

#[test]
fn pairs_trust_the_larger_row() {
    // The smaller row's right-hand side carries an error of 1e-12, a millionth of its size; x is at a quarter turn,
    // where the larger row knows it best.
    let (sin, cos) = 1.5_f64.sin_cos();
    let roots = search::<f64>().trig_pair(RATIO, [1.0, 0.0, cos], [0.0, 1e-6, 1e-6 * sin + 1e-12]);
    assert!(miss(roots, 1.5) < 1e-12, "{roots:?}");
}

#[test]
fn pairs_of_one_direction_have_the_roots_of_one_row() {
    let (a, b, c) = (0.3, 0.4, 0.1);
    // What a pair finds has no sign.
    let one = search::<f64>().trig(LENGTH.unsigned(), a, b, c);
    assert_eq!(search::<f64>().trig_pair(LENGTH, [a, b, c], [0.0; 3]), one);
    assert_eq!(search::<f64>().trig_pair(LENGTH, [0.5 * a, 0.5 * b, 0.5 * c], [a, b, c]), one);
}

#[test]
fn a_row_that_is_rounding_does_not_decide() {
    // cos x = 1/2; the other row would have sin x = 0, if 1e-8 were more than the root of a rounding.
    let roots = search::<f64>().trig_pair(RATIO, [1.0, 0.0, 0.5], [0.0, 1e-8, 0.0]);
    assert_eq!(roots.len(), 2);
    for wanted in [core::f64::consts::FRAC_PI_3, -core::f64::consts::FRAC_PI_3] {
        assert!(miss(roots, wanted) < 1e-15);
    }
}

#[test]
fn pairs_off_the_circle_are_unreachable() {
    // (cos x, sin x) would have to be (1.2, 0.9): 1.5 long.
    let rows = |h: f64| ([h, 0.0, 1.2 * h], [0.0, h, 0.9 * h]);
    let (first, second) = rows(1.0);
    let IkError::Unreachable { excess, .. } = refusal(|s| s.trig_pair(RATIO, first, second)) else {
        panic!()
    };
    assert!((excess - 0.5).abs() < 1e-15);
    let (first, second) = rows(0.1);
    let IkError::Unreachable { excess, .. } = refusal(|s| s.trig_pair(LENGTH, first, second)) else {
        panic!()
    };
    assert!((excess - 0.05).abs() < 1e-15);
}

fn quadratic_recovers<S: Float>() {
    let mut random = Random(3);
    for _ in 0..2000 {
        let (x1, x2, a): (S, S, S) =
            (random.between(-0.7, 0.7), random.between(-0.7, 0.7), random.between(0.2, 2.0));
        let a = if random.between::<S>(-1.0, 1.0) < S::ZERO { -a } else { a };
        let roots = search().quadratic(SLIDE, a, -(a * (x1 + x2)), a * (x1 * x2));
        let apart = (x1 - x2).abs().max(S::SQRT_EPSILON);
        for wanted in [x1, x2] {
            let off = roots.into_iter().map(|root| (root - wanted).abs()).fold(S::INFINITY, Float::min);
            assert!(off <= S::from_f64(16.0) * S::EPSILON / apart, "{x1} {x2}: {roots:?}");
        }
    }
}

#[test]
fn quadratic_finds_random_roots() {
    quadratic_recovers::<f64>();
    quadratic_recovers::<f32>();
}

#[test]
fn quadratic_loses_no_digits_to_cancellation() {
    // (x - 0.7)(x - 1e-9): the textbook's formula gives the small root to seven digits.
    let roots = search::<f64>().quadratic(SLIDE, 1.0, -(0.7 + 1e-9), 0.7e-9);
    let small = roots.into_iter().fold(f64::INFINITY, f64::min);
    assert!((small - 1e-9).abs() < 1e-24, "{small}");
}

fn quadratic_edges<S: Float>() {
    let number = S::from_f64;
    let close = |roots: Roots<S>, wanted: S| {
        assert_eq!(roots.len(), 1, "{roots:?}");
        assert!(roots.into_iter().all(|x| (x - wanted).abs() <= number(8.0) * S::EPSILON), "{roots:?}");
    };
    close(search().quadratic(SLIDE, S::ONE, number(-1.0), number(0.25)), number(0.5));
    close(search().quadratic(SLIDE, S::ONE, S::ZERO, S::ZERO), S::ZERO);
    // Without a square, or with what rounding leaves of one, it is linear.
    close(search().quadratic(SLIDE, S::ZERO, S::TWO, number(-0.5)), number(0.25));
    close(search().quadratic(SLIDE, S::EPSILON, S::TWO, number(-0.5)), number(0.25));
    // A small square beside it moves the root a little and adds one far away.
    let roots = search().quadratic(SLIDE, number(1e-3), S::TWO, number(-0.5));
    assert!(
        roots.into_iter().any(|x| (x - number(0.249_968_757_810_059_45)).abs() < number(8.0) * S::EPSILON)
    );
    // x^2 + 0.09 = 0: out of reach by 0.3 m.
    let error = refusal(|s| s.quadratic(SLIDE, S::ONE, S::ZERO, number(0.09)));
    let IkError::Unreachable { excess, .. } = error else { panic!("{error}") };
    assert!((excess - number(0.3)).abs() < number(4.0) * S::EPSILON);
}

#[test]
fn quadratic_at_and_beyond_the_edge() {
    quadratic_edges::<f64>();
    quadratic_edges::<f32>();
}

#[test]
fn linear_finds_its_root() {
    assert_eq!(search::<f64>().linear(SLIDE, 0.5, 0.2), roots_of(0.4));
    assert_eq!(search::<f32>().linear(RATIO, -2.0, 1.0), roots_of(-0.5));
}

#[test]
fn what_is_no_number_is_refused() {
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        for at in 0..3 {
            let mut good = [0.3, 0.4, 0.1];
            good[at] = bad;
            let [a, b, c] = good;
            let row = [0.4, -0.3, 0.1];
            assert_eq!(refusal(|s| s.trig(LENGTH, a, b, c)), IkError::NotFinite);
            assert_eq!(refusal(|s| s.trig_pair(LENGTH, good, row)), IkError::NotFinite);
            assert_eq!(refusal(|s| s.trig_pair(LENGTH, row, good)), IkError::NotFinite);
            assert_eq!(refusal(|s| s.quadratic(SLIDE, a, b, c)), IkError::NotFinite);
        }
        assert_eq!(refusal(|s| s.linear(SLIDE, bad, 1.0)), IkError::NotFinite);
        assert_eq!(refusal(|s| s.linear(SLIDE, 1.0, bad)), IkError::NotFinite);
    }
}
