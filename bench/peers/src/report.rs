//! Measures a solver and prints its line.

use crate::poses::{Case, Matrix};
use crate::solvers::{Solutions, Solver};
use std::f64::consts::TAU;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::{Duration, Instant};

/// A solution misses its target by less than this (m, or an entry of the rotation), or is wrong.
const RIGHT: f64 = 1e-6;

/// Joint values that made a pose are found again when every one is this near (rad).
const FOUND: f64 = 1e-6;

/// How long all repeats of one solver may take.
const PATIENCE: Duration = Duration::from_secs(4);

/// What was measured.
pub struct Measured {
    pub name: String,
    /// Seconds a pose, least of the repeats.
    pub seconds: f64,
    /// Random poses that were solved.
    pub poses: usize,
    /// Right solutions a pose.
    pub right: f64,
    /// Others that it returned, a pose.
    pub wrong: f64,
    /// Greatest miss of a right solution.
    pub worst: f64,
    /// Share of poses whose own joint values were found.
    pub originals: f64,
    /// Share of lattice poses with a right solution.
    pub lattice: f64,
    /// How often it panicked.
    pub panics: usize,
}

type Fk<'a> = &'a dyn Fn(&[f64; 6]) -> Matrix;

/// Poses that are timed together.
const BATCH: usize = 100;

/// By how much joint values miss a pose.
fn miss(fk: Fk, q: &[f64; 6], pose: &Matrix) -> f64 {
    let reached = fk(q);
    let entries = reached.iter().flatten().zip(pose.iter().flatten());
    entries
        .map(|(a, b)| (a - b).abs())
        .fold(0.0, |worst, off| if off > worst || off.is_nan() { off } else { worst })
}

fn apart(a: &[f64; 6], b: &[f64; 6]) -> f64 {
    let turn = |a: f64, b: f64| {
        let off = (a - b).rem_euclid(TAU);
        off.min(TAU - off)
    };
    a.iter().zip(b).map(|(a, b)| turn(*a, *b)).fold(0.0, f64::max)
}

/// Its solutions; none where it panics.
fn solutions(solver: &dyn Solver, pose: usize, panics: &mut usize) -> Solutions {
    catch_unwind(AssertUnwindSafe(|| solver.solutions(pose))).unwrap_or_else(|_| {
        *panics += 1;
        Vec::new()
    })
}

/// Solves for a pose as it is timed.
fn run(solver: &dyn Solver, pose: usize) {
    catch_unwind(AssertUnwindSafe(|| solver.run(pose))).ok();
}

pub fn measure(solver: &mut dyn Solver, random: &[Case], lattice: &[Case], fk: Fk) -> Measured {
    let poses = |cases: &[Case]| cases.iter().map(|case| case.pose).collect::<Vec<_>>();
    solver.prepare(&poses(lattice));
    let start = Instant::now();
    let (mut solved, mut tried, mut panics) = (0, 0, 0);
    for (index, case) in lattice.iter().enumerate() {
        let right = |q: &[f64; 6]| miss(fk, q, &case.pose) < RIGHT;
        solved += usize::from(solutions(solver, index, &mut panics).iter().any(right));
        tried += 1;
        if start.elapsed() > PATIENCE {
            break;
        }
    }
    solver.prepare(&poses(random));
    let start = Instant::now();
    (0..20).for_each(|pose| run(solver, pose));
    let one = start.elapsed().as_secs_f64() / 20.0;
    let count = ((PATIENCE.as_secs_f64() / 8.0 / one) as usize).clamp(20, random.len());
    let repeats = ((PATIENCE.as_secs_f64() / (one * count as f64)) as usize).clamp(2, 25);
    // The least that each batch took, so that what else the machine does spoils few of them.
    let mut least = vec![f64::INFINITY; count.div_ceil(BATCH)];
    for _ in 0..repeats {
        for (batch, least) in least.iter_mut().enumerate() {
            let start = Instant::now();
            (batch * BATCH..count.min((batch + 1) * BATCH)).for_each(|pose| run(solver, pose));
            *least = least.min(start.elapsed().as_secs_f64());
        }
    }
    let seconds = least.iter().sum::<f64>() / count as f64;
    let (mut right, mut wrong, mut worst, mut originals) = (0, 0, 0.0_f64, 0);
    for (index, case) in random.iter().enumerate().take(count) {
        let found = solutions(solver, index, &mut panics);
        for q in &found {
            let off = miss(fk, q, &case.pose);
            if off < RIGHT {
                right += 1;
                worst = worst.max(off);
            } else {
                wrong += 1;
            }
        }
        originals += usize::from(found.iter().any(|q| apart(q, &case.q) < FOUND));
    }
    let share = |part: usize, whole: usize| part as f64 / whole as f64;
    Measured {
        name: solver.name(),
        seconds,
        poses: count,
        right: share(right, count),
        wrong: share(wrong, count),
        worst,
        originals: share(originals, count),
        lattice: share(solved, tried),
        panics,
    }
}

/// The lines of one arm; times are also given in those of the first.
pub fn print(arm: &str, lines: &[Measured]) {
    println!("\n{arm}");
    println!(
        "  {:<38} {:>10} {:>8} {:>7} {:>9} {:>7} {:>9} {:>9} {:>8}",
        "", "us a pose", "ratio", "poses", "solutions", "wrong", "worst", "originals", "lattice"
    );
    let first = lines.first().map_or(f64::NAN, |line| line.seconds);
    for line in lines {
        let panics = if line.panics == 0 { String::new() } else { format!("  {} panics", line.panics) };
        println!(
            "  {:<38} {:>10.3} {:>8.2} {:>7} {:>9.4} {:>7.4} {:>9.1e} {:>8.2}% {:>7.2}%{panics}",
            line.name,
            1e6 * line.seconds,
            line.seconds / first,
            line.poses,
            line.right,
            line.wrong,
            line.worst,
            100.0 * line.originals,
            100.0 * line.lattice,
        );
    }
}
