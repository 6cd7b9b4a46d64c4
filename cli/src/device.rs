//! The device that a table describes.

use crate::failure::Refusal;
use crate::robot::Robot;
use dh_drivers::driver::DeviceSettings;

/// `[device]` of the table, at another rate (bits per second) if one is given.
///
/// # Errors
/// Where there is none, or it is not one that there is a driver for.
pub(crate) fn settings(robot: &Robot, baud: Option<u32>) -> Result<DeviceSettings, Refusal> {
    let Some(device) = &robot.model().device else {
        let message = format!("{} has no [device], so nothing moves it", robot.source.name_shown);
        return Err(Refusal::new("device", message)
            .help("write [device] with driver = \"dynamixel\" or \"mycobot\" into the table"));
    };
    let keys = device.keys.iter().map(|(key, value)| (key.as_str(), value.as_str()));
    let settings = DeviceSettings::of_table(&device.driver, keys)
        .map_err(|error| Refusal::new("device", format!("{}: {error}", robot.source.name_shown)))?;
    Ok(DeviceSettings { baud: baud.unwrap_or(settings.baud), ..settings })
}
