//! All inverse solutions of the same random poses, by generated code and by other crates, in one process.
//!
//! `cargo run --release [-- [--ours] [ARM ...]]` in this folder; cmake builds the C library under ik-geo. Times are sums over batches
//! of poses, of each the least of several runs; what counts is their ratio. `wrong` are returned solutions that miss the target by more than 1e-6,
//! `originals` the share of poses whose own joint values are among the solutions, `lattice` the share of poses with
//! joints at quarter turns that get a right solution. Arms of seven joints stand by themselves: no crate here solves them.

#![allow(deprecated, reason = "what the macro says of problems that are not solved")]

mod arm;
mod poses;
mod report;
mod seven;
mod solvers;

use arm::Axes;
use dh_runtime::nalgebra::{IsometryMatrix3, Matrix3, Rotation3, Translation3};
use dh_runtime::{IkError, Pose, dh_robot};
use poses::Matrix;
use solvers::{Crx, IkGeo, K, Opw, Solutions, Solver};
use std::hint::black_box;

/// Random poses of every arm.
const POSES: usize = 10_000;

/// Lattice poses of every arm.
const LATTICE: usize = 400;

/// Stands in for an inverse that an arm does not have (yet): the arm's own `ik_all` comes before it.
#[allow(dead_code, reason = "not called once every arm has its own")]
trait NotThere {
    fn ik_all(&self, _: &Pose) -> Result<dh_runtime::Solutions<6>, IkError> {
        Err(IkError::UnknownProblem)
    }
}

/// Generated code behind the interface of the solvers.
struct Generated<A: Arm> {
    arm: A,
    poses: Vec<Pose>,
}

trait Arm {
    fn matrix(&self, q: &[f64; 6]) -> Matrix;
    fn all(&self, pose: &Pose) -> Result<dh_runtime::Solutions<6>, IkError>;
}

impl<A: Arm> Solver for Generated<A> {
    fn name(&self) -> String {
        "generated code".to_owned()
    }

    fn prepare(&mut self, poses: &[Matrix]) {
        self.poses = poses.iter().map(pose).collect();
    }

    fn run(&self, pose: usize) {
        black_box(self.arm.all(black_box(&self.poses[pose]))).ok();
    }

    fn solutions(&self, pose: usize) -> Solutions {
        self.arm
            .all(&self.poses[pose])
            .map_or_else(|_| Vec::new(), |all| all.iter().map(|one| one.q).collect())
    }
}

fn pose([x, y, z]: &Matrix) -> Pose {
    let rotation = Matrix3::new(x[0], x[1], x[2], y[0], y[1], y[2], z[0], z[1], z[2]);
    IsometryMatrix3::from_parts(
        Translation3::new(x[3], y[3], z[3]),
        Rotation3::from_matrix_unchecked(rotation),
    )
}

fn matrix(pose: &Pose) -> Matrix {
    let (r, p) = (pose.rotation.matrix(), pose.translation.vector);
    [0, 1, 2].map(|i| [r[(i, 0)], r[(i, 1)], r[(i, 2)], p[i]])
}

/// Declares arms of shipped tables, with the solvers that can do them.
macro_rules! arms {
    ($($table:literal $name:ident: $peers:expr;)*) => {
        $(
            #[dh_robot($table)]
            #[derive(Clone, Copy)]
            struct $name;

            impl NotThere for $name {}

            impl Arm for $name {
                fn matrix(&self, q: &[f64; 6]) -> Matrix {
                    matrix(&self.fk(q))
                }

                fn all(&self, pose: &Pose) -> Result<dh_runtime::Solutions<6>, IkError> {
                    self.ik_all(pose)
                }
            }
        )*

        fn main() {
            let (flags, only): (Vec<String>, Vec<String>) =
                std::env::args().skip(1).partition(|argument| argument.starts_with("--"));
            let ours_alone = flags.iter().any(|flag| flag == "--ours");
            // Some peers panic at singular poses; that is counted.
            std::panic::set_hook(Box::new(|_| {}));
            $(
                if only.is_empty() || only.iter().any(|name| name == $table) {
                    compare($table, $name, $peers, ours_alone);
                }
            )*
            seven::compare(&only);
        }
    };
}

type Peers = Vec<Box<dyn Solver>>;

fn compare<A: Arm + Copy + 'static>(
    table: &str,
    arm: A,
    peers: impl Fn(&dyn Fn(&[f64; 6]) -> Matrix, Axes) -> Peers,
    ours_alone: bool,
) {
    let fk = |q: &[f64; 6]| arm.matrix(q);
    let random = poses::random(POSES, fk);
    let lattice = poses::lattice(LATTICE, fk);
    let mut solvers: Peers = Vec::new();
    match arm.all(&pose(&random[0].pose)) {
        Err(IkError::UnknownProblem) => {
            println!("\nSKIPPED: generated code has no full pose for {table} yet")
        }
        _ => solvers.push(Box::new(Generated { arm, poses: Vec::new() })),
    }
    if !ours_alone {
        solvers.extend(peers(&fk, Axes::of(table, fk)));
        solvers.push(Box::new(K::new(Axes::of(table, fk))));
    }
    let lines: Vec<_> =
        solvers.iter_mut().map(|solver| report::measure(&mut **solver, &random, &lattice, &fk)).collect();
    report::print(table, &lines);
}

fn geo(solver: &'static str) -> impl Fn(Axes) -> Box<dyn Solver> {
    move |axes| Box::new(IkGeo::new(solver, axes))
}

arms! {
    "puma560" Puma560: |fk, axes| {
        vec![
            geo("spherical_two_parallel")(axes),
            Box::new(Opw::new([0.0, -0.0203, 0.15005, 0.672, 0.4318, 0.4318, 0.0], fk)),
        ]
    };
    "kr6_r900" Kr6R900: |fk, axes| {
        vec![
            geo("spherical_two_parallel")(axes),
            Box::new(Opw::new([0.025, -0.035, 0.0, 0.4, 0.455, 0.42, 0.08], fk)),
        ]
    };
    "irb6640" Irb6640: |fk, axes| {
        vec![
            geo("spherical_two_parallel")(axes),
            Box::new(Opw::new([0.32, -0.2, 0.0, 0.78, 1.075, 1.392, 0.2], fk)),
        ]
    };
    "ur5" Ur5: |_, axes| vec![geo("three_parallel_two_intersecting")(axes)];
    "../../tests/near/ur5_tilted.toml" Ur5Tilted: |_, _| Vec::new();
    "../../tests/near/puma560_rounded.toml" Puma560Rounded: |_, _| Vec::new();
    "crx10ia_l" Crx10IaL: |_, axes| vec![Box::new(Crx::new()), geo("two_parallel")(axes)];
    "jaco2" Jaco2: |_, axes| vec![geo("two_parallel")(axes)];
    "manocha_canny" ManochaCanny: |_, axes| vec![geo("two_intersecting")(axes)];
}
