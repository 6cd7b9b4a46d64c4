//! A hash of everything in a table that changes what is computed or sent.
//!
//! FNV-1a over the values in the order of the model's fields, each list led by its length: comments, layout, order of
//! keys and units don't matter, since the values are in SI. Texts that only describe (the robot's name, its maker, its
//! source) don't count; names that requests use do.

use super::{Angle, Convention, JointKind, Limits, Linear, Model, Placement, Rotation, Row, Servo};

/// The fingerprint of a model.
pub(super) fn of(model: &Model) -> u64 {
    let mut hash = Hash(0xcbf2_9ce4_8422_2325);
    hash.number(match model.convention {
        Convention::Standard => 1,
        Convention::Modified => 2,
    });
    hash.list(&model.rows, Hash::row);
    for placement in [&model.base, &model.tool] {
        hash.placement(placement);
    }
    hash.list(&model.workspace.bounds, |hash, bound| {
        hash.number(2 * bound.axis + usize::from(bound.is_min));
        hash.value(bound.value);
    });
    hash.list(&model.workspace.keep_out, |hash, forbidden| {
        for value in forbidden.min.iter().chain(&forbidden.max) {
            hash.value(*value);
        }
    });
    hash.list(&model.sums, |hash, sum| {
        hash.terms(&sum.terms);
        hash.limits(&sum.range);
    });
    hash.list(&model.poses, |hash, pose| {
        hash.text(&pose.name);
        hash.list(&pose.q, |hash, value| hash.value(*value));
        hash.number(usize::from(pose.safe));
    });
    hash.list(&model.problems, |hash, problem| {
        hash.text(&problem.name);
        hash.text(problem.target.name());
        hash.list(&problem.constraints, Hash::linear);
        hash.list(&problem.filters, |hash, filter| {
            hash.linear(&filter.form);
            hash.terms(&filter.q);
            hash.number(usize::from(filter.strict));
        });
        hash.list(&problem.free, |hash, joint| hash.number(*joint));
    });
    hash.list(&model.servos, |hash, named| {
        hash.text(&named.name);
        hash.servo(&named.servo);
    });
    hash.option(model.device.as_ref(), |hash, device| {
        hash.text(&device.driver);
        let mut keys: Vec<_> = device.keys.iter().collect();
        keys.sort();
        hash.list(&keys, |hash, (key, value)| {
            hash.text(key);
            hash.text(value);
        });
    });
    hash.0
}

struct Hash(u64);

impl Hash {
    fn bytes(&mut self, bytes: &[u8]) {
        for byte in bytes {
            self.0 = (self.0 ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3);
        }
    }

    fn number(&mut self, number: usize) {
        self.bytes(&(number as u64).to_le_bytes());
    }

    fn value(&mut self, value: f64) {
        // 0 and -0 are one length.
        self.bytes(&(value + 0.0).to_bits().to_le_bytes());
    }

    fn text(&mut self, text: &str) {
        self.number(text.len());
        self.bytes(text.as_bytes());
    }

    fn list<T>(&mut self, items: &[T], mut each: impl FnMut(&mut Hash, &T)) {
        self.number(items.len());
        for item in items {
            each(self, item);
        }
    }

    fn option<T>(&mut self, item: Option<T>, each: impl FnOnce(&mut Hash, T)) {
        self.number(usize::from(item.is_some()));
        if let Some(item) = item {
            each(self, item);
        }
    }

    fn row(&mut self, row: &Row) {
        self.text(&row.name);
        self.number(match row.kind {
            JointKind::Revolute => 1,
            JointKind::Prismatic => 2,
        });
        for value in [row.d, row.a, row.alpha.value, row.beta.value, row.theta.value] {
            self.value(value);
        }
        self.terms(&row.terms);
        self.option(row.variable, Hash::number);
        self.option(row.limits.as_ref(), Hash::limits);
        for rate in [row.max_velocity, row.max_acceleration, row.max_jerk] {
            self.option(rate, Hash::value);
        }
        self.option(row.servo.as_ref(), Hash::servo);
    }

    fn terms(&mut self, terms: &[(usize, f64)]) {
        self.list(terms, |hash, (index, coefficient)| {
            hash.number(*index);
            hash.value(*coefficient);
        });
    }

    fn limits(&mut self, limits: &Limits) {
        self.value(limits.min);
        self.value(limits.max);
    }

    fn linear(&mut self, form: &Linear) {
        self.terms(&form.terms);
        self.value(form.constant.value);
    }

    fn placement(&mut self, placement: &Placement) {
        for value in placement.xyz {
            self.value(value);
        }
        match &placement.rotation {
            Rotation::Rpy(angles) => {
                self.list(angles, |hash, angle: &Angle| hash.value(angle.value));
            }
            Rotation::Matrix(rows) => {
                self.list(rows.as_flattened(), |hash, value| hash.value(*value));
            }
        }
    }

    fn servo(&mut self, servo: &Servo) {
        self.option(servo.id, |hash, id| hash.number(id as usize));
        self.value(servo.scale);
        self.value(servo.zero);
        self.option(servo.range.as_ref(), Hash::limits);
        self.option(servo.model.as_deref(), Hash::text);
    }
}
