//! Why an arm did not move, in the table's units.

use crate::failure::Refusal;
use crate::json::Json;
use crate::rule;
use crate::units::Units;
use dh_codegen::model::Model;
use dh_core::IkError;
use dh_drivers::DriverError;
use dh_drivers::driver::Cause;
use dh_drivers::motion::{JointName, MotionError, Reason};

/// What stopped a motion, or kept it from being made.
pub(super) fn of(model: &Model, error: &MotionError) -> Refusal {
    let units = Units::of(model);
    let value = |joint: &JointName, value: f64| {
        let (kind, _) = units.joint(joint.index);
        format!("{} {}", units.show(kind, units.variable(kind, value)), units.name(kind))
    };
    match error {
        MotionError::Refused(refusal) => {
            let mut told = reason(model, &refusal.reason);
            let place = refusal.sample.map_or(String::new(), |sample| format!(", {sample}"));
            told.message = format!("refused, move {}{place}: {}", refusal.step + 1, told.message);
            told = told.with("move", refusal.step + 1);
            let also: Vec<Refusal> = refusal.also.iter().map(|other| reason(model, other)).collect();
            for other in &also {
                told.message = format!("{}; {}", told.message, other.message);
            }
            if !also.is_empty() {
                told = told.with("also", Json::List(also.iter().map(Refusal::json).collect()));
            }
            if let Some(sample) = refusal.sample {
                told = told.with("sample", sample.index + 1).with("part", sample.part);
            }
            told
        }
        MotionError::NotAtStart { joint, actual, expected } => Refusal::new(
            "not_at_start",
            format!("{joint} is at {}, not at {}", value(joint, *actual), value(joint, *expected)),
        ),
        MotionError::Strayed { joint, actual, min, max, tolerance } => Refusal::new(
            "strayed",
            format!(
                "stopped: {joint} strayed to {}, further than {} from {} to {}",
                value(joint, *actual),
                value(joint, *tolerance),
                value(joint, *min),
                value(joint, *max)
            ),
        )
        .help("something may be in the arm's way, or it carries too much"),
        MotionError::NotArrived { joint, actual, goal, waited } => Refusal::new(
            "not_arrived",
            format!(
                "{joint} is at {}, not at rest in {}, {:.1} s later",
                value(joint, *actual),
                value(joint, *goal),
                waited.as_secs_f64()
            ),
        ),
        MotionError::NotSafe { nearest: Some((pose, joint)), actual, expected } => Refusal::new(
            "not_safe",
            format!(
                "torque stays on: the nearest safe pose is {pose}, where {joint} is at {}, now at {}",
                value(joint, *expected),
                value(joint, *actual)
            ),
        )
        .help("move there first, or have the torque cut all the same: hold the arm, it falls"),
        MotionError::NotSafe { nearest: None, .. } => Refusal::new("not_safe", error.to_string())
            .help("mark a pose of the table with safe = true, or have the torque cut all the same"),
        MotionError::Stopped => Refusal::new("stopped", "stopped; the arm holds"),
        MotionError::NotStopped { first, stop, watchdog } => {
            let mut told = of(model, first);
            told.message = format!("{}; and it could not be told to stop ({stop}): {watchdog}", told.message);
            told
        }
        MotionError::FeedbackLost { .. } => Refusal::new("feedback_lost", error.to_string()),
        MotionError::Fault { .. } => Refusal::new("fault", error.to_string()).help(CLEAR),
        MotionError::Driver(error) => of_driver(error),
        other => Refusal::new("device", other.to_string()),
    }
}

/// What the driver calls it.
const OPERATING_MODE: &str = "operating mode";

/// What to do about a latched fault.
const CLEAR: &str = "see to its cause; `clear` in dhc console has the device forget it";

/// What a device did not do, with what may be done about it.
pub(super) fn of_driver(error: &DriverError) -> Refusal {
    let told = Refusal::new("device", error.to_string());
    match error.cause {
        Cause::Silent { .. } | Cause::Garbled => told.help(
            "has the arm power, is it the right port, and is the rate the table's? --baud gives another; adapters that keep \
             bytes for 16 ms want a latency of 1 ms",
        ),
        Cause::Fault(_) => told.help(CLEAR),
        Cause::PowerOff => told.help("a move switches it on, and so does dhc console, where it holds"),
        Cause::LimitsDiffer { what: OPERATING_MODE, .. } => {
            told.help("--position-mode sets it, where the torque is off")
        }
        Cause::IdTaken { .. } => told.help("correct the id in the table; a servo's own is set with its maker's tools"),
        Cause::LimitsDiffer { .. } => told.help("set the servo up anew, or write into the table what it is set to"),
        Cause::WrongModel { .. } => told.help("is it this arm's port? Else correct the servo's model in the table"),
        _ => told,
    }
}

fn reason(model: &Model, reason: &Reason) -> Refusal {
    let units = Units::of(model);
    let value = |joint: &JointName, value: f64| {
        let (kind, _) = units.joint(joint.index);
        format!("{} {}", units.show(kind, units.variable(kind, value)), units.name(kind))
    };
    match reason {
        Reason::OutsideLimits { joint, value, min, max } => rule::outside(units, joint.index, *value, *min, *max),
        Reason::Forbidden(rule) | Reason::NoSolution(IkError::Forbidden { rule }) => {
            rule::forbidden(model, rule, &[])
        }
        Reason::NoSolution(IkError::OutsideLimits { joint, value, min, max }) => {
            rule::outside(units, *joint, *value, *min, *max)
        }
        Reason::NotOnPath { joint, value: at, solution } => Refusal::new(
            "not_on_path",
            format!(
                "the arm does not stand where the path begins: {joint} is at {}, the solution there has it at {}",
                value(joint, *at),
                value(joint, *solution)
            ),
        )
        .help("move to its beginning first, without --line"),
        Reason::NoStart(_) => Refusal::new("not_on_path", reason.to_string())
            .help("move to its beginning first, without --line"),
        Reason::Jump { joint, from, to } => Refusal::new(
            "jump",
            format!("the solutions jump: {joint} from {} to {}", value(joint, *from), value(joint, *to)),
        ),
        Reason::TooFast { joint, needed, allowed, speed, possible } => {
            let length = |metres: f64| format!("{} {}/s", units.show_length(units.length(metres)), units.length_name());
            Refusal::new(
                "too_fast",
                format!(
                    "{joint} would have to move at {}/s, more than {}/s, for {} along the path; {} is possible",
                    value(joint, *needed),
                    value(joint, *allowed),
                    length(*speed),
                    length(*possible)
                ),
            )
            .with("possible", units.length(*possible))
        }
        Reason::UnknownProblem { problem, known } => {
            Refusal::new("problem", format!("the table has no inverse problem `{problem}`"))
                .help(format!("--problem takes {}", known.join(", ")))
        }
        Reason::Singular { .. } => Refusal::new("singular", reason.to_string()),
        Reason::NoSolution(error) => Refusal::new("no_solution", error.to_string()),
        other => Refusal::new("refused", other.to_string()),
    }
}
