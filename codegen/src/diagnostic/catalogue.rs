//! Codes of diagnostics, and what they mean.

/// Declares the codes and the catalogue of their explanations.
macro_rules! catalogue {
    ($($name:ident = $code:literal, $text:literal;)*) => {
        $(#[doc = concat!("`", $code, "`, explained in [`CATALOGUE`].")] pub const $name: &str = $code;)*

        /// Every code with its explanation, in the order of the pipeline.
        pub const CATALOGUE: &[(&str, &str)] = &[$(($code, $text)),*];
    };
}

catalogue! {
    MISSING_FILE = "missing-file",
        "The table was not found. A path that ends in .toml is a file: it is looked for beside the source file that names it, then in the root of the crate, then in its folder robots/. A name without .toml is a table shipped with the project.";
    NOT_UTF8 = "not-utf8",
        "A table is a text in UTF-8. The place is the first byte that is not; a text in another encoding has to be converted.";
    TOO_LARGE = "too-large",
        "A table has at most 256 KiB. A robot needs a few; what makes a file so large is not a table.";
    SYNTAX = "syntax",
        "The text is not TOML 1.0. The statement that is broken is left out and the rest of the table is checked as far as it does not depend on it; more may be reported once it is mended.";
    DUPLICATE_KEY = "duplicate-key",
        "A key stands twice in one table of the file, or a [table] is opened twice. The first one is used to check the rest.";
    BOUND_ELSEWHERE = "bound-elsewhere",
        "A header such as [joint.servo] belongs to the last [[joint]] before it. After `joint = [...]` there is none, and TOML does not allow the list to be added to. Write `servo = {...}` inside the row that it belongs to, or every row as a [[joint]] of its own.";
    UNKNOWN_KEY = "unknown-key",
        "Keys that the format does not know are errors, so that a misspelt one is not passed over in silence.";
    MISSING_KEY = "missing-key",
        "A key that has no default is left out.";
    WRONG_TYPE = "wrong-type",
        "A value of another type is wanted. Numbers may be written as TOML numbers or, in quotes, as expressions.";
    WRONG_LENGTH = "wrong-length",
        "A list has more or fewer values than it has meanings for.";
    UNKNOWN_WORD = "unknown-word",
        "A word is wanted out of a short list: units \"m\", \"mm\", \"rad\", \"deg\"; convention \"standard\" or \"modified\"; type \"revolute\" or \"prismatic\"; targets as listed in the reference.";
    UNKNOWN_FORMAT = "unknown-format",
        "`format` is the version of the table format. This compiler reads version 1, also where the key is left out.";
    JOINT_COUNT = "joint-count",
        "A robot has at least one joint that moves, and at most 32 rows.";
    NOT_FINITE = "not-finite",
        "TOML knows nan and inf, and an expression may overflow; a robot has no such numbers. Leave out a limit that does not exist.";
    BAD_EXPRESSION = "bad-expression",
        "A number in quotes is an expression: + - * / ( ), pi, sqrt sin cos tan acos asin atan atan2, and at its end a unit: \"90 deg\", \"1.5 rad\", \"140 mm\", \"0.14 m\".";
    NO_VALUE = "no-value",
        "The expression divides by zero, or takes a function of something outside its domain: sqrt of a negative number, asin or acos of more than 1.";
    MIXED_UNITS = "mixed-units",
        "Expressions have dimensions: pi is half a turn whatever the table's units, a bare number is in the table's units. Adding the two would mean something else in another table, so the unit has to be written: \"pi/2 + 90 deg\".";
    WRONG_UNIT = "wrong-unit",
        "A length is wanted and an angle is written, or the other way round, or a number without a unit is wanted.";
    WRONG_VALUE = "wrong-value",
        "The value is of the right type, but not one that this key can have.";
    WRONG_JOINT_TYPE = "wrong-joint-type",
        "The theta of a revolute joint and the d of a prismatic one are what q varies; they are not given, only their value at q = 0, with `offset`. A revolute joint has `d` (its fixed offset along the axis), a prismatic one `theta` (its fixed angle).";
    LIMITS_ORDER = "limits-order",
        "The lower limit is above the upper one.";
    DUPLICATE_NAME = "duplicate-name",
        "Two joints, problems or servos have the same name, so that it says nothing. Rows without a name are J1, J2, ... by their place.";
    DUPLICATE_ID = "duplicate-id",
        "Two servos have the same id, of joints or of [[servo]] entries. On one bus both would do what either is told, and answer at the same time.";
    BAD_NAME = "bad-name",
        "The name becomes part of a Rust function's name (ik_NAME), so it has to be made of letters a-z, A-Z, digits and underscores, and must not begin with a digit.";
    RESERVED_NAME = "reserved-name",
        "The name would make a function that the arm has already: ik_all, ik_batch, ik_track, ik_free and others.";
    UNKNOWN_JOINT = "unknown-joint",
        "A joint is named that the table does not have. Joints are named as in their rows, J1, J2, ... by default.";
    HELD_JOINT = "held-joint",
        "A joint with `fixed` is held: it has a theta (or d), but no q, so nothing can refer to its q.";
    SINGULAR_COUPLING = "singular-coupling",
        "The couplings cancel each other, so that the joint variables can be moved together without moving the arm.";
    ROTATION = "rotation",
        "The rotation of [base] or [tool] is written either as `rpy` or as `quaternion = [x, y, z, w]`, whose length must not be zero. It need not be one.";
    POSE_LENGTH = "pose-length",
        "A named pose has one value for each joint that moves, base to tip. Held joints have none.";
    POSE_OUTSIDE_LIMITS = "pose-outside-limits",
        "A named pose is outside the limits of a joint, so that it cannot be moved to. A pose outside a [[limit]] on a sum of joints gets a warning: the arm refuses to move there all the same.";
    BAD_CONSTRAINT = "bad-constraint",
        "A constraint is an equation `left = right`, an entry of `where` an inequality with <=, <, >= or >.";
    NOT_LINEAR = "not-linear",
        "Constraints and `where` are linear in the joints: a sum of joints times numbers, and a number.";
    UNKNOWN_VARIABLE = "unknown-variable",
        "Constraints and `where` speak of theta1, theta2, ... (d1, d2, ... of prismatic joints), of q1, q2, ... or of joints by their names, numbered by rows, held ones included.";
    CONTRADICTION = "contradiction",
        "The constraints cannot hold together.";
    NO_SOLUTION = "no-solution",
        "No joint is left in the constraint, and what is left is not true.";
    REDUNDANT = "redundant",
        "The constraint says nothing that the others do not say, so it takes no unknown away.";
    UNEVEN = "uneven",
        "A problem has as many unknowns as its target prescribes rows: joints that move, less constraints, less `free` ones. Only the full pose may be over-determined.";
    ROUNDED_ANGLE = "rounded-angle",
        "The number is a multiple of 15 degrees rounded to the digits written. It is kept as written, so that the arm is built with axes that are not quite square; if the multiple is meant, write it as an expression, which is exact.";
    SERVO_RANGE = "servo-range",
        "The servo cannot be sent to all of the joint's limits. Motion uses what both allow.";
    NO_CLOSED_FORM = "no-closed-form",
        "The compiler looked for an order in which each step has one unknown joint (or sum of parallel joints), and found none for this problem under these constraints. Its function is left out, and the others stay.";
    VERIFICATION = "verification",
        "Every function is run against plain products of the table's own matrices before it is printed. One that does not agree is left out, and the others stay. This is never the table's mistake: the compiler derived something wrong, or its accuracy does not do for this arm.";
}

/// What a code means.
pub fn explain(code: &str) -> Option<&'static str> {
    CATALOGUE.iter().find(|(known, _)| *known == code).map(|(_, text)| *text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_are_unique_short_and_explained() {
        for (index, (code, text)) in CATALOGUE.iter().enumerate() {
            assert!(
                code.len() <= 20
                    && code.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-')
            );
            assert!(text.ends_with('.') && text.len() > 20, "{code}");
            assert!(CATALOGUE.iter().skip(index + 1).all(|(other, _)| other != code), "{code} stands twice");
            assert_eq!(explain(code), Some(*text));
        }
        assert_eq!(explain("E0000"), None);
    }
}
