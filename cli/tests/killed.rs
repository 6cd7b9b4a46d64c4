//! A program that is killed while it moves a Dynamixel arm: the servos' watchdogs stop the arm.

#![cfg(unix)]
#![expect(clippy::unwrap_used, reason = "a device that does not answer is a failure")]

mod common;

use common::command;
use dh_drivers::clock::RealClock;
use dh_drivers::dynamixel::control_table::{
    BUS_WATCHDOG, GOAL_POSITION, MOVING, PRESENT_POSITION, Register, TORQUE, WATCHDOG_TRIPPED,
};
use dh_drivers::dynamixel::{Bus, Timing};
use dh_drivers::port;
use std::io::{BufRead, BufReader};
use std::process::Child;
use std::sync::Arc;
use std::thread::sleep;
use std::time::Duration;

/// Ends with the test, however that ends.
struct Running(Child);

impl Drop for Running {
    fn drop(&mut self) {
        self.0.kill().unwrap();
        self.0.wait().unwrap();
    }
}

fn read(bus: &mut Bus, register: &Register) -> Vec<i64> {
    let answers = bus.sync_read(&[1, 2], register.address, register.size).unwrap();
    answers.iter().map(|answer| register.value(&answer.data).unwrap()).collect()
}

#[test]
fn a_killed_program_leaves_the_arm_stopped() {
    let mut device = Running(command("sim planar2r").spawn().unwrap());
    let mut line = String::new();
    BufReader::new(device.0.stdout.take().unwrap()).read_line(&mut line).unwrap();
    let port = line.split('"').nth(3).unwrap().to_owned();

    // Some ten seconds from tick 2048 to 3352, and back for the other joint; it tells how far it has come.
    let program = command(&format!("move planar2r --port {port} --joints 2,-2 --percent 20")).spawn();
    let mut program = Running(program.unwrap());
    let mut progress = BufReader::new(program.0.stderr.take().unwrap()).lines().map_while(Result::ok);
    assert!(progress.nth(1).unwrap().contains('%'), "it is on its way");
    drop(program);
    // The watchdog has 200 ms; nobody speaks to the servos meanwhile.
    sleep(Duration::from_millis(500));

    let line = port::open(&port, 57_600, Arc::new(RealClock::new())).unwrap();
    let mut bus = Bus::new(line, Timing::default());
    assert_eq!(read(&mut bus, &BUS_WATCHDOG), [WATCHDOG_TRIPPED; 2]);
    assert_eq!(read(&mut bus, &TORQUE), [1, 1], "it holds");
    assert_eq!(read(&mut bus, &MOVING), [0, 0]);
    let stopped = read(&mut bus, &PRESENT_POSITION);
    assert!(
        (2060..3340).contains(&stopped[0]) && (756..2036).contains(&stopped[1]),
        "on the way: {stopped:?}"
    );
    // At its speed it would be some 60 ticks further on.
    sleep(Duration::from_millis(500));
    assert_eq!(read(&mut bus, &PRESENT_POSITION), stopped, "it stays");
    // Goals are refused until somebody has seen to it.
    assert!(bus.write(1, GOAL_POSITION.address, &GOAL_POSITION.bytes(2048)).is_err());
}
