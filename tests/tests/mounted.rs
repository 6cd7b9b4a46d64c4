//! Frames known only at run time against the same frames written into the table.
#![allow(clippy::unwrap_used)]

use dh_core::{Float, Frame, Kinematics, Mounted, SolutionSet, Target, TargetKind};
use dh_tests::engine;
use std::fmt::Write;

const FIVE: &str = "[robot]\nname = \"five\"\nconvention = \"standard\"\n\
    [[joint]]\nd = 0.3\nalpha = \"pi/2\"\na = 0.05\n[[joint]]\na = 0.4\n[[joint]]\na = 0.3\n\
    [[joint]]\nalpha = \"pi/2\"\noffset = \"pi/2\"\n[[joint]]\nd = 0.1\nalpha = \"pi/2\"\na = 0.08\n\
    [[ik]]\nname = \"p\"\ntarget = \"position_direction\"\n";
const SKEW: &str = "[robot]\nname = \"skew\"\nconvention = \"standard\"\n\
    [[joint]]\nd = 0.3\nalpha = 1.2\na = 0.05\n[[joint]]\na = 0.4\nalpha = -0.4\nd = 0.1\n[[joint]]\na = 0.3\nalpha = 0.9\nd = 0.05\n\
    [[joint]]\nalpha = 1.3\na = 0.1\nd = 0.2\n[[joint]]\nd = 0.1\na = 0.04\nalpha = 0.7\n\
    [[ik]]\nname = \"p\"\ntarget = \"position_direction\"\n";
const RAY: &str = "[robot]\nname = \"ray\"\nconvention = \"standard\"\n\
    [[joint]]\nd = 0.3\nalpha = \"pi/2\"\na = 0.05\n[[joint]]\na = 0.4\n[[joint]]\na = 0.3\nalpha = \"pi/2\"\n\
    [[joint]]\nd = 0.1\nalpha = \"pi/2\"\n\
    [[ik]]\nname = \"p\"\ntarget = \"ray\"\n";
const TWO: &str = "[robot]\nname = \"two\"\nconvention = \"standard\"\n\
    [[joint]]\nd = 0.3\nalpha = \"pi/2\"\na = 0.05\n[[joint]]\na = 0.1\nalpha = \"pi/2\"\n\
    [[ik]]\nname = \"look\"\ntarget = \"lookat\"\n[[ik]]\nname = \"p\"\ntarget = \"direction\"\n";
const THREE: &str = "[robot]\nname = \"three\"\nconvention = \"standard\"\n\
    [[joint]]\nd = 0.3\nalpha = \"pi/2\"\n[[joint]]\na = 0.1\nalpha = \"-pi/2\"\n[[joint]]\nd = 0.2\n\
    [[ik]]\nname = \"p\"\ntarget = \"rotation\"\n";
const PLANAR3: &str = "[robot]\nname = \"pl\"\nconvention = \"standard\"\n\
    [[joint]]\na = 0.3\n[[joint]]\na = 0.2\n[[joint]]\na = 0.1\n\
    [[ik]]\nname = \"p\"\ntarget = \"xy_yaw\"\n";

struct Random(u64);
impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        f64::from((self.0 >> 40) as u32) / f64::from(1_u32 << 23) - 1.0
    }
    fn three(&mut self, size: f64) -> [f64; 3] {
        [size * self.next(), size * self.next(), size * self.next()]
    }
}

fn target_of(kind: TargetKind, tool: &Frame) -> Target {
    let position = tool.translation;
    let [x, y, _] = tool.x_axis();
    let yaw = y.atan2(x);
    match kind {
        TargetKind::Pose => Target::Pose(*tool),
        TargetKind::Position => Target::Position(position),
        TargetKind::PositionDirection => Target::PositionDirection { position, direction: tool.z_axis() },
        TargetKind::PositionYaw => Target::PositionYaw { position, yaw },
        TargetKind::Rotation => Target::Rotation(tool.rotation),
        TargetKind::Direction => Target::Direction(tool.z_axis()),
        TargetKind::Ray => Target::Ray { position: tool.transform_point([0.0, 0.0, 0.1]), direction: tool.z_axis() },
        TargetKind::Lookat => Target::Lookat(tool.transform_point([0.0, 0.0, 0.4])),
        TargetKind::Xy => Target::Xy([position[0], position[1]]),
        TargetKind::XyYaw => Target::XyYaw { position: [position[0], position[1]], yaw },
    }
}

/// (table, problem, unit of length (per m), rad unit)
fn apart(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).wrap_angle().abs()).fold(0.0, f64::max)
}

fn section(name: &str, place: [f64; 3], turn: [f64; 3], mm: bool) -> String {
    let place = if mm { place.map(|x| x * 1000.0) } else { place };
    let turn = turn.map(|x| format!("\"{x:?} rad\""));
    let mut text = String::new();
    writeln!(text, "\n[{name}]\nxyz = {place:?}\nrpy = [{}]", turn.join(", ")).unwrap();
    text
}

fn nalgebra_min(j: &[[f64; 6]], z: [f64;3]) -> f64 {
    // columns: v, and w across z
    let cols: Vec<[f64;6]> = j.iter().map(|c| { let d = c[3]*z[0]+c[4]*z[1]+c[5]*z[2]; [c[0],c[1],c[2],c[3]-d*z[0],c[4]-d*z[1],c[5]-d*z[2]] }).collect();
    // smallest singular by power iteration on inverse via brute: gram eig by jacobi
    let n = cols.len();
    let mut a = vec![vec![0.0; n]; n];
    for i in 0..n { for k in 0..n { a[i][k] = (0..6).map(|r| cols[i][r]*cols[k][r]).sum(); } }
    for _ in 0..100 { for p in 0..n { for q in p+1..n {
        if a[p][q] == 0.0_f64 { continue }
        let th = 0.5 * f64::atan2(2.0*a[p][q], a[q][q]-a[p][p]); let (s, c) = th.sin_cos();
        for r in 0..n { let (x, y) = (a[r][p], a[r][q]); a[r][p] = c*x - s*y; a[r][q] = s*x + c*y; }
        for r in 0..n { let (x, y) = (a[p][r], a[q][r]); a[p][r] = c*x - s*y; a[q][r] = s*x + c*y; }
    } } }
    (0..n).map(|i| a[i][i]).fold(f64::INFINITY, f64::min).max(0.0).sqrt()
}

#[test]
fn experiment() {
    let cases: u32 = std::env::var("CASES").map_or(100, |x| x.parse().unwrap());
    let only = std::env::var("ONLY").unwrap_or_default();
      
    
    let shipped = |name| dh_robots::table(name).unwrap();
    let list: &[(&str, &str, &str, bool)] = &[
        ("planar2r", shipped("planar2r"), "xy", false),
        ("planar3", PLANAR3, "p", false),
        ("scara", shipped("scara"), "place", true),
        ("mycobot", shipped("mycobot"), "tool_down", true),
        ("elbow3r", shipped("elbow3r"), "position", true),
        ("puma560", shipped("puma560"), "tool_down", true),
        ("ur5", shipped("ur5"), "tool_down", true),
        ("five", FIVE, "p", false),
        ("skew", SKEW, "p", false),
        ("ray", RAY, "p", false),
        ("look", TWO, "look", false),
        ("dir", TWO, "p", false),
        ("three", THREE, "p", false),
    ];
    for (name, text, problem, _) in list {
        if !name.contains(&only) { continue }
        let mm = text.contains("\"mm\"");
        for (kind, with_tool, turned, with_base) in [("shift", true, 0.0, 0.0), ("turn", true, 1.0, 0.0), ("base", false, 0.0, 1.0), ("both", true, 1.0, 1.0)] {
            let mut random = Random(7);
            let (mut found, mut expected, mut extra, mut own, mut all) = (0, 0, 0, 0, 0);
            
            let mut spent = std::time::Duration::ZERO;
            let mut bare_spent = std::time::Duration::ZERO;
            let bare = engine::interpreter(text).unwrap();
            let info = *bare.problems().iter().find(|info| info.name == *problem).unwrap();
            let mut compiled = true;
            for number in 0..cases {
                if number % 10 == 0 { }
                let tool = (random.three(if with_tool { 0.1 } else { 0.0 }), random.three(turned * 1.5));
                let base = (random.three(with_base * 0.5), random.three(with_base * 3.0));
                let (t, b) = (Frame::from_rpy(tool.0, tool.1), Frame::from_rpy(base.0, base.1));
                let written = format!("{text}{}{}", section("tool", tool.0, tool.1, mm), section("base", base.0, base.1, mm));
                let oracle = if number < 4 {engine::interpreter(&written).ok()} else {None};
                let oracle = oracle.filter(|o| o.problems().iter().any(|i| i.name == *problem));
                if number < 4 { compiled &= oracle.is_some(); }
                let mounted = Mounted::new(&*bare).with_tool(t).with_base(b);
                for _ in 0..(if number < 4 {10} else {1}) {
                let dof = bare.dof();
                // keep the constraints: by the table's own problem
                let mut q: Vec<f64> = (0..dof).map(|_| 3.1 * random.next()).collect();
                let mut set = SolutionSet::new();
                let first = target_of(info.target, &bare.fk(&q).unwrap());
                let t0 = std::time::Instant::now();
                let res = bare.ik_into(problem, &first, &mut set);
                bare_spent += t0.elapsed();
                if res.is_err() || set.is_empty() { continue }
                let pick = ((random.next() + 1.0) / 2.0 * set.len() as f64) as usize;
                q = set.get(pick.min(set.len()-1)).unwrap().q.to_vec();
                let target = target_of(info.target, &mounted.fk(&q).unwrap());
                all += 1;
                   
                let t0 = std::time::Instant::now();
                let mut got = SolutionSet::new();
                let outcome = mounted.ik_into(problem, &target, &mut got);
                spent += t0.elapsed();
                
                
                if outcome.is_err() { got = SolutionSet::new(); }
                if got.iter().any(|s| apart(s.q, &q) < 1e-6) { own += 1 }
                if let Some(oracle) = &oracle {
                    let mut want = SolutionSet::new();
                    let _ = oracle.ik_into(problem, &target, &mut want);
                    expected += want.len();
                    for w in want.iter() {
                        if got.iter().any(|s| apart(s.q, w.q) < 1e-6) { found += 1 }
                    }
                    for s in got.iter() {
                        if !want.iter().any(|w| apart(s.q, w.q) < 1e-6) { extra += 1 }
                    }
                }
                }
            }
            let n = all.max(1) as f64; 
            println!("{name:9} {kind:6} compiled {compiled}: own {own}/{all} found {found}/{expected} extra {extra}; time {:.0} us bare {:.0} us", spent.as_secs_f64()*1e6/n, bare_spent.as_secs_f64()*1e6/n);
        }
    }
}
