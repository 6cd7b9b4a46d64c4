//! How far moves have come, on stderr.

use dh_drivers::motion::Progress;
use std::io::{self, IsTerminal, Write};
use std::time::{Duration, Instant};

/// Moves that are shorter than this (s) are over before anybody has read anything of them.
const WORTH_TELLING: f64 = 1.0;
/// How often something is told: on a terminal, where it replaces what was told before, and elsewhere.
const ON_TERMINAL: Duration = Duration::from_millis(200);
const ELSEWHERE: Duration = Duration::from_secs(2);

/// What is called with each move's end: its index, and where the joints were to be and are.
type Arrived<'a> = &'a mut dyn FnMut(usize, &[f64], &[f64]);

/// Tells of progress on stderr, and calls somebody at the end of each move.
pub(crate) struct Watcher<'a> {
    arrived: Arrived<'a>,
    told: Option<Instant>,
    terminal: bool,
    line: bool,
}

impl<'a> Watcher<'a> {
    /// Calls `arrived` at the end of each move with its index, its goal and where the joints are (rad or m).
    pub(crate) fn new(arrived: Arrived<'a>) -> Self {
        Self { arrived, told: None, terminal: io::stderr().is_terminal(), line: false }
    }

    pub(super) fn tell(&mut self, progress: &Progress<'_>) {
        if progress.arrived {
            self.end();
            (self.arrived)(progress.step, progress.goal, &progress.state.positions());
            return;
        }
        let every = if self.terminal { ON_TERMINAL } else { ELSEWHERE };
        let now = Instant::now();
        let due = *self.told.get_or_insert(now) + every <= now;
        if progress.duration < WORTH_TELLING || !due {
            return;
        }
        self.told = Some(now);
        let part = 100.0 * (progress.elapsed / progress.duration).clamp(0.0, 1.0);
        let text = format!("move {} of {}, {part:.0} %", progress.step + 1, progress.steps);
        // Nobody is told where stderr is closed.
        let mut stderr = io::stderr().lock();
        let _ = if self.terminal { write!(stderr, "\r{text}  ") } else { writeln!(stderr, "{text}") };
        let _ = stderr.flush();
        self.line = self.terminal;
    }

    /// What comes next begins a line of its own.
    pub(super) fn end(&mut self) {
        if std::mem::take(&mut self.line) {
            let _ = writeln!(io::stderr().lock());
        }
    }
}
