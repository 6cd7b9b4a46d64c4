//! A device in memory: motors with finite speed and acceleration, and everything that may go wrong with it.

use dh_drivers::clock::{Clock, Time, VirtualClock};
use dh_drivers::driver::{Cause, Driver, DriverError, Fault, JointMap, JointState, Pace, State, Watchdog};
use dh_drivers::motion::Command;
use dh_drivers::simulate::Trapezoid;
use dh_runtime::Kinematics;
use std::sync::{Arc, Mutex, MutexGuard};
use std::time::Duration;

/// What is behind the driver, for tests to look at and to break.
#[derive(Debug)]
pub(crate) struct Arm {
    pub motors: Vec<Trapezoid>,
    pub torque: bool,
    now: Time,
    /// Everything that was sent to move it.
    pub sent: Vec<(Time, Vec<f64>)>,
    /// Calls of any kind.
    pub calls: usize,
    pub stops: usize,
    pub watchdog: Option<Duration>,
    last_word: Time,
    /// From then on no answer comes.
    pub silent_from: Option<Time>,
    /// From then on this joint does not move.
    pub stuck: Option<(Time, usize)>,
    /// From then on this fault is latched.
    pub fault: Option<(Time, usize, Fault)>,
    /// Whether `stop` fails, too.
    pub deaf: bool,
    /// Every so many reads one fails.
    pub lossy: Option<usize>,
}

impl Arm {
    fn advance(&mut self, now: Time) {
        let mut then = self.now;
        if let Some(watchdog) = self.watchdog {
            let trips = self.last_word + watchdog;
            if then < trips && trips <= now {
                self.step(then, trips);
                self.motors.iter_mut().for_each(Trapezoid::brake);
                then = trips;
            }
        }
        self.step(then, now);
        self.now = now;
    }

    fn step(&mut self, then: Time, now: Time) {
        for (index, motor) in self.motors.iter_mut().enumerate() {
            if self.stuck.is_some_and(|(from, joint)| joint == index && from <= now) {
                motor.velocity = 0.0;
                continue;
            }
            motor.advance(now.since(then).as_secs_f64());
        }
    }

    /// Lets time pass without a word.
    pub(crate) fn look(&mut self, now: Time) {
        self.advance(now);
    }

    /// Whether anything moves.
    pub(crate) fn moves(&self) -> bool {
        self.motors.iter().any(|motor| motor.velocity != 0.0)
    }

    pub(crate) fn positions(&self) -> Vec<f64> {
        self.motors.iter().map(|motor| motor.position).collect()
    }
}

#[derive(Debug)]
pub(crate) struct Memory {
    pub arm: Arc<Mutex<Arm>>,
    clock: Arc<VirtualClock>,
    joints: JointMap,
    pace: Pace,
    call: Duration,
}

pub(crate) const STREAM: Pace = Pace::Stream { period: Duration::from_millis(10) };

impl Memory {
    /// At rest at `start`; its motors are a quarter faster than the table asks of them.
    pub(crate) fn new(arm: &dyn Kinematics, pace: Pace, start: &[f64]) -> Self {
        let motors = arm.joints().iter().zip(start).map(|(joint, start)| {
            let velocity = 1.25 * joint.max_velocity.unwrap_or(10.0);
            Trapezoid::at(*start, velocity, 40.0 * velocity)
        });
        let state = Arm {
            motors: motors.collect(),
            torque: false,
            now: Time::START,
            sent: Vec::new(),
            calls: 0,
            stops: 0,
            watchdog: None,
            last_word: Time::START,
            silent_from: None,
            stuck: None,
            fault: None,
            deaf: false,
            lossy: None,
        };
        let joints = JointMap::of_table(arm).unwrap();
        let call = Duration::from_millis(1);
        let clock = Arc::new(VirtualClock::new());
        Self { arm: Arc::new(Mutex::new(state)), clock, joints, pace, call }
    }

    pub(crate) fn virtual_clock(&self) -> Arc<VirtualClock> {
        Arc::clone(&self.clock)
    }

    /// The arm after one exchange, which takes its time.
    fn exchange(&mut self, command: &'static str) -> Result<MutexGuard<'_, Arm>, DriverError> {
        self.clock.advance(self.call);
        let now = self.clock.now();
        let mut arm = self.arm.lock().unwrap();
        arm.advance(now);
        arm.calls += 1;
        if arm.silent_from.is_some_and(|from| from <= now) {
            let waited = Duration::from_millis(30);
            self.clock.advance(waited);
            return Err(DriverError::new("memory", command, Cause::Silent { waited }));
        }
        arm.last_word = now;
        Ok(arm)
    }
}

impl Driver for Memory {
    fn name(&self) -> &'static str {
        "memory"
    }

    fn clock(&self) -> Arc<dyn Clock> {
        self.clock.clone()
    }

    fn joints(&self) -> &JointMap {
        &self.joints
    }

    fn pace(&self) -> Pace {
        self.pace
    }

    fn read_state(&mut self) -> Result<State, DriverError> {
        let mut arm = self.exchange("read state")?;
        if arm.lossy.is_some_and(|every| arm.calls.is_multiple_of(every)) {
            return Err(DriverError::new("memory", "read state", Cause::Garbled));
        }
        let now = arm.now;
        let fault = arm.fault;
        let joints = arm.motors.iter_mut().enumerate().map(|(index, motor)| JointState {
            position: motor.position,
            velocity: Some(motor.velocity),
            fault: fault
                .filter(|(from, joint, _)| *from <= now && *joint == index)
                .map(|(_, _, fault)| fault),
            ..JointState::default()
        });
        Ok(State { stamp: now, joints: joints.collect(), fault: None })
    }

    fn torque(&mut self, on: bool) -> Result<(), DriverError> {
        self.exchange("torque")?.torque = on;
        Ok(())
    }

    fn send(&mut self, command: &Command) -> Result<(), DriverError> {
        let streams = matches!(self.pace, Pace::Stream { .. });
        let mut arm = self.exchange("goal")?;
        assert!(arm.torque, "moved without torque");
        let now = arm.now;
        arm.sent.push((now, command.positions().to_vec()));
        let goals = command.positions().iter().zip(command.velocities());
        for (motor, (goal, velocity)) in arm.motors.iter_mut().zip(goals) {
            motor.goal = *goal;
            if !streams {
                motor.max_velocity = velocity.max(1e-6);
            }
        }
        Ok(())
    }

    fn stop(&mut self) -> Result<(), DriverError> {
        let now = self.clock.now();
        let mut arm = self.arm.lock().unwrap();
        arm.advance(now);
        arm.stops += 1;
        if arm.deaf {
            let waited = Duration::from_millis(30);
            return Err(DriverError::new("memory", "stop", Cause::Silent { waited }));
        }
        arm.motors.iter_mut().for_each(Trapezoid::brake);
        Ok(())
    }

    fn clear_faults(&mut self) -> Result<(), DriverError> {
        self.exchange("clear faults")?.fault = None;
        Ok(())
    }

    fn watchdog(&mut self, timeout: Option<Duration>) -> Result<Watchdog, DriverError> {
        self.exchange("watchdog")?.watchdog = timeout;
        Ok(timeout.map_or(Watchdog::None, Watchdog::Device))
    }
}
