//! Paths of targets in space: straight lines, and curves through points.

use super::spline::Spline;
use dh_runtime::{Frame, Target, TargetKind};

/// How much turning counts as one metre of the way (rad): a path that only turns the hand has a length, too.
const TURN_PER_METRE: f64 = 10.0;

/// A smooth path of targets of one kind, by the way that was made along it (m; where the hand turns more than it
/// travels, the way is the turn, a radian for a tenth of a metre).
#[derive(Debug, Clone)]
pub(super) struct Path {
    kind: TargetKind,
    shape: Shape,
}

/// Targets as points of a space in which they can be interpolated: see [`coordinates`].
#[derive(Debug, Clone)]
enum Shape {
    /// From one point to another, at constant speed; great circles where the coordinates are directions.
    Line { from: Vec<f64>, to: Vec<f64>, length: f64 },
    /// Through points.
    Curve(Spline),
}

/// Why there is no path.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum NoPath {
    /// Targets of different kinds, the second of which is the wrong one.
    Kind(TargetKind),
    /// The ends are opposite: there is no shortest way to turn.
    HalfTurn,
}

impl Path {
    /// From `start` straight to `goal`; turns go the short way.
    pub(super) fn line(start: &Target, goal: &Target) -> Result<Self, NoPath> {
        let points = chain(start, std::slice::from_ref(goal))?;
        let (Some(from), Some(to)) = (points.first().cloned(), points.last().cloned()) else {
            return Err(NoPath::Kind(goal.kind()));
        };
        let length = distance(start.kind(), &from, &to);
        Ok(Self { kind: start.kind(), shape: Shape::Line { from, to, length } })
    }

    /// From `start` smoothly through all points to the last.
    pub(super) fn curve(start: &Target, through: &[Target]) -> Result<Self, NoPath> {
        let kind = start.kind();
        let (mut knots, mut values): (Vec<f64>, Vec<Vec<f64>>) = (Vec::new(), Vec::new());
        for point in chain(start, through)? {
            let way = match (knots.last(), values.last()) {
                (Some(knot), Some(before)) => knot + distance(kind, before, &point),
                _ => 0.0,
            };
            // A point twice in a row is one.
            if knots.last().is_none_or(|knot| way > *knot) {
                knots.push(way);
                values.push(point);
            }
        }
        match (Spline::through(knots, values), through.last()) {
            (Some(spline), _) => Ok(Self { kind, shape: Shape::Curve(spline) }),
            (None, Some(goal)) => Self::line(start, goal),
            (None, None) => Self::line(start, start),
        }
    }

    /// From start to end (m).
    pub(super) fn length(&self) -> f64 {
        match &self.shape {
            Shape::Line { length, .. } => *length,
            Shape::Curve(spline) => spline.end(),
        }
    }

    /// The target after so much of the way.
    pub(super) fn at(&self, way: f64) -> Target {
        let coordinates = match &self.shape {
            Shape::Line { from, to, length } => {
                let part = if *length > 0.0 { (way / length).clamp(0.0, 1.0) } else { 1.0 };
                between(self.kind, from, to, part)
            }
            Shape::Curve(spline) => spline.at(way).value,
        };
        target(self.kind, &coordinates)
    }
}

/// The target of a kind that a tool frame fulfils; of those that it fulfils of a kind that leaves a choice, the one
/// nearest to `goal`.
pub(super) fn of_tool(kind: TargetKind, tool: &Frame, goal: &Target) -> Target {
    let position = tool.translation;
    let [x, y, _] = position;
    let [ax, ay, _] = tool.x_axis();
    let (direction, yaw) = (tool.z_axis(), ay.atan2(ax));
    // The foot of the perpendicular from a point onto the tool's axis.
    let foot = |point: [f64; 3]| {
        let along: f64 = (0..3).map(|i| (point[i] - position[i]) * direction[i]).sum();
        [0, 1, 2].map(|i| position[i] + along * direction[i])
    };
    match (kind, goal) {
        (TargetKind::Pose, _) => Target::Pose(*tool),
        (TargetKind::Position, _) => Target::Position(position),
        (TargetKind::PositionDirection, _) => Target::PositionDirection { position, direction },
        (TargetKind::PositionYaw, _) => Target::PositionYaw { position, yaw },
        (TargetKind::Rotation, _) => Target::Rotation(tool.rotation),
        (TargetKind::Direction, _) => Target::Direction(direction),
        (TargetKind::Ray, Target::Ray { position: goal, .. }) => {
            Target::Ray { position: foot(*goal), direction }
        }
        (TargetKind::Ray, _) => Target::Ray { position, direction },
        (TargetKind::Lookat, Target::Lookat(goal)) => Target::Lookat(foot(*goal)),
        (TargetKind::Lookat, _) => Target::Lookat(position),
        (TargetKind::Xy, _) => Target::Xy([x, y]),
        (TargetKind::XyYaw, _) => Target::XyYaw { position: [x, y], yaw },
    }
}

/// How the coordinates of a kind are divided: places, then a direction (or the axis and sine of a rotation: a
/// quaternion), then an angle.
struct Layout {
    places: usize,
    sphere: usize,
}

fn layout(kind: TargetKind) -> Layout {
    let (places, sphere) = match kind {
        TargetKind::Pose => (3, 4),
        TargetKind::Position | TargetKind::PositionYaw | TargetKind::Lookat => (3, 0),
        TargetKind::PositionDirection | TargetKind::Ray => (3, 3),
        TargetKind::Rotation => (0, 4),
        TargetKind::Direction => (0, 3),
        TargetKind::Xy | TargetKind::XyYaw => (2, 0),
    };
    Layout { places, sphere }
}

/// A target as numbers that can be interpolated: positions as they are, rotations as quaternions, yaws as angles.
fn coordinates(target: &Target) -> Vec<f64> {
    let rotation = |rotation| Frame { rotation, ..Frame::IDENTITY }.quaternion();
    match target {
        Target::Pose(frame) => [frame.translation.as_slice(), &frame.quaternion()].concat(),
        Target::Position(position) | Target::Lookat(position) => position.to_vec(),
        Target::PositionDirection { position, direction } | Target::Ray { position, direction } => {
            [position.as_slice(), &unit(direction)].concat()
        }
        Target::PositionYaw { position, yaw } => [position.as_slice(), &[*yaw]].concat(),
        Target::Rotation(rows) => rotation(*rows).to_vec(),
        Target::Direction(direction) => unit(direction),
        Target::Xy(position) => position.to_vec(),
        Target::XyYaw { position, yaw } => [position.as_slice(), &[*yaw]].concat(),
    }
}

/// The target of a kind with these coordinates, directions and quaternions of any length.
fn target(kind: TargetKind, coordinates: &[f64]) -> Target {
    let number = |index: usize| coordinates.get(index).copied().unwrap_or(f64::NAN);
    let position = [number(0), number(1), number(2)];
    let frame = |translation: [f64; 3], first: usize| {
        let quaternion = [number(first), number(first + 1), number(first + 2), number(first + 3)];
        // One without a length is refused where the target is solved for.
        let nowhere = Frame { rotation: [[f64::NAN; 3]; 3], translation };
        Frame::from_quaternion(translation, quaternion).unwrap_or(nowhere)
    };
    let direction = [number(3), number(4), number(5)];
    match kind {
        TargetKind::Pose => Target::Pose(frame(position, 3)),
        TargetKind::Position => Target::Position(position),
        TargetKind::PositionDirection => Target::PositionDirection { position, direction },
        TargetKind::PositionYaw => Target::PositionYaw { position, yaw: number(3) },
        TargetKind::Rotation => Target::Rotation(frame([0.0; 3], 0).rotation),
        TargetKind::Direction => Target::Direction(position),
        TargetKind::Ray => Target::Ray { position, direction },
        TargetKind::Lookat => Target::Lookat(position),
        TargetKind::Xy => Target::Xy([number(0), number(1)]),
        TargetKind::XyYaw => Target::XyYaw { position: [number(0), number(1)], yaw: number(2) },
    }
}

/// The coordinates of all targets, each turned so that the way from the one before is short.
fn chain(start: &Target, others: &[Target]) -> Result<Vec<Vec<f64>>, NoPath> {
    let kind = start.kind();
    let Layout { places, sphere } = layout(kind);
    let mut points: Vec<Vec<f64>> = vec![coordinates(start)];
    for other in others {
        if other.kind() != kind {
            return Err(NoPath::Kind(other.kind()));
        }
        let mut point = coordinates(other);
        let Some(before) = points.last() else {
            break;
        };
        let ball = |point: &[f64]| point.get(places..places + sphere).unwrap_or_default().to_vec();
        let cosine = dot(&ball(before), &ball(&point));
        // A quaternion and its opposite are one rotation.
        if sphere == 4 && cosine < 0.0 {
            point.iter_mut().skip(places).for_each(|x| *x = -*x);
        }
        let opposite = if sphere == 4 { cosine.abs() < OPPOSITE } else { cosine < OPPOSITE - 1.0 };
        if sphere > 0 && opposite {
            return Err(NoPath::HalfTurn);
        }
        for (yaw, before) in point.iter_mut().zip(before).skip(places + sphere) {
            *yaw -= std::f64::consts::TAU * ((*yaw - before) / std::f64::consts::TAU).round();
        }
        points.push(point);
    }
    Ok(points)
}

/// So near to a half turn (rad, about), the shortest way round is a matter of rounding.
const OPPOSITE: f64 = 1e-6;

/// The way between two points: metres, or turn where that is more.
fn distance(kind: TargetKind, from: &[f64], to: &[f64]) -> f64 {
    let Layout { places, sphere } = layout(kind);
    let part = |first: usize, count: usize, list: &[f64]| -> Vec<f64> {
        list.iter().skip(first).take(count).copied().collect()
    };
    let difference = |first, count| -> f64 {
        let (from, to) = (part(first, count, from), part(first, count, to));
        from.iter().zip(&to).map(|(from, to)| (to - from).powi(2)).sum::<f64>().sqrt()
    };
    let (straight, yaw) = (difference(0, places), difference(places + sphere, usize::MAX));
    let angle = 2.0 * (difference(places, sphere) / 2.0).min(1.0).asin();
    // The angle between quaternions is half of that between rotations.
    let turn = if sphere == 4 { 2.0 * angle } else { angle };
    straight.max(turn.max(yaw) / TURN_PER_METRE)
}

/// A point between two: straight, but on the great circle where the coordinates are those of a sphere.
fn between(kind: TargetKind, from: &[f64], to: &[f64], part: f64) -> Vec<f64> {
    let Layout { places, sphere } = layout(kind);
    let ball = |list: &[f64]| list.get(places..places + sphere).unwrap_or_default().to_vec();
    let (one, other) = (ball(from), ball(to));
    let chord = one.iter().zip(&other).map(|(a, b)| (b - a).powi(2)).sum::<f64>().sqrt();
    let angle = 2.0 * (chord / 2.0).min(1.0).asin();
    let on_circle = |part: f64| if angle > 1e-9 { (part * angle).sin() / angle.sin() } else { part };
    let blend = |(place, (from, to)): (usize, (&f64, &f64))| {
        let round = (places..places + sphere).contains(&place);
        if round { on_circle(1.0 - part) * from + on_circle(part) * to } else { from + part * (to - from) }
    };
    if part >= 1.0 {
        return to.to_vec();
    }
    from.iter().zip(to).enumerate().map(blend).collect()
}

fn unit(vector: &[f64; 3]) -> Vec<f64> {
    let length = dot(vector, vector).sqrt();
    vector.iter().map(|x| x / length).collect()
}

fn dot(left: &[f64], right: &[f64]) -> f64 {
    left.iter().zip(right).map(|(x, y)| x * y).sum()
}

#[cfg(test)]
mod tests {
    use super::{NoPath, Path, of_tool};
    use dh_runtime::{Frame, Target, TargetKind, rotation_error};

    fn pose(xyz: [f64; 3], rpy: [f64; 3]) -> Target {
        Target::Pose(Frame::from_rpy(xyz, rpy))
    }

    fn frame(target: Target) -> Frame {
        match target {
            Target::Pose(frame) => frame,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn a_line_is_straight_and_turns_at_constant_speed() {
        let (start, goal) =
            (pose([0.1, 0.2, 0.3], [0.1, 0.4, -2.0]), pose([0.4, -0.2, 0.3], [0.3, -0.1, 2.5]));
        let path = Path::line(&start, &goal).unwrap();
        assert!((path.length() - 0.5).abs() < 1e-12);
        let whole = rotation_error(&frame(start).rotation, &frame(goal).rotation);
        for step in 0..=20 {
            let part = f64::from(step) / 20.0;
            let at = frame(path.at(part * 0.5));
            let expected = [0.1 + 0.3 * part, 0.2 - 0.4 * part, 0.3];
            assert!(at.translation.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12));
            let turned = rotation_error(&frame(start).rotation, &at.rotation);
            assert!((turned - part * whole).abs() < 1e-9, "{turned} {whole}");
        }
    }

    #[test]
    fn yaws_and_rotations_go_the_short_way() {
        let at = |yaw| Target::PositionYaw { position: [0.0; 3], yaw };
        let path = Path::line(&at(3.0), &at(-3.0)).unwrap();
        assert!((path.length() - (std::f64::consts::TAU - 6.0) / 10.0).abs() < 1e-12);
        let half = pose([0.0; 3], [0.0, 0.0, std::f64::consts::PI]);
        assert_eq!(Path::line(&pose([0.0; 3], [0.0; 3]), &half).err(), Some(NoPath::HalfTurn));
        let kinds = Path::line(&at(0.0), &Target::Position([0.0; 3]));
        assert_eq!(kinds.err(), Some(NoPath::Kind(TargetKind::Position)));
    }

    #[test]
    fn a_curve_goes_through_its_points() {
        let points = [[0.1, 0.0], [0.2, 0.1], [0.2, 0.1], [0.0, 0.3]].map(Target::Xy);
        let path = Path::curve(&Target::Xy([0.0, 0.0]), &points).unwrap();
        let way = 0.1 + 0.02_f64.sqrt();
        let Target::Xy([x, y]) = path.at(way) else { panic!() };
        assert!((x - 0.2).abs() < 1e-12 && (y - 0.1).abs() < 1e-12);
        assert_eq!(path.at(path.length()), Target::Xy([0.0, 0.3]));
        let still = Path::curve(&Target::Xy([0.0, 0.0]), &[Target::Xy([0.0, 0.0])]).unwrap();
        assert_eq!(still.length(), 0.0);
    }

    #[test]
    fn a_tool_fulfils_the_target_that_is_made_of_it() {
        let tool = Frame::from_rpy([0.1, -0.2, 0.3], [0.3, 1.1, -0.7]);
        let goals = [
            pose([0.0; 3], [0.0; 3]),
            Target::Position([0.0; 3]),
            Target::PositionDirection { position: [0.0; 3], direction: [0.0, 0.0, 2.0] },
            Target::PositionYaw { position: [0.0; 3], yaw: 1.0 },
            Target::Direction([1.0, 0.0, 0.0]),
            Target::Ray { position: [0.5, 0.5, 0.0], direction: [1.0, 0.0, 0.0] },
            Target::Lookat([0.2, 0.2, 0.2]),
            Target::Xy([0.0; 2]),
            Target::XyYaw { position: [0.0; 2], yaw: 0.0 },
        ];
        for goal in goals {
            let (position, rotation) = of_tool(goal.kind(), &tool, &goal).errors(&tool);
            assert!(position < 1e-12 && rotation < 1e-12, "{goal:?}: {position} {rotation}");
        }
    }
}
