//! Formulas in scene files: "0.1*sin(pi*x/50)" → a short program, run on many points at once.
//!
//! ```text
//! text ─► parser (precedence, bounded depth) ─► postfix program ─► values at many points
//!                                                x 3 * sin          a stack of blocks of 64
//! ```
//!
//! Functions come from `libm`, so that a formula gives the same bits on every machine. Errors carry their
//! place in the text.

use core::fmt;
use core::ops::Range;

/// A fault of a formula.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct ExpressionError {
    /// The bytes of the text that the error points at.
    pub(crate) place: Range<usize>,
    /// The fault, in words.
    pub(crate) message: String,
    /// Advice on what to write instead.
    pub(crate) hint: Option<String>,
}

/// A formula that is ready to be evaluated.
#[derive(Clone, PartialEq)]
pub(crate) struct Expression {
    text: String,
    program: Vec<Op>,
    /// Largest number of blocks on the stack.
    stack: usize,
}

impl fmt::Debug for Expression {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:?}", self.text)
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Op {
    Number(f64),
    Variable(usize),
    Negate,
    Square,
    Add,
    Subtract,
    Multiply,
    Divide,
    Compare(Comparison),
    /// A function of one number, by its index in [`UNARY`].
    Unary(usize),
    /// A function of two numbers, by its index in [`BINARY`].
    Binary(usize),
    /// A function of three numbers, by its index in [`TERNARY`].
    Ternary(usize),
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Comparison {
    Less,
    LessOrEqual,
    Greater,
    GreaterOrEqual,
}

impl Comparison {
    fn holds(self, a: f64, b: f64) -> bool {
        match self {
            Self::Less => a < b,
            Self::LessOrEqual => a <= b,
            Self::Greater => a > b,
            Self::GreaterOrEqual => a >= b,
        }
    }
}

type Unary = fn(f64) -> f64;
type Binary = fn(f64, f64) -> f64;
type Ternary = fn(f64, f64, f64) -> f64;

/// Functions of one number.
const UNARY: &[(&str, Unary)] = &[
    ("sin", libm::sin),
    ("cos", libm::cos),
    ("tan", libm::tan),
    ("asin", libm::asin),
    ("acos", libm::acos),
    ("atan", libm::atan),
    ("sinh", libm::sinh),
    ("cosh", libm::cosh),
    ("tanh", libm::tanh),
    ("exp", libm::exp),
    ("ln", libm::log),
    ("log2", libm::log2),
    ("log10", libm::log10),
    ("sqrt", libm::sqrt),
    ("cbrt", libm::cbrt),
    ("abs", libm::fabs),
    ("floor", libm::floor),
    ("ceil", libm::ceil),
    ("round", libm::round),
    ("sign", |a| f64::from(i8::from(a > 0.0) - i8::from(a < 0.0))),
];

/// Functions of two numbers.
const BINARY: &[(&str, Binary)] = &[
    ("pow", libm::pow),
    ("atan2", libm::atan2),
    ("hypot", libm::hypot),
    ("min", libm::fmin),
    ("max", libm::fmax),
    ("mod", |a, b| a - b * libm::floor(a / b)),
];

/// Functions of three numbers.
const TERNARY: &[(&str, Ternary)] = &[
    ("if", |c, a, b| if c != 0.0 { a } else { b }),
    ("clamp", |a, low, high| libm::fmin(libm::fmax(a, low), high)),
    ("smoothstep", |low, high, a| {
        let s = libm::fmin(libm::fmax((a - low) / (high - low), 0.0), 1.0);
        s * s * (3.0 - 2.0 * s)
    }),
];

const CONSTANTS: &[(&str, f64)] = &[
    ("pi", core::f64::consts::PI),
    ("tau", core::f64::consts::TAU),
    ("e", core::f64::consts::E),
];

/// Returns the names of all functions, those of one number first.
pub(crate) fn functions() -> impl Iterator<Item = &'static str> {
    let one = UNARY.iter().map(|(name, _)| *name);
    let two = BINARY.iter().map(|(name, _)| *name);
    one.chain(two).chain(TERNARY.iter().map(|(name, _)| *name))
}

/// Points that are evaluated together.
pub(crate) const BLOCK: usize = 64;

/// Numbers that fit on the stack of an evaluation without allocating memory.
const SHALLOW: usize = 8;

impl Expression {
    /// Longest formula \[bytes\].
    pub(crate) const LONGEST: usize = 10_000;

    /// Reads a formula in `variables`, which are numbered 0, 1, .. in this order.
    ///
    /// # Errors
    /// The first thing that is wrong, with its place.
    pub(crate) fn parse(text: &str, variables: &[&str]) -> Result<Self, ExpressionError> {
        if text.len() > Self::LONGEST {
            return Err(ExpressionError {
                place: 0..text.len(),
                message: format!("this expression has {} characters", text.len()),
                hint: Some(format!("at most {} are read", Self::LONGEST)),
            });
        }
        let mut parser = Parser {
            text,
            variables,
            at: 0,
            depth: 0,
            program: Vec::new(),
        };
        parser.comparison()?;
        parser.space();
        if parser.at < text.len() {
            return Err(parser.unexpected());
        }
        let (mut height, mut stack) = (0_usize, 0);
        for op in &parser.program {
            height = height + 1 - op.operands();
            stack = stack.max(height);
        }
        Ok(Self {
            text: text.to_owned(),
            program: parser.program,
            stack,
        })
    }

    /// Makes a formula of a number.
    pub(crate) fn number(number: f64) -> Self {
        Self {
            text: number.to_string(),
            program: vec![Op::Number(number)],
            stack: 1,
        }
    }

    /// Returns the value of a formula without variables.
    pub(crate) fn constant(&self) -> Option<f64> {
        match self.program[..] {
            [Op::Number(number)] => Some(number),
            _ => None,
        }
    }

    /// Returns true if the formula contains variable number `variable`.
    pub(crate) fn uses(&self, variable: usize) -> bool {
        self.program.contains(&Op::Variable(variable))
    }

    /// Evaluates the formula at every point: `fill(variable, first, values)` writes the values of a variable at
    /// the points `first..first + values.len()`.
    pub(crate) fn evaluate(&self, out: &mut [f64], fill: impl Fn(usize, usize, &mut [f64])) {
        // Only very deep formulas allocate memory.
        let (mut shallow, mut deep) = ([[0.0; BLOCK]; SHALLOW], Vec::new());
        let stack = if self.stack <= SHALLOW {
            &mut shallow[..]
        } else {
            deep.resize(self.stack, [0.0; BLOCK]);
            &mut deep[..]
        };
        for (block, out) in out.chunks_mut(BLOCK).enumerate() {
            let count = out.len();
            // The next free block on the stack.
            let mut top = 0;
            for op in &self.program {
                top -= op.operands();
                let (lower, upper) = stack.split_at_mut(top + 1);
                let a = &mut lower[top][..count];
                match *op {
                    Op::Number(number) => a.fill(number),
                    Op::Variable(variable) => fill(variable, block * BLOCK, a),
                    Op::Negate => a.iter_mut().for_each(|a| *a = -*a),
                    Op::Square => a.iter_mut().for_each(|a| *a *= *a),
                    Op::Unary(f) => a.iter_mut().for_each(|a| *a = UNARY[f].1(*a)),
                    Op::Ternary(f) => {
                        for (i, a) in a.iter_mut().enumerate() {
                            *a = TERNARY[f].1(*a, upper[0][i], upper[1][i]);
                        }
                    }
                    Op::Add => pairs(a, upper, |a, b| a + b),
                    Op::Subtract => pairs(a, upper, |a, b| a - b),
                    Op::Multiply => pairs(a, upper, |a, b| a * b),
                    Op::Divide => pairs(a, upper, |a, b| a / b),
                    Op::Compare(c) => pairs(a, upper, |a, b| f64::from(u8::from(c.holds(a, b)))),
                    Op::Binary(f) => pairs(a, upper, BINARY[f].1),
                }
                top += 1;
            }
            out.copy_from_slice(&stack[0][..count]);
        }
    }
}

fn pairs(a: &mut [f64], upper: &[[f64; BLOCK]], f: impl Fn(f64, f64) -> f64) {
    for (a, b) in a.iter_mut().zip(&upper[0]) {
        *a = f(*a, *b);
    }
}

impl Op {
    /// Returns how many numbers the operation takes from the stack. It puts back one.
    fn operands(self) -> usize {
        match self {
            Self::Number(_) | Self::Variable(_) => 0,
            Self::Negate | Self::Square | Self::Unary(_) => 1,
            Self::Ternary(_) => 3,
            _ => 2,
        }
    }
}

/// Deepest nesting of parentheses, signs and powers.
const DEEPEST: usize = 100;

struct Parser<'a> {
    text: &'a str,
    variables: &'a [&'a str],
    at: usize,
    depth: usize,
    program: Vec<Op>,
}

impl<'a> Parser<'a> {
    fn error(&self, place: Range<usize>, message: impl Into<String>) -> ExpressionError {
        ExpressionError {
            place,
            message: message.into(),
            hint: None,
        }
    }

    fn rest(&self) -> &'a str {
        &self.text[self.at..]
    }

    fn space(&mut self) {
        self.at = self.text.len() - self.rest().trim_start().len();
    }

    /// Consumes `word` if it comes next.
    fn take(&mut self, word: &str) -> bool {
        self.space();
        let found = self.rest().starts_with(word);
        if found {
            self.at += word.len();
        }
        found
    }

    /// Makes the error of the next character, which cannot stand here.
    fn unexpected(&self) -> ExpressionError {
        let Some(c) = self.rest().chars().next() else {
            let mut error = self.error(
                self.text.len()..self.text.len(),
                "the expression ends too soon",
            );
            if self.text.trim().is_empty() {
                error.message = "the expression is empty".to_owned();
            }
            return error;
        };
        let place = self.at..self.at + c.len_utf8();
        let hint = match c {
            ')' => Some("there is no \"(\" to it".to_owned()),
            ',' => Some(
                "a decimal point is written \".\"; commas part a function's arguments".to_owned(),
            ),
            '=' | '!' | '&' | '|' => {
                Some("there are <, <=, > and >=; products of them are \"and\"".to_owned())
            }
            c if c.is_alphanumeric() || c == '(' => Some("write * to multiply".to_owned()),
            _ => None,
        };
        ExpressionError {
            hint,
            ..self.error(place, format!("\"{c}\" is not expected here"))
        }
    }

    /// Adds an operation, or its result if all of its operands are numbers.
    fn push(&mut self, op: Op) {
        let from = self.program.len() - op.operands();
        self.program.push(op);
        let constant = op.operands() > 0
            && self.program[from..self.program.len() - 1]
                .iter()
                .all(|op| matches!(op, Op::Number(_)));
        if constant {
            let folded = Expression {
                text: String::new(),
                program: self.program.split_off(from),
                stack: 3,
            };
            let mut value = [0.0];
            folded.evaluate(&mut value, |_, _, _| {});
            self.program.push(Op::Number(value[0]));
        }
    }

    /// Parses `sum (< sum)?`.
    fn comparison(&mut self) -> Result<(), ExpressionError> {
        self.sum()?;
        for (word, comparison) in [
            ("<=", Comparison::LessOrEqual),
            (">=", Comparison::GreaterOrEqual),
            ("<", Comparison::Less),
            (">", Comparison::Greater),
        ] {
            if self.take(word) {
                self.sum()?;
                self.push(Op::Compare(comparison));
                break;
            }
        }
        Ok(())
    }

    /// Parses `product (± product)*`.
    fn sum(&mut self) -> Result<(), ExpressionError> {
        self.product()?;
        loop {
            let op = if self.take("+") {
                Op::Add
            } else if self.take("-") {
                Op::Subtract
            } else {
                return Ok(());
            };
            self.product()?;
            self.push(op);
        }
    }

    /// Parses `factor (×÷ factor)*`.
    fn product(&mut self) -> Result<(), ExpressionError> {
        self.factor()?;
        loop {
            let op = if self.take("*") {
                Op::Multiply
            } else if self.take("/") {
                Op::Divide
            } else {
                return Ok(());
            };
            self.factor()?;
            self.push(op);
        }
    }

    /// Parses `±factor` or `value (^ factor)?`: −2^2 is −4, 2^3^2 is 2^9. All recursion passes through here.
    fn factor(&mut self) -> Result<(), ExpressionError> {
        self.space();
        self.depth += 1;
        if self.depth > DEEPEST {
            let place = self.at..self.text.len();
            return Err(self.error(
                place,
                format!("the expression is nested more than {DEEPEST} deep"),
            ));
        }
        if self.take("-") {
            self.factor()?;
            self.push(Op::Negate);
        } else if self.take("+") {
            self.factor()?;
        } else {
            self.value()?;
            if self.take("^") {
                let from = self.program.len();
                self.factor()?;
                if self.program[from..] == [Op::Number(2.0)] {
                    self.program.pop();
                    self.push(Op::Square);
                } else {
                    self.push(Op::Binary(0)); // pow
                }
            }
        }
        self.depth -= 1;
        Ok(())
    }

    /// Parses a number, a name, a call, or an expression in parentheses.
    fn value(&mut self) -> Result<(), ExpressionError> {
        let start = self.at;
        match self.rest().chars().next() {
            Some('(') => {
                self.at += 1;
                self.comparison()?;
                self.close(start)
            }
            Some(c) if c.is_ascii_digit() || c == '.' => self.number(),
            Some(c) if c.is_alphabetic() || c == '_' => self.name(),
            _ => Err(self.unexpected()),
        }
    }

    /// Expects the parenthesis that closes the one at `open`.
    fn close(&mut self, open: usize) -> Result<(), ExpressionError> {
        if self.take(")") {
            return Ok(());
        }
        if self.at == self.text.len() {
            return Err(self.error(open..open + 1, "this parenthesis is not closed"));
        }
        Err(self.unexpected())
    }

    fn number(&mut self) -> Result<(), ExpressionError> {
        let bytes = self.text.as_bytes();
        let start = self.at;
        let digits = |from: usize| {
            let is_part = |b: &&u8| b.is_ascii_digit() || **b == b'.';
            from + bytes[from..].iter().take_while(is_part).count()
        };
        let mut end = digits(start);
        if matches!(bytes.get(end), Some(b'e' | b'E')) {
            let signed = usize::from(matches!(bytes.get(end + 1), Some(b'+' | b'-')));
            if bytes.get(end + 1 + signed).is_some_and(u8::is_ascii_digit) {
                end = digits(end + 1 + signed);
            }
        }
        self.at = end;
        match self.text[start..end].parse::<f64>() {
            Ok(number) if number.is_finite() => {
                self.push(Op::Number(number));
                Ok(())
            }
            _ => Err(self.error(start..end, "this is not a number")),
        }
    }

    fn name(&mut self) -> Result<(), ExpressionError> {
        let start = self.at;
        let length = self
            .rest()
            .find(|c: char| !(c.is_alphanumeric() || c == '_'))
            .unwrap_or(self.rest().len());
        let name = &self.text[start..start + length];
        self.at += length;
        let place = start..self.at;
        let open = self.at;
        let called = self.take("(");
        let call = |table: Option<usize>, op: fn(usize) -> Op, operands| {
            table.map(|index| (op(index), operands))
        };
        let function = call(UNARY.iter().position(|f| f.0 == name), Op::Unary, 1)
            .or_else(|| call(BINARY.iter().position(|f| f.0 == name), Op::Binary, 2))
            .or_else(|| call(TERNARY.iter().position(|f| f.0 == name), Op::Ternary, 3));
        if let Some((op, wanted)) = function {
            if !called {
                let error = self.error(place, format!("\"{name}\" is a function"));
                return Err(ExpressionError {
                    hint: Some(format!("write {name}(..)")),
                    ..error
                });
            }
            let mut given = 0;
            if !self.take(")") {
                loop {
                    self.comparison()?;
                    given += 1;
                    if !self.take(",") {
                        break;
                    }
                }
                self.close(
                    open + (self.text[open..].len() - self.text[open..].trim_start().len()),
                )?;
            }
            if given != wanted {
                let of = ["no argument", "1 argument", "2 arguments", "3 arguments"];
                return Err(self.error(
                    start..self.at,
                    format!("\"{name}\" takes {}, not {given}", of[wanted]),
                ));
            }
            self.push(op);
            return Ok(());
        }
        if !called {
            if let Some(variable) = self.variables.iter().position(|v| *v == name) {
                self.push(Op::Variable(variable));
                return Ok(());
            }
            if let Some((_, number)) = CONSTANTS.iter().find(|(constant, _)| *constant == name) {
                self.push(Op::Number(*number));
                return Ok(());
            }
        }
        Err(self.unknown(name, place, called))
    }

    fn unknown(&self, name: &str, place: Range<usize>, called: bool) -> ExpressionError {
        let shown = crate::text::shorten(name);
        let known: Vec<&str> = if called {
            functions().collect()
        } else {
            let constants = CONSTANTS.iter().map(|(name, _)| *name);
            self.variables
                .iter()
                .copied()
                .filter(|name| !name.starts_with('('))
                .chain(constants)
                .collect()
        };
        let kind = if called { "function" } else { "variable" };
        let hint = match crate::error::nearest(name, known.iter().copied()) {
            Some(near) if name.chars().count() > 1 => format!("did you mean \"{near}\"?"),
            _ => format!("known here: {}", known.join(", ")),
        };
        ExpressionError {
            hint: Some(hint),
            ..self.error(place, format!("unknown {kind} \"{shown}\""))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn value(text: &str, x: f64, y: f64) -> f64 {
        let expression = Expression::parse(text, &["x", "y"]).expect(text);
        let mut out = [0.0];
        expression.evaluate(&mut out, |variable, _, column| {
            column.fill(if variable == 0 { x } else { y });
        });
        out[0]
    }

    #[test]
    fn arithmetic_is_as_on_paper() {
        for (text, wanted) in [
            ("1 + 2 * 3", 7.0),
            ("(1 + 2) * 3", 9.0),
            ("2 - 3 - 4", -5.0),
            ("24 / 4 / 2", 3.0),
            ("-2^2", -4.0),
            ("2^-1", 0.5),
            ("2^3^2", 512.0),
            ("--1", 1.0),
            ("1.5e1 + .5", 15.5),
            ("2*e", 2.0 * core::f64::consts::E),
            ("x*y - y^2", 0.3 * 0.7 - 0.7 * 0.7),
            ("sin(pi/2) + cos(0)", 2.0),
            ("atan2(1, 1) * 4", core::f64::consts::PI),
            ("if(x < y, 1, 2)", 1.0),
            ("if(x >= y, 1, 2)", 2.0),
            ("clamp(5, 0, 1) + min(x, y) + max(x, y)", 2.0),
            ("mod(-1, 3)", 2.0),
            ("sign(-3) + abs(-3)", 2.0),
            ("smoothstep(0, 2, 1)", 0.5),
            (" ( x ) ", 0.3),
        ] {
            let found = value(text, 0.3, 0.7);
            assert!((found - wanted).abs() < 1e-14, "{text} is {found}");
        }
    }

    #[test]
    fn many_points_are_evaluated_like_one() {
        let expression = Expression::parse("if(x > 1, sin(x)*x - 3, x^3/2) + 1", &["x"]).unwrap();
        let points: Vec<f64> = (0..1000).map(|i| f64::from(i) * 0.003).collect();
        let mut all = vec![0.0; points.len()];
        expression.evaluate(&mut all, |_, first, column| {
            column.copy_from_slice(&points[first..first + column.len()]);
        });
        for (x, found) in points.iter().zip(all) {
            let mut one = [0.0];
            expression.evaluate(&mut one, |_, _, column| column.fill(*x));
            assert_eq!(one[0].to_bits(), found.to_bits());
        }
    }

    #[test]
    fn numbers_only_are_one_number() {
        assert_eq!(Expression::parse("2*pi*3", &[]).unwrap().program.len(), 1);
        let expression = Expression::parse("x*(1+1)", &["x", "t"]).unwrap();
        assert!(expression.uses(0) && !expression.uses(1) && expression.constant().is_none());
    }

    #[test]
    fn errors_know_their_place() {
        let error = |text: &str| {
            let error = Expression::parse(text, &["x", "y", "t"]).unwrap_err();
            (error.place.start, error.place.end, error.message)
        };
        assert_eq!(error("x + z").0, 4);
        assert_eq!(error("sin(x").0, 3);
        assert_eq!(error("x)").0, 1);
        assert_eq!(error("2x").0, 1);
        assert_eq!(error("x +").0, 3);
        assert_eq!(error("1.2.3").2, "this is not a number");
        assert_eq!(error("sine(x)").0, 0);
        assert_eq!(error("atan2(x)").2, "\"atan2\" takes 2 arguments, not 1");
        assert_eq!(error("sin").2, "\"sin\" is a function");
        assert_eq!(error("").2, "the expression is empty");
        assert_eq!(error("x == 1").0, 2);
        for deep in ["(".repeat(5000), "-".repeat(5000), "2^".repeat(3000)] {
            assert!(error(&deep).2.contains("deep"));
        }
        assert!(error(&"x+".repeat(9000)).2.contains("18000"));
        let sum = format!("{}x", "x+".repeat(4000));
        assert!(Expression::parse(&sum, &["x"]).is_ok());
    }

    proptest! {
        #[test]
        fn no_text_makes_it_panic(text in "[-+*/^()., xyzt0-9esinqrtabif<>=é]{0,40}") {
            if let Ok(expression) = Expression::parse(&text, &["x", "y", "z", "t"]) {
                let mut out = [0.0; 70];
                expression.evaluate(&mut out, |_, _, column| column.fill(0.5));
            }
        }
    }
}
