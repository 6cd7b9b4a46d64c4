//! Arms of seven joints: the solutions at a value of the free joint, and the one nearest to a seed.

use dh_runtime::{FULL_POSE, IkError, Kinematics, Pose, Solution, Solutions, dh_robot};
use std::f64::consts::{PI, TAU};
use std::hint::black_box;
use std::time::Instant;

/// How far seeds are from the joint values of their poses (rad).
const OFF: [f64; 4] = [0.02, 0.05, 0.3, 1.0];

/// Poses that are timed together, so that what else the machine does spoils few of them.
const BATCH: usize = 10;

trait Seven: Kinematics {
    fn pose(&self, q: &[f64; 7]) -> Pose;
    fn at(&self, pose: &Pose, free: f64) -> Result<Solutions<7>, IkError>;
    fn nearest(&self, pose: &Pose, seed: &[f64; 7]) -> Result<Solution<7>, IkError>;
}

macro_rules! arms {
    ($($table:literal $name:ident;)*) => {
        $(
            #[dh_robot($table)]
            struct $name;

            impl Seven for $name {
                fn pose(&self, q: &[f64; 7]) -> Pose {
                    self.fk(q)
                }
                fn at(&self, pose: &Pose, free: f64) -> Result<Solutions<7>, IkError> {
                    self.ik_at(pose, free)
                }
                fn nearest(&self, pose: &Pose, seed: &[f64; 7]) -> Result<Solution<7>, IkError> {
                    self.ik_nearest(pose, seed)
                }
            }
        )*

        /// Prints what arms of these names take, or all where there are none.
        pub fn compare(only: &[String]) {
            $(
                if only.is_empty() || only.iter().any(|name| name == $table) {
                    print($table, &$name);
                }
            )*
        }
    };
}

arms! {
    "crane_x7" CraneX7;
    "iiwa14" Iiwa14;
    "panda" Panda;
    "rizon4" Rizon4;
    "baxter" Baxter;
}

struct Case {
    q: [f64; 7],
    pose: Pose,
    seed: [f64; 7],
}

fn print(table: &str, arm: &dyn Seven) {
    let Some(free) = arm.redundancy(FULL_POSE).map(|redundancy| redundancy.joint) else {
        println!("\nSKIPPED: generated code has no full pose for {table}");
        return;
    };
    // Without a closed form one takes a hundred times as long.
    let mut cases = cases(arm, 0.05, 1000);
    if seconds(&cases[..BATCH], 1, &mut |case| {
        black_box(arm.at(&case.pose, case.q[free])).ok();
    }) > 2e-5
    {
        cases.truncate(100);
    }
    let count = cases.len();
    let found: Vec<_> = cases.iter().filter_map(|case| arm.at(&case.pose, case.q[free]).ok()).collect();
    let solutions: usize = found.iter().map(|all| all.len()).sum();
    let worst = found.iter().flatten().map(Solution::residual).fold(0.0, f64::max);
    let own = |case: &&Case| {
        let turned = |(a, b): (&f64, &f64)| ((a - b + PI).rem_euclid(TAU) - PI).abs() < 1e-6;
        arm.at(&case.pose, case.q[free])
            .is_ok_and(|all| all.iter().any(|one| one.q.iter().zip(&case.q).all(turned)))
    };
    let own = 100.0 * cases.iter().filter(own).count() as f64 / count as f64;
    let time = 1e6
        * seconds(&cases, 10, &mut |case| {
            black_box(arm.at(&case.pose, case.q[free])).ok();
        });
    println!("\n{table}, {count} poses");
    println!(
        "  free joint given: {time:8.3} us, {:.3} us a solution, worst {worst:.1e}, originals {own:.2}%",
        time * count as f64 / solutions.max(1) as f64
    );
    for off in OFF {
        let mut cases = self::cases(arm, off, count);
        let time = 1e6
            * seconds(&cases, 5, &mut |case| {
                black_box(arm.nearest(&case.pose, &case.seed)).ok();
            });
        let found: Vec<_> = cases.iter().map(|case| arm.nearest(&case.pose, &case.seed)).collect();
        let farther = |(case, found): (&Case, &Result<Solution<7>, IkError>)| {
            let wanted = distance(&case.q, &case.seed) + 1e-9;
            found.as_ref().is_ok_and(|solution| distance(&solution.q, &case.seed) > wanted)
        };
        let farther = cases.iter().zip(&found).filter(|pair| farther(*pair)).count();
        let none = found.iter().filter(|found| found.is_err()).count();
        cases.iter_mut().for_each(|case| case.seed = case.q);
        let returned =
            |case: &&Case| arm.nearest(&case.pose, &case.seed).is_ok_and(|found| found.q == case.q);
        let returned = cases.iter().filter(returned).count();
        println!(
            "  nearest, seed {off:4.2} off: {time:8.3} us; none {none}, farther than the pose's joints {farther}; \
             exact seeds returned {returned}"
        );
    }
}

fn distance(a: &[f64; 7], b: &[f64; 7]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
}

/// Joint values within limits, and seeds at some distance from them.
fn cases(arm: &dyn Seven, off: f64, count: usize) -> Vec<Case> {
    let mut state = 20_260_103;
    let mut draw = || crate::poses::draw(&mut state);
    let mut case = || {
        let mut q = [0.0; 7];
        for (value, joint) in q.iter_mut().zip(arm.joints()) {
            let (min, max) = joint.limits.map_or((-3.0, 3.0), |limits| (limits.min, limits.max));
            *value = min + (max - min) * draw();
        }
        let direction = [0; 7].map(|_| 2.0 * draw() - 1.0);
        let length = distance(&direction, &[0.0; 7]);
        let mut seed = q;
        seed.iter_mut().zip(direction).for_each(|(value, x)| *value += off * x / length);
        Case { q, pose: arm.pose(&q), seed }
    };
    (0..count).map(|_| case()).collect()
}

/// For one case: the least that each batch took.
fn seconds(cases: &[Case], repeats: usize, run: &mut dyn FnMut(&Case)) -> f64 {
    let mut least = vec![f64::INFINITY; cases.len().div_ceil(BATCH)];
    for _ in 0..repeats {
        for (batch, least) in cases.chunks(BATCH).zip(&mut least) {
            let start = Instant::now();
            batch.iter().for_each(|case| run(black_box(case)));
            *least = least.min(start.elapsed().as_secs_f64());
        }
    }
    least.iter().sum::<f64>() / cases.len() as f64
}
