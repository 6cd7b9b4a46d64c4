//! An arm of Dynamixel servos as motion sees it.

mod attachment;
mod command;
mod setup;
mod state;

use super::bus::Bus;
use super::control_table::{
    BUS_WATCHDOG, GOAL_POSITION, HARDWARE_ERROR, Model, PRESENT_POSITION, PRESENT_VELOCITY,
    PROFILE_ACCELERATION, PROFILE_VELOCITY, Register, TORQUE, WATCHDOG_TRIPPED, WATCHDOG_UNIT,
};
use super::status::hardware_fault;
use crate::clock::{Clock, Time};
use crate::driver::{Attachment, Cause, Driver, DriverError, Fault, JointMap, Pace, State, Watchdog};
use crate::motion::Command;
use std::sync::Arc;
use std::time::Duration;

/// What an arm may be told besides its table.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// From one command of a stream to the next; left out, as often as the line's rate allows, 100 times a second at
    /// most. USB adapters that keep bytes for 16 ms, as many do until their latency timer is set to 1 ms, do not allow
    /// that.
    pub period: Option<Duration>,
    /// The watchdog of a move for which [`Driver::watchdog`] was not called.
    pub watchdog: Duration,
    /// How fast [`Driver::stop`] decelerates (rad/s² or m/s²) where the table does not say how fast a joint may.
    pub braking: f64,
}

impl Default for Settings {
    /// A watchdog of 200 ms, 10 rad/s².
    fn default() -> Self {
        Self { period: None, watchdog: Duration::from_millis(200), braking: 10.0 }
    }
}

/// One servo as it was found.
#[derive(Debug, Clone, Copy)]
struct Servo {
    id: u8,
    model: &'static Model,
    /// Least and greatest goal (ticks): the servo's own, within the table's range.
    goals: (i64, i64),
    /// Profile velocity (register units) while it follows a stream.
    velocity: i64,
    /// Profile acceleration (register units) of a stop.
    braking: i64,
}

/// Whether goals may be sent.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Torque {
    Off,
    On,
    /// It was on, and what became of it is not known: the line was gone, a watchdog has tripped, a servo has started
    /// anew, or the driver has given up on a move.
    Interrupted,
}

/// The driver of an arm of X servos, one a joint, in one of the position modes.
///
/// It streams: goal positions are written to all servos at once, and each goes there as fast as it can, up to a fifth
/// more than the joint's greatest velocity so that it can catch up. While goals are sent, the servos' bus watchdogs are
/// armed: a servo that hears nothing for that long brakes and holds. They are disarmed by [`Driver::stop`] and by
/// [`Driver::watchdog`] with `None`, which is how a move ends; a driver that was let go in the middle of one, or a
/// pause within one that was longer than the watchdog, leaves the arm stopped, and sending is refused as
/// [`Cause::Interrupted`] until torque is switched on anew.
#[derive(Debug)]
pub struct Arm {
    bus: Bus,
    map: JointMap,
    servos: Vec<Servo>,
    attached: Vec<attachment::Attached>,
    settings: Settings,
    period: Duration,
    torque: Torque,
    /// The watchdog's time, while it is armed.
    armed: Option<Duration>,
    /// The profiles are those of a stop.
    braking: bool,
    fault: Option<(usize, Fault)>,
    seen: state::Seen,
}

impl Arm {
    /// Finds the servos of these joints, compares their models and limits with the table, and has them answer
    /// everything. Nothing moves, and torque is left as it is; it counts as off.
    ///
    /// Where a servo's velocity limit is less than the joint's, [`Driver::joints`] has the servo's.
    ///
    /// # Errors
    /// [`DriverError`]: a servo that is missing or another one than the table says, in a mode that takes no positions,
    /// or set up for less than the joint's limits need.
    pub fn connect(bus: Bus, map: JointMap, settings: Settings) -> Result<Self, DriverError> {
        setup::connect(bus, map, settings)
    }

    fn ids(&self) -> Vec<u8> {
        self.servos.iter().map(|servo| servo.id).collect()
    }

    fn error(&self, command: &'static str, joint: Option<usize>, cause: Cause) -> DriverError {
        let error = DriverError::new(self.bus.port().name(), command, cause);
        match joint.and_then(|joint| self.map.joints.get(joint)) {
            Some(joint) => error.of_joint(joint.name.as_str()),
            None => error,
        }
    }

    /// Calls the joint by its name where the bus knows only an id. After a port's failure nobody knows what the servos
    /// do.
    fn named(&mut self, error: DriverError) -> DriverError {
        if matches!(error.cause, Cause::Port(_)) && self.torque == Torque::On {
            self.torque = Torque::Interrupted;
        }
        setup::named(&self.map, error)
    }

    /// The present value of one register of every servo.
    fn read_all(&mut self, register: &Register) -> Result<Vec<i64>, DriverError> {
        let ids = self.ids();
        let answers = self.bus.sync_read(&ids, register.address, register.size);
        let answers = answers.map_err(|error| self.named(error))?;
        Ok(answers.iter().filter_map(|answer| register.value(&answer.data)).collect())
    }

    /// Writes to all servos at once, and reads back what it has become; several times where it is something else.
    fn write_all(
        &mut self,
        command: &'static str,
        address: u16,
        data: &[Vec<u8>],
    ) -> Result<(), DriverError> {
        let ids = self.ids();
        let length = data.first().map_or(0, Vec::len) as u16;
        let pairs: Vec<(u8, Vec<u8>)> = ids.iter().copied().zip(data.iter().cloned()).collect();
        let mut wrong = None;
        for _ in 0..3 {
            self.bus.sync_write(address, &pairs).map_err(|error| self.named(error))?;
            let now = self.bus.sync_read(&ids, address, length).map_err(|error| self.named(error))?;
            wrong = now.iter().zip(data).position(|(now, data)| now.data != *data);
            if wrong.is_none() {
                return Ok(());
            }
        }
        Err(self.error(command, wrong, Cause::Unheeded))
    }

    fn write_all_same(
        &mut self,
        command: &'static str,
        register: &Register,
        value: i64,
    ) -> Result<(), DriverError> {
        let data = vec![register.bytes(value); self.servos.len()];
        self.write_all(command, register.address, &data)
    }

    /// The hardware errors of all servos.
    fn latched(&mut self) -> Result<Vec<u8>, DriverError> {
        Ok(self.read_all(&HARDWARE_ERROR)?.into_iter().map(|bits| bits as u8).collect())
    }

    /// Profile acceleration, profile velocity and goal position of each servo, as they lie in the table.
    fn profiles(servos: &[Servo], goals: &[i64], acceleration: impl Fn(&Servo) -> i64) -> Vec<Vec<u8>> {
        let entry = |(servo, goal): (&Servo, &i64)| {
            let goal = (*goal).clamp(servo.goals.0, servo.goals.1);
            [
                PROFILE_ACCELERATION.bytes(acceleration(servo)),
                PROFILE_VELOCITY.bytes(servo.velocity),
                GOAL_POSITION.bytes(goal),
            ]
            .concat()
        };
        servos.iter().zip(goals).map(entry).collect()
    }

    /// Stops, as far as that can be done, after something else has failed.
    fn give_up(&mut self, error: DriverError) -> DriverError {
        if self.armed.is_some() && self.torque != Torque::Off {
            self.torque = Torque::Interrupted;
            // The error that led here is the one to tell of. Where this fails too, the watchdog stops the arm.
            let _ = self.brake();
        }
        error
    }

    /// Sends each servo to where it comes to rest at the soonest. The watchdog stays armed until all have heard: where
    /// that fails half-way, it stops the others.
    fn brake(&mut self) -> Result<(), DriverError> {
        self.braking = true;
        let heard = self.rest();
        if matches!(&heard, Err(error) if error.cause == Cause::Unheeded) {
            self.release_watchdog()?;
            self.rest()?;
        } else {
            heard?;
        }
        self.write_all_same("stop", &BUS_WATCHDOG, 0)?;
        self.armed = None;
        Ok(())
    }

    fn rest(&mut self) -> Result<(), DriverError> {
        let ids = self.ids();
        let length = PRESENT_POSITION.address + PRESENT_POSITION.size - PRESENT_VELOCITY.address;
        let answers = self.bus.sync_read(&ids, PRESENT_VELOCITY.address, length);
        let answers = answers.map_err(|error| self.named(error))?;
        let goals: Vec<i64> = answers
            .iter()
            .zip(&self.servos)
            .map(|(answer, servo)| state::rest(&answer.data, servo))
            .collect();
        let data = Self::profiles(&self.servos, &goals, |servo| servo.braking);
        self.write_all("stop", PROFILE_ACCELERATION.address, &data)
    }

    /// Lets servos take goals again whose watchdog has tripped. Nobody says that they don't go on to the old goal then,
    /// before they are told another one: they are made to crawl, and watched again at once.
    fn release_watchdog(&mut self) -> Result<(), DriverError> {
        let crawl = [PROFILE_ACCELERATION.bytes(0), PROFILE_VELOCITY.bytes(1)].concat();
        self.write_all("stop", PROFILE_ACCELERATION.address, &vec![crawl; self.servos.len()])?;
        let off = self.ids().into_iter().map(|id| (id, BUS_WATCHDOG.bytes(0))).collect::<Vec<_>>();
        self.bus.sync_write(BUS_WATCHDOG.address, &off).map_err(|error| self.named(error))?;
        self.watchdog(Some(self.settings.watchdog)).map(|_| ())
    }

    fn torque_on(&mut self) -> Result<(), DriverError> {
        let command = "torque on";
        let latched = self.latched()?;
        let fault =
            latched.iter().enumerate().find_map(|(joint, bits)| Some((joint, hardware_fault(*bits)?)));
        if let Some((joint, fault)) = fault {
            return Err(self.error(command, Some(joint), Cause::Fault(fault)));
        }
        // Before and after: some firmware takes the present position for its goal when torque comes, some may not.
        self.brake()?;
        self.switch(command, true)?;
        let goals = self.read_all(&PRESENT_POSITION)?;
        let data = Self::profiles(&self.servos, &goals, |_| 0);
        self.write_all(command, PROFILE_ACCELERATION.address, &data)?;
        self.braking = false;
        Ok(())
    }

    fn switch(&mut self, command: &'static str, on: bool) -> Result<(), DriverError> {
        for id in self.ids() {
            let outcome = self.bus.write(id, TORQUE.address, &TORQUE.bytes(on.into()));
            outcome.map_err(|error| self.named(error))?;
        }
        let wrong = self.read_all(&TORQUE)?.iter().position(|torque| *torque != i64::from(on));
        wrong.map_or(Ok(()), |joint| Err(self.error(command, Some(joint), Cause::Unheeded)))
    }

    /// Whether goals may be sent, as far as that is known.
    fn ready(&mut self, command: &'static str) -> Result<(), DriverError> {
        match (self.torque, self.fault) {
            (_, Some((joint, fault))) => return Err(self.error(command, Some(joint), Cause::Fault(fault))),
            (Torque::Off, _) => return Err(self.error(command, None, Cause::TorqueOff)),
            (Torque::Interrupted, _) => return Err(self.error(command, None, Cause::Interrupted)),
            (Torque::On, None) => {}
        }
        let Some(timeout) = self.armed else {
            return self.watchdog(Some(self.settings.watchdog)).map(|_| ());
        };
        // Nothing was heard of the servos for so long that they may not have heard anything either.
        let heard = self.bus.heard().unwrap_or(Time::START);
        if self.clock().now() - heard >= timeout {
            let tripped = self.read_all(&BUS_WATCHDOG)?.iter().position(|units| *units == WATCHDOG_TRIPPED);
            if tripped.is_some() {
                self.torque = Torque::Interrupted;
                return Err(self.error(command, tripped, Cause::Interrupted));
            }
        }
        Ok(())
    }
}

impl Driver for Arm {
    fn name(&self) -> &str {
        self.bus.port().name()
    }

    fn clock(&self) -> Arc<dyn Clock> {
        self.bus.port().clock()
    }

    fn joints(&self) -> &JointMap {
        &self.map
    }

    fn pace(&self) -> Pace {
        Pace::Stream { period: self.period }
    }

    fn read_state(&mut self) -> Result<State, DriverError> {
        self.present().map_err(|error| self.give_up(error))
    }

    fn torque(&mut self, on: bool) -> Result<(), DriverError> {
        // What happens half-way is not known.
        self.torque = Torque::Interrupted;
        if on {
            self.torque_on()?;
            self.torque = Torque::On;
        } else {
            self.switch("torque off", false)?;
            self.release_attached()?;
            self.torque = Torque::Off;
        }
        Ok(())
    }

    fn send(&mut self, command: &Command) -> Result<(), DriverError> {
        let goals = self.goals(command)?;
        self.ready(command::NAME).map_err(|error| self.give_up(error))?;
        self.follow(&goals).map_err(|error| self.give_up(error))
    }

    fn stop(&mut self) -> Result<(), DriverError> {
        let outcome = self.brake();
        if outcome.is_err() && self.torque == Torque::On {
            self.torque = Torque::Interrupted;
        }
        outcome
    }

    /// A servo forgets a hardware error by starting anew: its torque goes off, and it is away for some tenths of a second.
    fn clear_faults(&mut self) -> Result<(), DriverError> {
        let latched = self.latched()?;
        for (servo, bits) in self.servos.clone().iter().zip(latched) {
            if bits != 0 {
                self.torque = Torque::Off;
                let outcome = self.bus.reboot(servo.id).and_then(|_| self.bus.await_servo(servo.id));
                outcome.map_err(|error| self.named(error))?;
            }
        }
        self.fault = None;
        self.clear_attached()
    }

    fn attachments(&self) -> Vec<Attachment> {
        Arm::attachments(self)
    }

    fn move_attachment(&mut self, name: &str, value: f64) -> Result<(), DriverError> {
        self.move_attached(name, value)
    }

    fn read_attachment(&mut self, name: &str) -> Result<f64, DriverError> {
        self.read_attached(name)
    }

    fn watchdog(&mut self, timeout: Option<Duration>) -> Result<Watchdog, DriverError> {
        let command = "watchdog";
        let Some(timeout) = timeout else {
            self.write_all_same(command, &BUS_WATCHDOG, 0)?;
            self.armed = None;
            return Ok(Watchdog::None);
        };
        let units = timeout.as_secs_f64() / WATCHDOG_UNIT.as_secs_f64();
        let (min, max) = (1.0, BUS_WATCHDOG.range.1 as f64);
        if units > max {
            return Err(self.error(command, None, Cause::OutsideRange { value: units, min, max }));
        }
        let units = units.ceil().max(min) as u32;
        self.write_all_same(command, &BUS_WATCHDOG, units.into())?;
        let timeout = WATCHDOG_UNIT * units;
        self.armed = Some(timeout);
        Ok(Watchdog::Device(timeout))
    }
}

#[cfg(test)]
mod tests;
