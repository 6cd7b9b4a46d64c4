//! From a table to its device.

use dh_drivers::clock::VirtualClock;
use dh_drivers::connect;
use dh_drivers::driver::{DeviceKind, DeviceSettings, JointMap};
use dh_runtime::dh_robot;
use std::sync::Arc;

#[dh_robot("planar2r")]
struct Planar;

/// 0 is an id like any other, 253 and above are none: 254 speaks to all, the others are not used.
#[test]
fn ids_are_those_of_the_protocol() {
    let settings = DeviceSettings { kind: DeviceKind::Dynamixel, baud: 1_000_000 };
    for (id, refused) in [(0, false), (252, false), (253, true), (300, true)] {
        let mut joints = JointMap::of_table(&Planar).unwrap();
        joints.joints[0].id = id;
        let outcome = connect::simulated(settings, Box::new(Planar), &joints, Arc::new(VirtualClock::new()));
        match outcome {
            Ok(_) => assert!(!refused, "{id}"),
            Err(error) => {
                assert!(refused && error.to_string().contains("write id = 0 to 252"), "{id}: {error}");
            }
        }
    }
}
