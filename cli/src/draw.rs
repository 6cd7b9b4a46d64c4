//! `dhc draw`

use crate::arm::{self, Arm, DeviceFlags, Use, Watcher};
use crate::failure::{Failure, Refusal, Status};
use crate::json::Json;
use crate::move_arm::Pace;
use crate::text::columns;
use dh_core::{Target, TargetKind};
use dh_drivers::motion::Move;
use std::fs;
use std::io::{self, Read, Write};

/// Draws a figure: the hand goes to its first point, and from there in straight lines from point to point.
///
/// All of it is checked before anything is sent. At each point the arm comes to rest, and the point and where the hand is
/// are printed.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES, after_long_help = EXAMPLES)]
pub(crate) struct Arguments {
    #[command(flatten)]
    device: DeviceFlags,
    /// The points, one a line, coordinates with spaces or commas between them, in the table's unit of length; # begins a
    /// comment. - reads them from stdin.
    figure: String,
    /// Which inverse problem holds the hand; the first of the table that takes a position (target xy or position) if left
    /// out.
    #[arg(long, value_name = "NAME")]
    problem: Option<String>,
    /// Back to the first point at the end.
    #[arg(long)]
    close: bool,
    #[command(flatten)]
    pace: Pace,
    /// Answer in JSON, one object a point.
    #[arg(long)]
    pub(crate) json: bool,
}

const EXAMPLES: &str = "\
Examples:
  dhc draw planar2r figure.txt --port /dev/ttyUSB0 --problem xy_elbow_up --close
  printf '150 -100 70\\n150 0 70\\n' | dhc draw mycobot - --port /dev/ttyAMA0 --problem tool_down --speed 30";

/// Runs the command.
pub(crate) fn run(arguments: &Arguments, out: &mut dyn Write) -> Result<Status, Failure> {
    let text = match arguments.figure.as_str() {
        "-" => {
            let mut text = String::new();
            io::stdin().read_to_string(&mut text).map(|_| text)
        }
        path => fs::read_to_string(path),
    };
    let text = text.map_err(|error| Refusal::new("figure", format!("{}: {error}", arguments.figure)))?;
    arm::with(&arguments.device, Use::Move, |arm| {
        let problem = problem(arm, arguments.problem.as_deref())?;
        let points = points(arm, &problem, &text, &arguments.figure)?;
        let mut moves = Vec::new();
        for (index, target) in points.iter().enumerate() {
            let asked =
                if index == 0 { Move::nearest(&problem, *target) } else { Move::line(&problem, *target) };
            moves.push(arguments.pace.of(asked, arm));
        }
        if let (true, Some(first)) = (arguments.close, points.first()) {
            moves.push(arguments.pace.of(Move::line(&problem, *first), arm));
        }
        let mut reached: Vec<Vec<f64>> = Vec::new();
        let outcome = {
            let mut arrived = |_: usize, _: &[f64], q: &[f64]| reached.push(q.to_vec());
            arm.go(&moves, &mut Watcher::new(&mut arrived))
        };
        let targets = points.iter().cycle().zip(&reached).enumerate();
        let rows: Vec<Point> = targets.map(|(index, (target, q))| Point::of(arm, index, target, q)).collect();
        if arguments.json {
            rows.iter().try_for_each(|point| writeln!(out, "{}", point.json()))?;
        } else if !rows.is_empty() {
            write!(out, "{}", table(arm, &rows))?;
        }
        out.flush()?;
        outcome?;
        Ok(Status::Done)
    })
}

/// A point of the figure and where the hand came to rest, in the table's unit.
struct Point {
    number: usize,
    target: Vec<f64>,
    hand: Vec<f64>,
}

impl Point {
    fn of(arm: &Arm<'_>, index: usize, target: &Target, q: &[f64]) -> Self {
        let units = arm.units();
        let wanted = target.numbers();
        let hand = arm.hand(q).translation;
        let length = |(x, _): (&f64, &f64)| units.length(*x);
        Self {
            number: index + 1,
            target: wanted.iter().map(|x| units.length(*x)).collect(),
            hand: hand.iter().zip(wanted.iter()).map(length).collect(),
        }
    }

    fn off(&self) -> f64 {
        self.target.iter().zip(&self.hand).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
    }

    fn json(&self) -> Json {
        Json::Object(vec![
            ("point", self.number.into()),
            ("target", Json::numbers(self.target.iter().copied())),
            ("hand", Json::numbers(self.hand.iter().copied())),
            ("off", self.off().into()),
        ])
    }
}

fn table(arm: &Arm<'_>, rows: &[Point]) -> String {
    let list = |numbers: &[f64]| numbers.iter().map(|x| arm.short_length(*x)).collect::<Vec<_>>().join(" ");
    let unit = arm.units().length_name();
    let header = ["point".to_owned(), format!("target ({unit})"), format!("hand ({unit})"), "off".to_owned()];
    let row = |point: &Point| {
        let off = arm.short_length(point.off());
        [point.number.to_string(), list(&point.target), list(&point.hand), off]
    };
    columns("", &[header].into_iter().chain(rows.iter().map(row)).collect::<Vec<_>>())
}

/// The problem that holds the hand.
fn problem(arm: &Arm<'_>, asked: Option<&str>) -> Result<String, Refusal> {
    let takes_position = |kind| matches!(kind, TargetKind::Position | TargetKind::Xy);
    if let Some(name) = asked {
        let kind = arm.kind(name)?;
        return if takes_position(kind) {
            Ok(name.to_owned())
        } else {
            let message = format!("`{name}` takes a target of kind {kind}; a figure has positions only");
            Err(Refusal::new("problem", message))
        };
    }
    let problems = arm.robot.arm().problems();
    let first = problems.iter().find(|problem| takes_position(problem.target) && problem.free.is_empty());
    first.map(|problem| problem.name.to_owned()).ok_or_else(|| {
        Refusal::new("problem", "the table has no inverse problem whose target is a position")
            .help("add an [[ik]] entry with target = \"position\" or \"xy\"")
    })
}

fn points(arm: &Arm<'_>, problem: &str, text: &str, name: &str) -> Result<Vec<Target>, Refusal> {
    let kind = arm.kind(problem)?;
    let mut points = Vec::new();
    for (index, line) in text.lines().enumerate() {
        let line = line.split('#').next().unwrap_or_default();
        let words = line.split([' ', '\t', ',']).filter(|word| !word.is_empty());
        let numbers: Option<Vec<f64>> =
            words.map(|word| word.parse().ok().filter(|x: &f64| x.is_finite())).collect();
        let units = arm.units();
        let target = match (kind, numbers.as_deref()) {
            (_, Some([])) => continue,
            (TargetKind::Xy, Some([x, y])) => Target::Xy([units.metres(*x), units.metres(*y)]),
            (TargetKind::Position, Some([x, y, z])) => {
                Target::Position([units.metres(*x), units.metres(*y), units.metres(*z)])
            }
            _ => {
                let count = if kind == TargetKind::Xy { 2 } else { 3 };
                let message = format!("{name}:{}: a point of `{problem}` has {count} numbers", index + 1);
                return Err(Refusal::new("figure", message).help(format!("the line is: {}", line.trim())));
            }
        };
        points.push(target);
    }
    if points.is_empty() {
        return Err(Refusal::new("figure", format!("{name} has no points")));
    }
    Ok(points)
}
