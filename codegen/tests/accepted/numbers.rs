//! Numbers, expressions, angles and rotations.

use super::*;

/// `d` of a row whose d is written like this.
fn length(expression: &str) -> f64 {
    model_of(&format!("{MILLIMETRES}[[joint]]\nd = {expression}\n")).rows[0].d
}

fn angle(head: &str, expression: &str) -> Angle {
    model_of(&format!("{head}[[joint]]\nalpha = {expression}\n")).rows[0].alpha
}

#[test]
fn numbers_are_in_the_units_of_the_table_unless_they_bring_their_own() {
    for (written, metres) in [
        ("140", 0.14),
        ("140.0", 0.14),
        ("0x8c", 0.14),
        ("1_40", 0.14),
        ("1.4e2", 0.14),
        ("\"140\"", 0.14),
        ("\"140 mm\"", 0.14),
        ("\"0.14 m\"", 0.14),
        ("\"100 + 40\"", 0.14),
        ("\"100 + 40 mm\"", 0.14),
        ("\"2 * (50 + 20)\"", 0.14),
        ("\"280/2 mm\"", 0.14),
        ("\"100 mm + 0.04 m\"", 0.14),
        ("\"140mm\"", 0.14),
        ("\"--140\"", 0.14),
        ("\"280 * sin(30)\"", 0.14),
        ("\"280 * cos(pi/3)\"", 0.14),
        ("\"sqrt(3*3 + 4*4) * 28\"", 0.14),
        ("\"28 * (pi / (pi/5))\"", 0.14),
        ("'140'", 0.14),
        ("\"\"\"140\"\"\"", 0.14),
    ] {
        assert!((length(written) - metres).abs() < 1e-15, "{written} is {}", length(written));
    }
}

#[test]
fn angles_that_are_multiples_of_15_degrees_are_exact() {
    for (written, fifteenths) in [
        ("90", 6),
        ("-90.0", -6),
        ("\"pi/2\"", 6),
        ("\"1.5707963267948966 rad\"", 6),
        ("\"pi/2 + 90 deg\"", 12),
        ("\"90 deg + pi/2\"", 12),
        ("\"45 + 45\"", 6),
        ("\"pi/2 rad\"", 6),
        ("\"acos(0)\"", 6),
        ("\"asin(0.5)\"", 2),
        ("\"atan(1)\"", 3),
        ("\"atan2(-1, -1)\"", -9),
        ("\"-2*pi/3\"", -8),
        ("\"pi - 2*pi\"", -12),
        ("\"360/24\"", 1),
    ] {
        assert_eq!(angle(MILLIMETRES, written).fifteenths, Some(fifteenths), "{written}");
    }
    assert_eq!(angle(METRES, "1.5707963267948966").fifteenths, Some(6));
    assert_eq!(angle(METRES, "\"sin(pi/6) * pi\"").fifteenths, Some(6));
    let not_quite = angle(METRES, "1.57079");
    assert_eq!((not_quite.value, not_quite.fifteenths), (1.57079, None));
}

#[test]
fn calibrated_and_other_numbers_get_no_warning() {
    for written in ["1.570796", "1.57", "1.5708", "1.571", "3.14159"] {
        let (_, said) = checked(&format!("{METRES}[[joint]]\nalpha = {written}\n"));
        assert!(said.starts_with("warning[rounded-angle]"), "{written}");
    }
    for written in
        ["1.5707", "1.572", "1.6", "2.88", "0.26", "1.5712345", "1.570796326794", "0.0", "0.0001", "7.85e-1"]
    {
        model_of(&format!("{METRES}[[joint]]\nalpha = {written}\n"));
    }
    // In degrees no multiple of 15 needs rounding.
    model_of(&format!("{MILLIMETRES}[[joint]]\nalpha = 1.5708\n[[joint]]\nalpha = 89.98\n"));
}

#[test]
fn base_and_tool_are_exact_too() {
    let rotation = |line: &str| model_of(&format!("{METRES}[[joint]]\n[tool]\n{line}\n")).tool.rotation;
    let rpy = |roll: i32, pitch: i32, yaw: i32| Rotation::Rpy([roll, pitch, yaw].map(Angle::from_fifteenths));
    assert_eq!(rotation("rpy = [0, \"pi/2\", \"-45 deg\"]"), rpy(0, 6, -3));
    assert_eq!(rotation("quaternion = [0, 0, 0, 1]"), rpy(0, 0, 0));
    assert_eq!(rotation("quaternion = [0, 0, 0, -2]"), rpy(0, 0, 0));
    assert_eq!(rotation("quaternion = [0, 0, 0.7071, 0.7071]"), rpy(0, 0, 6));
    assert_eq!(rotation("quaternion = [0, 1, 0, 1]"), rpy(0, 6, 0));
    assert_eq!(rotation("quaternion = [1, 0, 0, 0]"), rpy(12, 0, 0));
    assert_eq!(rotation("quaternion = [1e-200, 0, 0, 1e-200]"), rpy(6, 0, 0));
    let Rotation::Matrix(rows) = rotation("quaternion = [0.1, 0.2, 0.3, 0.9]") else { panic!("not exact") };
    for (i, one) in rows.iter().enumerate() {
        for (j, two) in rows.iter().enumerate() {
            let product: f64 = one.iter().zip(two).map(|(x, y)| x * y).sum();
            assert!((product - if i == j { 1.0 } else { 0.0 }).abs() < 1e-15);
        }
    }
}

#[test]
fn every_quaternion_is_the_rotation_that_it_names() {
    for [x, y, z, w] in [
        [0.1, 0.2, 0.3, 0.9],
        [0.5, 0.5, 0.5, 0.5],
        [0.0, 1.0, 0.0, 1.0],
        [0.0, 1.0, 1.0, 0.0],
        [1.0, -1.0, 0.0, 0.0],
    ] {
        let text = format!("{METRES}[[joint]]\n[tool]\nquaternion = [{x}, {y}, {z}, {w}]\n");
        let tool = product::frames(&model_of(&text), &[0.0]).tool;
        // v + 2 u x (u x v + w v), for a unit quaternion (u, w)
        let length = f64::sqrt(x * x + y * y + z * z + w * w);
        let ([x, y, z], w) = ([x / length, y / length, z / length], w / length);
        let cross = |a: [f64; 3], b: [f64; 3]| {
            [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
        };
        for column in 0..3 {
            let mut v = [0.0; 3];
            v[column] = 1.0;
            let u = [x, y, z];
            let inner = cross(u, v);
            let outer = cross(u, [0, 1, 2].map(|i| inner[i] + w * v[i]));
            for row in 0..3 {
                assert!((tool[row][column] - (v[row] + 2.0 * outer[row])).abs() < 1e-15);
            }
        }
    }
}
