//! Every table of `refusals/` against the text that is said about it, and what must hold for any text at all.
//!
//! `UPDATE_EXPECT=1 cargo test -p dh-codegen --test refusals` writes the texts anew.
#![allow(clippy::unwrap_used, reason = "a test fails with it")]

use dh_codegen::diagnostic::{Diagnostics, Style};
use dh_codegen::model::{self, product};
use dh_codegen::table;
use expect_test::expect_file;
use std::path::{Path, PathBuf};

fn tables() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/refusals");
    let mut tables: Vec<PathBuf> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "toml"))
        .collect();
    tables.sort();
    tables
}

fn diagnostics_of(text: &str) -> Diagnostics {
    let mut diagnostics = Diagnostics::new();
    let table = table::parse(text, &mut diagnostics);
    let model = model::check(&table, &mut diagnostics);
    assert!(model.is_some() || diagnostics.has_errors(), "no model, and nothing said about it");
    // What is generated for an arm that has mistakes starts from these.
    if let Some(model) = model {
        assert_eq!(model.chain().links.len(), model.chain().joints.len() + 1);
        let frames = product::frames(&model, &vec![0.1; model.joints.len()]);
        assert_eq!(frames.rows.len(), model.rows.len() + 1);
    }
    diagnostics
}

#[test]
fn every_mistake_is_said_once_with_its_place_and_what_to_write() {
    let tables = tables();
    assert!(tables.len() > 50);
    for path in tables {
        let text = std::fs::read_to_string(&path).unwrap();
        let name = path.file_name().unwrap().to_str().unwrap();
        let drawn = diagnostics_of(&text).render(&text, name, Style::Plain);
        assert!(!drawn.is_empty(), "{name} is not refused");
        expect_file![path.with_extension("txt")].assert_eq(&format!("{drawn}\n"));
    }
}

#[test]
fn every_code_of_the_two_stages_is_shown() {
    let shown: String = tables()
        .iter()
        .map(|path| std::fs::read_to_string(path.with_extension("txt")).unwrap_or_default())
        .collect();
    // The reader of files checks the first three, later stages say the others.
    let elsewhere = ["missing-file", "not-utf8", "too-large", "no-closed-form", "verification"];
    for (code, _) in dh_codegen::diagnostic::catalogue::CATALOGUE {
        assert!(
            elsewhere.contains(code) || shown.contains(&format!("[{code}]")),
            "no table is refused with {code}"
        );
    }
}

#[test]
fn every_diagnostic_has_a_place_inside_the_text_and_help() {
    for path in tables() {
        let text = std::fs::read_to_string(&path).unwrap();
        for diagnostic in diagnostics_of(&text).sorted() {
            assert!(!diagnostic.labels.is_empty(), "{}: {}", path.display(), diagnostic.message);
            assert!(diagnostic.labels.iter().all(|label| label.span.end <= text.len()), "{}", path.display());

            assert!(!diagnostic.help.is_empty(), "{}: {}", path.display(), diagnostic.message);
            assert!(!diagnostic.message.ends_with('.'), "{}", diagnostic.message);
        }
    }
}

/// A generator of its own, so that a failure can be repeated.
struct Random(u64);

impl Random {
    fn below(&mut self, bound: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as usize % bound.max(1)
    }
}

/// Pieces that are put where they don't belong.
const PIECES: [&str; 40] = [
    "[[joint]]\n",
    "[joint.servo]\n",
    "[",
    "]",
    "{",
    "}",
    "\"",
    "'",
    "\"\"\"",
    "=",
    ",",
    "#",
    "\n",
    "\r\n",
    "\\",
    "é",
    "\u{0}",
    "nan",
    "inf",
    "-inf",
    "9223372036854775807",
    "-9223372036854775808",
    "1e400",
    "1e308",
    "0x",
    "1__0",
    "((((((((((((((((((((((((((((((((",
    "pi",
    "theta1",
    "q2",
    " deg",
    "<=",
    "fixed = 0\n",
    "type = \"prismatic\"\n",
    "couple = { J1 = 1 }\n",
    "[[ik]]\n",
    "free = [\"J1\"]\n",
    "limits = [1, -1]\n",
    "1979-05-27",
    "true",
];

fn mutated(text: &str, random: &mut Random) -> String {
    let mut bytes = text.as_bytes().to_vec();
    for _ in 0..=random.below(4) {
        let at = random.below(bytes.len() + 1);
        let length = random.below(12).min(bytes.len() - at);
        match random.below(4) {
            0 => {
                bytes.splice(at..at + length, []);
            }
            1 => {
                bytes.splice(at..at, PIECES[random.below(PIECES.len())].bytes());
            }
            2 => {
                let from = random.below(bytes.len() + 1);
                let copied = bytes[from..(from + length * 4).min(bytes.len())].to_vec();
                bytes.splice(at..at, copied);
            }
            _ => {
                if let Some(byte) = bytes.get_mut(at) {
                    *byte = random.below(128) as u8;
                }
            }
        }
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

fn survives(text: &str, style: Style) {
    diagnostics_of(text).render(text, "mutated.toml", style);
}

#[test]
fn no_mutation_panics() {
    let mut random = Random(0x9e37_79b9_7f4a_7c15);
    for path in tables() {
        let text = std::fs::read_to_string(&path).unwrap();
        for style in [Style::Plain, Style::WithinError, Style::Coloured].repeat(15) {
            survives(&mutated(&text, &mut random), style);
        }
    }
}

#[test]
fn nothing_large_or_deep_hangs() {
    let deep =
        |open: &str, close: &str, count: usize| format!("{}1{}", open.repeat(count), close.repeat(count));
    let head = "[robot]\nname = \"x\"\nconvention = \"standard\"\n[[joint]]\n";
    let texts = [
        format!("{head}d = \"{}\"", deep("(", ")", 60_000)),
        format!("{head}d = \"{}1\"", "-".repeat(200_000)),
        format!("{head}d = \"1{}\"", "+1".repeat(100_000)),
        format!("{head}d = \"{}", "sin(".repeat(50_000)),
        format!("{head}d = {}", deep("[", "]", 50_000)),
        format!("{head}d = {}", deep("{ a = ", "}", 30_000)),
        format!("{}.a = 1", "a.a".repeat(60_000)),
        (0..20_000)
            .map(|index| {
                format!(
                    "k{index} = 1
"
                )
            })
            .collect::<Vec<_>>()
            .concat(),
        "a = 1\n".repeat(40_000),
        format!("a = {{ {} }}", "a = 1, ".repeat(30_000)),
        "[[joint]]\n".repeat(20_000),
        "[[ik]]\nname = \"a\"\n".repeat(10_000),
        "[a]\n".repeat(50_000),
        "= \n".repeat(60_000),
        format!("{head}[poses]\na = [{}]", "1, ".repeat(60_000)),
        format!(
            "{head}[[ik]]\nname = \"x\"\ntarget = \"xy\"\nconstraints = [{}]",
            "\"q1 = 1\", ".repeat(20_000)
        ),
        format!(
            "{head}[[ik]]\nname = \"x\"\ntarget = \"xy\"\nconstraints = [\"{}q1 = 1\"]",
            "q1 + ".repeat(40_000)
        ),
        format!("{head}name = \"{}\"\nd = \"{}\"", "n".repeat(100_000), "x".repeat(100_000)),
        format!("{head}d = {}", "9".repeat(200_000)),
        format!("{head}d = 0x{}", "f".repeat(200_000)),
        format!(
            "{head}d = 1e308\na = -1e308\nalpha = 1e308\n[[joint]]\nd = 1e308\nalpha = 1e-308\ncouple = {{ J1 = 1e308 }}\n"
        ),
        "\u{feff}[robot]\nname = 1".to_owned(),
        "x".repeat(300_000),
    ];
    for text in texts {
        survives(&text, Style::Plain);
    }
}
