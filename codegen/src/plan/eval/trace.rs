//! What an interpreter tells those who watch it.

use crate::plan::Stage;

/// Something that happened while a function ran, in the order of the plan.
#[derive(Debug, Clone, Copy)]
#[non_exhaustive]
pub enum Event<'e, S = f64> {
    /// A named step was computed: `s1`, `c234`, `x2`, ...
    Value {
        /// Its name in the plan and in generated code.
        name: &'e str,
        /// Its value.
        value: S,
    },
    /// The equation of a stage of an inverse function was solved. [`Event::Root`] follows for each root, with the
    /// events of what comes after it, then [`Event::Done`]. Without roots this branch is dead.
    Stage {
        /// Index into the function's stages.
        index: usize,
        /// The stage.
        stage: &'e Stage,
        /// How many roots it has at this point.
        roots: usize,
    },
    /// The next root of the innermost stage that is not done.
    Root {
        /// Index of the stage.
        stage: usize,
        /// Which root, counted from 0.
        number: usize,
        /// Name of the unknown: `theta1`, `theta23`, `d3`.
        name: &'e str,
        /// Its value (rad or m).
        value: S,
    },
    /// All roots of a stage have been followed.
    Done {
        /// Index of the stage.
        stage: usize,
    },
    /// All joints of a branch are known.
    Candidate {
        /// Joint variables (rad or m), not yet wrapped into (-pi, pi].
        q: &'e [S],
        /// Distance from the target (m).
        position_error: S,
        /// Angle from the target (rad).
        rotation_error: S,
        /// Whether it is a solution: it meets the target, and the problem's `where` keeps it.
        kept: bool,
    },
}
