use super::{Chart, GeneralArm, JOINTS, SixJoints};
use crate::Frame;
use std::vec::Vec;

const H: f64 = core::f64::consts::FRAC_PI_2;

struct Random(u64);
impl Random {
    fn next(&mut self, from: f64, to: f64) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        from + (to - from) * ((self.0 >> 11) as f64 / (1_u64 << 53) as f64)
    }
    fn joints(&mut self) -> [f64; 6] {
        [0; 6].map(|_| self.next(-core::f64::consts::PI, core::f64::consts::PI))
    }
}

fn turn(q: f64) -> Frame {
    let (s, c) = libm::sincos(q);
    Frame { rotation: [[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]], translation: [0.0; 3] }
}

fn link([a, alpha, d]: [f64; 3]) -> Frame {
    let (s, c) = libm::sincos(alpha);
    Frame { rotation: [[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]], translation: [a, 0.0, d] }
}

fn arm(rows: [[f64; 3]; 6], charts: &[Chart]) -> SixJoints<'_> {
    let [l1, l2, l3, l4, l5, l6] = rows.map(link);
    SixJoints {
        links: [Frame::IDENTITY, l1, l2, l3, l4, l5, l6],
        prismatic: [false; 6],
        reach: rows.iter().map(|[a, _, d]| a.abs() + d.abs()).sum(),
        charts,
        triple: None,
    }
}

fn fk(arm: &SixJoints<'_>, q: &[f64; JOINTS]) -> Frame {
    let mut frame = arm.links[0];
    for (q, link) in q.iter().zip(&arm.links[1..]) {
        frame = frame * turn(*q) * *link;
    }
    frame
}

fn apart(a: &[f64; 6], b: &[f64; 6]) -> f64 {
    a.iter()
        .zip(b)
        .map(|(a, b)| {
            ((a - b) - core::f64::consts::TAU * libm::round((a - b) / core::f64::consts::TAU)).abs()
        })
        .fold(0.0, f64::max)
}

fn arms() -> Vec<(&'static str, [[f64; 3]; 6])> {
    let (sa, ss) = (libm::sin(H / 3.0), libm::sin(2.0 * H / 3.0));
    let (d4, d5, d6) = (0.2073 + sa / ss * 0.0741, 2.0 * sa / ss * 0.0741, sa / ss * 0.0741 + 0.16);
    let mut random = Random(7);
    let mut any = || [0; 6].map(|_| [random.next(0.0, 0.6), random.next(-2.0, 2.0), random.next(0.0, 0.5)]);
    std::vec![
        (
            "manseur",
            [[0.3, H, 0.0], [1.0, H, 0.0], [0.0, H, 0.2], [1.5, H, 0.0], [0.0, H, 0.0], [0.0, H, 0.0]]
        ),
        (
            "crx",
            [
                [0.0, -H, 0.0],
                [0.71, 0.0, 0.0],
                [0.0, -H, 0.0],
                [0.0, H, 0.54],
                [0.0, -H, 0.15],
                [0.0, 0.0, 0.16]
            ]
        ),
        (
            "jaco2",
            [
                [0.0, H, 0.2755],
                [0.41, 2.0 * H, 0.0],
                [0.0, H, -0.0098],
                [0.0, 2.0 * H / 3.0, -d4],
                [0.0, 2.0 * H / 3.0, -d5],
                [0.0, 2.0 * H, -d6]
            ]
        ),
        (
            "ur5off",
            [
                [0.0, H, 0.0892],
                [-0.425, 1e-4, 0.0],
                [-0.392, -1e-4, 0.0],
                [1e-4, H, 0.1093],
                [0.0, -H, 0.09475],
                [0.0, 0.0, 0.0825]
            ]
        ),
        (
            "pumaoff",
            [
                [0.0, H, 0.0],
                [0.4318, 0.0, 0.0],
                [0.0203, -H, 0.15005],
                [1e-4, H, 0.4318],
                [1e-4, -H, 0.0],
                [0.0, 0.0, 0.05]
            ]
        ),
        (
            "ur5",
            [
                [0.0, H, 0.0892],
                [-0.425, 0.0, 0.0],
                [-0.392, 0.0, 0.0],
                [0.0, H, 0.1093],
                [0.0, -H, 0.09475],
                [0.0, 0.0, 0.0825]
            ]
        ),
        (
            "puma",
            [
                [0.0, H, 0.0],
                [0.4318, 0.0, 0.0],
                [0.0203, -H, 0.15005],
                [0.0, H, 0.4318],
                [0.0, -H, 0.0],
                [0.0, 0.0, 0.05]
            ]
        ),
        ("gen0", any()),
        ("gen1", any()),
        ("gen2", any()),
    ]
}

/// Name, rows of a, alpha and d, charts.
type Case = (&'static str, [[f64; 3]; 6], [Chart; 3]);

/// Arms of all kinds with the charts that the compiler chooses for them.
fn cases() -> Vec<Case> {
    let line = Chart::new(1, true, 0, true, false, 8);
    let (near, far) = (Chart::new(1, true, 1, true, true, 8), Chart::new(4, false, 2, true, true, 8));
    let charts = |name: &str| match name {
        "manseur" => [
            Chart::new(4, false, 1, false, false, 12),
            Chart::new(4, false, 2, false, false, 12),
            Chart::new(1, true, 1, false, false, 12),
        ],
        name if name.starts_with("gen") => {
            [line, Chart::new(4, false, 0, false, false, 8), Chart { degree: 12, divided: false, ..far }]
        }
        _ => [far, near, Chart::new(4, false, 0, false, false, 8)],
    };
    arms().into_iter().map(|(name, rows)| (name, rows, charts(name))).collect()
}

#[test]
fn the_joints_that_a_pose_was_made_from_are_found() {
    for (name, rows, charts) in cases() {
        let arm = arm(rows, &charts);
        let mut random = Random(11);
        for _ in 0..150 {
            let q = random.joints();
            let pose = fk(&arm, &q);
            let mut nearest = f64::INFINITY;
            arm.solve(&pose, |solution, _| {
                let (position, rotation) = crate::Target::Pose(pose).errors(&fk(&arm, solution));
                let worst = (position / arm.reach).max(rotation);
                assert!(worst <= 2e-10, "{name} at {q:?}: {worst:e}");
                nearest = nearest.min(apart(solution, &q));
            });
            assert!(nearest < 1e-7, "{name}: {q:?} is {nearest:e} away");
        }
    }
}

#[test]
fn attainable_poses_of_the_lattice_have_solutions() {
    for (name, rows, charts) in cases() {
        let arm = arm(rows, &charts);
        let mut random = Random(5);
        for _ in 0..30 {
            let q = [0; 6].map(|_| H * libm::floor(random.next(-1.0, 3.0)));
            let pose = fk(&arm, &q);
            let mut count = 0;
            arm.solve(&pose, |_, _| count += 1);
            assert!(count > 0, "{name}: none at {q:?}");
        }
    }
}

#[test]
fn a_pose_out_of_reach_has_none() {
    for (name, rows, charts) in cases() {
        let arm = arm(rows, &charts);
        let mut pose = fk(&arm, &[0.3, 0.4, 0.5, 0.6, 0.7, 0.8]);
        pose.translation = [2.0 * arm.reach, 0.0, 0.0];
        let mut count = 0;
        arm.solve(&pose, |_, _| count += 1);
        assert_eq!(count, 0, "{name}");
    }
}

#[test]
fn given_joints_become_part_of_the_links() {
    let (_, rows, charts) = cases().remove(7);
    let six = arm(rows, &charts);
    let [l0, l1, l2, l3, l4, l5, l6] = six.links;
    let middle = turn(0.4) * l3;
    let links = [l0, l1, l2, Frame::IDENTITY, middle, l4, l5, l6];
    let seven = GeneralArm {
        links: &links,
        prismatic: &[false; 7],
        given: &[3],
        reach: six.reach,
        charts: &charts,
        triple: &None,
    };
    let folded = seven.six(&[-0.4]);
    let q = [0.1, -0.2, 0.3, -0.4, 0.5, -0.6];
    let tips = folded.map(|folded| (folded.tip(&q), six.tip(&q)));
    assert!(tips.is_some_and(|(one, other)| crate::Target::Pose(one).errors(&other).0 < 1e-15));
    assert!(seven.six(&[]).is_none());
}

#[test]
fn mirrored_joint_values_have_the_same_tip() {
    for (name, rows, charts) in cases() {
        let arm = arm(rows, &charts);
        let scaled = arm.scaled();
        let mut random = Random(3);
        let joints: Vec<usize> =
            (0..6).filter(|joint| super::mirror::Mirror::of(&scaled, *joint).is_some()).collect();
        let wanted: &[usize] = match name {
            "manseur" => &[2, 5],
            "crx" => &[0, 3],
            // Of the UR5, whose axes 2, 3 and 4 are parallel, the fifth meets the fourth beside the first.
            "puma" => &[3, 5],
            _ => &[],
        };
        assert_eq!(joints, wanted, "{name}");
        for joint in joints {
            let Some(mirror) = super::mirror::Mirror::of(&scaled, joint) else { continue };
            for _ in 0..20 {
                let q = random.joints();
                let (other, turned_over) = mirror.apply(&q);
                assert!(
                    apart(&[q[joint], 0.0, 0.0, 0.0, 0.0, 0.0], &[other[joint], 0.0, 0.0, 0.0, 0.0, 0.0])
                        > 3.1
                );
                let (position, rotation) = crate::Target::Pose(fk(&arm, &q)).errors(&fk(&arm, &other));
                assert!(position.max(rotation) < 1e-14, "{name} at {q:?}: {position:e} {rotation:e}");
                let (one, mirrored) = (arm.determinant(&q), arm.determinant(&other));
                let sign = if turned_over { -1.0 } else { 1.0 };
                assert!((one - sign * mirrored).abs() < 1e-14, "{name} at {q:?}: {one} {mirrored}");
            }
        }
    }
}

#[test]
fn what_is_computed_beforehand_is_what_would_be() {
    for (name, rows, charts) in cases() {
        for chart in charts {
            let charts = [chart];
            let six = arm(rows, &charts);
            let (prismatic, given) = ([false; 6], []);
            let bare = GeneralArm {
                links: &six.links,
                prismatic: &prismatic,
                given: &given,
                reach: six.reach,
                charts: &charts,
                triple: &None,
            };
            let triple = bare.triple();
            assert!(triple.is_some(), "{name}");
            let prepared = GeneralArm { triple: &triple, ..bare };
            let mut random = Random(9);
            for _ in 0..10 {
                let pose = fk(&six, &random.joints());
                let solutions = |arm: &GeneralArm<'_>| {
                    let mut all = Vec::new();
                    if let Some(six) = arm.six(&[]) {
                        six.solve_in(chart, &pose, &mut |q, determinant| all.push((*q, determinant)));
                    }
                    all
                };
                assert_eq!(solutions(&prepared), solutions(&bare), "{name}");
            }
            // A link that follows the target, or a joint that is given, is not known beforehand.
            let through = [Chart { dropped: 2, ..chart }];
            assert_eq!(GeneralArm { charts: &through, ..bare }.triple(), None);
            assert_eq!(GeneralArm { prismatic: &[false; 7], given: &[2], ..bare }.triple(), None);
        }
    }
}

/// Five joints with the tool across the last one, stretched out in the plane of the first axis: one of six equations says
/// nothing of such a direction, and is rounding.
#[test]
fn an_equation_that_vanishes_at_a_target_is_not_trusted() {
    let across =
        Frame { rotation: [[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]], translation: [0.0; 3] };
    let rows = [[0.0, H, 0.104], [0.158, 0.0, 0.0], [0.15, 0.0, 0.0], [0.0, H, 0.0]];
    let [l1, l2, l3, l4] = rows.map(link);
    let l5 = link([0.0, 0.0, 0.1944]) * across;
    let chart = Chart {
        dropped: 4,
        backward: false,
        hidden: 0,
        swapped: true,
        divided: false,
        degree: 4,
        periods: 1,
    };
    let charts = [
        chart,
        Chart { hidden: 2, ..chart },
        Chart { dropped: 1, backward: true, hidden: 1, divided: true, ..chart },
    ];
    let links = [Frame::IDENTITY, l1, l2, l3, l4, l5, Frame::IDENTITY];
    let arm = SixJoints { links, prismatic: [false; 6], reach: 0.6064, charts: &charts, triple: None };
    let mut random = Random(3);
    for _ in 0..30 {
        let mut noise = || random.next(-1.0, 1.0) * 3e-16;
        let rotation = [[noise(), noise(), 1.0], [noise(), -1.0, noise()], [1.0, noise(), noise()]];
        let pose = Frame { rotation, translation: [0.15 + noise(), noise(), 0.1404] };
        for chart in charts {
            let mut count = 0;
            let outcome = arm.solve_in(chart, &pose, &mut |_, _| count += 1);
            assert!(outcome.doubtful || count >= 8, "{chart:?}: {count}");
        }
        let mut known: Vec<[f64; JOINTS]> = Vec::new();
        arm.solve(&pose, |q, _| {
            if !known.iter().any(|other| apart(other, q) < 1e-6) {
                known.push(*q);
            }
        });
        assert_eq!(known.len(), 8, "{known:?}");
    }
}
