//! An arm with a device that moves it.

mod feedback;
mod run;

use super::checked::Checked;
use super::dynamics::Defaults;
use super::error::MotionError;
use super::moves::Move;
use super::planner::{OtherArm, Planner};
use super::refusal::{JointName, Refusal};
use super::settings::{Settings, Tolerance};
use crate::driver::{Driver, DriverError, State, Watchdog};
use dh_runtime::{Kinematics, NamedPose};
use std::fmt;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Stops a robot from elsewhere: from the handler of Ctrl-C, another thread, or what watches the progress of a move.
#[derive(Debug, Clone, Default)]
pub struct StopHandle(Arc<AtomicBool>);

impl StopHandle {
    /// The arm stops on its path and holds; it makes no other move until [`StopHandle::clear`].
    pub fn stop(&self) {
        self.0.store(true, Ordering::SeqCst);
    }

    /// Moves may be made again.
    pub fn clear(&self) {
        self.0.store(false, Ordering::SeqCst);
    }

    /// Whether it was asked to stop.
    pub fn is_set(&self) -> bool {
        self.0.load(Ordering::SeqCst)
    }
}

/// How far a run has come.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Progress<'p> {
    /// Which move is under way (0-based).
    pub step: usize,
    /// Of how many.
    pub steps: usize,
    /// How much of what the moves take is over (s); what the arm needs to come to rest is not counted.
    pub elapsed: f64,
    /// What they take all together (s).
    pub duration: f64,
    /// Whether the arm is at rest where this move ends.
    pub arrived: bool,
    /// Where this move ends (rad or m).
    pub goal: &'p [f64],
    /// What the device said last.
    pub state: &'p State,
}

/// An arm, and the device that moves it.
///
/// It plans from where the arm stands and sends nothing before the whole of what was asked for is checked. While the arm
/// moves, its position is watched: a fault, feedback that stays away, or joints that are elsewhere than they should be
/// stop it. A robot that is dropped while its arm moves stops it, and the arm holds.
///
/// Of the arm's links only the tool point is checked against the workspace rules. Nothing knows of the other links, of
/// what the arm carries, or of what stands around.
pub struct Robot<'k, D: Driver> {
    planner: Planner<'k>,
    driver: D,
    poses: Vec<SafePose>,
    settings: Settings,
    /// What the device said last.
    state: State,
    /// Where the arm was last sent, if it got there.
    held: Option<Vec<f64>>,
    torque: bool,
    /// The arm was sent off and not seen at rest since.
    under_way: bool,
    /// What happens to it without a word, then.
    watchdog: Watchdog,
    /// Why it was not seen the last time, if it was not.
    unseen: Option<DriverError>,
    stop: StopHandle,
}

#[derive(Debug, Clone)]
struct SafePose {
    name: String,
    q: Vec<f64>,
}

/// Why there is no robot.
#[derive(Debug, Clone, PartialEq)]
pub enum ConnectError {
    /// The driver is another arm's.
    OtherArm(OtherArm),
    /// The device does not say where the arm is.
    Driver(DriverError),
}

impl fmt::Display for ConnectError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::OtherArm(error) => error.fmt(f),
            Self::Driver(error) => error.fmt(f),
        }
    }
}

impl std::error::Error for ConnectError {}

impl<'k, D: Driver> Robot<'k, D> {
    /// Asks the device where the arm is. Torque stays as it is until the first move; a device that says nothing without
    /// power has to be switched on before, by [`Driver::torque`].
    ///
    /// # Errors
    /// Where the driver is another arm's, or the device does not answer.
    pub fn new(arm: &'k dyn Kinematics, driver: D) -> Result<Self, ConnectError> {
        let mut driver = driver;
        let pace = driver.pace();
        let planner = Planner::new(arm, driver.joints(), pace).map_err(ConnectError::OtherArm)?;
        let state = driver.read_state().map_err(ConnectError::Driver)?;
        Ok(Self {
            planner,
            driver,
            poses: Vec::new(),
            settings: Settings::of_pace(pace),
            state,
            held: None,
            torque: false,
            under_way: false,
            watchdog: Watchdog::None,
            unseen: None,
            stop: StopHandle::default(),
        })
    }

    /// With the named poses of the table, of which the safe ones are where torque may be cut.
    pub fn with_poses(mut self, poses: &[NamedPose<'_>]) -> Self {
        let safe = poses.iter().filter(|pose| pose.safe);
        self.poses = safe.map(|pose| SafePose { name: pose.name.to_owned(), q: pose.q.to_vec() }).collect();
        self
    }

    /// With other tolerances and times.
    pub fn with_settings(mut self, settings: Settings) -> Self {
        self.settings = settings;
        self
    }

    /// With other limits of velocity, acceleration and jerk where the table has none.
    pub fn with_defaults(mut self, defaults: &Defaults) -> Self {
        self.planner.set_defaults(defaults);
        self
    }

    /// The arm, with the limits that motion keeps.
    pub fn arm(&self) -> &dyn Kinematics {
        self.planner.arm()
    }

    /// What plans and checks.
    pub fn planner(&self) -> &Planner<'k> {
        &self.planner
    }

    /// The device, for what it has besides joints.
    pub fn driver(&mut self) -> &mut D {
        &mut self.driver
    }

    /// Stops the arm from elsewhere.
    pub fn stop_handle(&self) -> StopHandle {
        self.stop.clone()
    }

    /// What the device said last; nothing is asked.
    pub fn state(&self) -> &State {
        &self.state
    }

    /// Asks the device for everything that it tells.
    ///
    /// # Errors
    /// Where it doesn't answer.
    pub fn read(&mut self) -> Result<&State, DriverError> {
        self.state = self.driver.read_state()?;
        Ok(&self.state)
    }

    /// Where the arm stands, as moves are planned from it (rad or m): where it was sent, as long as it is about there;
    /// else where it was last seen, with joints that are a little beyond their limits on them.
    pub fn stands(&self) -> Vec<f64> {
        let seen = self.state.positions();
        match &self.held {
            Some(held) if self.furthest_beyond(&seen, held, &self.settings.start).is_none() => held.clone(),
            _ => self.planner.inside(&seen, &self.settings.start),
        }
    }

    /// Checks moves from where the arm stands. Nothing is sent.
    ///
    /// # Errors
    /// What is wrong with them.
    pub fn plan(&self, moves: &[Move]) -> Result<Checked, Refusal> {
        self.planner.plan(&self.stands(), moves)
    }

    /// Checks moves from where the arm stands, and makes them.
    ///
    /// # Errors
    /// A refusal, before anything is sent; else what [`Robot::run`] meets.
    pub fn go(&mut self, moves: &[Move]) -> Result<(), MotionError> {
        self.go_watched(moves, &mut |_| {})
    }

    /// The same, and tells how it is going whenever the device has said something.
    ///
    /// # Errors
    /// As [`Robot::go`].
    pub fn go_watched(
        &mut self,
        moves: &[Move],
        watch: &mut dyn FnMut(&Progress<'_>),
    ) -> Result<(), MotionError> {
        let mut checked = self.plan(moves)?;
        self.read()?;
        // It may have been moved by hand since it was last seen.
        if checked.start() != Some(self.stands().as_slice()) {
            checked = self.plan(moves)?;
        }
        self.run(&checked, watch)
    }

    /// Switches torque on: the arm holds where it is.
    ///
    /// # Errors
    /// What the device says.
    pub fn hold(&mut self) -> Result<(), MotionError> {
        self.driver.torque(true)?;
        self.torque = true;
        Ok(())
    }

    /// Switches torque off, if the arm is in a pose that the table marks safe.
    ///
    /// # Errors
    /// [`MotionError::NotSafe`] anywhere else; torque stays on then.
    pub fn release(&mut self) -> Result<(), MotionError> {
        let seen = self.read()?.positions();
        let mut nearest: Option<(String, usize, f64)> = None;
        for pose in &self.poses {
            let Some((index, off)) = self.furthest_beyond(&seen, &pose.q, &self.settings.safe) else {
                return self.release_anywhere();
            };
            if nearest.as_ref().is_none_or(|(_, _, least)| off < *least) {
                nearest = Some((pose.name.clone(), index, off));
            }
        }
        let index = nearest.as_ref().map_or(0, |(_, index, _)| *index);
        let pose = nearest.as_ref().and_then(|(name, ..)| self.poses.iter().find(|pose| pose.name == *name));
        let value = |q: Option<&Vec<f64>>| q.and_then(|q| q.get(index)).copied().unwrap_or(f64::NAN);
        let expected = value(pose.map(|pose| &pose.q));
        let nearest = nearest.map(|(name, index, _)| (name, self.planner.joint_name(index)));
        Err(MotionError::NotSafe { nearest, actual: value(Some(&seen)), expected })
    }

    /// Switches torque off wherever the arm is. It falls unless something holds it.
    ///
    /// # Errors
    /// What the device says.
    pub fn release_anywhere(&mut self) -> Result<(), MotionError> {
        self.driver.torque(false)?;
        (self.torque, self.held) = (false, None);
        Ok(())
    }

    /// Makes the device forget the faults that it has latched. Joints that they were latched of may lose their torque by it:
    /// the arm may sink there until the next move or [`Robot::hold`] switches it on.
    ///
    /// # Errors
    /// What the device says; [`MotionError::Fault`] where a fault is latched again at once.
    pub fn clear_faults(&mut self) -> Result<(), MotionError> {
        self.driver.clear_faults()?;
        (self.torque, self.held) = (false, None);
        self.read()?;
        self.no_fault()
    }

    /// Brings the arm to rest as fast as it decelerates, off its path, and waits for the rest. It holds then.
    ///
    /// # Errors
    /// Where the device doesn't hear, or the arm doesn't come to rest.
    pub fn emergency_stop(&mut self) -> Result<(), MotionError> {
        self.driver.stop()?;
        self.held = None;
        self.wait_for_rest()
    }

    /// The joint that is furthest from where it should be, as a multiple of the tolerance, if that is more than 1.
    fn furthest_beyond(&self, q: &[f64], expected: &[f64], tolerance: &Tolerance) -> Option<(usize, f64)> {
        let joints = q.iter().zip(expected).zip(self.arm().joints()).enumerate();
        let off = joints.map(|(index, ((q, expected), joint))| {
            let off = (q - expected).abs() / tolerance.of(joint.kind);
            // What is no number is nowhere.
            (index, if off.is_nan() { f64::INFINITY } else { off })
        });
        off.filter(|(_, off)| *off > 1.0).max_by(|(_, a), (_, b)| a.total_cmp(b))
    }

    fn joint_name(&self, index: usize) -> JointName {
        self.planner.joint_name(index)
    }
}

impl<D: Driver> fmt::Debug for Robot<'_, D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Robot")
            .field("arm", &self.arm().name())
            .field("driver", &self.driver)
            .field("state", &self.state)
            .finish_non_exhaustive()
    }
}

/// Stops the arm where it moves; it holds.
impl<D: Driver> Drop for Robot<'_, D> {
    fn drop(&mut self) {
        if self.under_way {
            // There is nobody left to tell.
            let _ = self.driver.stop();
        }
    }
}
