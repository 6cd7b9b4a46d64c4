//! The sections of a table.

use super::fields::{Fields, Reader};
use super::{
    BOUNDS, Device, Joint, KeepOut, NamedServo, Placement, Pose, Problem, Robot, Servo, SumLimit, Table,
    Workspace,
};
use crate::diagnostic::{Diagnostic, catalogue, shortened};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

const ROOT: [&str; 11] =
    ["format", "robot", "joint", "base", "tool", "workspace", "limit", "poses", "ik", "servo", "device"];
const ROBOT: [&str; 5] = ["name", "manufacturer", "source", "convention", "units"];
const JOINT: [&str; 16] = [
    "name",
    "type",
    "d",
    "a",
    "alpha",
    "beta",
    "theta",
    "offset",
    "direction",
    "couple",
    "fixed",
    "limits",
    "max_velocity",
    "max_acceleration",
    "max_jerk",
    "servo",
];
const SERVO: [&str; 7] = ["id", "sign", "zero", "counts_per_turn", "counts_per_unit", "range", "model"];
const NAMED_SERVO: [&str; 8] =
    ["name", "id", "sign", "zero", "counts_per_turn", "counts_per_unit", "range", "model"];
const PLACEMENT: [&str; 3] = ["xyz", "rpy", "quaternion"];
const WORKSPACE: [&str; 7] = ["x_min", "x_max", "y_min", "y_max", "z_min", "z_max", "keep_out"];
const PROBLEM: [&str; 5] = ["name", "target", "constraints", "where", "free"];

/// Reads every section.
pub(super) fn read(reader: &mut Reader, root: &DeTable) -> Table {
    let whole = Fields { table: root, span: 0..0, place: "the table" };
    reader.refuse_unknown(&whole, &ROOT);
    if let Some(value) = root.get("format") {
        format_version(reader, value);
    }
    Table {
        robot: robot(reader, root),
        joints: reader.entries(root, "joint").into_iter().filter_map(|value| joint(reader, value)).collect(),
        base: root.get("base").and_then(|value| placement(reader, value, "`[base]`")),
        tool: root.get("tool").and_then(|value| placement(reader, value, "`[tool]`")),
        workspace: root.get("workspace").and_then(|value| workspace(reader, value)).unwrap_or_default(),
        limits: reader
            .entries(root, "limit")
            .into_iter()
            .filter_map(|value| sum_limit(reader, value))
            .collect(),
        poses: root.get("poses").map(|value| poses(reader, value)).unwrap_or_default(),
        problems: reader.entries(root, "ik").into_iter().filter_map(|value| problem(reader, value)).collect(),
        servos: reader
            .entries(root, "servo")
            .into_iter()
            .filter_map(|value| named_servo(reader, value))
            .collect(),
        device: root.get("device").and_then(|value| device(reader, value)),
        complete: reader.complete,
    }
}

fn format_version(reader: &mut Reader, value: &Spanned<DeValue>) {
    match value.get_ref() {
        DeValue::Integer(version) if version.as_str() == "1" => {}
        DeValue::Integer(version) => reader.diagnostics.push(
            Diagnostic::error(
                catalogue::UNKNOWN_FORMAT,
                format!(
                    "format {} is not known to this compiler, which reads format 1",
                    shortened(version.as_str())
                ),
            )
            .at(value.span(), "")
            .help("write `format = 1`, or use the compiler that the table was written for"),
        ),
        _ => reader.wrong_type("`format`", value, "the number 1"),
    }
}

fn robot(reader: &mut Reader, root: &DeTable) -> Option<Robot> {
    let Some(value) = root.get("robot") else {
        if reader.complete {
            reader.diagnostics.push(
                Diagnostic::error(catalogue::MISSING_KEY, "the table has no `[robot]`")
                    .at(0..0, "")
                    .help("write `[robot]`, and below it `name = \"...\"` and `convention = \"standard\"` or `\"modified\"`"),
            );
        }
        return None;
    };
    let fields = reader.open(value, "`[robot]`", &ROBOT)?;
    reader.required(&fields, "name", "\"...\"");
    reader.required(&fields, "convention", "\"standard\"` (distal) or `convention = \"modified\"");
    let mut robot = Robot {
        name: reader.text(&fields, "name"),
        manufacturer: reader.text(&fields, "manufacturer"),
        source: reader.text(&fields, "source"),
        convention: reader.text(&fields, "convention"),
        span: fields.span.clone(),
        ..Robot::default()
    };
    if let Some(value) = fields.value("units")
        && let Some(units) = reader.open(value, "`units`", &["length", "angle"])
    {
        robot.length = reader.text(&units, "length");
        robot.angle = reader.text(&units, "angle");
    }
    Some(robot)
}

fn joint(reader: &mut Reader, value: &Spanned<DeValue>) -> Option<Joint> {
    // A row that cannot be read is not a row less.
    let Some(fields) = reader.open(value, "a joint", &JOINT) else {
        reader.complete = false;
        return None;
    };
    Some(Joint {
        line: reader.line(&fields.span),
        header: reader.first_line(&fields.span),
        name: reader.text(&fields, "name"),
        kind: reader.text(&fields, "type"),
        d: reader.number(&fields, "d"),
        theta: reader.number(&fields, "theta"),
        a: reader.number(&fields, "a"),
        alpha: reader.number(&fields, "alpha"),
        beta: reader.number(&fields, "beta"),
        offset: reader.number(&fields, "offset"),
        fixed: reader.number(&fields, "fixed"),
        d_key: fields.key_span("d"),
        theta_key: fields.key_span("theta"),
        direction: reader.number(&fields, "direction"),
        couple: reader.weights(&fields, "couple").unwrap_or_default(),
        limits: reader.numbers(&fields, "limits", &["min", "max"]),
        max_velocity: reader.number(&fields, "max_velocity"),
        max_acceleration: reader.number(&fields, "max_acceleration"),
        max_jerk: reader.number(&fields, "max_jerk"),
        servo: fields
            .value("servo")
            .and_then(|value| reader.open(value, "a servo", &SERVO))
            .map(|fields| servo(reader, &fields)),
        span: fields.span,
    })
}

fn servo(reader: &mut Reader, fields: &Fields) -> Servo {
    Servo {
        span: fields.span.clone(),
        id: reader.number(fields, "id"),
        sign: reader.number(fields, "sign"),
        zero: reader.number(fields, "zero"),
        counts_per_turn: reader.number(fields, "counts_per_turn"),
        counts_per_unit: reader.number(fields, "counts_per_unit"),
        range: reader.numbers(fields, "range", &["min", "max"]),
        model: reader.text(fields, "model"),
    }
}

fn named_servo(reader: &mut Reader, value: &Spanned<DeValue>) -> Option<NamedServo> {
    let fields = reader.open(value, "a `[[servo]]`", &NAMED_SERVO)?;
    reader.required(&fields, "name", "\"hand\"");
    let servo = servo(reader, &fields);
    Some(NamedServo { name: reader.text(&fields, "name")?, servo })
}

fn placement(reader: &mut Reader, value: &Spanned<DeValue>, place: &'static str) -> Option<Placement> {
    let fields = reader.open(value, place, &PLACEMENT)?;
    Some(Placement {
        xyz: reader.numbers(&fields, "xyz", &["x", "y", "z"]),
        rpy: reader.numbers(&fields, "rpy", &["roll", "pitch", "yaw"]),
        quaternion: reader.numbers(&fields, "quaternion", &["x", "y", "z", "w"]),
        span: fields.span,
    })
}

fn workspace(reader: &mut Reader, value: &Spanned<DeValue>) -> Option<Workspace> {
    let fields = reader.open(value, "`[workspace]`", &WORKSPACE)?;
    let bounds = BOUNDS
        .iter()
        .enumerate()
        .filter_map(|(index, key)| Some((index, reader.number(&fields, key)?)))
        .collect();
    let mut keep_out = Vec::new();
    match fields.value("keep_out").map(|value| (value, value.get_ref())) {
        None => {}
        Some((_, DeValue::Array(boxes))) => {
            keep_out = boxes.iter().filter_map(|value| forbidden_box(reader, value)).collect();
        }
        Some((value, _)) => {
            let wanted = "a list of boxes, such as `[{ min = [0, 0, 0], max = [1, 1, 1] }]`";
            reader.wrong_type("`keep_out`", value, wanted);
        }
    }
    Some(Workspace { bounds, keep_out })
}

fn forbidden_box(reader: &mut Reader, value: &Spanned<DeValue>) -> Option<KeepOut> {
    let fields = reader.open(value, "a box of `keep_out`", &["min", "max"])?;
    reader.required(&fields, "min", "[x, y, z]");
    reader.required(&fields, "max", "[x, y, z]");
    let min = reader.numbers(&fields, "min", &["x", "y", "z"]);
    let max = reader.numbers(&fields, "max", &["x", "y", "z"]);
    Some(KeepOut { min: min?, max: max?, span: fields.span })
}

fn sum_limit(reader: &mut Reader, value: &Spanned<DeValue>) -> Option<SumLimit> {
    let fields = reader.open(value, "a `[[limit]]`", &["of", "range"])?;
    reader.required(&fields, "of", "{ J2 = 1, J3 = 1 }");
    reader.required(&fields, "range", "[min, max]");
    let of = reader.weights(&fields, "of");
    let range = reader.numbers(&fields, "range", &["min", "max"]);
    Some(SumLimit { of: of?, range: range?, span: reader.first_line(&fields.span) })
}

fn poses(reader: &mut Reader, value: &Spanned<DeValue>) -> Vec<Pose> {
    let Some(fields) = reader.open_any(value, "`[poses]`") else {
        return Vec::new();
    };
    let pose = |(key, value): (&Spanned<_>, &Spanned<DeValue>)| {
        let name = Reader::key_text(key);
        if let DeValue::Array(_) = value.get_ref() {
            return Some(Pose { q: reader.numbers_of(&shortened(&name.value), value)?, name, safe: false });
        }
        if !matches!(value.get_ref(), DeValue::Table(_)) {
            let wanted = "a list of joint values, or `{ q = [...], safe = true }`";
            reader.wrong_type(&format!("`{}`", shortened(&name.value)), value, wanted);
            return None;
        }
        let fields = reader.open(value, "a pose", &["q", "safe"])?;
        let safe = reader.flag(&fields, "safe").unwrap_or(false);
        let q = reader.required(&fields, "q", "[...]")?;
        Some(Pose { q: reader.numbers_of("q", q)?, name, safe })
    };
    fields.in_order().into_iter().filter_map(pose).collect()
}

fn problem(reader: &mut Reader, value: &Spanned<DeValue>) -> Option<Problem> {
    let fields = reader.open(value, "an `[[ik]]`", &PROBLEM)?;
    reader.required(&fields, "name", "\"tool_down\"");
    reader.required(&fields, "target", "\"position\"");
    let (constraints, all_constraints) = reader.texts(&fields, "constraints");
    let (filters, all_filters) = reader.texts(&fields, "where");
    let (free, all_free) = reader.texts(&fields, "free");
    Some(Problem {
        line: reader.line(&fields.span),
        complete: reader.complete && all_constraints && all_filters && all_free,
        name: reader.text(&fields, "name"),
        target: reader.text(&fields, "target"),
        constraints,
        filters,
        free,
        span: fields.span,
    })
}

fn device(reader: &mut Reader, value: &Spanned<DeValue>) -> Option<Device> {
    let fields = reader.open_any(value, "`[device]`")?;
    reader.required(&fields, "driver", "\"mycobot\"");
    let driver = reader.text(&fields, "driver");
    let mut keys = Vec::new();
    for (key, value) in fields.in_order() {
        if key.get_ref() == "driver" {
            continue;
        }
        let written = reader.text.get(value.span()).unwrap_or("");
        match value.get_ref() {
            DeValue::Table(_) if !written.starts_with('{') => {
                let wanted = "a value, or a table in braces";
                reader.wrong_type(&format!("`{}`", shortened(key.get_ref())), value, wanted);
            }
            DeValue::String(text) => keys.push((key.get_ref().to_string(), text.to_string())),
            _ => keys.push((key.get_ref().to_string(), written.to_owned())),
        }
    }
    Some(Device { driver: driver?, keys })
}
