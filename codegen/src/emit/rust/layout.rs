//! Expressions, and where their lines break: as rustfmt's defaults would break them.

/// Columns of a line.
pub(super) const WIDTH: usize = 100;
/// Width up to which rustfmt keeps arguments and arrays on one line.
const SHORT: usize = 60;
/// Width of an element up to which a long array is filled line by line.
const NARROW: usize = 10;
/// Columns of one level.
const TAB: usize = 4;

/// An expression of the generated text.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Expression {
    /// A name, literal or anything that binds at least as tightly as a call.
    Atom(String),
    /// -x
    Neg(Box<Expression>),
    /// x op y
    Binary(Operator, Box<Expression>, Box<Expression>),
    /// `[x, y, ..]`
    Array(Vec<Expression>),
    /// `(x, y)`, always over several lines.
    Tuple(Vec<Expression>),
    /// `f(x, y, ..)`
    Call(String, Vec<Expression>),
    /// `S { field: x, .. }`, always over several lines.
    Struct(String, Vec<(&'static str, Expression)>),
}

/// A binary operator.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Operator {
    Add,
    Sub,
    Mul,
    Div,
}

impl Operator {
    fn symbol(self) -> &'static str {
        match self {
            Self::Add => "+",
            Self::Sub => "-",
            Self::Mul => "*",
            Self::Div => "/",
        }
    }

    fn binds_tighter(self) -> bool {
        matches!(self, Self::Mul | Self::Div)
    }
}

impl Expression {
    /// On one line.
    pub(super) fn flat(&self) -> String {
        match self {
            Self::Atom(text) => text.clone(),
            Self::Neg(x) => {
                format!("-{}", parenthesised(x, matches!(**x, Self::Binary(..) | Self::Neg(_)), Self::flat))
            }
            Self::Binary(operator, left, right) => {
                let (left, right) = operands(*operator, left, right, Self::flat);
                format!("{left} {} {right}", operator.symbol())
            }
            Self::Array(items) => format!("[{}]", list(items)),
            Self::Tuple(items) => format!("({})", list(items)),
            Self::Call(function, arguments) => format!("{function}({})", list(arguments)),
            Self::Struct(name, fields) => {
                let fields: Vec<_> =
                    fields.iter().map(|(field, value)| format!("{field}: {}", value.flat())).collect();
                format!("{name} {{ {} }}", fields.join(", "))
            }
        }
    }

    /// Lines for a place `used` columns into a line of a block at `indent`, with `after` columns to follow.
    pub(super) fn lines(&self, indent: usize, used: usize, after: usize) -> String {
        let flat = self.flat();
        let fits = used + flat.len() + after <= WIDTH;
        match self {
            Self::Atom(_) => flat,
            Self::Struct(name, fields) => struct_lines(name, fields, indent),
            Self::Tuple(items) => bracketed("(", items, ")", indent),
            Self::Array(items) if !fits || flat.len() - 2 > SHORT => bracketed("[", items, "]", indent),
            Self::Call(function, arguments)
                if !fits
                    || matches!(arguments[..], [Self::Struct(..)])
                    || flat.len() - function.len() - 2 > SHORT =>
            {
                match &arguments[..] {
                    [Self::Array(items)] => return bracketed(&format!("{function}(["), items, "])", indent),
                    [Self::Struct(name, fields)] => {
                        return format!("{})", struct_lines(&format!("{function}({name}"), fields, indent));
                    }
                    _ => {}
                }
                bracketed(&format!("{function}("), arguments, ")", indent)
            }
            _ if fits => flat,
            Self::Neg(x) => {
                let parentheses = matches!(**x, Self::Binary(..) | Self::Neg(_));
                format!("-{}", parenthesised(x, parentheses, |x| x.lines(indent, used + 2, after + 1)))
            }
            Self::Binary(operator, ..) => self.chain(*operator, indent, used, after),
            Self::Array(_) | Self::Call(..) => flat,
        }
    }

    /// The operands of a chain of one operator, one a line.
    fn chain(&self, operator: Operator, indent: usize, used: usize, after: usize) -> String {
        let mut operands = Vec::new();
        let mut rest = self;
        while let Self::Binary(same, left, right) = rest
            && *same == operator
        {
            operands.push((&**right, needs_right(operator, right)));
            rest = left;
        }
        operands.push((rest, needs_left(operator, rest)));
        operands.reverse();
        let nested = indent + TAB;
        let mut text = String::new();
        let last = operands.len() - 1;
        for (i, (operand, parentheses)) in operands.into_iter().enumerate() {
            let after = if i == last { after } else { 0 } + usize::from(parentheses);
            if i == 0 {
                text = parenthesised(operand, parentheses, |x| {
                    x.lines(indent, used + usize::from(parentheses), after)
                });
                continue;
            }
            let end = text.lines().last().map_or(0, str::len) + if text.contains('\n') { 0 } else { used };
            if end <= nested {
                // So short a first operand would stand alone: the next one joins it.
                text.push(' ');
            } else {
                text.push('\n');
                text.push_str(&" ".repeat(nested));
            }
            text.push_str(operator.symbol());
            text.push(' ');
            let column = nested + 2 + usize::from(parentheses);
            text.push_str(&parenthesised(operand, parentheses, |x| x.lines(nested, column, after)));
        }
        text
    }
}

/// `head expression tail` as a statement at `indent`; a right-hand side that fits whole on a line of its own gets one.
pub(super) fn statement(indent: usize, head: &str, expression: &Expression, tail: &str) -> String {
    let margin = " ".repeat(indent);
    if head.is_empty() {
        return format!("{margin}{}{tail}", expression.lines(indent, indent, tail.len()));
    }
    let beside = expression.lines(indent, indent + head.len() + 1, tail.len());
    let long = beside.lines().next().map_or(0, str::len) + indent + head.len() + 1 + tail.len() > WIDTH;
    if beside.contains('\n') || long {
        let below = expression.lines(indent + TAB, indent + TAB, tail.len());
        let own = matches!(expression, Expression::Binary(..) | Expression::Neg(_) | Expression::Atom(_));
        let fits = indent + TAB + below.len() + tail.len() <= WIDTH;
        let call = matches!(expression, Expression::Call(..)) && fits && !below.contains('\n');
        if call
            || own && (fits && !below.contains('\n') || beside.lines().count() > below.lines().count() + 1)
        {
            return format!("{margin}{head}\n{}{below}{tail}", " ".repeat(indent + TAB));
        }
    }
    format!("{margin}{head} {beside}{tail}")
}

fn needs_left(operator: Operator, left: &Expression) -> bool {
    matches!(left, Expression::Binary(inner, ..) if operator.binds_tighter() && !inner.binds_tighter())
}

fn needs_right(operator: Operator, right: &Expression) -> bool {
    match right {
        Expression::Binary(inner, ..) => operator.binds_tighter() || !inner.binds_tighter(),
        Expression::Neg(_) => true,
        _ => false,
    }
}

fn operands(
    operator: Operator,
    left: &Expression,
    right: &Expression,
    print: impl Fn(&Expression) -> String,
) -> (String, String) {
    (
        parenthesised(left, needs_left(operator, left), &print),
        parenthesised(right, needs_right(operator, right), &print),
    )
}

fn parenthesised(
    expression: &Expression,
    parentheses: bool,
    print: impl Fn(&Expression) -> String,
) -> String {
    let text = print(expression);
    if parentheses { format!("({text})") } else { text }
}

fn list(items: &[Expression]) -> String {
    items.iter().map(Expression::flat).collect::<Vec<_>>().join(", ")
}

/// Items between brackets, over several lines: filled where all are narrow, else one a line.
fn bracketed(open: &str, items: &[Expression], close: &str, indent: usize) -> String {
    let nested = indent + TAB;
    let margin = " ".repeat(nested);
    let mut text = format!("{open}\n");
    let array = open.ends_with('[');
    if array && items.iter().all(|item| item.flat().len() <= NARROW) {
        let mut row = margin.clone();
        for item in items {
            let item = item.flat();
            if row.len() > nested && row.len() + item.len() + 2 > WIDTH {
                text.push_str(row.trim_end());
                text.push('\n');
                row.clone_from(&margin);
            }
            row.push_str(&item);
            row.push_str(", ");
        }
        text.push_str(row.trim_end());
        text.push('\n');
    } else {
        for item in items {
            text.push_str(&margin);
            text.push_str(&item.lines(nested, nested, 1));
            text.push_str(",\n");
        }
    }
    text.push_str(&" ".repeat(indent));
    text.push_str(close);
    text
}

fn struct_lines(name: &str, fields: &[(&'static str, Expression)], indent: usize) -> String {
    let nested = indent + TAB;
    let mut text = format!("{name} {{\n");
    for (field, value) in fields {
        match value {
            Expression::Atom(same) if same == field => text.extend([" ".repeat(nested).as_str(), field, ","]),
            _ => text.push_str(&statement(nested, &format!("{field}:"), value, ",")),
        }
        text.push('\n');
    }
    text.push_str(&" ".repeat(indent));
    text.push('}');
    text
}

#[cfg(test)]
mod tests {
    use super::{Expression, Operator, statement};

    fn binary(operator: Operator, x: Expression, y: Expression) -> Expression {
        Expression::Binary(operator, Box::new(x), Box::new(y))
    }

    fn atom(text: &str) -> Expression {
        Expression::Atom(text.to_owned())
    }

    #[test]
    fn parentheses_keep_the_order_of_evaluation() {
        use Operator::{Add, Div, Mul, Sub};
        let sum = || binary(Add, atom("a"), atom("b"));
        let product = || binary(Mul, atom("a"), atom("b"));
        assert_eq!(binary(Sub, sum(), atom("c")).flat(), "a + b - c");
        assert_eq!(binary(Add, atom("c"), sum()).flat(), "c + (a + b)");
        assert_eq!(binary(Div, product(), atom("c")).flat(), "a * b / c");
        assert_eq!(binary(Mul, atom("c"), product()).flat(), "c * (a * b)");
        assert_eq!(binary(Add, product(), product()).flat(), "a * b + a * b");
        assert_eq!(binary(Mul, sum(), Expression::Neg(Box::new(atom("c")))).flat(), "(a + b) * (-c)");
        assert_eq!(Expression::Neg(Box::new(sum())).flat(), "-(a + b)");
    }

    #[test]
    fn long_sums_break_before_their_operators() {
        let term = || binary(Operator::Mul, atom("a_long_coefficient"), atom("another_value"));
        let two = binary(Operator::Add, term(), term());
        let short = statement(4, "let x =", &binary(Operator::Add, two.clone(), atom("c")), ";");
        assert_eq!(
            short,
            "    let x = a_long_coefficient * another_value + a_long_coefficient * another_value + c;"
        );
        let three = binary(Operator::Add, two, term());
        assert_eq!(
            statement(8, "let x =", &three, ";"),
            "        let x = a_long_coefficient * another_value
            + a_long_coefficient * another_value
            + a_long_coefficient * another_value;"
        );
        let call = Expression::Call("search.trig".to_owned(), vec![atom("THETA1"), three]);
        assert_eq!(
            statement(4, "for theta1 in", &call, " {"),
            "    for theta1 in search.trig(
        THETA1,
        a_long_coefficient * another_value
            + a_long_coefficient * another_value
            + a_long_coefficient * another_value,
    ) {"
        );
    }
}
