//! Tables drawn at random, class by class.

/// The same numbers on every run.
pub(crate) struct Random(pub(crate) u64);

impl Random {
    /// In 0 ... 1.
    pub(crate) fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        f64::from((self.0 >> 40) as u32) / f64::from(1_u32 << 24)
    }

    /// In -1 ... 1.
    #[allow(dead_code, reason = "not every test draws such numbers")]
    pub(crate) fn symmetric(&mut self) -> f64 {
        2.0 * self.unit() - 1.0
    }

    pub(crate) fn sign(&mut self) -> f64 {
        if self.unit() < 0.5 { -1.0 } else { 1.0 }
    }

    /// m
    pub(crate) fn length(&mut self) -> f64 {
        (0.1 + 0.5 * self.unit()) * self.sign()
    }

    /// A quarter turn either way, or any twist (deg).
    pub(crate) fn twist(&mut self, skew: bool) -> f64 {
        self.sign() * if skew { 30.0 + 120.0 * self.unit() } else { 90.0 }
    }
}

/// One row: `L` is a length, `T` a twist, 0 nothing, in the order a, alpha, d; `P` before them a sliding row; `-` a
/// reversed one; `C` one that follows the row before it.
pub(crate) const CLASSES: &[(&str, &str, bool)] = &[
    ("spherical wrist, parallel shoulder", "LTL L0L LTL 0TL 0T0 00L", false),
    ("spherical wrist, skew twists", "LTL L0L LTL 0TL 0T0 00L", true),
    ("spherical wrist, first axes meet", "0TL LTL LTL 0TL 0T0 LTL", false),
    ("spherical shoulder", "0TL 0T0 LTL L0L LTL 00L", false),
    ("spherical shoulder, skew twists", "0TL 0T0 LTL L0L LTL 00L", true),
    ("three parallel axes, the wrist's meet", "0TL L0L L0L 0TL 0TL 00L", false),
    ("reversed and coupled rows", "LTL -L0L CLTL -0TL 0T0 C0TL", false),
    ("slides before a spherical wrist", "LTL LTL P0T 0TL 0T0 LTL", false),
    ("a slide below a spherical wrist", "PLT LTL LTL 0TL 0T0 LTL", false),
    ("four joints of a gripper on slides", "L0L L0L P0T 00L", false),
    ("spherical wrist, nothing else special", "LTL LTL LTL 0TL 0T0 00L", true),
    ("spherical shoulder, nothing else special", "0TL 0T0 LTL LTL LTL 00L", true),
    ("axes 2 to 4 meet, 5 and 6 are parallel", "LTL 0TL 0T0 LTL L0L 00L", false),
    ("axes 2 to 4 meet, 5 and 6 too", "LTL 0TL 0T0 LTL 0TL 00L", true),
    ("axes 2 to 4 meet, nothing else special", "LTL 0TL 0T0 LTL LTL 00L", false),
    ("axes 3 to 5 meet, 1 and 2 are parallel", "L0L LTL 0TL 0T0 LTL 00L", true),
    ("axes 3 to 5 meet, 1 and 2 too", "0TL LTL 0TL 0T0 LTL 00L", false),
    ("axes 3 to 5 meet, nothing else special", "LTL LTL 0TL 0T0 LTL 00L", true),
    ("axes 1 to 3 are parallel, nothing else special", "L0L L0L LTL LTL LTL 00L", false),
    ("axes 2 to 4 are parallel, nothing else special", "LTL L0L L0L LTL LTL 00L", false),
    ("axes 2 to 4 are parallel, skew twists", "LTL L0L L0L LTL LTL 00L", true),
    ("axes 3 to 5 are parallel, nothing else special", "LTL LTL L0L L0L LTL 00L", false),
    ("axes 4 to 6 are parallel, skew twists", "LTL LTL LTL L0L L0L 00L", true),
    ("axes 4 to 6 are parallel, 2 and 3 meet", "LTL 0TL LTL L0L L0L 00L", false),
];

pub(crate) fn table(rows: &str, skew: bool, random: &mut Random) -> String {
    let mut text = String::from(
        "[robot]\nname = \"Drawn\"\nconvention = \"standard\"\nunits = { length = \"m\", angle = \"deg\" }\n",
    );
    for (index, row) in rows.split(' ').enumerate() {
        text += "\n[[joint]]\n";
        let mut keys = if row.contains('P') { ["a", "alpha", ""] } else { ["a", "alpha", "d"] }.into_iter();
        for letter in row.chars() {
            match letter {
                'P' => text += "type = \"prismatic\"\n",
                '-' => text += "direction = -1\n",
                'C' => text.extend(["couple = { J", &index.to_string(), " = -1 }\n"]),
                _ => {
                    let Some(key) = keys.next() else { continue };
                    let value = match letter {
                        'L' => random.length(),
                        'T' => random.twist(skew),
                        _ => 0.0,
                    };
                    text.extend([key, " = ", &value.to_string(), "\n"]);
                }
            }
        }
    }
    let [x, y, z] = [0; 3].map(|_| random.length());
    text + &format!("\n[tool]\nxyz = [{x}, {y}, {z}]\nrpy = [0, 90, {}]\n", random.twist(true))
}

/// The same arm in the other convention: what follows a joint moves to the row after it, and the last row's to the tool's
/// place, which is drawn anew anyway.
pub(crate) fn modified_rows(text: &str) -> String {
    let mut blocks: Vec<String> = text.split("\n[[joint]]\n").map(str::to_owned).collect();
    let (mut a, mut alpha) = ("a = 0".to_owned(), "alpha = 0".to_owned());
    for block in blocks.iter_mut().skip(1) {
        let mut lines: Vec<String> = block.lines().map(str::to_owned).collect();
        for line in &mut lines {
            if line.starts_with("a =") {
                std::mem::swap(line, &mut a);
            } else if line.starts_with("alpha =") {
                std::mem::swap(line, &mut alpha);
            }
        }
        *block = lines.join("\n") + "\n";
    }
    blocks.join("\n[[joint]]\n").replace("\"standard\"", "\"modified\"")
}
