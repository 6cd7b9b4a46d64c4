//! Chains that are made for one thing each.

use super::{Found, RowChain};
use crate::{Frame, Target};
use core::f64::consts::{FRAC_PI_2, PI};
use std::vec::Vec;

/// All that is found for a target, with what the best start missed it by, where unknowns that are free are wanted there.
fn search(chain: &RowChain<'_>, target: &Target, wanted: f64) -> (Vec<Found>, f64) {
    let mut found = Vec::new();
    let miss = chain.solve(target, &[], (&[wanted; 6], 0.0), &mut |solution| found.push(*solution));
    (found, miss)
}

fn turned(rpy: [f64; 3]) -> Frame {
    Frame::from_rpy([0.0; 3], rpy)
}

fn shifted(x: f64) -> Frame {
    Frame { translation: [x, 0.0, 0.0], ..Frame::IDENTITY }
}

/// Slides have no limits but where a table gives them, and then the reach has no part of theirs.
#[test]
fn a_slide_goes_as_far_as_it_must() {
    let links =
        [turned([0.0; 3]), turned([0.0, FRAC_PI_2, 0.0]), turned([FRAC_PI_2, 0.0, 0.0]), shifted(0.05)];
    let chain = RowChain {
        links: &links,
        prismatic: &[false, true, false],
        forms: &[&[1.0, 0.0, 0.0, 0.0], &[0.0, 1.0, 0.0, 0.0], &[0.0, 0.0, 1.0, 0.0]],
        turns: &[1, 0, 1],
        reach: 0.1,
        patience: 64,
    };
    for away in [0.3, 1.3, 2.0, 20.0] {
        let x = [0.7, away, -0.4, 0.0, 0.0, 0.0];
        let target = Target::Position(chain.tip(&[], &x).translation);
        let (found, miss) = search(&chain, &target, 0.0);
        let near = |other: &Found| other.x.iter().zip(x).all(|(a, b)| (a - b).abs() < 1e-6);
        assert!(found.iter().any(near), "{away} m: {found:?}, missed by {miss}");
        assert!(found.iter().all(|solution| target.errors(&chain.tip(&[], &solution.x)).0 < 1e-9));
    }
}

/// Three pairs of links 1 m long, each pair folded by twice x: 2 cos x (u + v + w) = 0, of which u lies at 0, v at x, and w
/// at y, each plus a constant. All y solve it where x is a quarter turn; beside that curve is the place where u, v and w
/// make a triangle.
#[test]
fn a_solution_beside_a_curve_is_found() {
    let (x, y) = (FRAC_PI_2 + 0.2, 0.1);
    let third = 2.0 * PI / 3.0;
    // Direction of each link: factors of x and y, and a constant.
    let means = [[0.0, 0.0, 0.0], [1.0, 0.0, third - x], [0.0, 1.0, 2.0 * third - y]];
    let mut last = [0.0; 3];
    let mut forms: Vec<[f64; 3]> = Vec::new();
    for [of_x, of_y, constant] in means {
        for sign in [1.0, -1.0] {
            let own = [of_x + sign, of_y, constant];
            forms.push(core::array::from_fn(|place| own[place] - last[place]));
            last = own;
        }
    }
    let forms: Vec<&[f64]> = forms.iter().map(|form| &form[..]).collect();
    let mut links = [shifted(1.0); 7];
    links[0] = Frame::IDENTITY;
    let chain = RowChain {
        links: &links,
        prismatic: &[false; 6],
        forms: &forms,
        turns: &[1, 1],
        reach: 6.0,
        patience: 256,
    };
    let (found, _) = search(&chain, &Target::Xy([0.0; 2]), 0.0);
    let beside = found.iter().find(|other| (other.x[0] - x).abs() < 1e-6 && (other.x[1] - y).abs() < 1e-6);
    assert_eq!(beside.map(|solution| solution.free), Some(None), "{found:?}");
    assert!(found.iter().any(|solution| solution.free == Some(1)), "{found:?}");
}

/// A tool on the axis of a pitch joint: its yaw is 0 as long as its x axis is ahead, and half a turn beyond upright.
#[test]
fn what_is_handed_on_of_a_curve_heads_as_wanted() {
    let links = [turned([-FRAC_PI_2, 0.0, 0.0]), Frame::IDENTITY];
    let chain = RowChain {
        links: &links,
        prismatic: &[false],
        forms: &[&[1.0, 0.0]],
        turns: &[1],
        reach: 1.0,
        patience: 64,
    };
    for (yaw, wanted) in [(0.0, 0.4), (0.0, 3.0), (PI, 3.0), (PI, 0.4)] {
        let target = Target::PositionYaw { position: [0.0; 3], yaw };
        let (found, _) = search(&chain, &target, wanted);
        assert!(found.len() == 1 && found[0].free == Some(0), "{found:?}");
        let (position, rotation) = target.errors(&chain.tip(&[], &found[0].x));
        assert!(
            position < 1e-9 && rotation < 1e-9,
            "yaw {yaw}, near {wanted}: off by {rotation} at {found:?}"
        );
    }
}

/// A tool that only slides along its x axis never has that axis the other way round.
#[test]
fn a_target_that_is_met_only_backwards_is_missed_by_half_a_turn() {
    let links = [turned([0.0, FRAC_PI_2, 0.0]), turned([0.0, -FRAC_PI_2, 0.0])];
    let chain = RowChain {
        links: &links,
        prismatic: &[true],
        forms: &[&[1.0, 0.0]],
        turns: &[0],
        reach: 1.0,
        patience: 64,
    };
    let target = |yaw| Target::XyYaw { position: [0.3, 0.0], yaw };
    assert_eq!(search(&chain, &target(0.0), 0.0).0.len(), 1);
    let (found, miss) = search(&chain, &target(PI), 0.0);
    assert!(found.is_empty() && miss == PI, "missed by {miss}: {found:?}");
    assert_eq!(chain.descend(&target(PI), &[], 1), None);
}
