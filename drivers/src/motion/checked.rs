//! Moves that were checked.

use super::command::Command;
use crate::driver::Pace;
use dh_runtime::{Frame, Kinematics};

/// Moves that were checked as a whole, to be run by a [`Robot`](super::Robot). Nothing else makes one but
/// [`Planner::plan`](super::Planner::plan).
#[derive(Debug, Clone, PartialEq)]
pub struct Checked {
    pub(super) legs: Vec<Leg>,
    /// What it was checked for besides the table: how commands are sent, and with which tool on which base.
    pub(super) origin: Origin,
}

/// What the moves of a table were checked for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Origin {
    pace: Pace,
    /// Where flange and tool are with all joints at 0. The flange tells one base from others, and the two together one
    /// tool from others.
    places: [Option<Frame>; 2],
}

impl Origin {
    pub(super) fn of(arm: &dyn Kinematics, pace: Pace) -> Self {
        let zero = vec![0.0; arm.dof()];
        Self { pace, places: [arm.fk_flange(&zero).ok(), arm.fk(&zero).ok()] }
    }
}

/// One move, from rest to rest.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Leg {
    /// Where it begins (rad or m).
    pub(super) start: Vec<f64>,
    /// What is sent: setpoints, one a period, or goals. Never empty; the last is where it ends.
    pub(super) commands: Vec<Command>,
    /// When each command is due (s after the start of the leg); of a goal, when it should be reached.
    pub(super) times: Vec<f64>,
}

impl Leg {
    /// Where it ends (rad or m).
    pub(super) fn goal(&self) -> &[f64] {
        self.commands.last().map_or(&self.start, Command::positions)
    }

    /// Goes on with another one, which begins where this one ends.
    pub(super) fn append(&mut self, next: Leg) {
        let ends = self.duration();
        self.times.extend(next.times.iter().map(|time| ends + time));
        self.commands.extend(next.commands);
    }

    /// The place so many setpoints after the first, in a straight line between two of them, and what the velocity is
    /// there at this part of the speed of the whole. What lies between setpoints was checked with them.
    pub(super) fn between(&self, place: f64, rate: f64) -> Command {
        let last = self.commands.len().saturating_sub(1);
        let index = (place.max(0.0) as usize).min(last);
        let (Some(before), Some(after)) =
            (self.commands.get(index), self.commands.get((index + 1).min(last)))
        else {
            return Command::new(0, Vec::new(), Vec::new());
        };
        let part = (place - index as f64).clamp(0.0, 1.0);
        let blend = |from: &[f64], to: &[f64]| -> Vec<f64> {
            from.iter().zip(to).map(|(from, to)| from + part * (to - from)).collect()
        };
        let mut velocities = blend(before.velocities(), after.velocities());
        for velocity in &mut velocities {
            *velocity *= rate;
        }
        Command::new(before.fingerprint(), blend(before.positions(), after.positions()), velocities)
    }

    fn duration(&self) -> f64 {
        self.times.last().copied().unwrap_or(0.0)
    }
}

impl Checked {
    /// How many moves there are.
    pub fn moves(&self) -> usize {
        self.legs.len()
    }

    /// Where a move ends (rad or m).
    pub fn goal(&self, index: usize) -> Option<&[f64]> {
        self.legs.get(index).map(Leg::goal)
    }

    /// Where the whole begins (rad or m).
    pub fn start(&self) -> Option<&[f64]> {
        self.legs.first().map(|leg| leg.start.as_slice())
    }

    /// What is sent for a move: positions and velocities of each command with its time after the move's start.
    pub fn commands(&self, index: usize) -> impl Iterator<Item = (f64, &Command)> {
        let leg = self.legs.get(index);
        leg.into_iter().flat_map(|leg| leg.times.iter().copied().zip(&leg.commands))
    }

    /// How long it takes (s), without the time that the arm needs to come to rest after each move. What a device with
    /// profiles of its own takes is an estimate.
    pub fn duration(&self) -> f64 {
        self.legs.iter().map(Leg::duration).sum()
    }
}
