//! Time, real or virtual.
//!
//! Everything that waits takes its time from a [`Clock`]. On a [`VirtualClock`] a wait takes no time: it moves the
//! clock. Simulated devices then run as fast as the processor allows, and always alike.

use std::fmt;
use std::ops::{Add, AddAssign, Sub};
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// A point in time: what has passed since the clock was started.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub struct Time(Duration);

impl Time {
    /// When the clock was started.
    pub const START: Time = Time(Duration::ZERO);
    /// Later than any deadline.
    pub const NEVER: Time = Time(Duration::MAX);

    /// So long after the clock was started.
    pub const fn after_start(elapsed: Duration) -> Time {
        Time(elapsed)
    }

    /// Since the clock was started.
    pub const fn since_start(self) -> Duration {
        self.0
    }

    /// How long after `earlier`; zero where it is not.
    pub const fn since(self, earlier: Time) -> Duration {
        self.0.saturating_sub(earlier.0)
    }
}

/// Saturates at [`Time::NEVER`].
impl Add<Duration> for Time {
    type Output = Time;
    fn add(self, duration: Duration) -> Time {
        Time(self.0.saturating_add(duration))
    }
}

impl AddAssign<Duration> for Time {
    fn add_assign(&mut self, duration: Duration) {
        *self = *self + duration;
    }
}

/// [`Time::since`]
impl Sub for Time {
    type Output = Duration;
    fn sub(self, earlier: Time) -> Duration {
        self.since(earlier)
    }
}

/// What tells the time and waits. Shared as `Arc<dyn Clock>` between a port, its driver and who calls that.
pub trait Clock: fmt::Debug + Send + Sync {
    /// The time.
    fn now(&self) -> Time;

    /// Waits until then; returns at once where that is past.
    fn sleep_until(&self, time: Time);
}

/// The time of the operating system, from when it was made.
#[derive(Debug, Clone, Copy)]
pub struct RealClock {
    start: Instant,
}

impl RealClock {
    /// Starts at zero now.
    pub fn new() -> Self {
        Self { start: Instant::now() }
    }
}

impl Default for RealClock {
    fn default() -> Self {
        Self::new()
    }
}

impl Clock for RealClock {
    fn now(&self) -> Time {
        Time(self.start.elapsed())
    }

    fn sleep_until(&self, time: Time) {
        let wait = time.since(self.now());
        if !wait.is_zero() {
            std::thread::sleep(wait);
        }
    }
}

/// Stands still until somebody waits: then it is the time that was waited for.
///
/// It is meant for one thread. Where several wait on one, each moves the clock for all of them.
#[derive(Debug, Default)]
pub struct VirtualClock {
    nanoseconds: AtomicU64,
}

impl VirtualClock {
    /// Stands at zero.
    pub fn new() -> Self {
        Self::default()
    }

    /// Moves it forward.
    pub fn advance(&self, duration: Duration) {
        self.sleep_until(self.now() + duration);
    }
}

impl Clock for VirtualClock {
    fn now(&self) -> Time {
        Time(Duration::from_nanos(self.nanoseconds.load(Ordering::SeqCst)))
    }

    fn sleep_until(&self, time: Time) {
        let nanoseconds = u64::try_from(time.since_start().as_nanos()).unwrap_or(u64::MAX);
        self.nanoseconds.fetch_max(nanoseconds, Ordering::SeqCst);
    }
}
