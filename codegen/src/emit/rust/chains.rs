//! Constants of inverse functions that find all unknowns at once: the chain, and what a nearly special arm is to the one
//! that was meant.

use super::Printer;
use super::body::Locals;
use super::layout::Expression;
use super::number::{self, number};
use super::text::Text;
use crate::plan::{FollowingChain, GeneralChain, Nearly, Step};

impl Printer<'_> {
    /// What some steps need to know of the arm.
    pub(super) fn arms(&self, text: &mut Text, steps: &[Step], locals: &Locals) {
        for step in steps {
            match step {
                Step::General { chain, .. } => self.chain(text, &locals.chain, chain),
                Step::Descents { chain, .. } => self.following(text, &locals.chain, chain),
                Step::Near { nearly, otherwise, .. } => {
                    self.nearly(text, locals, nearly);
                    self.arms(text, otherwise, locals);
                }
                _ => {}
            }
        }
    }

    /// What a nearly special arm is to the one that was meant.
    fn nearly(&self, text: &mut Text, locals: &Locals, nearly: &Nearly) {
        let (name, chain) = (&locals.nearly, &locals.chain);
        let ty = self.paths.runtime("Nearly");
        text.line("#[rustfmt::skip]");
        text.line(format!("const {name}: {ty}<'static> = {ty} {{"));
        text.line(format!("    unknowns: &{:?},", nearly.unknowns));
        let follow = nearly
            .follow
            .iter()
            .map(|(place, joint, factor)| format!("({place}, {joint}, {})", self.exact(*factor).flat()));
        text.line(format!("    follow: &[{}],", follow.collect::<Vec<_>>().join(", ")));
        text.line(
            "    // What each step is off by: by the deviation; by earlier unknowns that are off by 1.",
        );
        text.line("    gains: &[");
        let (mut gains, mut length) = (nearly.gains.as_slice(), 1);
        while let Some((row, rest)) = gains.split_at_checked(length).filter(|(row, _)| !row.is_empty()) {
            let row = row.iter().map(|gain| number(*gain, super::ScalarType::F64, &self.paths));
            text.line(format!("        {},", row.collect::<Vec<_>>().join(", ")));
            (gains, length) = (rest, length + 1);
        }
        text.line("    ],");
        let deviation = number(nearly.deviation, super::ScalarType::F64, &self.paths);
        text.line(format!("    deviation: {deviation},"));
        text.line(format!("    mirrored: {},", nearly.mirrored));
        let [some, none] = ["Some", "None"].map(|name| self.paths.prelude(name));
        if let Some(joints) = &nearly.joints {
            text.line(format!("    chain: {some}({} {{", self.paths.runtime("Exact")));
            text.line(format!("        arm: {chain},"));
            text.line("        // Each joint as a form in those of the chain: six factors and a constant.");
            text.line("        joints: &[");
            for form in joints {
                text.line(format!("            {},", self.exact_list(form)));
            }
            text.line("        ],");
            text.line("    }),");
        } else {
            text.line(format!("    chain: {none},"));
        }
        text.line("};");
    }

    /// The chain of a function that searches: f64 whatever the scalar.
    fn following(&self, text: &mut Text, name: &str, chain: &FollowingChain) {
        let ty = self.paths.runtime("RowChain");
        let forms = chain.forms.iter().flatten().copied();
        Self::allow_approximate(text, chain.links.iter().flat_map(dh_core::Frame::rows).chain(forms));
        text.line("#[rustfmt::skip]");
        text.line(format!("const {name}: {ty}<'static> = {ty} {{"));
        self.links(text, ["row", "rows"], &chain.links);
        text.line(format!("    prismatic: &{:?},", chain.prismatic));
        text.line("    // Each row by the unknowns, the joints that are given, and a constant.");
        text.line("    forms: &[");
        for form in &chain.forms {
            text.line(format!("        &{},", self.exact_list(form)));
        }
        text.line("    ],");
        text.line("    // After how many turns of each unknown all is as it was; 0 for a slide.");
        text.line(format!("    turns: &{:?},", chain.turns));
        text.line(format!("    reach: {},", self.exact(chain.reach).flat()));
        text.line(format!("    patience: {},", chain.patience));
        text.line("};");
    }

    /// An f64 whatever the scalar.
    fn exact(&self, value: f64) -> Expression {
        let text = number(value.abs(), super::ScalarType::F64, &self.paths);
        Expression::Atom(if value.is_sign_negative() { format!("-{text}") } else { text })
    }

    fn exact_list(&self, values: &[f64]) -> String {
        Expression::Array(values.iter().map(|value| self.exact(*value)).collect()).flat()
    }

    fn allow_approximate(text: &mut Text, values: impl IntoIterator<Item = f64>) {
        if values.into_iter().any(number::looks_approximate) {
            text.line(format!("#[allow({}, reason = \"as the table has it\")]", number::APPROXIMATE));
        }
    }

    /// Fixed transforms between joints, or rows.
    fn links(&self, text: &mut Text, [one, many]: [&str; 2], links: &[dh_core::Frame]) {
        text.line(format!(
            "    // Rows of [R | p]: before the first {one}, between the {many}, after the last."
        ));
        text.line("    links: &[");
        for link in links {
            let rows = self.exact_list(&link.rows());
            text.line(format!("        {}::from_rows({rows}),", self.paths.runtime("Frame")));
        }
        text.line("    ],");
    }

    /// The chain of a function without a closed form: f64 whatever the scalar, for its polynomials need the digits.
    fn chain(&self, text: &mut Text, name: &str, chain: &GeneralChain) {
        let ty = self.paths.runtime("GeneralArm");
        Self::allow_approximate(text, chain.links.iter().flat_map(dh_core::Frame::rows));
        text.line("#[rustfmt::skip]");
        // What does not depend on the target is computed when this is compiled.
        let prepared = chain.given.is_empty() && !chain.charts.is_empty();
        let bare = if prepared { format!("BARE_{name}") } else { name.to_owned() };
        text.line(format!("const {bare}: {ty}<'static> = {ty} {{"));
        self.links(text, ["joint", "joints"], &chain.links);
        text.line(format!("    prismatic: &{:?},", chain.prismatic));
        text.line(format!("    given: &{:?},", chain.given));
        text.line(format!("    reach: {},", self.exact(chain.reach).flat()));
        text.line("    charts: &[");
        for chart in &chain.charts {
            let dh_core::Chart { dropped, backward, hidden, swapped, divided, degree, periods } = chart;
            let repeated = if *periods == 1 { String::new() } else { format!(".repeated({periods})") };
            text.line(format!(
                "        {}::new({dropped}, {backward}, {hidden}, {swapped}, {divided}, {degree}){repeated},",
                self.paths.runtime("Chart")
            ));
        }
        text.line("    ],");
        text.line("    triple: &None,");
        text.line("};");
        if prepared {
            text.line("// With what does not depend on the target.");
            text.line(format!(
                "const {name}: {ty}<'static> = {ty} {{ triple: &{bare}.triple(), ..{bare} }};"
            ));
        }
    }
}
