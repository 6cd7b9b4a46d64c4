//! A table's kinematic content, read without the compiler: rows in SI, couplings as linear terms, base and tool.
//!
//! It reads correct tables only; what is wrong with a table is the compiler's to say.

use toml::de::{DeTable, DeValue};

use crate::double_double::DoubleDouble;
use crate::expression::{Quantity, Units, degree, evaluate, literal};
use crate::matrix::Matrix;

type Result<T> = std::result::Result<T, String>;

/// Which Denavit-Hartenberg convention the rows follow.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Convention {
    /// A = Rz(theta) Tz(d) Tx(a) Rx(alpha) Ry(beta).
    Standard,
    /// A = Tx(a) Rx(alpha) Ry(beta) Rz(theta) Tz(d).
    Modified,
}

/// One `[[joint]]`.
#[derive(Debug, Clone)]
pub struct Row {
    /// `name`, or J1, J2, ...
    pub name: String,
    /// Whether d varies, and not theta.
    pub prismatic: bool,
    /// rad
    pub theta: DoubleDouble,
    /// m
    pub d: DoubleDouble,
    /// m
    pub a: DoubleDouble,
    /// rad
    pub alpha: DoubleDouble,
    /// rad
    pub beta: DoubleDouble,
    /// What is added to theta or d: (index of q, coefficient in SI).
    pub terms: Vec<(usize, DoubleDouble)>,
    /// Index of the row's own q; none where it is held.
    pub variable: Option<usize>,
    /// Least and greatest q (rad or m).
    pub limits: Option<(f64, f64)>,
}

/// A robot.
#[derive(Debug, Clone)]
pub struct Chain {
    /// `convention`.
    pub convention: Convention,
    /// Units of the table.
    pub units: Units,
    /// Base to tip.
    pub rows: Vec<Row>,
    /// Rows with a q, in order.
    pub joints: Vec<usize>,
    /// `[base]`.
    pub base: Matrix,
    /// `[tool]`.
    pub tool: Matrix,
    /// `[poses]`, in SI.
    pub poses: Vec<(String, Vec<f64>)>,
}

/// An entry of a table, without its span.
fn get<'t, 'i>(table: &'t DeTable<'i>, key: &str) -> Option<&'t DeValue<'i>> {
    table.get(key).map(toml::Spanned::get_ref)
}

fn number(value: &DeValue<'_>, quantity: Quantity, units: &Units) -> Result<DoubleDouble> {
    let unit = units.of(quantity);
    let plain = |text: &str| literal(text).map(|x| x * unit).ok_or_else(|| format!("`{text}`"));
    let value = match value {
        DeValue::Integer(integer) => plain(integer.as_str())?,
        DeValue::Float(float) => plain(float.as_str())?,
        DeValue::String(text) => evaluate(text, quantity, units)?,
        _ => return Err("not a number".to_owned()),
    };
    Ok(if quantity == Quantity::Angle { exact_angle(value) } else { value })
}

/// Multiples of 15 degrees to within 1e-12 rad are meant exactly.
fn exact_angle(angle: DoubleDouble) -> DoubleDouble {
    let fifteen = degree() * DoubleDouble::from(15.0);
    let exact = fifteen * DoubleDouble::from((angle / fifteen).to_f64().round());
    if (angle - exact).to_f64().abs() <= 1e-12 { exact } else { angle }
}

fn numbers<const N: usize>(
    value: &DeValue<'_>,
    quantity: Quantity,
    units: &Units,
) -> Result<[DoubleDouble; N]> {
    let array = value.as_array().ok_or("not an array")?;
    let values: Vec<_> = array.iter().map(|v| number(v.get_ref(), quantity, units)).collect::<Result<_>>()?;
    values.try_into().map_err(|_| format!("not {N} numbers"))
}

fn placement(table: &DeTable<'_>, key: &str, units: &Units) -> Result<Matrix> {
    let Some(frame) = get(table, key).and_then(DeValue::as_table) else { return Ok(Matrix::identity()) };
    let mut matrix = Matrix::identity();
    if let Some(xyz) = get(frame, "xyz") {
        matrix = Matrix::translation(numbers(xyz, Quantity::Length, units)?);
    }
    if let Some(rpy) = get(frame, "rpy") {
        let [roll, pitch, yaw] = numbers(rpy, Quantity::Angle, units)?;
        for (axis, angle) in [(2, yaw), (1, pitch), (0, roll)] {
            matrix = matrix.times(&Matrix::rotation(axis, angle));
        }
    }
    if let Some(quaternion) = get(frame, "quaternion") {
        matrix = matrix.times(&Matrix::quaternion(numbers(quaternion, Quantity::Ratio, units)?));
    }
    Ok(matrix)
}

fn units(robot: &DeTable<'_>) -> Result<Units> {
    let given = get(robot, "units").and_then(DeValue::as_table);
    let unit = |key| given.and_then(|units| get(units, key)).and_then(DeValue::as_str);
    Ok(Units {
        length: match unit("length") {
            None | Some("m") => DoubleDouble::ONE,
            Some("mm") => DoubleDouble::ONE / DoubleDouble::from(1000.0),
            Some(other) => return Err(format!("unit `{other}`")),
        },
        angle: match unit("angle") {
            None | Some("rad") => DoubleDouble::ONE,
            Some("deg") => degree(),
            Some(other) => return Err(format!("unit `{other}`")),
        },
    })
}

impl Row {
    /// What q of this row measures.
    pub fn quantity(&self) -> Quantity {
        if self.prismatic { Quantity::Length } else { Quantity::Angle }
    }

    fn read(entry: &DeTable<'_>, index: usize, joints: &mut Vec<usize>, units: &Units) -> Result<Self> {
        let prismatic = get(entry, "type").and_then(DeValue::as_str) == Some("prismatic");
        let variable = get(entry, "fixed").is_none().then(|| {
            joints.push(index);
            joints.len() - 1
        });
        let optional =
            |key, quantity| get(entry, key).map_or(Ok(DoubleDouble::ZERO), |v| number(v, quantity, units));
        let quantity = if prismatic { Quantity::Length } else { Quantity::Angle };
        let at_zero = optional(if variable.is_some() { "offset" } else { "fixed" }, quantity)?;
        let limits = match get(entry, "limits") {
            None => None,
            Some(value) => {
                let [min, max] = numbers(value, quantity, units)?;
                Some((min.to_f64(), max.to_f64()))
            }
        };
        let direction =
            get(entry, "direction").map_or(Ok(DoubleDouble::ONE), |v| number(v, Quantity::Ratio, units))?;
        Ok(Self {
            name: get(entry, "name")
                .and_then(DeValue::as_str)
                .map_or(format!("J{}", index + 1), str::to_owned),
            prismatic,
            theta: if prismatic { optional("theta", Quantity::Angle)? } else { at_zero },
            d: if prismatic { at_zero } else { optional("d", Quantity::Length)? },
            a: optional("a", Quantity::Length)?,
            alpha: optional("alpha", Quantity::Angle)?,
            beta: optional("beta", Quantity::Angle)?,
            terms: variable.map(|q| (q, direction)).into_iter().collect(),
            variable,
            limits,
        })
    }
}

impl Chain {
    /// The kinematic content of a table.
    ///
    /// # Errors
    /// What is wrong with the text.
    pub fn read(text: &str) -> Result<Self> {
        let table = DeTable::parse(text).map_err(|error| error.to_string())?;
        let table = table.get_ref();
        let robot = get(table, "robot").and_then(DeValue::as_table).ok_or("no [robot]")?;
        let units = units(robot)?;
        let convention = match get(robot, "convention").and_then(DeValue::as_str) {
            Some("standard") => Convention::Standard,
            Some("modified") => Convention::Modified,
            other => return Err(format!("convention {other:?}")),
        };
        let entries = get(table, "joint").and_then(DeValue::as_array).ok_or("no [[joint]]")?;
        let entries: Vec<_> = entries.iter().filter_map(|entry| entry.get_ref().as_table()).collect();
        let mut joints = Vec::new();
        let mut rows = Vec::new();
        for (index, entry) in entries.iter().enumerate() {
            rows.push(Row::read(entry, index, &mut joints, &units)?);
        }
        for (index, entry) in entries.iter().enumerate() {
            let terms = couplings(entry, index, &rows, &units)?;
            rows[index].terms.extend(terms);
        }
        let poses = poses(table, &rows, &joints, &units)?;
        let base = placement(table, "base", &units)?;
        let tool = placement(table, "tool", &units)?;
        Ok(Self { convention, units, rows, joints, base, tool, poses })
    }

    /// How many joint variables there are.
    pub fn dof(&self) -> usize {
        self.joints.len()
    }
}

/// `couple = { J2 = -1 }`: table units of this row's variable for one table unit of the other's.
fn couplings(
    entry: &DeTable<'_>,
    index: usize,
    rows: &[Row],
    units: &Units,
) -> Result<Vec<(usize, DoubleDouble)>> {
    let Some(couple) = get(entry, "couple").and_then(DeValue::as_table) else { return Ok(Vec::new()) };
    let mut terms = Vec::new();
    for (name, value) in couple {
        let other = rows.iter().find(|row| row.name == *name.get_ref()).ok_or("a coupling to no joint")?;
        let variable = other.variable.ok_or("a coupling to a held joint")?;
        let factor = number(value.get_ref(), Quantity::Ratio, units)?;
        let unit = units.of(rows[index].quantity()) / units.of(other.quantity());
        terms.push((variable, factor * unit));
    }
    Ok(terms)
}

fn poses(
    table: &DeTable<'_>,
    rows: &[Row],
    joints: &[usize],
    units: &Units,
) -> Result<Vec<(String, Vec<f64>)>> {
    let Some(entries) = get(table, "poses").and_then(DeValue::as_table) else { return Ok(Vec::new()) };
    let mut poses = Vec::new();
    for (name, value) in entries {
        let value = value.get_ref();
        let q = value.as_table().and_then(|pose| get(pose, "q")).unwrap_or(value);
        let q = q.as_array().ok_or("a pose that is no array")?;
        if q.len() != joints.len() {
            return Err(format!("pose `{}` has {} numbers", name.get_ref(), q.len()));
        }
        let q =
            q.iter().zip(joints).map(|(value, &row)| number(value.get_ref(), rows[row].quantity(), units));
        let q: Vec<_> = q.map(|value| value.map(DoubleDouble::to_f64)).collect::<Result<_>>()?;
        poses.push((name.get_ref().to_string(), q));
    }
    Ok(poses)
}
