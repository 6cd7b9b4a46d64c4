use super::{Chart, JOINTS, SixJoints};
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
        [0; 6].map(|_| self.next(-3.14, 3.14))
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

#[test]
#[ignore = "a survey"]
fn survey() {
    let count = std::env::var("POSES").ok().and_then(|n| n.parse().ok()).unwrap_or(300);
    let only = std::env::var("ARM").unwrap_or_default();
    for (name, rows) in arms() {
        if !name.starts_with(&only) {
            continue;
        }
        for (dropped, backward) in [(1, true), (4, false)] {
            for hidden in 0..3 {
                for swapped in [false, true] {
                    for (divided, degree) in [(true, 8), (false, 12)] {
                        if divided == (hidden == 0) {
                            continue;
                        }
                        let degree = if hidden == 0 { 8 } else { degree };
                        let chart = Chart::new(dropped, backward, hidden, swapped, divided, degree);
                        let charts = [chart];
                        let arm = arm(rows, &charts);
                        let mut random = Random(11);
                        let (mut found, mut doubtful, mut solutions, mut lost) = (0, 0, 0, 0);
                        let start = std::time::Instant::now();
                        for _ in 0..count {
                            let q = random.joints();
                            let pose = fk(&arm, &q);
                            let mut list: Vec<[f64; 6]> = Vec::new();
                            let outcome = arm.solve(&pose, |solution| {
                                if list.iter().all(|other| apart(other, &solution.q) > 1e-6) {
                                    list.push(solution.q);
                                }
                            });
                            let hit = list.iter().any(|other| apart(other, &q) < 1e-7);
                            found += usize::from(hit);
                            doubtful += usize::from(outcome.doubtful);
                            lost += usize::from(!hit && !outcome.doubtful);
                            solutions += list.len();
                        }
                        let time = start.elapsed().as_secs_f64() / count as f64 * 1e6;
                        std::println!(
                            "{name:8} drop {} hid {} {} deg {degree} found {found}/{count} doubtful {doubtful} lost {lost} solutions {:.3} {time:.1} us",
                            dropped + 1,
                            chart.unknown() + 1,
                            u8::from(swapped),
                            f64::from(solutions as u32) / count as f64
                        );
                    }
                }
            }
        }
    }
}
