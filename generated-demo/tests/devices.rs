//! The programs on a port, in real time: what they did is asked of the simulated device, not of them.

#![cfg(unix)]
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::io::{BufRead, BufReader, Write};
use std::process::{Child, Command, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use dh_drivers::clock::{RealClock, Time};
use dh_drivers::dynamixel::control_table::MODELS;
use dh_drivers::dynamixel::{ServoSpec, SimulatedBus};
use dh_drivers::mycobot::{Model, SimulatedMyCobot};
use dh_drivers::simulate::{Line, Pty, SimulatedDevice, serve};
use dh_runtime::dh_robot;

#[dh_robot("mycobot")]
struct MyCobot;

/// A device that a test can look at while a program has its port.
#[derive(Debug)]
struct Shared<D>(Arc<Mutex<D>>);

impl<D: SimulatedDevice> SimulatedDevice for Shared<D> {
    fn receive(&mut self, bytes: &[u8], now: Time) {
        self.0.lock().unwrap().receive(bytes, now);
    }
    fn advance(&mut self, now: Time) {
        self.0.lock().unwrap().advance(now);
    }
    fn next_send(&self) -> Option<Time> {
        self.0.lock().unwrap().next_send()
    }
    fn send(&mut self, now: Time) -> Option<Vec<u8>> {
        self.0.lock().unwrap().send(now)
    }
}

/// A device on a terminal, until it is dropped.
struct Served<D> {
    device: Arc<Mutex<D>>,
    port: String,
    stop: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
    _alone: MutexGuard<'static, ()>,
}

/// Devices run in real time, and so do the programs: one test at a time has the processor.
static ALONE: Mutex<()> = Mutex::new(());

impl<D: SimulatedDevice + 'static> Served<D> {
    fn new(device: D) -> Self {
        let alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
        let device = Arc::new(Mutex::new(device));
        let stop = Arc::new(AtomicBool::new(false));
        let (mut shared, told) = (Shared(Arc::clone(&device)), Arc::clone(&stop));
        let mut line = Pty::open(None).unwrap();
        let port = line.name();
        let thread =
            std::thread::spawn(move || serve(&mut shared, &mut line, &RealClock::new(), &told).unwrap());
        Self { device, port, stop, thread: Some(thread), _alone: alone }
    }
}

impl<D> Drop for Served<D> {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        self.thread.take().unwrap().join().unwrap();
    }
}

fn start(program: &str, arguments: &[&str], port: &str) -> Child {
    let mut command = Command::new(program);
    command.args(arguments).args(["--port", port]);
    command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
}

fn mycobot() -> Served<SimulatedMyCobot<'static>> {
    Served::new(SimulatedMyCobot::new(Box::new(MyCobot), Model::Pi).unwrap())
}

/// How far a joint is from where it should be (deg).
fn off(arm: &SimulatedMyCobot<'_>, degrees: [f64; 6]) -> f64 {
    let pairs = arm.positions().into_iter().zip(degrees);
    pairs.map(|(q, goal)| (q.to_degrees() - goal).abs()).fold(0.0, f64::max)
}

#[test]
fn mycobot_moves_the_hand_and_holds() {
    let served = mycobot();
    let child = start(
        env!("CARGO_BIN_EXE_mycobot_arm"),
        &["hand", "150", "-100", "70", "--speed", "100"],
        &served.port,
    );
    let output = child.wait_with_output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let arm = served.device.lock().unwrap();
    assert!(off(&arm, [-12.0814, -51.1653, -123.7964, 84.9618, 0.0, -12.0814]) < 0.1);
    assert!(arm.is_holding() && !arm.is_moving());
}

/// Ctrl-C on the way: the arm stops where it is, holds, and the program says so.
#[test]
fn an_interrupt_stops_the_arm_and_it_holds() {
    let served = mycobot();
    let mut child = start(env!("CARGO_BIN_EXE_mycobot_arm"), &["joints", "--speed", "10"], &served.port);
    child.stdin.as_mut().unwrap().write_all(b"80 0 0 0 0 0\n").unwrap();
    let deadline = Instant::now() + Duration::from_secs(20);
    while off(&served.device.lock().unwrap(), [0.0; 6]) < 10.0 {
        assert!(Instant::now() < deadline, "it does not move");
        std::thread::sleep(Duration::from_millis(20));
    }
    Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    let mut said = String::new();
    BufReader::new(child.stdout.as_mut().unwrap()).read_line(&mut said).unwrap();
    assert!(said.contains("stop"), "{said}");
    {
        let arm = served.device.lock().unwrap();
        assert!(arm.is_holding() && !arm.is_moving());
        assert!(off(&arm, [0.0; 6]) < 40.0, "it stopped on the way");
    }
    // It goes on with the next line.
    child.stdin.take().unwrap().write_all(b"20 0 0 0 0 0\n").unwrap();
    assert!(child.wait_with_output().unwrap().status.success());
    assert!(off(&served.device.lock().unwrap(), [20.0, 0.0, 0.0, 0.0, 0.0, 0.0]) < 0.1);
}

#[test]
fn planar_arm_ends_at_zero_without_torque() {
    let servo = |id| ServoSpec { id, model: &MODELS[0], baud: 57_600, position: 2300.0 };
    let served = Served::new(SimulatedBus::new([1, 2].map(servo)));
    let mut child = start(env!("CARGO_BIN_EXE_planar_arm"), &[], &served.port);
    child.stdin.take().unwrap().write_all(b"z\nd\nq\n").unwrap();
    let output = child.wait_with_output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert_eq!(text.lines().filter(|line| line.starts_with("target")).count(), 6, "{text}");
    let bus = served.device.lock().unwrap();
    for servo in bus.servos() {
        assert!((servo.position() - 2048.0).abs() <= 2.0, "{servo:?}");
        assert!(!servo.is_driven(), "{servo:?}");
    }
}
