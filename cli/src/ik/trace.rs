//! The steps of an inverse problem as they are taken.

use crate::robot::Robot;
use crate::text::{exact, small};
use crate::units::Units;
use dh_codegen::plan::Function;
use dh_codegen::plan::eval::Event;

/// Collects the steps of one run, an indent deeper for every root.
pub(super) struct Trace<'a> {
    units: Units<'a>,
    function: &'a Function,
    /// Powers of the metre of the function's values.
    dimensions: Vec<u8>,
    depth: usize,
    text: String,
}

impl<'a> Trace<'a> {
    /// Of a function of a robot.
    pub(super) fn new(robot: &'a Robot, function: &'a Function) -> Self {
        let dimensions = function.dimensions(robot.model(), &robot.output.plan.constants);
        Trace { units: robot.units(), function, dimensions, depth: 0, text: String::new() }
    }

    /// What happened.
    pub(super) fn event(&mut self, event: Event<'_>) {
        match event {
            Event::Value { name, value } => {
                let value = self.value(name, value);
                self.line(&format!("{name} = {value}"));
            }
            Event::Stage { index, stage, roots } => {
                let count = match roots {
                    0 => "no root: this branch ends here".to_owned(),
                    1 => "1 root".to_owned(),
                    roots => format!("{roots} roots"),
                };
                self.line(&format!("step {}: {}: {count}", index + 1, stage.equation));
            }
            Event::Root { stage, name, value, .. } => {
                self.depth = stage;
                let length = self.dimension(name) > 0;
                let (value, unit) = if length {
                    (self.units.length(value), self.units.length_name())
                } else {
                    (self.units.angle(value), self.units.angle_name())
                };
                self.line(&format!("{name} = {} {unit}", exact(value)));
                self.depth = stage + 1;
            }
            Event::Done { stage } => self.depth = stage,
            Event::Candidate { q, position_error, rotation_error, kept } => {
                let q: Vec<String> = self.units.joints(q).into_iter().map(exact).collect();
                let verdict = if kept { "kept" } else { "dropped" };
                self.line(&format!(
                    "q = {}: {verdict}, errors {} m, {} rad",
                    q.join(", "),
                    small(position_error),
                    small(rotation_error)
                ));
            }
            _ => {}
        }
    }

    /// All of it.
    pub(super) fn into_text(self) -> String {
        self.text
    }

    fn line(&mut self, line: &str) {
        self.text += &"  ".repeat(self.depth);
        self.text += line;
        self.text.push('\n');
    }

    fn dimension(&self, name: &str) -> u8 {
        let place = self.function.values.iter().position(|known| known == name);
        place.and_then(|place| self.dimensions.get(place)).copied().unwrap_or(0)
    }

    fn value(&self, name: &str, value: f64) -> String {
        let power = self.dimension(name);
        let unit = match power {
            0 => String::new(),
            1 => format!(" {}", self.units.length_name()),
            power => format!(" {}^{power}", self.units.length_name()),
        };
        format!("{}{unit}", exact(self.units.power(value, power)))
    }
}
