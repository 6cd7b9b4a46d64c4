//! One arm out of many: its servos' zeros and signs, in a file of its own.
//!
//! A table describes all arms of a kind, but no two are put together alike. What one arm has of its own is a small TOML
//! file that is given at run time and replaces the table's zeros and signs:
//!
//! ```toml
//! format = 1
//! robot = "Planar 2R"
//! fingerprint = "00f1e2d3c4b5a697"   # of the table that it was made for
//!
//! [[joint]]
//! name = "J1"
//! zero = 2051                        # what the servo says where q = 0
//! sign = 1                           # -1 where it counts against q
//! ```

use crate::driver::{DeviceJoint, JointMap};
use std::fmt;
use std::fmt::Write as _;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// The only format there is.
const FORMAT: i64 = 1;

/// How far what a servo counts between two poses may be from what the table says, as a part of it.
const SCALE_TOLERANCE: f64 = 0.05;

/// Zeros and signs of one arm.
#[derive(Debug, Clone, PartialEq)]
pub struct Unit {
    /// The name in the table that it was made for.
    pub robot: String,
    /// The fingerprint of that table.
    pub fingerprint: u64,
    /// One a joint of the table, in its order.
    pub joints: Vec<UnitJoint>,
}

/// Zero and sign of one joint's servo.
#[derive(Debug, Clone, PartialEq)]
pub struct UnitJoint {
    /// Its name in the table.
    pub name: String,
    /// Device value at q = 0.
    pub zero: f64,
    /// Whether the servo counts against q.
    pub reversed: bool,
}

/// What is wrong with a unit file, and where in it (1-based; none where it is the whole).
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct UnitError {
    /// Line and column.
    pub place: Option<(usize, usize)>,
    /// What is wrong and what to write instead.
    pub message: String,
}

/// Why no unit could be made of what was measured.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum CalibrationError {
    /// There are too few or too many joint values.
    Length {
        /// How many joints there are.
        expected: usize,
        /// How many values were given.
        got: usize,
    },
    /// Between two poses the servo has counted something else than the table says.
    Scale {
        /// The joint.
        joint: String,
        /// By how much the device value should differ.
        expected: f64,
        /// By how much it does.
        measured: f64,
    },
}

impl Unit {
    /// Reads a unit file.
    ///
    /// # Errors
    /// The first thing that is wrong with it.
    pub fn parse(text: &str) -> Result<Self, UnitError> {
        let document = DeTable::parse(text).map_err(|error| {
            let place = error.span().map(|span| place(text, span.start));
            UnitError { place, message: error.message().to_owned() }
        })?;
        let file = Reader { text };
        let root = document.get_ref();
        file.only(root, &["format", "robot", "fingerprint", "joint"])?;
        if let Some(format) = root.get("format") {
            let known = file.number(format, "format")?;
            if known != FORMAT as f64 {
                return Err(
                    file.at(format, format!("format {known} is not known; write `format = {FORMAT}`"))
                );
            }
        }
        let robot = file.text(file.required(root, "robot", 0)?, "robot")?;
        let written = file.required(root, "fingerprint", 0)?;
        let fingerprint = u64::from_str_radix(&file.text(written, "fingerprint")?, 16).map_err(|_| {
            file.at(written, "`fingerprint` is 16 hexadecimal digits; dhc calibrate writes them".to_owned())
        })?;
        let joints = file.required(root, "joint", 0)?;
        let DeValue::Array(entries) = joints.get_ref() else {
            return Err(file.at(joints, "write one `[[joint]]` for every joint".to_owned()));
        };
        let joints = entries.iter().map(|entry| file.joint(entry)).collect::<Result<_, _>>()?;
        Ok(Self { robot, fingerprint, joints })
    }

    /// Puts the zeros and signs of this arm in the place of the table's.
    ///
    /// # Errors
    /// Where it was made for another table, or has other joints.
    pub fn apply(&self, map: &mut JointMap) -> Result<(), UnitError> {
        let refuse = |message: String| Err(UnitError { place: None, message });
        if self.fingerprint != map.fingerprint {
            return refuse(format!(
                "it was made for the table of {} with the fingerprint {:016x}, this one's is {:016x}; calibrate anew with \
                 `dhc calibrate`",
                self.robot, self.fingerprint, map.fingerprint
            ));
        }
        let names: Vec<&str> = map.joints.iter().map(|joint| joint.name.as_str()).collect();
        let ours: Vec<&str> = self.joints.iter().map(|joint| joint.name.as_str()).collect();
        if names != ours {
            return refuse(format!("it has the joints {}, the table {}", ours.join(", "), names.join(", ")));
        }
        for (joint, own) in map.joints.iter_mut().zip(&self.joints) {
            joint.zero = own.zero;
            joint.scale = if own.reversed { -joint.scale.abs() } else { joint.scale.abs() };
        }
        Ok(())
    }

    /// From an arm that was put into one pose, or into two of them one after the other: what its servos said there
    /// (device units) and the joint values of the poses (rad or m). One pose gives the zeros; with a second one, the
    /// signs of those joints that differ between the two. Everything else is as in the map.
    ///
    /// # Errors
    /// Where a servo has counted something else between the poses than the map says.
    pub fn measured(
        robot: &str,
        map: &JointMap,
        (q, device): (&[f64], &[f64]),
        second: Option<(&[f64], &[f64])>,
    ) -> Result<Self, CalibrationError> {
        let lists = [Some(q), Some(device), second.map(|(q, _)| q), second.map(|(_, device)| device)];
        if let Some(wrong) = lists.into_iter().flatten().find(|list| list.len() != map.len()) {
            return Err(CalibrationError::Length { expected: map.len(), got: wrong.len() });
        }
        let mut joints = Vec::new();
        for (index, (joint, (q, device))) in map.joints.iter().zip(q.iter().zip(device)).enumerate() {
            let other = second.and_then(|(q, device)| Some((q.get(index)?, device.get(index)?)));
            let scale = match other {
                Some((other, there)) => sign_of(joint, other - q, there - device)?,
                None => joint.scale,
            };
            joints.push(UnitJoint {
                name: joint.name.clone(),
                zero: device - scale * q,
                reversed: scale < 0.0,
            });
        }
        Ok(Self { robot: robot.to_owned(), fingerprint: map.fingerprint, joints })
    }

    /// The file.
    pub fn to_toml(&self) -> String {
        let mut text = format!(
            "# Servo zeros and signs of one arm, by dhc calibrate.\nformat = {FORMAT}\nrobot = {}\nfingerprint = \"{:016x}\"\n",
            quoted(&self.robot),
            self.fingerprint
        );
        for UnitJoint { name, zero, reversed } in &self.joints {
            let sign = if *reversed { -1 } else { 1 };
            // Writing to a string cannot fail. Adding 0 makes a positive zero of a negative one.
            let _ = write!(
                text,
                "\n[[joint]]\nname = {}\nzero = {:?}\nsign = {sign}\n",
                quoted(name),
                zero + 0.0
            );
        }
        text
    }
}

/// The scale of a joint with the sign that it was seen to have; as it was where the joint was not moved.
fn sign_of(joint: &DeviceJoint, turned: f64, counted: f64) -> Result<f64, CalibrationError> {
    let expected = joint.scale * turned;
    if turned == 0.0 {
        return Ok(joint.scale);
    }
    if (counted.abs() - expected.abs()).abs() > SCALE_TOLERANCE * expected.abs() {
        return Err(CalibrationError::Scale { joint: joint.name.clone(), expected, measured: counted });
    }
    Ok(joint.scale.abs() * (counted * turned).signum())
}

/// A TOML string.
fn quoted(text: &str) -> String {
    let mut quoted = String::from("\"");
    for c in text.chars() {
        match c {
            '"' | '\\' => quoted.extend(['\\', c]),
            c if c.is_control() => {
                let _ = write!(quoted, "\\u{:04X}", c as u32);
            }
            c => quoted.push(c),
        }
    }
    quoted.push('"');
    quoted
}

/// 1-based line and column of a byte.
fn place(text: &str, byte: usize) -> (usize, usize) {
    let before = text.get(..byte).unwrap_or(text);
    let start = before.rfind('\n').map_or(0, |newline| newline + 1);
    let column = before.get(start..).unwrap_or_default().chars().count() + 1;
    (before.matches('\n').count() + 1, column)
}

/// Reads the values of one file.
struct Reader<'t> {
    text: &'t str,
}

impl Reader<'_> {
    fn at(&self, value: &Spanned<DeValue<'_>>, message: String) -> UnitError {
        UnitError { place: Some(place(self.text, value.span().start)), message }
    }

    fn only(&self, table: &DeTable<'_>, known: &[&str]) -> Result<(), UnitError> {
        let unknown = table.keys().find(|key| !known.contains(&key.get_ref().as_ref()));
        unknown.map_or(Ok(()), |key| {
            let message = format!("unknown key `{}`; there are {}", key.get_ref(), known.join(", "));
            Err(UnitError { place: Some(place(self.text, key.span().start)), message })
        })
    }

    fn required<'d, 'i>(
        &self,
        table: &'d DeTable<'i>,
        key: &str,
        from: usize,
    ) -> Result<&'d Spanned<DeValue<'i>>, UnitError> {
        table.get(key).ok_or_else(|| UnitError {
            place: Some(place(self.text, from)),
            message: format!("`{key}` is missing"),
        })
    }

    fn text(&self, value: &Spanned<DeValue<'_>>, key: &str) -> Result<String, UnitError> {
        match value.get_ref() {
            DeValue::String(text) => Ok(text.clone().into_owned()),
            _ => Err(self.at(value, format!("`{key}` is a text: write it in quotation marks"))),
        }
    }

    fn number(&self, value: &Spanned<DeValue<'_>>, key: &str) -> Result<f64, UnitError> {
        let number = match value.get_ref() {
            // Other bases have other digits, but nobody writes a zero of a servo in them.
            DeValue::Integer(integer) if integer.radix() == 10 => integer.as_str().parse().ok(),
            DeValue::Float(float) => float.as_str().parse().ok(),
            _ => None,
        };
        let finite = number.filter(|number: &f64| number.is_finite());
        finite.ok_or_else(|| self.at(value, format!("`{key}` is a finite number")))
    }

    fn joint(&self, entry: &Spanned<DeValue<'_>>) -> Result<UnitJoint, UnitError> {
        let DeValue::Table(table) = entry.get_ref() else {
            return Err(self.at(entry, "write one `[[joint]]` for every joint".to_owned()));
        };
        self.only(table, &["name", "zero", "sign"])?;
        let required = |key| self.required(table, key, entry.span().start);
        let name = self.text(required("name")?, "name")?;
        let zero = self.number(required("zero")?, "zero")?;
        let written = required("sign")?;
        let sign = self.number(written, "sign")?;
        if sign.abs() != 1.0 {
            return Err(self.at(written, "`sign` is 1 or -1".to_owned()));
        }
        Ok(UnitJoint { name, zero, reversed: sign < 0.0 })
    }
}

impl fmt::Display for UnitError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.place {
            Some((line, column)) => write!(f, "{line}:{column}: {}", self.message),
            None => f.write_str(&self.message),
        }
    }
}

impl std::error::Error for UnitError {}

impl fmt::Display for CalibrationError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Length { expected, got } => write!(f, "{got} joint values where there are {expected}"),
            Self::Scale { joint, expected, measured } => write!(
                f,
                "between the two poses the servo of {joint} counted {measured:.1}; by the table it would be {:.1}",
                expected.abs()
            ),
        }
    }
}

impl std::error::Error for CalibrationError {}
