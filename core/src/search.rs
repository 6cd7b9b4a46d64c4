//! A search for all solutions of one inverse problem: equations are solved one after the other, candidates are
//! accepted or refused, and where nothing is found the failure that came furthest says why.

mod closer;
mod conditions;
mod edge;
mod free;
mod general;
mod marks;
mod motions;
mod near;
mod polynomial;
mod pose;
mod quartic;
mod roots;
mod trigonometric;

pub use conditions::Condition;
pub use general::Candidates;
pub use near::{Exact, Form, Near, Nearly};
pub use quartic::QuarticRoots;
pub use roots::Roots;

use edge::Edges;
use free::Free;

use crate::{
    Branch, Float, IkError, Rule, Seed, Solution, Solutions, Step, Wanted, Winding, residual_tolerance,
};

/// Coefficients up to this many machine epsilons (of the size of the numbers that the equation is made of) are what
/// rounding leaves of 0.
const VANISHING: f64 = 64.0;

/// A double root is taken for one, rather than for two that rounding has driven apart, up to this many machine epsilons
/// (of the size of the numbers that the equation is made of) inside the edge of the domain.
const DOUBLE_ROOT: f64 = 4.0;

/// A search for the solutions of one inverse problem of a robot with `N` joints.
///
/// Generated code nests its equations: for each root of the first the second is solved, and so on; innermost it hands
/// in a candidate.
///
/// ```
/// use dh_core::{Measure, Search, Step};
/// // x = cos(theta1), at 0.5
/// const STEP_1: Step = Step::new(0, 0b1, false, Measure::Length);
/// let mut search = Search::<1>::new(1.0, &[]);
/// let mut roots = search.trig(STEP_1, 1.0, 0.0, 0.5);
/// while let Some((theta1, _, _)) = search.next_angle(&mut roots) {
///     search.accept([theta1], 0.0, 0.0);
/// }
/// let solutions = search.finish()?;
/// assert_eq!(solutions.len(), 2);
/// # Ok::<(), dh_core::IkError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Search<'a, const N: usize, S = f64> {
    reach: S,
    windings: &'a [Winding<'a, S>],
    solutions: Solutions<N, S>,
    /// Bit i is set where step i, solved last, left its unknown free.
    free_steps: u32,
    /// Bit i is set where the equations of step i were once next to nothing: they may be what is left of none.
    vague_steps: u32,
    /// Bit i is set where step i, solved last, took its `-` root.
    branch: u32,
    /// Of the steps before the one that was solved last, which are at the edge of their domain.
    edges: Edges<S>,
    /// The first row of what each step left free.
    free_rows: [u8; N],
    /// What was tried of each step that is free, or was.
    free: [Option<Free<S>>; N],
    failure: Option<Failure<S>>,
    /// How many candidates were taken, those that were there already included.
    accepted: u32,
    /// Whether a step had roots so near to each other, or so uncertain, that two branches may have met.
    doubtful: bool,
    /// Whether a solution is off by more than well-conditioned steps leave.
    inaccurate: bool,
    /// Whether solutions that are off were brought nearer to their target: then those that stay off miss it.
    polished: bool,
    /// Bit i is set where the caller gives joint i: it stays as it is.
    given: u32,
    /// What the unknowns are at joint values to be near to, with these; free ones are tried there first.
    wanted: Option<(&'a [S], Seed<'a, S>)>,
    /// Which solutions, from one to before another, are known to be on curves of solutions, of which one point is to be marked.
    on_curves: (usize, usize),
    /// Whether solutions may be set to other values of a joint that is free: not where conditions were asked about them.
    movable: Movable,
}

/// Whether a solution with a free joint may be set to another value of it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Movable {
    Yes,
    No,
}

/// Why a branch ended.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Failure<S> {
    /// How far it came.
    depth: u32,
    /// By how much it failed, relative to the size of the numbers involved.
    miss: S,
    error: IkError<S>,
}

/// A candidate that misses its target says less than any step that fails.
const DEPTH_OF_MISSED: u32 = 0;
/// A candidate that a condition refuses was a solution: it came further than any step.
const DEPTH_OF_REFUSED: u32 = u32::MAX;

impl<'a, const N: usize, S: Float> Search<'a, N, S> {
    /// A new search. The reach (m) of the arm gives tolerances their scale; the windings
    /// ([`Rules::windings`](crate::Rules::windings)) say which whole turns make no difference.
    #[inline]
    pub fn new(reach: S, windings: &'a [Winding<'a, S>]) -> Self {
        // An arm that has orientations only has no reach; its lengths are all 0, and so are their errors.
        let reach = if reach > S::ZERO && reach.is_finite() { reach } else { S::ONE };
        Self {
            reach,
            windings,
            solutions: Solutions::EMPTY,
            free_steps: 0,
            vague_steps: 0,
            branch: 0,
            edges: Edges::NONE,
            free_rows: [0; N],
            free: core::array::from_fn(|_| None),
            failure: None,
            accepted: 0,
            doubtful: false,
            inaccurate: false,
            polished: false,
            given: 0,
            wanted: None,
            on_curves: (0, 0),
            movable: Movable::Yes,
        }
    }

    /// The same; unknowns that the target leaves free are set as near as can be to what is wanted of them.
    #[inline]
    pub fn about<const K: usize>(
        reach: S,
        windings: &'a [Winding<'a, S>],
        wanted: &'a Wanted<'a, K, S>,
    ) -> Self {
        Self { wanted: wanted.view(), ..Self::new(reach, windings) }
    }

    /// The same for a problem some of whose joints the caller gives.
    #[inline]
    pub fn with_given(self, joints: &[usize]) -> Self {
        let given = joints.iter().fold(0, |given, joint| given | 1_u32.wrapping_shl(*joint as u32));
        Self { given, ..self }
    }

    /// Takes a candidate (rad or m) with its errors against the target (m, rad). Revolute joints are brought to
    /// (-pi, pi]. A candidate that misses its target, a false root of a squared equation, is dropped.
    pub fn accept(&mut self, q: [S; N], position_error: S, rotation_error: S) {
        let tolerance: S = residual_tolerance();
        let hits = position_error <= tolerance * self.reach && rotation_error <= tolerance;
        if !(hits && q.iter().all(|value| value.is_finite())) {
            self.miss(position_error, rotation_error);
            return;
        }
        let mut q = q;
        crate::rules::wrap_all(self.windings, &mut q);
        let free = self.free_row();
        let accurate = accurate(free.is_some());
        self.inaccurate |= !(position_error <= accurate * self.reach && rotation_error <= accurate);
        self.accepted += 1;
        let branch = self.branch();
        self.solutions.push(Solution { q, position_error, rotation_error, free, branch }, self.windings);
    }

    /// Drops a candidate that misses its target by so much (m, rad).
    fn miss(&mut self, position_error: S, rotation_error: S) {
        let miss = (position_error / self.reach).max(rotation_error);
        self.fail(DEPTH_OF_MISSED, miss, IkError::Failed { position_error, rotation_error });
    }

    /// The roots that the steps solved last have taken.
    fn branch(&self) -> Branch {
        Branch::of_steps(self.branch)
    }

    /// Notes that a candidate was a solution but breaks a condition of the problem.
    pub fn refuse(&mut self, rule: Rule<S>) {
        let miss = if let Rule::Where { excess, .. } = rule { excess } else { S::ZERO };
        self.fail(DEPTH_OF_REFUSED, miss, IkError::Forbidden { rule });
    }

    /// What was found.
    ///
    /// # Errors
    /// Where nothing was: the failure of the branch that came furthest; of several at the same step, the one that
    /// failed by least.
    #[inline(always)]
    #[allow(clippy::inline_always, reason = "a call would copy the solutions once more")]
    pub fn finish(&mut self) -> Result<Solutions<N, S>, IkError<S>> {
        if self.polished {
            self.solutions.drop_misses(self.reach);
        }
        if self.solutions.is_empty() {
            return Err(self.failure.map_or(IkError::NotFinite, |failure| failure.error));
        }
        Ok(self.solutions.copied())
    }

    fn fail(&mut self, depth: u32, miss: S, error: IkError<S>) {
        let further =
            self.failure.is_none_or(|old| depth > old.depth || (depth == old.depth && miss < old.miss));
        if further {
            self.failure = Some(Failure { depth, miss, error });
        }
    }

    fn fail_step(&mut self, step: Step, miss: S, error: IkError<S>) -> Roots<S> {
        self.fail(u32::from(step.index) + 1, miss, error);
        Roots::NONE
    }

    /// A step begins: what it left free on another branch is forgotten.
    #[inline]
    fn begin(&mut self, step: Step) -> Scale<S> {
        self.free_steps &= !step.bit();
        let size = step.measure.scale(self.reach);
        Scale {
            size,
            vanishing: S::from_f64(VANISHING) * S::EPSILON * size,
            tolerance: residual_tolerance::<S>() * size,
        }
    }

    /// The coefficients of a step vanish: any value does, or none.
    fn degenerate(&mut self, step: Step, gap: S, scale: &Scale<S>) -> Roots<S> {
        if gap > scale.tolerance {
            return self.singular(step, gap, scale);
        }
        self.mark_free(step);
        self.free(Free::any(step, self.wanted_of(step), self.accepted))
    }

    /// What is wanted (rad or m) of the unknown of a step.
    fn wanted_of(&self, step: Step) -> Option<S> {
        let (unknowns, seed) = self.wanted?;
        let value = *unknowns.get(usize::from(step.index))? + seed.aside * step.half_range(self.reach);
        value.is_finite().then_some(value)
    }

    fn mark_free(&mut self, step: Step) {
        self.doubtful = true;
        self.free_steps |= step.bit();
        if let Some(row) = self.free_rows.get_mut(usize::from(step.index)) {
            *row = step.first_row() as u8;
        }
    }

    fn singular(&mut self, step: Step, gap: S, scale: &Scale<S>) -> Roots<S> {
        self.fail_step(step, gap / scale.size, IkError::Singular { joint: step.first_row(), gap })
    }

    fn not_finite(&mut self, step: Step) -> Roots<S> {
        self.fail_step(step, S::INFINITY, IkError::NotFinite)
    }

    /// The first row of the outermost step that is free now.
    fn free_row(&self) -> Option<usize> {
        if self.free_steps == 0 {
            return None;
        }
        self.free_rows.get(self.free_steps.trailing_zeros() as usize).map(|row| usize::from(*row))
    }
}

/// A solution with errors (reaches, rad) of up to this many machine epsilons is left as it is: 1e-13 in f64. Well-conditioned
/// steps leave some ten; next to singular poses, where they leave more, a few steps on all joints at once take it away.
const ACCURATE: f64 = 512.0;

/// The errors (reaches, rad) that a solution is left with. A joint that any value will do of stays where it is wanted.
fn accurate<S: Float>(free: bool) -> S {
    if free { indifferent() } else { S::from_f64(ACCURATE) * S::EPSILON }
}

/// Two rows of an angle that are this small (beside the numbers that they are made of) are met by any angle, as far as the
/// target is: 1.5e-11 in f64, 6e-5 in f32. What they say of it is what is left of an aligned wrist by steps before that are
/// not well-conditioned, and by rounding.
pub(crate) fn indifferent<S: Float>() -> S {
    (S::SQRT_EPSILON / S::from_f64(1024.0)).max(S::from_f64(512.0) * S::EPSILON)
}

/// The numbers that a step's coefficients are compared with.
struct Scale<S> {
    /// Size of the numbers that the equation is made of: the reach, its square, or 1.
    size: S,
    /// Coefficients up to here are 0.
    vanishing: S,
    /// A gap or an excess up to here is left to the residual of the candidate to judge.
    tolerance: S,
}
