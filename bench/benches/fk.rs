//! Forward kinematics, pose by pose: generated code against the product of 4x4 matrices that people write.
//!
//! Every side gets the same random joint values and gives a pose as a matrix (3x3 and translation, or 4x4), all in one
//! process. 1024 poses stay in the first cache, 16384 do not, and are too many for a branch predictor to learn.

use std::hint::black_box;

use dh_bench::{MatrixArm, random_joints};
use dh_runtime::{Pose, dh_robot};
use divan::Bencher;
use divan::counter::ItemsCount;

#[dh_robot("ur5")]
struct Ur5;

#[dh_robot("puma560")]
struct Puma560;

#[dh_robot("panda")]
struct Panda;

#[dh_robot("mycobot")]
struct MyCobot;

/// A generated arm of N joints under the name of its table.
trait Arm<const N: usize> {
    const TABLE: &str;
    fn pose(q: &[f64; N]) -> Pose;
}

macro_rules! arm {
    ($arm:ident, $joints:literal, $table:literal) => {
        impl Arm<$joints> for $arm {
            const TABLE: &str = $table;
            #[inline]
            fn pose(q: &[f64; $joints]) -> Pose {
                $arm.fk(q)
            }
        }
    };
}

arm!(Ur5, 6, "ur5");
arm!(Puma560, 6, "puma560");
arm!(Panda, 7, "panda");
arm!(MyCobot, 6, "mycobot");

/// The product of matrices of a table whose numbers both sides agree on.
fn matrix_arm<A: Arm<N>, const N: usize>() -> MatrixArm {
    let arm = MatrixArm::shipped(A::TABLE).unwrap_or_else(|error| unreachable!("{error}"));
    for q in random_joints::<N>(100) {
        let ours = A::pose(&q).to_homogeneous();
        for theirs in [arm.fk(&q), arm.fk_precomputed(&q)] {
            assert!((ours - theirs).amax() < 1e-13, "{} at {q:?}", A::TABLE);
        }
    }
    arm
}

fn time<const N: usize, T>(bencher: Bencher, count: usize, fk: impl Fn(&[f64; N]) -> T) {
    let joints = random_joints::<N>(count);
    bencher.counter(ItemsCount::new(count)).bench_local(|| {
        for q in &joints {
            black_box(fk(black_box(q)));
        }
    });
}

macro_rules! group {
    ($group:ident, $arm:ident, $joints:literal) => {
        mod $group {
            use super::{Arm, Bencher, matrix_arm, time, $arm};

            #[divan::bench(args = [1024, 16384])]
            fn generated(bencher: Bencher, count: usize) {
                time::<$joints, _>(bencher, count, $arm::pose);
            }

            #[divan::bench(args = [1024, 16384])]
            fn matrices(bencher: Bencher, count: usize) {
                let arm = matrix_arm::<$arm, $joints>();
                time::<$joints, _>(bencher, count, |q| arm.fk(q));
            }

            #[divan::bench(args = [1024, 16384])]
            fn matrices_with_twists_precomputed(bencher: Bencher, count: usize) {
                let arm = matrix_arm::<$arm, $joints>();
                time::<$joints, _>(bencher, count, |q| arm.fk_precomputed(q));
            }
        }
    };
}

group!(ur5, Ur5, 6);
group!(puma560, Puma560, 6);
group!(panda, Panda, 7);
group!(mycobot, MyCobot, 6);

fn main() {
    divan::main();
}
