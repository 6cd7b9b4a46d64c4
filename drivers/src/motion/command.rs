//! What moves an arm.

/// Joint values that were checked against the limits and rules of one arm, to be sent to that arm's driver.
///
/// Only [`motion`](crate::motion) makes one, and it makes them of what it has checked: its fields are private, and so is
/// its constructor. A driver therefore need not ask where the numbers come from; it compares
/// [`fingerprint`](Self::fingerprint) with its own, so that what was checked for one arm is not sent to another.
#[derive(Debug, Clone, PartialEq)]
pub struct Command {
    fingerprint: u64,
    positions: Vec<f64>,
    velocities: Vec<f64>,
}

impl Command {
    /// Of what has been checked: positions (rad or m) and velocities (rad/s or m/s), one a joint.
    pub(super) fn new(fingerprint: u64, positions: Vec<f64>, velocities: Vec<f64>) -> Self {
        Self { fingerprint, positions, velocities }
    }

    /// Unchecked, for tests of drivers within this crate.
    #[cfg(test)]
    pub(crate) fn for_test(fingerprint: u64, positions: Vec<f64>, velocities: Vec<f64>) -> Self {
        Self::new(fingerprint, positions, velocities)
    }

    /// The table that it was checked against: [`Kinematics::fingerprint`](dh_runtime::Kinematics::fingerprint).
    pub fn fingerprint(&self) -> u64 {
        self.fingerprint
    }

    /// Where the joints are to be (rad or m), in the table's order.
    pub fn positions(&self) -> &[f64] {
        &self.positions
    }

    /// Streams: the velocity (rad/s or m/s, signed) of the path at this point. Point to point: how fast (same units)
    /// each joint may go at most on the way there; 0 where it stays.
    pub fn velocities(&self) -> &[f64] {
        &self.velocities
    }
}
