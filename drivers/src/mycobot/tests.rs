//! The driver against the simulated arm, in one process and on a clock that takes no time.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

mod bad_line;
mod readings;
mod session;

use std::sync::{Arc, Mutex, MutexGuard};
use std::time::Duration;

use dh_runtime::{Kinematics, dh_robot};

use super::{Model, MyCobot, SimulatedMyCobot};
use crate::clock::{Clock, VirtualClock};
use crate::driver::{Driver, JointMap};
use crate::motion::Command;
use crate::simulate::{Faults, Faulty, SimulatedPort};

#[dh_robot("mycobot")]
struct Arm;

/// A tenth of a degree.
const TENTH: f64 = 0.1 * std::f64::consts::PI / 180.0;
/// rad/s at 100 %.
const FULL: f64 = 160.0 * std::f64::consts::PI / 180.0;

/// A driver and the arm behind it.
struct Bench {
    driver: MyCobot,
    device: Arc<Mutex<Faulty<SimulatedMyCobot<'static>>>>,
    clock: Arc<VirtualClock>,
}

impl Bench {
    /// On a good line.
    fn new(model: Model) -> Self {
        let clock = Arc::new(VirtualClock::new());
        let arm = SimulatedMyCobot::new(Box::new(Arm), model).unwrap();
        let device = Arc::new(Mutex::new(Faulty::new(arm, Faults::default(), 20_250_101)));
        let port = SimulatedPort::new(Arc::clone(&device), Arc::clone(&clock) as Arc<dyn Clock>);
        let joints = JointMap::of_table(&Arm).unwrap();
        let driver = MyCobot::new(Box::new(port), joints, model).unwrap();
        Self { driver, device, clock }
    }

    fn device(&self) -> MutexGuard<'_, Faulty<SimulatedMyCobot<'static>>> {
        self.device.lock().unwrap()
    }

    /// A goal (deg of the table) at a speed in percent.
    fn goal(degrees: [f64; 6], percent: f64) -> Command {
        let positions = degrees.map(f64::to_radians).to_vec();
        Command::for_test(Arm.fingerprint(), positions, vec![FULL * percent / 100.0; 6])
    }

    /// Waits, and brings the arm there.
    fn pass(&self, time: Duration) {
        use crate::simulate::SimulatedDevice;
        self.clock.advance(time);
        self.device().advance(self.clock.now());
    }

    /// Reads until the arm says that it rests, at most for 30 s: where it is (rad).
    fn arrive(&mut self) -> Vec<f64> {
        let end = self.clock.now() + Duration::from_secs(30);
        loop {
            let state = self.driver.read_state().unwrap();
            if state.joints.iter().all(|joint| joint.moving == Some(false)) {
                return state.positions();
            }
            assert!(self.clock.now() < end, "it never arrives");
            self.pass(Duration::from_millis(50));
        }
    }
}

fn apart(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}
