//! The edge of a planar arm's workspace.

use dh_runtime::Limits;

/// Joint values of a planar arm of two links, one after the other, that take its hand along the whole edge of its
/// workspace in one stroke, for the limits of its two joints (rad).
///
/// The edge consists of arcs on which one joint moves and the other is at a limit, or the elbow is straight: circles
/// about the base where joint 2 is at a limit or 0, circles about the elbow where joint 1 is at a limit. Drawn with the
/// joints as axes these are the sides of a rectangle, and a bar through it where joint 2 may be 0. The bar's ends are
/// the only two places where three sides meet, so a stroke that draws each side once must begin at one of them and end
/// at the other (Euler); from there the bar is taken once more, to `q = 0` or as near to it as joint 1 comes.
///
/// Where joint 2 cannot be 0 there is no bar: the stroke goes once round, and ends where it began.
pub fn workspace_edge(joint1: Limits, joint2: Limits) -> Vec<[f64; 2]> {
    let (a, b, c, d) = (joint1.min, joint1.max, joint2.min, joint2.max);
    if !joint2.contains(0.0) {
        return vec![[a, c], [b, c], [b, d], [a, d], [a, c]];
    }
    vec![[a, 0.0], [a, c], [b, c], [b, 0.0], [a, 0.0], [a, d], [b, d], [b, 0.0], [joint1.clamp(0.0), 0.0]]
}

#[cfg(test)]
mod tests {
    use super::workspace_edge;
    use dh_runtime::Limits;

    /// One joint moves at a time, each side is drawn once (and the bar's half a second time, on the way to 0).
    #[test]
    fn each_side_is_drawn_once() {
        let limits = |min, max| Limits { min, max };
        let way = workspace_edge(limits(-3.0, 2.0), limits(-1.0, 1.5));
        let mut sides: Vec<[[f64; 2]; 2]> = Vec::new();
        for pair in way.windows(2) {
            let [mut from, mut to] = [pair[0], pair[1]];
            assert!((from[0] == to[0]) != (from[1] == to[1]), "{pair:?}");
            if from > to {
                (from, to) = (to, from);
            }
            sides.push([from, to]);
        }
        let last = sides.pop().unwrap();
        assert_eq!((last, way.last()), ([[0.0, 0.0], [2.0, 0.0]], Some(&[0.0, 0.0])));
        sides.sort_by(|a, b| a.partial_cmp(b).unwrap());
        let expected = [
            [[-3.0, -1.0], [-3.0, 0.0]],
            [[-3.0, -1.0], [2.0, -1.0]],
            [[-3.0, 0.0], [-3.0, 1.5]],
            [[-3.0, 0.0], [2.0, 0.0]],
            [[-3.0, 1.5], [2.0, 1.5]],
            [[2.0, -1.0], [2.0, 0.0]],
            [[2.0, 0.0], [2.0, 1.5]],
        ];
        assert_eq!(sides, expected);

        let bent = workspace_edge(limits(-1.0, 1.0), limits(0.5, 2.0));
        assert_eq!((bent.len(), bent.first()), (5, bent.last()));
    }
}
