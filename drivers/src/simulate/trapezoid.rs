//! Motion at finite speed and acceleration.

/// A motor that goes to its goal with a trapezoid of velocity: it accelerates, cruises, decelerates, and is at rest in
/// the goal. Goals may change on the way, also to places that it must turn round for.
///
/// Units are those of whoever uses it; time is in seconds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Trapezoid {
    /// Where it is.
    pub position: f64,
    /// How fast it goes.
    pub velocity: f64,
    /// Where it is to be.
    pub goal: f64,
    /// The greatest speed, positive.
    pub max_velocity: f64,
    /// The greatest acceleration and deceleration, positive.
    pub max_acceleration: f64,
}

/// What is left of a stretch for want of digits, as a part of the whole.
const ROUNDING: f64 = 1e-12;

impl Trapezoid {
    /// At rest there.
    pub fn at(position: f64, max_velocity: f64, max_acceleration: f64) -> Self {
        Self { position, velocity: 0.0, goal: position, max_velocity, max_acceleration }
    }

    /// Whether it is on its way.
    pub fn is_moving(&self) -> bool {
        self.velocity != 0.0 || self.position != self.goal
    }

    /// Where it comes to rest at the soonest.
    pub fn stopping_point(&self) -> f64 {
        self.position + self.velocity * self.velocity.abs() / (2.0 * self.max_acceleration)
    }

    /// Decelerates from now on and holds where it comes to rest.
    pub fn brake(&mut self) {
        self.goal = self.stopping_point();
    }

    /// Stops dead: no torque, no motion.
    pub fn freeze(&mut self) {
        self.velocity = 0.0;
        self.goal = self.position;
    }

    /// Goes on for so many seconds. What moves is a sequence of stretches of constant acceleration; each is computed
    /// in closed form, so that the result does not depend on how finely time is cut.
    pub fn advance(&mut self, seconds: f64) {
        let mut left = seconds;
        // Brake, turn round, accelerate, cruise, decelerate: five stretches at most, and some for rounding.
        for _ in 0..12 {
            if !(left > 0.0 && self.is_moving()) {
                return;
            }
            left -= self.stretch(left);
        }
    }

    /// Goes through one stretch of constant acceleration, of at most so many seconds, and says how many it took.
    fn stretch(&mut self, left: f64) -> f64 {
        let (a, v_max) = (self.max_acceleration, self.max_velocity);
        // Towards the goal is positive, as seen from where braking now would end.
        let overshoot = self.stopping_point() - self.goal;
        let tolerance = ROUNDING * (1.0 + self.goal.abs());
        let (acceleration, duration) = if overshoot.abs() <= tolerance {
            // Decelerating now ends in the goal.
            let duration = self.velocity.abs() / a;
            if duration <= left {
                self.velocity = 0.0;
                self.position = self.goal;
                return duration;
            }
            (-a * self.velocity.signum(), duration)
        } else {
            let towards = -overshoot.signum();
            let speed = self.velocity * towards;
            if speed < 0.0 {
                // The wrong way, or past the point where braking ends in the goal: to rest first.
                (a * towards, -speed / a)
            } else if speed > v_max * (1.0 + ROUNDING) {
                (-a * towards, (speed - v_max) / a)
            } else {
                let distance = (self.goal - self.position) * towards;
                // The peak of a triangle that ends in the goal: v²/(2a) up from speed, and down to 0.
                let peak = (0.5 * speed * speed + a * distance).max(0.0).sqrt();
                if peak <= v_max {
                    (a * towards, ((peak - speed) / a).max(0.0))
                } else if speed < v_max * (1.0 - ROUNDING) {
                    (a * towards, (v_max - speed) / a)
                } else {
                    (0.0, ((distance - 0.5 * v_max * v_max / a) / v_max).max(0.0))
                }
            }
        };
        let t = duration.min(left);
        self.position += self.velocity * t + 0.5 * acceleration * t * t;
        self.velocity += acceleration * t;
        t
    }
}

#[cfg(test)]
mod tests {
    use super::Trapezoid;

    /// A triangle and a trapezoid of known length: t = 2 sqrt(d/a), and d/v + v/a.
    #[test]
    fn takes_the_time_of_the_textbook() {
        for (distance, time) in [(0.25, 2.0 * f64::sqrt(0.25 / 2.0)), (3.0, 3.0 + 0.5)] {
            for cuts in [1, 7, 1000] {
                let mut motor = Trapezoid { goal: distance, ..Trapezoid::at(0.0, 1.0, 2.0) };
                for _ in 0..cuts {
                    assert!(motor.is_moving());
                    motor.advance(time / f64::from(cuts) * (1.0 - 1e-9));
                }
                assert!(motor.is_moving() && (motor.position - distance).abs() < 1e-6, "{motor:?}");
                motor.advance(1e-6);
                assert!(!motor.is_moving() && motor.position == distance, "{motor:?}");
            }
        }
    }

    /// Where it is on the way does not depend on how often it is asked.
    #[test]
    fn one_step_is_as_good_as_many() {
        let start = Trapezoid { goal: 1000.0, ..Trapezoid::at(1.0 / 3.0, 157.893_97, 40_000.0) };
        for time in [0.001, 0.003, 0.1, 0.25, 2.0, 6.33, 6.335, 7.0] {
            let (mut once, mut often) = (start, start);
            once.advance(time);
            (0..1000).for_each(|_| often.advance(time / 1000.0));
            assert!((once.position - often.position).abs() < 1e-6, "{time}: {once:?} {often:?}");
            let fastest = start.position + time * start.max_velocity;
            assert!(once.position <= fastest + 1e-6, "{time}: {once:?}");
        }
    }

    /// A goal behind it, and a brake, at full speed: it never goes faster or brakes harder than it can, and ends there.
    #[test]
    fn turns_round_and_brakes_within_its_means() {
        for goal in [-1.0, 0.9, 1.05, 5.0, f64::NAN] {
            let mut motor = Trapezoid { goal: 10.0, ..Trapezoid::at(0.0, 1.0, 2.0) };
            motor.advance(1.25);
            assert!((motor.velocity - 1.0).abs() < 1e-12 && (motor.position - 1.0).abs() < 1e-12);
            if goal.is_nan() {
                motor.brake();
            } else {
                motor.goal = goal;
            }
            let expected = if goal.is_nan() { 1.25 } else { goal };
            for _ in 0..10_000 {
                let before = motor.velocity;
                motor.advance(1e-3);
                assert!((motor.velocity - before).abs() <= 2e-3 + 1e-9 && motor.velocity.abs() <= 1.0 + 1e-9);
            }
            assert!(!motor.is_moving() && (motor.position - expected).abs() < 1e-9, "{goal}: {motor:?}");
        }
    }
}
