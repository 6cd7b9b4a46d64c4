//! An arm of a table with its device, for the commands that move it or look at it.

mod interrupt;
mod progress;
mod refusal;

use crate::device;
use crate::failure::{Failure, Refusal, Status, complain};
use crate::json::Json;
use crate::list::List;
use crate::robot::Robot;
use crate::units::{Units, fixed};
use dh_codegen::model::{self, JointKind, Model};
use dh_codegen::verify::Level;
use dh_core::{Frame, Limits, Mounted, NamedPose, TargetKind};
use dh_drivers::clock::RealClock;
use dh_drivers::driver::{Attachment, AttachmentUnit, DeviceJoint, DeviceKind, Driver, Effort, JointMap};
use dh_drivers::dynamixel::control_table::POSITION_MODE;
use dh_drivers::dynamixel::{Bus, Timing};
use dh_drivers::motion::{self, Move};
use dh_drivers::unit::Unit;
use dh_drivers::{connect, port};
use std::fs;
use std::io::{self, Write};
use std::path::PathBuf;
use std::sync::Arc;

pub(crate) use progress::Watcher;

/// Which device, and what is on it.
#[derive(Debug, clap::Args)]
pub(crate) struct DeviceFlags {
    /// A table file, or the name of a shipped table.
    table: String,
    /// The arm's port: a device like /dev/ttyUSB0 or what `dhc sim` printed, or tcp:HOST:PORT.
    #[arg(long, value_name = "PORT")]
    pub(crate) port: String,
    /// Bits per second of the port, where the arm is not set up as its table says (115200: a myCobot with an M5).
    #[arg(long, value_name = "RATE", value_parser = clap::value_parser!(u32).range(1..))]
    baud: Option<u32>,
    /// Set Dynamixel servos to position mode first, which they keep; those whose torque is on refuse.
    #[arg(long)]
    position_mode: bool,
    /// Servo zeros and signs of this very arm, as `dhc calibrate` writes them.
    #[arg(long, value_name = "FILE")]
    pub(crate) unit: Option<PathBuf>,
    /// A tool on the table's tool frame: X,Y,Z or X,Y,Z,R,P,Y in the table's units.
    #[arg(long, value_name = "X,Y,Z[,R,P,Y]", allow_hyphen_values = true)]
    tool: Option<List>,
    /// Where the table's base frame stands, likewise; positions are in the world then.
    #[arg(long, value_name = "X,Y,Z[,R,P,Y]", allow_hyphen_values = true)]
    base: Option<List>,
}

/// An arm whose device has answered.
pub(crate) struct Arm<'a> {
    pub(crate) robot: motion::Robot<'a, Box<dyn Driver>>,
    pub(crate) model: &'a Model,
}

/// What a command does with an arm.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Use {
    /// Looks where it is.
    Look,
    /// Moves it. One that is silent, as some are without power, is switched on first: it holds where it is.
    Move,
}

/// Loads a table, opens its device, and does something with the arm.
///
/// # Errors
/// Where either fails; and what is done with the arm.
pub(crate) fn with(
    flags: &DeviceFlags,
    purpose: Use,
    act: impl FnOnce(&mut Arm<'_>) -> Result<Status, Failure>,
) -> Result<Status, Failure> {
    let robot = Robot::load(&flags.table, Level::Quick)?;
    let settings = device::settings(&robot, flags.baud)?;
    let program = robot.program()?;
    let arm = program.interpreter().map_err(|error| robot.unusable(&error))?;
    let units = robot.units();
    let mounted = Mounted::new(&arm).with_tool(frame(flags.tool.as_ref(), "tool", units)?);
    let mounted = mounted.with_base(frame(flags.base.as_ref(), "base", units)?);
    let mut joints = JointMap::of_table(&arm).map_err(|error| Refusal::new("servo", error.to_string()))?;
    if let Some(path) = &flags.unit {
        unit(path)?
            .apply(&mut joints)
            .map_err(|error| Refusal::new("unit", format!("{}: {error}", path.display())))?;
    }
    let open = || {
        let port = port::open(&flags.port, settings.baud, Arc::new(RealClock::new()));
        port.map_err(|error| Refusal::new("port", error.to_string()))
    };
    if flags.position_mode && settings.kind == DeviceKind::Dynamixel {
        let ids: Vec<u8> = joints.joints.iter().filter_map(|joint| joint.id.try_into().ok()).collect();
        let outcome = Bus::new(open()?, Timing::default()).set_operating_mode(&ids, POSITION_MODE);
        outcome.map_err(|error| refusal::of_driver(&error))?;
    }
    let port = open()?;
    let attachments = robot.model().servos.iter().map(attachment).collect::<Result<_, _>>()?;
    let driver = connect::connect_with(settings, joints, attachments, port);
    let mut driver = driver.map_err(|error| match error {
        connect::ConnectError::Driver(error) => refusal::of_driver(&error),
        other => Refusal::new("device", other.to_string()),
    })?;
    if purpose == Use::Move && connect::wake(driver.as_mut()).map_err(|error| refusal::of_driver(&error))? {
        complain("the arm had no power, which was switched on: it holds where it is");
    }
    let robot_in_motion = motion::Robot::new(&mounted, driver).map_err(|error| match error {
        motion::ConnectError::Driver(error) => refusal::of_driver(&error),
        other @ motion::ConnectError::OtherArm(_) => Refusal::new("device", other.to_string()),
    })?;
    let poses: Vec<NamedPose<'_>> = robot.model().poses.iter().map(named_pose).collect();
    let robot_in_motion = robot_in_motion.with_poses(&poses);
    interrupt::install(&robot_in_motion.stop_handle())?;
    act(&mut Arm { robot: robot_in_motion, model: robot.model() })
}

/// A servo outside the chain.
fn attachment(named: &model::NamedServo) -> Result<DeviceJoint, Refusal> {
    let model::Servo { id, scale, zero, range, ref model } = named.servo;
    let range = range.map(|range| Limits { min: range.min, max: range.max });
    let servo = dh_core::Servo { id, scale, zero, range, model: model.as_deref() };
    DeviceJoint::of_servo(&named.name, servo).map_err(|error| Refusal::new("servo", error.to_string()))
}

fn named_pose(pose: &dh_codegen::model::NamedPose) -> NamedPose<'_> {
    let named = NamedPose::new(&pose.name, &pose.q);
    if pose.safe { named.marked_safe() } else { named }
}

fn unit(path: &PathBuf) -> Result<Unit, Refusal> {
    let refuse = |message: String| Refusal::new("unit", format!("{}: {message}", path.display()));
    let text = fs::read_to_string(path).map_err(|error| refuse(error.to_string()))?;
    Unit::parse(&text).map_err(|error| Refusal::new("unit", format!("{}:{error}", path.display())))
}

fn frame(list: Option<&List>, name: &str, units: Units<'_>) -> Result<Frame, Failure> {
    let Some(List(numbers)) = list else {
        return Ok(Frame::IDENTITY);
    };
    let rpy = match numbers.as_slice() {
        [_, _, _] => [0.0; 3],
        [_, _, _, roll, pitch, yaw] => [*roll, *pitch, *yaw].map(|angle| units.radians(angle)),
        other => {
            let message = format!("--{name} has {} numbers where 3 or 6 are needed", other.len());
            return Err(Failure::Usage(message));
        }
    };
    let [x, y, z] = [0, 1, 2].map(|i| units.metres(numbers.get(i).copied().unwrap_or(f64::NAN)));
    let frame = Frame::from_rpy([x, y, z], rpy);
    if !frame.is_finite() {
        return Err(Refusal::new("not_finite", format!("--{name} has a number that is not finite")).into());
    }
    Ok(frame)
}

impl Arm<'_> {
    /// The table's units.
    pub(crate) fn units(&self) -> Units<'_> {
        Units::of(self.model)
    }

    /// The joint values of a named pose (rad or m).
    ///
    /// # Errors
    /// Where the table has none of that name.
    pub(crate) fn pose(&self, name: &str) -> Result<Vec<f64>, Refusal> {
        let poses = &self.model.poses;
        if let Some(pose) = poses.iter().find(|pose| pose.name == name) {
            return Ok(pose.q.clone());
        }
        let known: Vec<&str> = poses.iter().map(|pose| pose.name.as_str()).collect();
        let help = match known.as_slice() {
            [] => "the table names no poses".to_owned(),
            known => format!("there are {}", known.join(", ")),
        };
        Err(Refusal::new("pose", format!("there is no pose `{name}`")).help(help))
    }

    /// The kind of target that a problem takes.
    ///
    /// # Errors
    /// Where there is no such problem.
    pub(crate) fn kind(&self, problem: &str) -> Result<TargetKind, Refusal> {
        let problems = self.robot.arm().problems();
        let found = problems.iter().find(|known| known.name == problem).map(|known| known.target);
        found.ok_or_else(|| {
            let known: Vec<&str> = problems.iter().map(|known| known.name).collect();
            let refusal = Refusal::new("problem", format!("the table has no inverse problem `{problem}`"));
            match known.as_slice() {
                [] => refusal.help("it has none at all; use --joints or --pose"),
                known => refusal.help(format!("--problem takes {}", known.join(", "))),
            }
        })
    }

    /// Checks moves from where the arm stands.
    ///
    /// # Errors
    /// What is wrong with them.
    pub(crate) fn plan(&self, moves: &[Move]) -> Result<motion::Checked, Refusal> {
        self.robot.plan(moves).map_err(|refused| refusal::of(self.model, &refused.into()))
    }

    /// Makes moves; what stops them is told in the table's units.
    ///
    /// # Errors
    /// As [`motion::Robot::go`].
    pub(crate) fn go(&mut self, moves: &[Move], watcher: &mut Watcher<'_>) -> Result<(), Refusal> {
        let model = self.model;
        // A stop that was asked for while the last move was made is over with it.
        self.robot.stop_handle().clear();
        let moving = interrupt::Moving::begin();
        let outcome = self.robot.go_watched(moves, &mut |progress| watcher.tell(progress));
        drop(moving);
        watcher.end();
        outcome.map_err(|error| refusal::of(model, &error))
    }

    /// Asks the device for its state.
    ///
    /// # Errors
    /// Where it doesn't answer.
    pub(crate) fn read(&mut self) -> Result<(), Refusal> {
        let outcome = self.robot.read().map(|_| ());
        outcome.map_err(|error| refusal::of_driver(&error))
    }

    /// Has the device forget its faults.
    ///
    /// # Errors
    /// What the device says.
    pub(crate) fn clear_faults(&mut self) -> Result<(), Refusal> {
        self.robot.clear_faults().map_err(|error| refusal::of(self.model, &error))
    }

    /// What the device moves besides the joints, by its name.
    pub(crate) fn attachment(&mut self, name: &str) -> Option<Attachment> {
        self.robot.driver().attachments().into_iter().find(|attachment| attachment.name == name)
    }

    /// Moves an attachment to a value in the table's unit of angle, or percent.
    ///
    /// # Errors
    /// Where that is out of its range, or what the device says.
    pub(crate) fn move_attachment(&mut self, which: &Attachment, value: f64) -> Result<(), Refusal> {
        let value_in_si = match which.unit {
            AttachmentUnit::Angle => self.units().radians(value),
            AttachmentUnit::Percent => value,
        };
        if !which.range.contains(value_in_si) {
            let shown = [value_in_si, which.range.min, which.range.max];
            let [value, min, max] = shown.map(|value| self.show_attachment(which, value));
            return Err(Refusal::new(
                "attachment",
                format!("{} takes {min} to {max}, not {value}", which.name),
            ));
        }
        let outcome = self.robot.driver().move_attachment(&which.name, value_in_si);
        outcome.map_err(|error| refusal::of_driver(&error))
    }

    /// Where an attachment is, for people.
    ///
    /// # Errors
    /// What the device says.
    pub(crate) fn read_attachment(&mut self, which: &Attachment) -> Result<String, Refusal> {
        let value = self.robot.driver().read_attachment(&which.name);
        Ok(self.show_attachment(which, value.map_err(|error| refusal::of_driver(&error))?))
    }

    fn show_attachment(&self, which: &Attachment, value: f64) -> String {
        match which.unit {
            AttachmentUnit::Angle => {
                let units = self.units();
                format!("{} {}", show(units, JointKind::Revolute, value), units.angle_name())
            }
            AttachmentUnit::Percent => format!("{value:.0} %"),
        }
    }

    /// Switches the torque on.
    ///
    /// # Errors
    /// What the device says.
    pub(crate) fn hold(&mut self) -> Result<(), Refusal> {
        self.robot.hold().map_err(|error| refusal::of(self.model, &error))
    }

    /// Cuts the torque, where that is safe or wanted.
    ///
    /// # Errors
    /// Where it is neither.
    pub(crate) fn release(&mut self, anywhere: bool) -> Result<(), Refusal> {
        let outcome = if anywhere { self.robot.release_anywhere() } else { self.robot.release() };
        outcome.map_err(|error| refusal::of(self.model, &error))
    }

    /// Where the hand is at these joint values (rad or m).
    pub(crate) fn hand(&self, q: &[f64]) -> Frame {
        self.robot.arm().fk(q).unwrap_or(Frame { translation: [f64::NAN; 3], ..Frame::IDENTITY })
    }

    /// State and hand, for programs or for people.
    pub(crate) fn tell(&self, json: bool, out: &mut dyn Write) -> io::Result<()> {
        if json {
            writeln!(out, "{}", self.json())?;
        } else {
            self.show(out)?;
        }
        out.flush()
    }

    /// State and hand, as `--json` shows them.
    fn json(&self) -> Json {
        let state = self.robot.state();
        let joints = state.joints.iter().enumerate().map(|(index, joint)| {
            let (kind, name) = self.units().joint(index);
            let mut fields = vec![
                ("name", Json::from(name)),
                ("position", self.units().variable(kind, joint.position).into()),
            ];
            let velocity = joint.velocity.map(|velocity| self.units().variable(kind, velocity));
            fields.extend(velocity.map(|velocity| ("velocity", velocity.into())));
            match joint.effort {
                Some(Effort::Current(current)) => fields.push(("current", current.into())),
                Some(Effort::Load(load)) => fields.push(("load", load.into())),
                None => {}
            }
            fields.extend(joint.temperature.map(|temperature| ("temperature", temperature.into())));
            fields.extend(joint.moving.map(|moving| ("moving", moving.into())));
            let fault = joint.fault.map(|fault| fault.to_string());
            fields.extend(fault.map(|fault| ("fault", fault.as_str().into())));
            Json::Object(fields)
        });
        let q = state.positions();
        let mut fields = vec![
            ("q", Json::numbers(self.units().joints(&q))),
            ("joints", Json::List(joints.collect())),
            ("hand", self.units().pose(&self.hand(&q))),
        ];
        let fault = state.fault.map(|fault| fault.to_string());
        fields.extend(fault.map(|fault| ("fault", fault.as_str().into())));
        Json::Object(fields)
    }

    /// The same for people.
    pub(crate) fn show(&self, out: &mut dyn Write) -> io::Result<()> {
        let units = self.units();
        let state = self.robot.state();
        let header = ["joint", "position", "", "velocity", "load", "temperature", ""].map(str::to_owned);
        let row = |(index, joint): (usize, &dh_drivers::driver::JointState)| {
            let (kind, name) = units.joint(index);
            let unknown = || "-".to_owned();
            [
                name.to_owned(),
                show(units, kind, joint.position),
                units.name(kind).to_owned(),
                joint.velocity.map_or_else(unknown, |velocity| show(units, kind, velocity)),
                match joint.effort {
                    Some(Effort::Current(current)) => format!("{current:.3} A"),
                    Some(Effort::Load(load)) => format!("{:.1} %", load * 100.0),
                    None => unknown(),
                },
                joint.temperature.map_or_else(unknown, |temperature| format!("{temperature:.0} C")),
                joint.fault.map_or_else(String::new, |fault| format!("fault: {fault}")),
            ]
        };
        let rows: Vec<_> = [header].into_iter().chain(state.joints.iter().enumerate().map(row)).collect();
        write!(out, "{}", crate::text::columns("", &rows))?;
        if let Some(fault) = state.fault {
            writeln!(out, "fault: {fault}")?;
        }
        self.show_hand("hand", &self.hand(&state.positions()), out)
    }

    /// Where a hand is, for people.
    pub(crate) fn show_hand(&self, title: &str, hand: &Frame, out: &mut dyn Write) -> io::Result<()> {
        let units = self.units();
        let position = units.point(hand.translation).map(|x| self.short_length(x));
        let rpy = hand.rpy().map(|angle| fixed(units.angle(angle), 2));
        writeln!(
            out,
            "{title} at {} {}, rpy {} {}",
            position.join(" "),
            units.length_name(),
            rpy.join(" "),
            units.angle_name()
        )
    }

    /// A length in the table's unit as exactly as arms are: to a hundredth of a millimetre.
    pub(crate) fn short_length(&self, length: f64) -> String {
        fixed(length, if self.units().length_name() == "m" { 5 } else { 2 })
    }
}

/// A joint value as exactly as servos are.
fn show(units: Units<'_>, kind: JointKind, value: f64) -> String {
    let value = units.variable(kind, value);
    let decimals = match (units.name(kind), kind) {
        ("deg" | "mm", _) => 2,
        (_, JointKind::Revolute) => 4,
        (_, JointKind::Prismatic) => 5,
    };
    fixed(value, decimals)
}
