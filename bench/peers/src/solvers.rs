//! One adapter a crate: poses in its types, its solutions as joint values of our table.

use crate::arm::{Axes, times_transposed};
use crate::poses::Matrix;
use std::hint::black_box;

pub type Solutions = Vec<[f64; 6]>;

/// A solver with its poses prepared in its own types.
pub trait Solver {
    /// The crate, and which of its solvers.
    fn name(&self) -> String;
    /// Takes over poses; what that costs isn't timed.
    fn prepare(&mut self, poses: &[Matrix]);
    /// Solves for a pose, as a program would, and drops what it gives. This is what is timed.
    fn run(&self, pose: usize);
    /// What it gives, as joint values of the table.
    fn solutions(&self, pose: usize) -> Solutions;
}

/// ik-geo: subproblems on directions and offsets of the axes.
pub struct IkGeo {
    solver: &'static str,
    robot: ik_geo::robot::Robot,
    axes: Axes,
    poses: Vec<(ik_geo::nalgebra::Matrix3<f64>, ik_geo::nalgebra::Vector3<f64>)>,
}

impl IkGeo {
    pub fn new(solver: &'static str, axes: Axes) -> Self {
        use ik_geo::inverse_kinematics::auxiliary::Matrix3x7;
        use ik_geo::nalgebra::{Matrix3x6, Vector3};
        use ik_geo::robot as make;
        let columns: Vec<Vector3<f64>> = axes.h.iter().map(|h| Vector3::from(*h)).collect();
        let h = Matrix3x6::from_columns(&columns);
        let mut points: Vec<Vector3<f64>> = axes.points.iter().map(|p| Vector3::from(*p)).collect();
        points.push(Vector3::from(axes.home.map(|[_, _, _, p]| p)));
        points.insert(0, Vector3::zeros());
        let steps: Vec<Vector3<f64>> = points.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let p = Matrix3x7::from_columns(&steps);
        let robot = match solver {
            "spherical_two_parallel" => make::spherical_two_parallel(h, p),
            "three_parallel_two_intersecting" => make::three_parallel_two_intersecting(h, p),
            "two_parallel" => make::two_parallel(h, p),
            "two_intersecting" => make::two_intersecting(h, p),
            other => panic!("no solver {other}"),
        };
        Self { solver, robot, axes, poses: Vec::new() }
    }
}

impl Solver for IkGeo {
    fn name(&self) -> String {
        format!("ik-geo, {}", self.solver)
    }

    fn prepare(&mut self, poses: &[Matrix]) {
        use ik_geo::nalgebra::{Matrix3, Vector3};
        let home = &self.axes.home;
        self.poses = poses
            .iter()
            .map(|pose| {
                let r = times_transposed(pose, home);
                (Matrix3::from_fn(|i, j| r[i][j]), Vector3::from(pose.map(|[_, _, _, p]| p)))
            })
            .collect();
    }

    fn run(&self, pose: usize) {
        use ik_geo::robot::IKSolver;
        let (rotation, position) = self.poses[pose];
        black_box(self.robot.ik(black_box(rotation), position));
    }

    fn solutions(&self, pose: usize) -> Solutions {
        use ik_geo::robot::IKSolver;
        let (rotation, position) = self.poses[pose];
        let found = self.robot.ik(rotation, position).into_iter();
        found.map(|(turned, _)| self.axes.joints(&turned.into())).collect()
    }
}

/// rs-opw-kinematics: seven lengths. Signs, offsets and the flange's turn are found by comparing poses.
pub struct Opw {
    arm: rs_opw_kinematics::kinematics_impl::OPWKinematics,
    /// Our tool frame in theirs.
    tool: rs_opw_kinematics::pose::Pose,
    poses: Vec<rs_opw_kinematics::pose::Pose>,
}

fn opw_pose(m: &Matrix) -> rs_opw_kinematics::pose::Pose {
    use rs_opw_kinematics::glam::{DMat3, DQuat, DVec3};
    let column = |j: usize| DVec3::new(m[0][j], m[1][j], m[2][j]);
    let rotation = DQuat::from_mat3(&DMat3::from_cols(column(0), column(1), column(2)));
    rs_opw_kinematics::pose::Pose { translation: column(3), rotation: rotation.normalize() }
}

impl Opw {
    /// `lengths`: a1, a2, b, c1, c2, c3, c4 (m).
    pub fn new(lengths: [f64; 7], fk: impl Fn(&[f64; 6]) -> Matrix) -> Self {
        use rs_opw_kinematics::kinematic_traits::Kinematics;
        use rs_opw_kinematics::kinematics_impl::OPWKinematics;
        use rs_opw_kinematics::parameters::opw_kinematics::Parameters;
        use std::f64::consts::FRAC_PI_2;
        let samples = [
            [0.0; 6],
            [0.3, -0.5, 0.7, 1.1, -0.4, 0.9],
            [-1.2, 0.4, -0.8, 0.3, 1.3, -2.0],
            [2.1, 1.5, 0.2, -1.9, 0.8, 0.5],
        ];
        for choice in 0..64 * 16 * 4_u32 {
            let sign = |bit: u32| if choice >> bit & 1 == 1 { -1 } else { 1 };
            let quarters = |bit: u32| f64::from(choice >> bit & 3) * FRAC_PI_2 - FRAC_PI_2;
            let [a1, a2, b, c1, c2, c3, c4] = lengths;
            let parameters = Parameters {
                a1,
                a2: f64::from(sign(11)) * a2,
                b: f64::from(sign(10)) * b,
                c1,
                c2,
                c3,
                c4,
                offsets: [0.0, quarters(6), quarters(8), 0.0, 0.0, 0.0],
                sign_corrections: [0, 1, 2, 3, 4, 5].map(|bit| sign(bit) as i8),
                dof: 6,
            };
            let arm = OPWKinematics::new(parameters);
            let tools = samples.map(|q| {
                let theirs = arm.forward(&q);
                let ours = opw_pose(&fk(&q));
                let turned = theirs.rotation.conjugate();
                (turned * (ours.translation - theirs.translation), (turned * ours.rotation).normalize())
            });
            let (at, turn) = tools[0];
            if tools.iter().all(|(p, r)| (*p - at).length() < 1e-9 && r.dot(turn).abs() > 1.0 - 1e-9) {
                let tool = rs_opw_kinematics::pose::Pose { translation: at, rotation: turn };
                return Self { arm, tool, poses: Vec::new() };
            }
        }
        panic!("no signs and offsets make it the arm of the table");
    }
}

impl Solver for Opw {
    fn name(&self) -> String {
        "rs-opw-kinematics".to_owned()
    }

    fn prepare(&mut self, poses: &[Matrix]) {
        let turn = self.tool.rotation.conjugate();
        self.poses = poses
            .iter()
            .map(|pose| {
                let ours = opw_pose(pose);
                let rotation = (ours.rotation * turn).normalize();
                let translation = ours.translation - rotation * self.tool.translation;
                rs_opw_kinematics::pose::Pose { translation, rotation }
            })
            .collect();
    }

    fn run(&self, pose: usize) {
        use rs_opw_kinematics::kinematic_traits::Kinematics;
        black_box(self.arm.inverse(black_box(&self.poses[pose])));
    }

    fn solutions(&self, pose: usize) -> Solutions {
        use rs_opw_kinematics::kinematic_traits::Kinematics;
        self.arm.inverse(&self.poses[pose]).into_iter().collect()
    }
}

/// crx-kinematics: its table is where ours has its numbers from; millimetres and degrees.
pub struct Crx {
    arm: crx_kinematics::Crx,
    poses: Vec<crx_kinematics::Iso3>,
}

impl Crx {
    pub fn new() -> Self {
        Self { arm: crx_kinematics::Crx::new_10ia_l(), poses: Vec::new() }
    }
}

impl Solver for Crx {
    fn name(&self) -> String {
        "crx-kinematics".to_owned()
    }

    fn prepare(&mut self, poses: &[Matrix]) {
        self.poses = poses
            .iter()
            .map(|[x, y, z]| {
                let row = |r: &[f64; 4]| [r[0], r[1], r[2], r[3] * 1000.0];
                let rows = [row(x), row(y), row(z), [0.0, 0.0, 0.0, 1.0]].concat();
                crx_kinematics::row_slice_to_iso(&rows).expect("a pose")
            })
            .collect();
    }

    fn run(&self, pose: usize) {
        black_box(self.arm.ik(black_box(&self.poses[pose])));
    }

    fn solutions(&self, pose: usize) -> Solutions {
        self.arm.ik(&self.poses[pose]).iter().map(|solution| solution.joints.map(f64::to_radians)).collect()
    }
}

/// k: iterates from where the arm stands to one solution.
pub struct K {
    axes: Axes,
    chain: k::SerialChain<f64>,
    solver: k::JacobianIkSolver<f64>,
    poses: Vec<k::nalgebra::Isometry3<f64>>,
}

impl K {
    pub fn new(axes: Axes) -> Self {
        use k::nalgebra::{Translation3, Unit, UnitQuaternion, Vector3};
        let mut before = [0.0; 3];
        let mut nodes: Vec<k::Node<f64>> = Vec::new();
        let step = |from: [f64; 3], to: [f64; 3]| {
            Translation3::new(to[0] - from[0], to[1] - from[1], to[2] - from[2])
        };
        for (i, (h, point)) in axes.h.iter().zip(&axes.points).enumerate() {
            let axis = Unit::new_normalize(Vector3::from(*h));
            let node =
                k::NodeBuilder::new().name(&format!("j{i}")).joint_type(k::JointType::Rotational { axis });
            nodes.push(node.translation(step(before, *point)).into_node());
            before = *point;
        }
        let tip = axes.home.map(|[_, _, _, p]| p);
        let rotation = UnitQuaternion::from_rotation_matrix(&rotation(&axes.home));
        let tool = k::NodeBuilder::new().name("tool").joint_type(k::JointType::Fixed);
        nodes.push(tool.translation(step(before, tip)).rotation(rotation).into_node());
        for pair in nodes.windows(2) {
            pair[1].set_parent(&pair[0]);
        }
        let chain = k::SerialChain::from_end(&nodes[6]);
        Self { axes, chain, solver: k::JacobianIkSolver::new(1e-8, 1e-8, 0.8, 200), poses: Vec::new() }
    }

    fn solve(&self, pose: usize) -> Option<[f64; 6]> {
        use k::InverseKinematicsSolver;
        self.chain.set_joint_positions_clamped(&[0.1, -0.2, 0.3, 0.4, 0.5, -0.6]);
        self.solver.solve(&self.chain, &self.poses[pose]).ok()?;
        self.chain.joint_positions().try_into().ok()
    }
}

fn rotation(m: &Matrix) -> k::nalgebra::Rotation3<f64> {
    k::nalgebra::Rotation3::from_matrix_unchecked(k::nalgebra::Matrix3::from_fn(|i, j| m[i][j]))
}

impl Solver for K {
    fn name(&self) -> String {
        "k (one solution, iterated)".to_owned()
    }

    fn prepare(&mut self, poses: &[Matrix]) {
        use k::nalgebra::{Isometry3, Translation3, UnitQuaternion};
        self.poses = poses
            .iter()
            .map(|pose| {
                let [x, y, z] = pose.map(|[_, _, _, p]| p);
                let turn = UnitQuaternion::from_rotation_matrix(&rotation(pose));
                Isometry3::from_parts(Translation3::new(x, y, z), turn)
            })
            .collect();
    }

    fn run(&self, pose: usize) {
        black_box(self.solve(pose));
    }

    fn solutions(&self, pose: usize) -> Solutions {
        self.solve(pose).map(|turned| self.axes.joints(&turned)).into_iter().collect()
    }
}
