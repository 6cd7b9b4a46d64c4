//! Equations of the second degree in the cosine and sine of an angle: all roots, double ones, and none.

#![allow(clippy::unwrap_used, clippy::indexing_slicing, reason = "a test fails by panicking")]

mod random;

use dh_core::{BranchBit, BranchWord, Float, IkError, Measure, Search, Solutions, Step};
use random::Random;

const STEP: Step = Step::new(0, 0b1, false, Measure::Power(3));
const BIT: BranchBit = BranchBit::new(0, BranchWord::Joint, 0);
const REACH: f64 = 0.8;

type Forms<S = f64> = [[S; 3]; 2];

fn solve<S: Float>(forms: Forms, right: f64) -> Result<Solutions<1, S>, IkError<S>> {
    let mut search = Search::<1, S>::new(S::from_f64(REACH), &[]);
    let mut roots = search.quartic(STEP, forms.map(|form| form.map(S::from_f64)), S::from_f64(right));
    while let Some((x, sin, cos)) = search.next_of_quartic(&mut roots) {
        let (s, c) = x.sin_cos();
        assert!((sin - s).abs() + (cos - c).abs() <= S::from_f64(4.0) * S::EPSILON);
        search.accept([x], S::ZERO, S::ZERO);
    }
    search.finish()
}

/// The left side less the right one, and its derivative.
fn value(forms: &Forms, right: f64, x: f64) -> [f64; 2] {
    let (sin, cos) = (libm::sin(x), libm::cos(x));
    let (mut sum, mut slope) = (-right * right, 0.0);
    for [k, l, m] in forms {
        let form = k + l * cos + m * sin;
        sum += form * form;
        slope += 2.0 * form * (m * cos - l * sin);
    }
    [sum, slope]
}

fn drawn(random: &mut Random) -> Forms {
    [(); 2].map(|()| [(); 3].map(|()| random.between(-0.3, 0.3)))
}

#[test]
fn every_change_of_sign_has_its_root_and_its_sign() {
    const PLACES: u32 = 2000;
    let mut random = Random(11);
    let mut counts = [0; 5];
    for _ in 0..500 {
        let forms = drawn(&mut random);
        let right: f64 = random.between(0.05, 0.4);
        let at = |place: u32| core::f64::consts::TAU * f64::from(place) / f64::from(PLACES);
        let changes: Vec<f64> = (0..PLACES)
            .filter(|place| {
                let [here, next] = [at(*place), at(place + 1)].map(|x| value(&forms, right, x)[0]);
                (here > 0.0) != (next > 0.0)
            })
            .map(at)
            .collect();
        let found = solve::<f64>(forms, right);
        let found = found.as_ref().map_or(&[][..], Solutions::as_slice);
        for x in &changes {
            let near = |root: f64| (root - x).rem_euclid(core::f64::consts::TAU) <= 1.001 * at(1);
            assert!(found.iter().any(|one| near(one.q[0])), "{forms:?} {right}: {x} in {found:?}");
        }
        for one in found {
            let [miss, slope] = value(&forms, right, one.q[0]);
            // Next to a double root, the value knows half of the digits.
            assert!(
                miss.abs() <= 1e-15 * (1.0 + 1.0 / slope.abs()) || slope.abs() < 1e-2,
                "{forms:?} {right}: {one:?}"
            );
            assert!(slope.abs() < 1e-6 || one.branch.is_plus(&BIT).unwrap() == (slope > 0.0));
        }
        counts[changes.len()] += 1;
    }
    assert!(counts[0] > 20 && counts[2] > 20 && counts[4] > 20, "{counts:?}");
}

fn double_roots<S: Float>() {
    // (k + cos x)² + sin² x = (1 + k)²: 2 k (1 - cos x) = 0.
    for k in [0.3, 0.05, 2.0] {
        let forms = [[k, 1.0, 0.0], [0.0, 0.0, 1.0]];
        for off in [0.0, 1e-16, -1e-16] {
            let found = solve::<S>(forms, (1.0 + k) * (1.0 + off)).unwrap();
            let near = S::from_f64(16.0) * S::SQRT_EPSILON;
            assert!(found.iter().any(|one| one.q[0].abs() <= near), "{k} {off}: {found:?}");
        }
    }
}

#[test]
fn double_roots_are_found() {
    double_roots::<f64>();
    double_roots::<f32>();
}

/// A unit vector (s sin x, e, s cos x) with s² + e² = 1, less a number h: beside it 2 (1 - h) sin x. Where 1 - h is n, roots next to 0
/// are as far apart as e.
#[test]
fn roots_that_nearly_meet_keep_the_digits_of_small_coordinates() {
    for h in [0.0_f64, 0.4, -0.3] {
        for e in [1e-5, 1e-7, 1e-9, 1e-11] {
            let (n, s) = (1.0 - h.abs(), libm::sqrt(1.0 - e * e));
            let turned = h.signum();
            let forms = [[-h, turned * s, 0.0], [0.0, 0.0, 2.0 * n]];
            let others = [[0.0, 0.0, s], [e, 0.0, 0.0]];
            let gaps = if h < 0.0 { [2.0 * (n - 1.0), 0.0] } else { [0.0, 2.0 * (n - 1.0)] };
            let mut search = Search::<1>::new(REACH, &[]);
            let mut roots = search.quartic_unit(STEP, forms, n, others, [1.0, gaps[0], gaps[1]]);
            let mut found = Vec::new();
            while let Some((x, ..)) = search.next_of_quartic(&mut roots) {
                found.push(x);
            }
            // n² - (s cos x - h)² = n (x² + e²) + ..., and (2 n x)².
            let off = e / libm::sqrt(4.0 * n - 1.0);
            for root in [off, -off] {
                let nearest = found.iter().map(|x| (x - root).abs()).fold(f64::INFINITY, f64::min);
                assert!(nearest <= 1e-6 * e + e * e + 1e-15, "{h} {e}: {nearest} {found:?}");
            }
        }
    }
}

#[test]
fn vanishing_coefficients_leave_the_joint_free_or_are_singular() {
    let still = |k: f64| [[k, 0.0, 0.0], [0.4, 1e-18, 0.0]];
    assert_eq!(solve::<f64>(still(0.3), 0.5).unwrap()[0].free, Some(0));
    // A circle on a circle.
    let round = [[0.0, 0.3, 0.0], [0.0, 0.0, 0.3]];
    assert_eq!(solve::<f64>(round, 0.3).unwrap()[0].free, Some(0));
    assert!(matches!(solve::<f64>(still(0.1), 0.5), Err(IkError::Singular { joint: 0, .. })));
    assert!(matches!(solve::<f64>(round, 0.2), Err(IkError::Singular { joint: 0, .. })));
}

#[test]
fn what_is_out_of_reach_says_so_and_what_is_no_number_too() {
    let forms = [[0.3, 0.1, 0.0], [0.0, 0.0, 0.1]];
    assert!(matches!(solve::<f64>(forms, 0.5), Err(IkError::Unreachable { excess, .. }) if excess > 0.1));
    for bad in [f64::NAN, f64::INFINITY] {
        assert_eq!(solve::<f64>([[bad, 0.1, 0.0], [0.0, 0.0, 0.1]], 0.5), Err(IkError::NotFinite));
        assert_eq!(solve::<f64>(forms, bad), Err(IkError::NotFinite));
    }
}
