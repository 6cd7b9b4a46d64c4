//! `[base]` and `[tool]`.

use super::quantity::Converter;
use super::{Angle, Placement, Rotation};
use crate::diagnostic::{Diagnostic, catalogue};
use crate::table::{self, Numbers};

/// A fixed frame; where it is left out, none.
pub(super) fn placement(written: Option<&table::Placement>, converter: &mut Converter) -> Placement {
    let still = Placement { xyz: [0.0; 3], rotation: Rotation::Rpy([Angle::ZERO; 3]) };
    let Some(written) = written else { return still };
    if let (Some(rpy), Some(quaternion)) = (&written.rpy, &written.quaternion) {
        converter.diagnostics.push(
            Diagnostic::error(
                catalogue::ROTATION,
                "the rotation is written twice, as `rpy` and as `quaternion`",
            )
            .at(quaternion.span.clone(), "")
            .beside(rpy.span.clone(), "")
            .help("leave one of them out"),
        );
    }
    let xyz = written.xyz.as_ref().and_then(|xyz| three(xyz, |number| converter.length(number)));
    let rpy = written.rpy.as_ref().and_then(|rpy| three(rpy, |number| converter.angle(number)));
    let quaternion = written.quaternion.as_ref().and_then(|quaternion| rotation(quaternion, converter));
    Placement {
        xyz: xyz.unwrap_or(still.xyz),
        rotation: rpy.map(Rotation::Rpy).or(quaternion).unwrap_or(still.rotation),
    }
}

fn three<T>(numbers: &Numbers, convert: impl FnMut(&table::Number) -> Option<T>) -> Option<[T; 3]> {
    // All of them are converted, so that all mistakes are found.
    let converted: Vec<Option<T>> = numbers.value.iter().map(convert).collect();
    converted.into_iter().collect::<Option<Vec<T>>>()?.try_into().ok()
}

/// The rotation of a quaternion x, y, z, w of any length but zero.
fn rotation(numbers: &Numbers, converter: &mut Converter) -> Option<Rotation> {
    let parts: Vec<Option<f64>> = numbers.value.iter().map(|number| converter.plain(number)).collect();
    let parts: Option<Vec<f64>> = parts.into_iter().collect();
    let [x, y, z, w]: [f64; 4] = parts?.try_into().ok()?;
    let largest = [x, y, z, w].into_iter().map(f64::abs).fold(0.0, f64::max);
    if largest == 0.0 {
        converter.diagnostics.push(
            Diagnostic::error(catalogue::ROTATION, "a quaternion of zero length is no rotation")
                .at(numbers.span.clone(), "")
                .help("write `quaternion = [0, 0, 0, 1]` for no rotation, or leave it out"),
        );
        return None;
    }
    let scaled = [x, y, z, w].map(|part| part / largest);
    let length = libm::sqrt(scaled.iter().map(|part| part * part).sum());
    let [x, y, z, w] = scaled.map(|part| part / length);
    let rows = [
        [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - z * w), 2.0 * (x * z + y * w)],
        [2.0 * (x * y + z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - x * w)],
        [2.0 * (x * z - y * w), 2.0 * (y * z + x * w), 1.0 - 2.0 * (x * x + y * y)],
    ];
    let exact = rpy_of(&rows).map(Angle::from_radians);
    let all_exact = exact.iter().all(|angle| angle.fifteenths.is_some());
    Some(if all_exact { Rotation::Rpy(exact) } else { Rotation::Matrix(rows) })
}

/// Roll, pitch and yaw of a rotation; at a pitch of a quarter turn the roll is 0.
fn rpy_of([[r11, r12, _], [r21, r22, _], [r31, r32, r33]]: &[[f64; 3]; 3]) -> [f64; 3] {
    let cosine = libm::hypot(*r11, *r21);
    let pitch = libm::atan2(-r31, cosine);
    // Below this the others are rounding errors, and roll and yaw turn about one axis.
    if cosine < 1e-9 {
        return [0.0, pitch, libm::atan2(-r12, *r22)];
    }
    [libm::atan2(*r32, *r33), pitch, libm::atan2(*r21, *r11)]
}
