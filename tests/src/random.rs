//! Random tables: every way of the format to write a chain, and joint values to try it at.
//!
//! A strategy draws a `Spec`, small numbers that shrink well, and prints it as a table; the oracle reads that text
//! like anybody's.

use std::fmt::Write;

use proptest::prelude::*;

/// A table and joint values.
#[derive(Debug, Clone)]
pub struct RandomArm {
    /// TOML.
    pub text: String,
    /// rad or m, one a joint.
    pub q: Vec<f64>,
}

/// A length, in micrometres, and how to write it.
#[derive(Debug, Clone, Copy)]
struct Length(i32, Style);

/// An angle: a multiple of 15 degrees, or any number of thousandths of a degree.
#[derive(Debug, Clone, Copy)]
enum Angle {
    Fifteen(i32, Style),
    Any(i32, Style),
}

/// How a number is written.
#[derive(Debug, Clone, Copy)]
enum Style {
    /// In table units, without quotes where that is exact.
    Bare,
    /// With a unit of its own.
    Unit,
    /// As an expression.
    Expression,
}

#[derive(Debug, Clone)]
struct Row {
    prismatic: bool,
    held: bool,
    a: Length,
    alpha: Angle,
    beta: Option<Angle>,
    /// What does not vary: d of a revolute row, theta of a prismatic one.
    d: Length,
    theta: Angle,
    /// `offset` or `fixed`.
    offset: (Length, Angle),
    direction: Option<bool>,
    couple: Option<(prop::sample::Index, i32)>,
}

#[derive(Debug, Clone)]
enum Turn {
    None,
    Rpy([Angle; 3]),
    Quaternion([i32; 4]),
}

#[derive(Debug, Clone)]
struct Placement {
    xyz: [Length; 3],
    turn: Turn,
}

#[derive(Debug, Clone)]
struct Spec {
    convention: &'static str,
    millimetres: bool,
    degrees: bool,
    /// Couplings point to earlier rows, or all to later ones: never in a circle.
    later: bool,
    rows: Vec<Row>,
    base: Option<Placement>,
    tool: Option<Placement>,
}

fn style() -> impl Strategy<Value = Style> {
    prop_oneof![3 => Just(Style::Bare), 1 => Just(Style::Unit), 1 => Just(Style::Expression)]
}

fn length() -> impl Strategy<Value = Length> {
    let micrometres = prop_oneof![2 => Just(0), 3 => -600_000..600_000];
    (micrometres, style()).prop_map(|(length, style)| Length(length, style))
}

fn angle() -> impl Strategy<Value = Angle> {
    prop_oneof![
        1 => Just(Angle::Fifteen(0, Style::Bare)),
        3 => (-2..=2, style()).prop_map(|(quarters, style)| Angle::Fifteen(6 * quarters, style)),
        1 => (-12..=12, style()).prop_map(|(fifteenths, style)| Angle::Fifteen(fifteenths, style)),
        2 => (-180_000..180_000, style()).prop_map(|(angle, style)| Angle::Any(angle, style)),
    ]
}

fn row() -> impl Strategy<Value = Row> {
    let kind = (prop::bool::weighted(0.2), prop::bool::weighted(0.1), prop::option::of(any::<bool>()));
    let couple =
        prop::option::weighted(0.2, (any::<prop::sample::Index>(), prop_oneof![-2_000..2_000, Just(-1_000)]));
    let beta = prop::option::weighted(0.15, angle());
    (kind, length(), angle(), beta, length(), angle(), (length(), angle()), couple).prop_map(
        |((prismatic, held, direction), a, alpha, beta, d, theta, offset, couple)| Row {
            prismatic,
            held,
            a,
            alpha,
            beta,
            d,
            theta,
            offset,
            direction,
            couple,
        },
    )
}

fn placement() -> impl Strategy<Value = Placement> {
    let turn = prop_oneof![
        Just(Turn::None),
        [angle(), angle(), angle()].prop_map(Turn::Rpy),
        [-9..9, -9..9, -9..9, 1..9].prop_map(Turn::Quaternion),
    ];
    ([length(), length(), length()], turn).prop_map(|(xyz, turn)| Placement { xyz, turn })
}

fn spec() -> impl Strategy<Value = Spec> {
    let frame = || prop::option::weighted(0.4, placement());
    let rows = prop::collection::vec(row(), 1..=10);
    (any::<[bool; 4]>(), rows, frame(), frame()).prop_map(|(switches, mut rows, base, tool)| {
        let [modified, millimetres, degrees, later] = switches;
        // A robot has a joint.
        rows[0].held = false;
        let convention = if modified { "modified" } else { "standard" };
        Spec { convention, millimetres, degrees, later, rows, base, tool }
    })
}

impl Spec {
    fn length(&self, Length(micrometres, style): Length) -> String {
        let (mm, m) = (f64::from(micrometres) / 1e3, f64::from(micrometres) / 1e6);
        match (style, self.millimetres) {
            (Style::Bare, true) => format!("{mm}"),
            (Style::Bare, false) => format!("{m}"),
            (Style::Unit, true) => format!("\"{m} m\""),
            (Style::Unit, false) => format!("\"{mm} mm\""),
            (Style::Expression, true) => format!("\"-({micrometres} / 1e3) * (2 - 3)\""),
            (Style::Expression, false) => format!("\"{micrometres} / sqrt(1e12)\""),
        }
    }

    fn angle(&self, angle: Angle) -> String {
        match angle {
            Angle::Fifteen(0, Style::Bare) => "0".to_owned(),
            Angle::Fifteen(fifteenths, Style::Bare) if self.degrees => format!("{}", 15 * fifteenths),
            Angle::Fifteen(fifteenths, Style::Unit) => format!("\"{} deg\"", 15 * fifteenths),
            Angle::Fifteen(fifteenths, _) => format!("\"{fifteenths} * pi / 12\""),
            Angle::Any(thousandths, Style::Bare) if self.degrees => {
                format!("{}", f64::from(thousandths) / 1e3)
            }
            Angle::Any(thousandths, Style::Bare) => format!("{}", f64::from(thousandths) / 6e4),
            Angle::Any(thousandths, Style::Unit) => format!("\"{} deg\"", f64::from(thousandths) / 1e3),
            Angle::Any(thousandths, Style::Expression) => format!("\"atan2({thousandths}, 1e5) + pi/7\""),
        }
    }

    /// rad or m of one table unit of this row's variable.
    fn unit(&self, row: usize) -> f64 {
        match (self.rows[row].prismatic, self.millimetres, self.degrees) {
            (true, true, _) => 1e-3,
            (false, _, true) => 1_f64.to_radians(),
            _ => 1.0,
        }
    }

    fn joint(&self, text: &mut String, index: usize) -> std::fmt::Result {
        let row = &self.rows[index];
        let (offset_length, offset_angle) = row.offset;
        writeln!(text, "\n[[joint]]\na = {}\nalpha = {}", self.length(row.a), self.angle(row.alpha))?;
        if let Some(beta) = row.beta {
            writeln!(text, "beta = {}", self.angle(beta))?;
        }
        let at_zero = if row.prismatic {
            writeln!(text, "type = \"prismatic\"\ntheta = {}", self.angle(row.theta))?;
            self.length(offset_length)
        } else {
            writeln!(text, "d = {}", self.length(row.d))?;
            self.angle(offset_angle)
        };
        writeln!(text, "{} = {at_zero}", if row.held { "fixed" } else { "offset" })?;
        if let (Some(forward), false) = (row.direction, row.held) {
            writeln!(text, "direction = {}", if forward { 1 } else { -1 })?;
        }
        if let Some((pick, thousandths)) = row.couple {
            let span = if self.later { index + 1..self.rows.len() } else { 0..index };
            let others: Vec<usize> = span.filter(|&other| !self.rows[other].held).collect();
            if !others.is_empty() {
                let other = *pick.get(&others);
                // At most 2 rad, or m, for one of the other's: a joint that turns by hundreds tests the sine.
                let factor = f64::from(thousandths) / 1e3 * self.unit(other) / self.unit(index);
                writeln!(text, "couple = {{ J{} = {factor} }}", other + 1)?;
            }
        }
        Ok(())
    }

    fn placement(&self, text: &mut String, key: &str, placement: Option<&Placement>) -> std::fmt::Result {
        let Some(Placement { xyz, turn }) = placement else { return Ok(()) };
        let [x, y, z] = xyz.map(|length| self.length(length));
        writeln!(text, "\n[{key}]\nxyz = [{x}, {y}, {z}]")?;
        match turn {
            Turn::None => Ok(()),
            Turn::Rpy(rpy) => {
                let [roll, pitch, yaw] = rpy.map(|angle| self.angle(angle));
                writeln!(text, "rpy = [{roll}, {pitch}, {yaw}]")
            }
            Turn::Quaternion([x, y, z, w]) => writeln!(text, "quaternion = [{x}, {y}, {z}, {w}]"),
        }
    }

    fn print(&self, text: &mut String) -> std::fmt::Result {
        writeln!(text, "[robot]\nname = \"Random\"")?;
        let length = if self.millimetres { "mm" } else { "m" };
        let angle = if self.degrees { "deg" } else { "rad" };
        writeln!(text, "units = {{ length = \"{length}\", angle = \"{angle}\" }}")?;
        writeln!(text, "convention = \"{}\"", self.convention)?;
        (0..self.rows.len()).try_for_each(|index| self.joint(text, index))?;
        self.placement(text, "base", self.base.as_ref())?;
        self.placement(text, "tool", self.tool.as_ref())
    }

    /// `fractions` are in -1 ... 1: half a turn, or half a metre.
    fn arm(&self, fractions: &[f64]) -> RandomArm {
        let mut text = String::new();
        // Writing into a string cannot fail.
        let _ = self.print(&mut text);
        let joints = self.rows.iter().filter(|row| !row.held).zip(fractions);
        let scale = |row: &Row| if row.prismatic { 0.5 } else { std::f64::consts::PI };
        RandomArm { text, q: joints.map(|(row, x)| x * scale(row)).collect() }
    }
}

/// Any chain of one to ten rows: both conventions, revolute and prismatic joints, held rows, couplings, directions,
/// offsets, beta, both placements, all units and ways to write a number.
pub fn any_arm() -> impl Strategy<Value = RandomArm> {
    (spec(), prop::collection::vec(-1.0..=1.0, 10)).prop_map(|(spec, fractions)| spec.arm(&fractions))
}

/// An arm as calibration leaves it: axes 2, 3 and 4 nearly parallel, with offsets of up to kilometres that cancel.
pub fn calibrated_arm() -> impl Strategy<Value = RandomArm> {
    let exponents = [-5.5..-2.0, -5.5..-2.0];
    let shifts = [-0.04..0.04, -0.04..0.04, -0.1..0.1];
    (exponents, shifts, prop::array::uniform6(-1e-3..1e-3), prop::array::uniform6(-3.1..3.1)).prop_map(
        |(exponents, [shift2, shift3, d4], e, q)| {
            let [twist2, twist3] = exponents.map(|exponent| 10_f64.powf(exponent));
            // Sideways, an offset comes to its product with the twist: a few centimetres here.
            let d2 = shift2 / twist2;
            let d3 = shift3 / twist3 - d2;
            let d4 = d4 - (d2 + d3);
            let rows = [
                (0.0892 + e[0], e[1], std::f64::consts::FRAC_PI_2 + e[2], e[0]),
                (d2, -0.425 + e[3], twist2, e[1]),
                (d3, -0.392 + e[4], twist3, e[2]),
                (d4, e[5], std::f64::consts::FRAC_PI_2 + e[0], e[3]),
                (0.0947 + e[1], e[2], -std::f64::consts::FRAC_PI_2 + e[3], e[4]),
                (0.0823 + e[4], 0.0, 0.0, e[5]),
            ];
            let joints = rows.map(|(d, a, alpha, offset)| {
                format!("\n[[joint]]\nd = {d}\na = {a}\nalpha = {alpha}\noffset = {offset}\n")
            });
            RandomArm {
                text: format!(
                    "[robot]\nname = \"Calibrated\"\nconvention = \"standard\"\n{}",
                    joints.concat()
                ),
                q: q.to_vec(),
            }
        },
    )
}
