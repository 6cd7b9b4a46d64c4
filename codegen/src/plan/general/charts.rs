//! Which joints play which part: tried on poses of the arm itself.

use super::GeneralChain;
use dh_core::{Chart, Frame, SixJoints};

/// Degrees that are tried, the least first. No chain of six joints has more than sixteen solutions, and a resultant that
/// is not rid of its constant factor has four degrees more.
const DEGREES: [u8; 5] = [2, 4, 6, 8, 12];
/// A degree is high enough if what should vanish is this small, relative to the greatest coefficient.
const ACCURATE: f64 = 1e-9;
/// On how many poses charts are tried, and how many are tried further.
const ROUNDS: [(usize, usize); 3] = [(3, 8), (12, 5), (48, 5)];
/// How many charts are kept.
const KEPT: usize = 3;
/// What joint values count that were not found where the chart had no doubt; a doubt counts 1, for another chart is to be
/// asked then.
const MISSED: f64 = 4.0;
/// What a degree more costs, of the work on a pose.
const WORK: f64 = 0.07;
/// What a digit counts that Newton's method had to supply.
const DIGIT: f64 = 0.02;

/// The arm with values for its given joints, six joint values and the pose that belongs to them.
struct Trial<'a> {
    six: SixJoints<'a>,
    q: [f64; 6],
    pose: Frame,
}

/// The charts that find most, the best first, and how badly they do together: the sum over those that are kept, a
/// missing one counting as one that finds nothing.
pub(super) fn choose(chain: &GeneralChain) -> (Vec<Chart>, f64) {
    let (kept, badness) = best(chain, &THROUGH_THE_TARGET);
    // Joints that a target adds may themselves make a special geometry there; other cuts then go round it.
    if kept.is_empty() { best(chain, &ALL) } else { (kept, badness) }
}

/// Whether the joints of a chain can move its tip every way, but at singular poses.
pub(super) fn is_regular(chain: &GeneralChain) -> bool {
    let mut random = Random::new();
    (0..3).filter_map(|_| random.trial(chain)).any(|trial| !trial.six.is_singular(&trial.q))
}

/// The best charts of those with these joints dropped, and the directions.
fn best(chain: &GeneralChain, cuts: &[(u8, bool)]) -> (Vec<Chart>, f64) {
    let mut random = Random::new();
    let most = ROUNDS.iter().map(|(poses, _)| *poses).max().unwrap_or_default();
    let trials: Vec<Trial<'_>> = (0..most).filter_map(|_| random.trial(chain)).collect();
    let charts = candidates(chain, cuts).into_iter().filter_map(|chart| with_degree(chart, &trials));
    let mut charts: Vec<Tried> = charts.map(Tried::new).collect();
    for (poses, promising) in ROUNDS {
        let trials = trials.get(..poses).unwrap_or(&trials);
        let mut better: Vec<Tried> = Vec::new();
        for mut tried in charts {
            // One that can't be kept is not tried to the end.
            let last = if poses < most {
                better.get(promising - 1)
            } else {
                better.iter().find(|other| fail_together(other.chart, tried.chart))
            };
            if tried.on(trials, last.map_or(f64::INFINITY, |last| last.badness)) {
                let place = better.partition_point(|other| other.badness <= tried.badness);
                better.insert(place, tried);
            }
        }
        better.truncate(promising);
        charts = better;
    }
    let mut kept: Vec<Chart> = Vec::new();
    let nothing = trials.len() as f64 * MISSED;
    let mut together = KEPT as f64 * nothing;
    for Tried { chart, badness, .. } in charts {
        if kept.len() < KEPT && !kept.iter().any(|other| fail_together(*other, chart)) {
            kept.push(chart);
            together += badness - nothing;
        }
    }
    (kept, together)
}

/// Cuts at which the two joints that are eliminated first see the line through the target, so that no special geometry of
/// the arm makes the resultant vanish at all poses.
const THROUGH_THE_TARGET: [(u8, bool); 2] = [(1, true), (4, false)];

/// All cuts.
const ALL: [(u8, bool); 12] = [
    (0, false),
    (0, true),
    (1, false),
    (1, true),
    (2, false),
    (2, true),
    (3, false),
    (3, true),
    (4, false),
    (4, true),
    (5, false),
    (5, true),
];

/// Every choice of the other joints.
fn candidates(chain: &GeneralChain, cuts: &[(u8, bool)]) -> Vec<Chart> {
    let found = chain.prismatic.iter().enumerate().filter(|(joint, _)| !chain.given.contains(joint));
    let found: Vec<bool> = found.map(|(_, slides)| *slides).collect();
    let slides = |joint: usize| found.get(joint).copied().unwrap_or(false);
    let mut charts = Vec::new();
    for &(dropped, backward) in cuts {
        for hidden in 0..3 {
            for (swapped, divided) in [(false, false), (true, false), (false, true), (true, true)] {
                let chart = Chart::new(dropped, backward, hidden, swapped, divided, 0);
                // Next to the eliminated pair the resultant has no constant factor.
                let pointless = hidden == 0 && divided;
                if !pointless && !slides(usize::from(dropped)) && !slides(chart.unknown()) {
                    charts.push(chart);
                }
            }
        }
    }
    charts
}

/// The chart with the least degree that is high enough.
fn with_degree(chart: Chart, trials: &[Trial<'_>]) -> Option<Chart> {
    let mut degrees = DEGREES.into_iter().flat_map(|degree| {
        // By symmetry of the arm it may repeat itself after half a turn.
        [2, 1].map(|periods| Chart { degree: degree / periods, ..chart }.repeated(periods))
    });
    degrees.find(|chart| {
        let accurate = |trial: &Trial<'_>| trial.six.noise(*chart, &trial.pose) < ACCURATE;
        trials.iter().take(2).all(accurate)
    })
}

/// Charts of the same hidden joint fail at the same poses.
fn fail_together(a: Chart, b: Chart) -> bool {
    a.unknown() == b.unknown() && a.dropped == b.dropped
}

/// A chart, and how it does.
struct Tried {
    chart: Chart,
    /// Of every pose that it was tried on: whether the joint values were found, and what counts against it.
    outcomes: Vec<(bool, [f64; 2])>,
    /// How badly it does: joint values that were not found, doubts, digits and degree.
    badness: f64,
}

impl Tried {
    fn new(chart: Chart) -> Self {
        Self { chart, outcomes: Vec::new(), badness: 0.0 }
    }

    /// Tries it on more poses. False where it finds fewer than half, or as soon as it is worse than `limit`.
    fn on(&mut self, trials: &[Trial<'_>], limit: f64) -> bool {
        let mut hits = 0;
        self.badness = f64::from(self.chart.degree) * WORK * trials.len() as f64;
        for (place, trial) in trials.iter().enumerate() {
            if self.badness > limit {
                return false;
            }
            let known = self.outcomes.get(place).copied();
            let (found, against) = known.unwrap_or_else(|| outcome(self.chart, trial));
            if known.is_none() {
                self.outcomes.push((found, against));
            }
            hits += usize::from(found);
            for cost in against {
                self.badness += cost;
            }
        }
        2 * hits >= trials.len()
    }
}

/// Whether the chart finds the joint values, what it misses or doubts, and digits.
fn outcome(chart: Chart, Trial { six, q, pose }: &Trial<'_>) -> (bool, [f64; 2]) {
    let mut found = false;
    let outcome = six.solve_in(chart, pose, &mut |solution, _| {
        let apart = |((a, b), slides): ((&f64, &f64), &bool)| {
            let apart = a - b;
            let turn = std::f64::consts::TAU;
            (if *slides { apart } else { apart - turn * libm::round(apart / turn) }).abs()
        };
        found |= solution.iter().zip(q).zip(&six.prismatic).map(apart).fold(0.0, f64::max) < 1e-6;
    });
    let missed = match (found, outcome.doubtful) {
        (_, true) => 1.0,
        (true, false) => 0.0,
        (false, false) => MISSED,
    };
    (found, [missed, DIGIT * (16.0 + libm::log10(outcome.moved.clamp(1e-16, 1.0)))])
}

/// A linear congruential generator \[Knuth, TAOCP 2, §3.3.4\]: the same poses on every host.
pub(in crate::plan) struct Random(u64);

impl Random {
    pub(in crate::plan) const fn new() -> Self {
        Self(0x2545_f491_4f6c_dd1d)
    }

    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// rad, or m of an arm of this reach
    pub(in crate::plan) fn value(&mut self, slides: bool, reach: f64) -> f64 {
        let x = 2.0 * self.unit() - 1.0;
        if slides { x * reach } else { x * std::f64::consts::PI }
    }

    fn trial<'a>(&mut self, chain: &'a GeneralChain) -> Option<Trial<'a>> {
        let slides = |joint: &usize| chain.prismatic.get(*joint).copied().unwrap_or(false);
        let given: Vec<f64> =
            chain.given.iter().map(|joint| self.value(slides(joint), chain.reach)).collect();
        let six = chain.arm().six(&given)?;
        let q = six.prismatic.map(|slides| self.value(slides, chain.reach));
        Some(Trial { six, q, pose: six.tip(&q) })
    }
}
