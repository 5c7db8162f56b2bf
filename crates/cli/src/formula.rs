//! Formulas over named numbers, with their derivatives: `ball.x^2 + 0.1*ball.vy`.
//!
//! ```text
//!  sum     = product { ("+" | "-") product }
//!  product = sign { ("*" | "/") sign }
//!  sign    = { "+" | "-" } power                       −x^2 is −(x^2)
//!  power   = atom [ "^" sign ]                         x^y^z is x^(y^z)
//!  atom    = number | "pi" | name | "{" name "}" | function "(" sum ")" | "(" sum ")"
//! ```
//!
//! A name is made of letters, digits, `_` and `.`; braces admit any other (`{left link.x}`). What begins with
//! `impulse(` goes on behind the parenthesis (`impulse(ball, floor).n`).

use std::f64::consts::PI;

use crate::impulse::IMPULSE;

/// Formulas of more bytes, or nested deeper, are refused: they are read and evaluated recursively.
const LONGEST: usize = 4000;
const DEEPEST: usize = 100;

/// A formula whose variables are of type `V`.
#[derive(Clone, Debug, PartialEq)]
pub struct Formula<V> {
    /// The variables that occur, each once.
    pub variables: Vec<V>,
    root: Node,
}

/// What is wrong with a formula.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("column {column}: {message}")]
pub struct FormulaError {
    /// Column, from 1.
    pub column: usize,
    /// What is wrong and what to do.
    pub message: String,
}

#[derive(Clone, Debug, PartialEq)]
enum Node {
    Number(f64),
    Variable(usize),
    Negative(Box<Node>),
    Binary(char, Box<[Node; 2]>),
    Call(Function, Box<Node>),
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Function {
    Sin,
    Cos,
    Tan,
    Exp,
    Ln,
    Sqrt,
    Abs,
}

const FUNCTIONS: [(&str, Function); 7] = [
    ("sin", Function::Sin),
    ("cos", Function::Cos),
    ("tan", Function::Tan),
    ("exp", Function::Exp),
    ("ln", Function::Ln),
    ("sqrt", Function::Sqrt),
    ("abs", Function::Abs),
];

impl<V: PartialEq> Formula<V> {
    /// Reads a formula; `resolve` says which variable a name stands for, or why none.
    ///
    /// # Errors
    /// The column and what is wrong there.
    pub fn parse(
        text: &str,
        resolve: impl Fn(&str) -> Result<V, String>,
    ) -> Result<Self, FormulaError> {
        let mut parser = Parser { text, at: 0, depth: 0, variables: Vec::new(), resolve };
        if text.len() > LONGEST {
            let message = format!("{} bytes are too many; {LONGEST} are allowed", text.len());
            return Err(parser.error(message));
        }
        let root = parser.sum()?;
        match parser.peek() {
            None => Ok(Self { variables: parser.variables, root }),
            Some(c) => Err(parser.error(format!("unexpected `{c}`; an operator was expected"))),
        }
    }

    /// The value and its derivatives by the variables, whose values are given in their order.
    #[must_use]
    pub fn evaluate(&self, values: &[f64]) -> (f64, Vec<f64>) {
        let Dual { value, d } = self.root.evaluate(values);
        (value, d)
    }
}

struct Parser<'a, V, R> {
    text: &'a str,
    at: usize,
    /// How deep the place is nested.
    depth: usize,
    variables: Vec<V>,
    resolve: R,
}

impl<V: PartialEq, R: Fn(&str) -> Result<V, String>> Parser<'_, V, R> {
    fn sum(&mut self) -> Result<Node, FormulaError> {
        let mut left = self.product()?;
        while let Some(operator) = self.accept(&['+', '-']) {
            left = Node::Binary(operator, Box::new([left, self.product()?]));
        }
        Ok(left)
    }

    fn product(&mut self) -> Result<Node, FormulaError> {
        let mut left = self.sign()?;
        while let Some(operator) = self.accept(&['*', '/']) {
            left = Node::Binary(operator, Box::new([left, self.sign()?]));
        }
        Ok(left)
    }

    fn sign(&mut self) -> Result<Node, FormulaError> {
        if self.depth == DEEPEST {
            return Err(self.error(format!("nested more than {DEEPEST} deep; simplify it")));
        }
        self.depth += 1;
        let node = self.signed();
        self.depth -= 1;
        node
    }

    fn signed(&mut self) -> Result<Node, FormulaError> {
        match self.accept(&['+', '-']) {
            Some('-') => Ok(Node::Negative(Box::new(self.sign()?))),
            Some(_) => self.sign(),
            None => self.power(),
        }
    }

    fn power(&mut self) -> Result<Node, FormulaError> {
        let base = self.atom()?;
        match self.accept(&['^']) {
            Some(operator) => Ok(Node::Binary(operator, Box::new([base, self.sign()?]))),
            None => Ok(base),
        }
    }

    fn atom(&mut self) -> Result<Node, FormulaError> {
        match self.peek() {
            None => {
                Err(self.error("the formula ends where a number or a name was expected".into()))
            }
            Some('(') => self.parenthesis(),
            Some('{') => {
                let rest = &self.text[self.at + 1..];
                let end = rest.find('}').ok_or_else(|| self.error("`}` is missing".into()))?;
                let variable = self.variable(&rest[..end])?;
                self.at += end + 2;
                Ok(variable)
            }
            Some(c) if c.is_ascii_digit() || c == '.' => self.number(),
            Some(c) if c.is_alphabetic() || c == '_' => self.name(),
            Some(c) => {
                Err(self.error(format!("unexpected `{c}`; a number or a name was expected")))
            }
        }
    }

    fn parenthesis(&mut self) -> Result<Node, FormulaError> {
        self.at += 1;
        let inside = self.sum()?;
        match self.accept(&[')']) {
            Some(_) => Ok(inside),
            None => Err(self.error("`)` is missing".into())),
        }
    }

    fn number(&mut self) -> Result<Node, FormulaError> {
        let rest = &self.text[self.at..];
        let mut previous = ' ';
        let belongs = |c: char| {
            let exponent = matches!(previous, 'e' | 'E') && matches!(c, '+' | '-');
            previous = c;
            c.is_ascii_digit() || matches!(c, '.' | 'e' | 'E') || exponent
        };
        let digits = prefix(rest, belongs);
        let number = digits.parse();
        let number = number.map_err(|_| self.error(format!("`{digits}` is not a number")))?;
        self.at += digits.len();
        Ok(Node::Number(number))
    }

    fn name(&mut self) -> Result<Node, FormulaError> {
        let rest = &self.text[self.at..];
        let mut name = prefix(rest, belongs);
        if name == IMPULSE && rest[name.len()..].trim_start().starts_with('(') {
            let end = rest.find(')').ok_or_else(|| self.error("`)` is missing".into()))? + 1;
            name = &rest[..end + prefix(&rest[end..], belongs).len()];
        }
        if name == "pi" {
            self.at += name.len();
            return Ok(Node::Number(PI));
        }
        if let Some((_, function)) = FUNCTIONS.iter().find(|(known, _)| *known == name) {
            self.at += name.len();
            return match self.peek() {
                Some('(') => Ok(Node::Call(*function, Box::new(self.parenthesis()?))),
                _ => Err(self.error(format!("`(` is missing after `{name}`"))),
            };
        }
        let variable = self.variable(name)?;
        self.at += name.len();
        Ok(variable)
    }

    fn variable(&mut self, name: &str) -> Result<Node, FormulaError> {
        let variable = (self.resolve)(name.trim()).map_err(|message| self.error(message))?;
        let known = self.variables.iter().position(|v| *v == variable);
        Ok(Node::Variable(known.unwrap_or_else(|| {
            self.variables.push(variable);
            self.variables.len() - 1
        })))
    }

    /// The next character that is not blank.
    fn peek(&mut self) -> Option<char> {
        self.at += self.text[self.at..].len() - self.text[self.at..].trim_start().len();
        self.text[self.at..].chars().next()
    }

    fn accept(&mut self, wanted: &[char]) -> Option<char> {
        let found = self.peek().filter(|c| wanted.contains(c))?;
        self.at += found.len_utf8();
        Some(found)
    }

    fn error(&self, message: String) -> FormulaError {
        FormulaError { column: self.text[..self.at].chars().count() + 1, message }
    }
}

/// Whether a character may be part of a name.
fn belongs(c: char) -> bool {
    c.is_alphanumeric() || c == '_' || c == '.'
}

/// The longest start of a text whose characters all belong.
fn prefix(text: &str, mut belongs: impl FnMut(char) -> bool) -> &str {
    &text[..text.find(|c| !belongs(c)).unwrap_or(text.len())]
}

/// A value and its derivatives by all variables.
struct Dual {
    value: f64,
    d: Vec<f64>,
}

impl Dual {
    /// f(u) with f'(u) at hand.
    fn of(value: f64, slope: f64, u: Self) -> Self {
        Self { value, d: u.d.into_iter().map(|du| slope * du).collect() }
    }

    /// f(a, b) with both partial derivatives at hand.
    fn of_two(value: f64, [by_a, by_b]: [f64; 2], a: &Self, b: &Self) -> Self {
        // A variable that does not occur must not meet an infinite slope.
        let term = |slope: f64, d: f64| if d == 0.0 { 0.0 } else { slope * d };
        let d = a.d.iter().zip(&b.d).map(|(da, db)| term(by_a, *da) + term(by_b, *db)).collect();
        Self { value, d }
    }
}

impl Node {
    fn evaluate(&self, x: &[f64]) -> Dual {
        match self {
            Self::Number(value) => Dual { value: *value, d: vec![0.0; x.len()] },
            Self::Variable(i) => {
                let d = (0..x.len()).map(|k| if k == *i { 1.0 } else { 0.0 }).collect();
                Dual { value: x[*i], d }
            }
            Self::Negative(u) => {
                let u = u.evaluate(x);
                Dual::of(-u.value, -1.0, u)
            }
            Self::Binary(operator, sides) => {
                let [a, b] = [sides[0].evaluate(x), sides[1].evaluate(x)];
                let (u, v) = (a.value, b.value);
                let (value, by) = match operator {
                    '+' => (u + v, [1.0, 1.0]),
                    '-' => (u - v, [1.0, -1.0]),
                    '*' => (u * v, [v, u]),
                    '/' => (u / v, [1.0 / v, -u / (v * v)]),
                    _ if v == 0.0 => (1.0, [0.0, u.ln()]),
                    _ => (u.powf(v), [v * u.powf(v - 1.0), u.powf(v) * u.ln()]),
                };
                Dual::of_two(value, by, &a, &b)
            }
            Self::Call(function, u) => {
                let u = u.evaluate(x);
                let (value, slope) = function.evaluate(u.value);
                Dual::of(value, slope, u)
            }
        }
    }
}

impl Function {
    /// Value and slope.
    fn evaluate(self, u: f64) -> (f64, f64) {
        match self {
            Self::Sin => (u.sin(), u.cos()),
            Self::Cos => (u.cos(), -u.sin()),
            Self::Tan => (u.tan(), 1.0 + u.tan().powi(2)),
            Self::Exp => (u.exp(), u.exp()),
            Self::Ln => (u.ln(), 1.0 / u),
            Self::Sqrt => (u.sqrt(), 0.5 / u.sqrt()),
            Self::Abs => (u.abs(), if u == 0.0 { 0.0 } else { u.signum() }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Formula, FormulaError};

    fn parse(text: &str) -> Result<Formula<String>, FormulaError> {
        Formula::parse(text, |name| match name {
            "a.x" | "b.x" | "left link.y" | "impulse(a, b c).n" => Ok(name.to_owned()),
            _ => Err(format!("unknown `{name}`")),
        })
    }

    #[track_caller]
    fn check(text: &str, [a, b]: [f64; 2], value: f64, d: [f64; 2]) {
        let formula = parse(text).expect("the formula is valid");
        let at: Vec<f64> =
            formula.variables.iter().map(|v| if v == "a.x" { a } else { b }).collect();
        let (found, slopes) = formula.evaluate(&at);
        assert!((found - value).abs() < 1e-14, "{text} is {found}, not {value}");
        for (variable, slope) in formula.variables.iter().zip(slopes) {
            let expected = d[usize::from(variable != "a.x")];
            assert!((slope - expected).abs() < 1e-13, "{text} by {variable}: {slope}");
        }
    }

    #[test]
    fn precedence_is_that_of_mathematics() {
        check("-a.x^2", [3.0, 0.0], -9.0, [-6.0, 0.0]);
        check("2^-a.x", [1.0, 0.0], 0.5, [-0.5 * 2.0_f64.ln(), 0.0]);
        check("a.x^b.x^2", [2.0, 2.0], 16.0, [32.0, 64.0 * 2.0_f64.ln()]);
        check("1 - a.x - b.x*2/4", [1.0, 1.0], -0.5, [-1.0, -0.5]);
        check("(a.x - b.x)^2", [1.0, 3.0], 4.0, [-4.0, 4.0]);
        check("1e-2*a.x + .5", [1.0, 0.0], 0.51, [0.01, 0.0]);
    }

    #[test]
    fn functions_know_their_slopes() {
        check("sin(a.x)*cos(b.x)", [0.0, 0.0], 0.0, [1.0, 0.0]);
        check("exp(2*a.x) + ln(b.x)", [0.0, 4.0], 1.0 + 4.0_f64.ln(), [2.0, 0.25]);
        check("sqrt({left link.y}) + abs(a.x) + tan(pi)", [-3.0, 4.0], 5.0, [-1.0, 0.25]);
        check("2*impulse(a, b c).n - a.x", [1.0, 3.0], 5.0, [-1.0, 2.0]);
        check("a.x^0", [0.0, 0.0], 1.0, [0.0, 0.0]);
    }

    #[test]
    fn errors_name_the_column() {
        let error = |text| parse(text).expect_err("the formula is wrong").to_string();
        assert_eq!(error("a.x + c.x"), "column 7: unknown `c.x`");
        assert_eq!(
            error("a.x +"),
            "column 6: the formula ends where a number or a name was expected"
        );
        assert_eq!(error("2 a.x"), "column 3: unexpected `a`; an operator was expected");
        assert_eq!(error("1 + impulse(a"), "column 5: `)` is missing");
        assert_eq!(error("impulse"), "column 1: unknown `impulse`");
        assert_eq!(error("(a.x"), "column 5: `)` is missing");
        assert_eq!(error("sin a.x"), "column 5: `(` is missing after `sin`");
        assert_eq!(error("1.2.3"), "column 1: `1.2.3` is not a number");
        assert_eq!(error("{a.x"), "column 1: `}` is missing");
        assert_eq!(error("a.x * *"), "column 7: unexpected `*`; a number or a name was expected");
    }

    /// Formulas are read and evaluated recursively: deep ones must not use up the stack.
    #[test]
    fn length_and_depth_are_bounded() {
        let error = |text: String| parse(&text).expect_err("the formula is too much").to_string();
        let deep = "column 101: nested more than 100 deep; simplify it";
        assert_eq!(error("(".repeat(4000)), deep);
        assert_eq!(error("-".repeat(4000)), deep);
        assert_eq!(error(" ".repeat(4001)), "column 1: 4001 bytes are too many; 4000 are allowed");
        check(&"+a.x".repeat(1000), [0.5, 0.0], 500.0, [1000.0, 0.0]);
    }
}
