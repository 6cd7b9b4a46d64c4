//! What is left to find once the constraints are put into the chain.
//!
//! The value of every row (theta or d) becomes a linear form in as few of them as the constraints and couplings leave
//! free, and in those of the joints that the caller gives. Angles stay whole multiples of these, so that sums of them
//! are frequencies of a trigonometric polynomial.

use crate::model::{Angle, JointKind, Linear, Model, Row};

/// A constant of an elimination: an exact part in units of 15 degrees, and a rest in rad or m.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Offset {
    pub fifteenths: f64,
    pub rest: f64,
}

impl Offset {
    fn new(angle: Angle) -> Self {
        match angle.fifteenths {
            Some(fifteenths) => Self { fifteenths: f64::from(fifteenths), rest: 0.0 },
            None => Self { fifteenths: 0.0, rest: angle.value },
        }
    }

    fn add_scaled(self, other: Self, factor: f64) -> Self {
        Self {
            fifteenths: self.fifteenths + factor * other.fifteenths,
            rest: self.rest + factor * other.rest,
        }
    }

    /// rad or m
    pub(super) fn value(self) -> f64 {
        self.fifteenths * (std::f64::consts::PI / 12.0) + self.rest
    }

    /// Whole units of 15 degrees, and what is left (rad).
    pub(super) fn split(self) -> (i32, f64) {
        let whole = self.fifteenths.round();
        if (self.fifteenths - whole).abs() < 1e-9 { (whole as i32, self.rest) } else { (0, self.value()) }
    }
}

/// Value of a row: sum of multiples of the free variables, and a constant.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Form {
    /// One coefficient a free variable.
    pub coefficients: Vec<f64>,
    /// rad or m
    pub offset: Offset,
}

/// A free variable.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Free {
    /// The row that it is a multiple of.
    pub row: usize,
    /// An angle or a length.
    pub kind: JointKind,
    /// Where the caller gives it.
    pub given: Option<Given>,
}

/// A joint that the caller gives. Its variable is what the joint adds to its own row, with the row's value at zero:
/// the row's theta or d, unless other joints are coupled to it too.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Given {
    /// Its place among the values that the caller gives.
    pub place: usize,
    /// Index of q.
    pub joint: usize,
    /// variable = factor * q + `at_zero`
    pub factor: f64,
    /// rad or m
    pub at_zero: Offset,
}

/// All rows in terms of the free ones.
#[derive(Debug, Clone)]
pub(super) struct Unknowns {
    /// The free variables, base to tip; those that are given last.
    pub free: Vec<Free>,
    /// theta (or d) of every row of the table.
    pub rows: Vec<Form>,
    /// Every joint variable.
    pub joints: Vec<Form>,
}

impl Unknowns {
    /// A form's constant, with what the given variables are where their joints are at 0.
    pub(super) fn constant(&self, form: &Form) -> Offset {
        let given = self.free.iter().zip(&form.coefficients).filter_map(|(free, k)| Some((free.given?, *k)));
        given.fold(form.offset, |sum, (given, k)| sum.add_scaled(given.at_zero, k))
    }

    /// The rows with none of the variables given and all of them base to tip, and which of these each was.
    pub(super) fn base_to_tip(&self) -> (Self, Vec<usize>) {
        let mut order: Vec<usize> = (0..self.free.len()).collect();
        order.sort_by_key(|index| self.free.get(*index).map(|free| free.row));
        let free = order.iter().filter_map(|index| self.free.get(*index));
        let free = free.map(|free| Free { given: None, ..*free }).collect();
        let form = |form: &Form| Form {
            coefficients: order.iter().filter_map(|index| form.coefficients.get(*index).copied()).collect(),
            offset: form.offset,
        };
        let rows = self.rows.iter().map(form).collect();
        (Self { free, rows, joints: Vec::new() }, order)
    }

    /// How many there are that the caller doesn't give.
    pub(super) fn to_find(&self) -> usize {
        self.free.iter().filter(|free| free.given.is_none()).count()
    }

    /// What the caller gives.
    pub(super) fn given(&self) -> impl Iterator<Item = (Free, Given)> {
        self.free.iter().filter_map(|free| free.given.map(|given| (*free, given)))
    }
}

/// Why the constraints can't be put into the chain.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Trouble {
    /// An angle that follows a length, or a length that follows an angle.
    MixedKinds {
        /// Which row of the table.
        row: usize,
        /// The row that it follows.
        leader: usize,
    },
    /// A row that follows by a fraction, or by too large a multiple.
    Fraction,
}

/// Largest multiple by which a row may follow another.
const LARGEST_MULTIPLE: f64 = 64.0;

/// Eliminates what couplings and constraints determine, `given` being the joints (indices of q) that the caller gives.
/// Angles are whole multiples of the free ones.
pub(super) fn eliminate(model: &Model, constraints: &[Linear], given: &[usize]) -> Result<Unknowns, Trouble> {
    let unknowns = eliminate_any(model, constraints, given)?;
    if whole_multiples(&unknowns) { Ok(unknowns) } else { Err(Trouble::Fraction) }
}

/// The same whatever the multiples.
pub(super) fn eliminate_any(
    model: &Model,
    constraints: &[Linear],
    given: &[usize],
) -> Result<Unknowns, Trouble> {
    let rows = model.rows.len();
    let given: Vec<Free> =
        given.iter().enumerate().filter_map(|(place, joint)| Free::given(model, place, *joint)).collect();
    // Columns: the rows' values, then the given variables.
    let count = rows + given.len();
    let joints = joints_by_rows(model, count);
    // Rows of sum = 0: coefficients of the rows' values, and the constant.
    let mut system: Vec<Form> = Vec::new();
    for (index, row) in model.rows.iter().enumerate().filter(|(_, row)| row.variable.is_none()) {
        let mut form = Form { coefficients: vec![0.0; count], offset: at_zero(row) };
        for &(joint, factor) in &row.terms {
            if let Some(joint) = joints.get(joint) {
                form = plus(&form, joint, factor);
            }
        }
        if let Some(own) = form.coefficients.get_mut(index) {
            *own -= 1.0;
        }
        system.push(form);
    }
    for constraint in constraints {
        let mut form = Form {
            coefficients: vec![0.0; count],
            offset: Offset::default().add_scaled(Offset::new(constraint.constant), -1.0),
        };
        for &(row, factor) in &constraint.terms {
            if let Some(own) = form.coefficients.get_mut(row) {
                *own += factor;
            }
        }
        system.push(form);
    }
    for (index, free) in given.iter().enumerate() {
        // factor * q + value at zero - variable = 0, q by the rows' values.
        let (Some(Given { joint, factor, at_zero, .. }), zero) = (free.given, unit(rows + index, count))
        else {
            continue;
        };
        let mut form = plus(&zero_like(&zero), &zero, -1.0);
        form.offset = at_zero;
        if let Some(joint) = joints.get(joint) {
            form = plus(&form, joint, factor);
        }
        system.push(form);
    }
    let solved = reduce(system, rows);
    in_free(model, &solved, &joints, given)
}

impl Free {
    fn given(model: &Model, place: usize, joint: usize) -> Option<Self> {
        let row = *model.joints.get(joint)?;
        let data = model.rows.get(row)?;
        let factor = data.terms.iter().find(|(index, _)| *index == joint).map_or(1.0, |(_, factor)| *factor);
        let given = Given { place, joint, factor, at_zero: at_zero(data) };
        Some(Self { row, kind: data.kind, given: Some(given) })
    }
}

/// theta or d of a row where all joints are at 0.
fn at_zero(row: &Row) -> Offset {
    match row.kind {
        JointKind::Revolute => Offset::new(row.theta),
        JointKind::Prismatic => Offset { fifteenths: 0.0, rest: row.d },
    }
}

/// q of every joint in terms of the rows' values, the first of `width` columns: the inverse of the coupling matrix.
fn joints_by_rows(model: &Model, width: usize) -> Vec<Form> {
    let count = model.joints.len();
    // Rows of: sum of coupling * q - value + offset = 0, the unknowns being q first, then the values.
    let mut rows: Vec<(Vec<f64>, Form)> = Vec::new();
    for &row in &model.joints {
        let Some(data) = model.rows.get(row) else { continue };
        let mut left = vec![0.0; count];
        for &(joint, factor) in &data.terms {
            if let Some(entry) = left.get_mut(joint) {
                *entry += factor;
            }
        }
        let mut right = Form {
            coefficients: vec![0.0; width],
            offset: Offset::default().add_scaled(at_zero(data), -1.0),
        };
        if let Some(entry) = right.coefficients.get_mut(row) {
            *entry = 1.0;
        }
        rows.push((left, right));
    }
    for pivot in 0..rows.len() {
        let size = |row: &(Vec<f64>, Form)| row.0.get(pivot).map_or(0.0, |x| x.abs());
        let best = (pivot..rows.len()).max_by(|a, b| {
            let (a, b) = (rows.get(*a).map_or(0.0, size), rows.get(*b).map_or(0.0, size));
            a.total_cmp(&b)
        });
        rows.swap(pivot, best.unwrap_or(pivot));
        let Some((left, right)) = rows.get(pivot).cloned() else { continue };
        let own = left.get(pivot).copied().unwrap_or(1.0);
        let (left, right): (Vec<f64>, Form) =
            (left.iter().map(|x| x / own).collect(), plus(&zero_like(&right), &right, 1.0 / own));
        for (index, row) in rows.iter_mut().enumerate() {
            let factor = if index == pivot { 0.0 } else { -row.0.get(pivot).copied().unwrap_or(0.0) };
            if index == pivot {
                *row = (left.clone(), right.clone());
            } else if factor != 0.0 {
                row.0.iter_mut().zip(&left).for_each(|(x, y)| *x += factor * y);
                row.1 = plus(&row.1, &right, factor);
            }
        }
    }
    rows.into_iter().map(|(_, right)| right).collect()
}

/// Gauss-Jordan elimination; the result says each determined row's value in terms of the others and of what is given.
fn reduce(mut system: Vec<Form>, rows: usize) -> Vec<Option<Form>> {
    let mut solved: Vec<Option<Form>> = vec![None; rows];
    while let Some(form) = system.pop() {
        let Some(pivot) = pivot(&form, rows) else { continue };
        let own = form.coefficients.get(pivot).copied().unwrap_or(1.0);
        let mut value = plus(&zero_like(&form), &form, -1.0 / own);
        if let Some(entry) = value.coefficients.get_mut(pivot) {
            *entry = 0.0;
        }
        let insert = |other: &mut Form| {
            let factor = other.coefficients.get(pivot).copied().unwrap_or(0.0);
            if factor != 0.0 {
                if let Some(entry) = other.coefficients.get_mut(pivot) {
                    *entry = 0.0;
                }
                *other = plus(other, &value, factor);
            }
        };
        system.iter_mut().for_each(insert);
        solved.iter_mut().flatten().for_each(insert);
        if let Some(place) = solved.get_mut(pivot) {
            *place = Some(value);
        }
    }
    solved
}

/// The row to express by the others: the last one by which all coefficients are whole multiples, else the one with
/// the greatest coefficient.
fn pivot(form: &Form, rows: usize) -> Option<usize> {
    let columns = || form.coefficients.iter().enumerate().filter(|(_, x)| x.abs() > 1e-12);
    let present = || columns().filter(|(index, _)| *index < rows);
    let whole = |own: f64| columns().all(|(_, x)| (x / own).fract() == 0.0);
    let last = present().filter(|(_, own)| whole(**own)).map(|(index, _)| index).next_back();
    last.or_else(|| present().max_by(|a, b| a.1.abs().total_cmp(&b.1.abs())).map(|(index, _)| index))
}

fn in_free(
    model: &Model,
    solved: &[Option<Form>],
    joints: &[Form],
    given: Vec<Free>,
) -> Result<Unknowns, Trouble> {
    let width = model.rows.len() + given.len();
    let unknown = model.rows.iter().enumerate().filter(|(row, _)| matches!(solved.get(*row), Some(None)));
    let mut free: Vec<Free> = unknown.map(|(row, data)| Free { row, kind: data.kind, given: None }).collect();
    let columns: Vec<usize> = free.iter().map(|free| free.row).chain(model.rows.len()..width).collect();
    free.extend(given);
    let by_free = |form: &Form| Form {
        coefficients: columns
            .iter()
            .map(|column| form.coefficients.get(*column).copied().unwrap_or(0.0))
            .collect(),
        offset: form.offset,
    };
    let mut rows: Vec<Form> = Vec::new();
    for (index, data) in model.rows.iter().enumerate() {
        let form = match solved.get(index) {
            Some(Some(form)) => by_free(form),
            _ => by_free(&unit(index, width)),
        };
        let mut leaders = form.coefficients.iter().zip(&free);
        if let Some((_, other)) = leaders.find(|(x, free)| **x != 0.0 && free.kind != data.kind) {
            return Err(Trouble::MixedKinds { row: index, leader: other.row });
        }
        rows.push(form);
    }
    let mut unknowns = Unknowns { free, rows, joints: Vec::new() };
    unknowns.joints = joints.iter().map(|joint| combine(joint, &unknowns.rows)).collect();
    Ok(unknowns)
}

/// Whether every angle is a small whole multiple of the free ones. By a fraction of a turn a joint would follow whole
/// turns of another, and q in (-pi, pi] would no longer say which.
fn whole_multiples(unknowns: &Unknowns) -> bool {
    let angles = unknowns.free.iter().enumerate().filter(|(_, free)| free.kind == JointKind::Revolute);
    let small = |x: f64| (x - x.round()).abs() < 1e-12 && x.abs() <= LARGEST_MULTIPLE;
    let mut uses = angles.flat_map(|(index, _)| {
        unknowns.rows.iter().filter_map(move |row| row.coefficients.get(index).copied())
    });
    uses.all(small)
}

/// A linear form in the rows' values, in terms of the free variables.
pub(super) fn combine(form: &Form, rows: &[Form]) -> Form {
    let width = rows.first().map_or(0, |row| row.coefficients.len());
    let mut sum = Form { coefficients: vec![0.0; width], offset: form.offset };
    for (factor, row) in form.coefficients.iter().zip(rows).filter(|(factor, _)| **factor != 0.0) {
        sum = plus(&sum, row, *factor);
    }
    sum
}

fn plus(a: &Form, b: &Form, factor: f64) -> Form {
    Form {
        coefficients: a.coefficients.iter().zip(&b.coefficients).map(|(x, y)| x + factor * y).collect(),
        offset: a.offset.add_scaled(b.offset, factor),
    }
}

fn zero_like(form: &Form) -> Form {
    Form { coefficients: vec![0.0; form.coefficients.len()], offset: Offset::default() }
}

fn unit(at: usize, count: usize) -> Form {
    let mut form = Form { coefficients: vec![0.0; count], offset: Offset::default() };
    if let Some(entry) = form.coefficients.get_mut(at) {
        *entry = 1.0;
    }
    form
}
