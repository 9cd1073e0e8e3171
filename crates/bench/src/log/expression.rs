//! Arithmetic of columns: `(p_a - p_b) * 4.9e-4` in `[columns]`.
//!
//! An expression has `+ - * / ^`, a sign, parentheses, numbers with a decimal point, the functions
//! and constants below, and columns: by name, in backticks if the name has other characters than
//! letters, digits, `_` and points, or as `column(3)` by index from 0. `^` binds most tightly and
//! from the right, then a sign, then `*` and `/`.
//!
//! Parsing compiles to operations on a stack. So evaluation does not recurse, and the depth of
//! parsing is bounded.

/// Maximum depth of nested parentheses, signs and powers.
const MAX_DEPTH: usize = 64;
/// Maximum length of an expression, bytes.
const MAX_LENGTH: usize = 4096;

type Unary = fn(f64) -> f64;
type Binary = fn(f64, f64) -> f64;

/// Functions of one argument.
const FUNCTIONS: [(&str, Unary); 5] =
    [("abs", f64::abs), ("sqrt", f64::sqrt), ("sin", f64::sin), ("cos", f64::cos), ("tan", f64::tan)];
/// Functions of two arguments.
const FUNCTIONS_OF_TWO: [(&str, Binary); 1] = [("atan2", f64::atan2)];
/// Constants; a column of the same name hides them. `deg` is a degree in rad.
const CONSTANTS: [(&str, f64); 2] = [("pi", core::f64::consts::PI), ("deg", core::f64::consts::PI / 180.0)];

/// Reason why a text is no expression.
#[derive(Debug, PartialEq, thiserror::Error)]
#[error("character {position}: found {found}; expected {expected}")]
pub struct SyntaxError {
    /// Part that was found.
    pub found: String,
    /// Character of the text, from 1.
    pub position: usize,
    /// Part that was expected.
    pub expected: &'static str,
}

/// Step of an evaluation on a stack.
#[derive(Clone, Copy, Debug)]
enum Operation {
    Number(f64),
    /// Value of a column, by its place in `columns`.
    Column(usize),
    Negate,
    Binary(Binary),
    Unary(Unary),
}

/// An expression whose columns have been looked up.
#[derive(Debug, Default)]
pub struct Expression {
    /// Indices of the columns, each once.
    pub columns: Vec<usize>,
    /// Names that are no columns, each once.
    pub unknown: Vec<String>,
    operations: Vec<Operation>,
}

impl Expression {
    /// The expression that is one column.
    pub fn column(index: usize) -> Self {
        Self { columns: vec![index], operations: vec![Operation::Column(0)], ..Self::default() }
    }

    /// Parses a text; `locate` returns the index of a column by name.
    pub fn parse(text: &str, locate: &dyn Fn(&str) -> Option<usize>) -> Result<Self, SyntaxError> {
        if text.len() > MAX_LENGTH {
            let found = format!("more than {MAX_LENGTH} bytes");
            return Err(SyntaxError { found, position: 1, expected: "a shorter expression" });
        }
        let mut parser = Parser { text, at: 0, locate, depth: 0, out: Self::default() };
        parser.sum()?;
        match parser.token() {
            (Token::End, _) => Ok(parser.out),
            (token, at) => Err(parser.error(token, at, "an operator or the end")),
        }
    }

    /// Value for the readings of the columns in one row; `stack` is working memory.
    pub fn value(&self, readings: &[f64], stack: &mut Vec<f64>) -> f64 {
        stack.clear();
        for operation in &self.operations {
            let value = match *operation {
                Operation::Number(value) => value,
                Operation::Column(place) => readings.get(place).copied().unwrap_or(f64::NAN),
                Operation::Negate => -pop(stack),
                Operation::Unary(function) => function(pop(stack)),
                Operation::Binary(function) => {
                    let right = pop(stack);
                    function(pop(stack), right)
                }
            };
            stack.push(value);
        }
        pop(stack)
    }

    fn add_column(&mut self, index: usize) {
        let known = self.columns.iter().position(|column| *column == index);
        let place = known.unwrap_or_else(|| {
            self.columns.push(index);
            self.columns.len() - 1
        });
        self.operations.push(Operation::Column(place));
    }
}

/// Takes the last value; the parser pushes as many as are taken.
fn pop(stack: &mut Vec<f64>) -> f64 {
    stack.pop().unwrap_or(f64::NAN)
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Token<'a> {
    Number(&'a str),
    Name(&'a str),
    Quoted(&'a str),
    Sign(char),
    End,
}

const OPERAND: &str = "a number, a column, `(` or a function";

/// Recursive descent; every method leaves one value on the stack.
struct Parser<'a> {
    text: &'a str,
    /// Byte of the next token.
    at: usize,
    locate: &'a dyn Fn(&str) -> Option<usize>,
    depth: usize,
    out: Expression,
}

impl<'a> Parser<'a> {
    fn sum(&mut self) -> Result<(), SyntaxError> {
        self.product()?;
        loop {
            let add: Binary = match self.peek() {
                Token::Sign('+') => |a, b| a + b,
                Token::Sign('-') => |a, b| a - b,
                _ => return Ok(()),
            };
            self.token();
            self.product()?;
            self.out.operations.push(Operation::Binary(add));
        }
    }

    fn product(&mut self) -> Result<(), SyntaxError> {
        self.signed()?;
        loop {
            let multiply: Binary = match self.peek() {
                Token::Sign('*') => |a, b| a * b,
                Token::Sign('/') => |a, b| a / b,
                _ => return Ok(()),
            };
            self.token();
            self.signed()?;
            self.out.operations.push(Operation::Binary(multiply));
        }
    }

    /// A power with any number of signs. All recursion passes through here.
    fn signed(&mut self) -> Result<(), SyntaxError> {
        self.depth += 1;
        if self.depth > MAX_DEPTH {
            let position = self.position(self.at);
            let found = format!("more than {MAX_DEPTH} nested parentheses, signs or powers");
            return Err(SyntaxError { found, position, expected: "a simpler expression" });
        }
        match self.peek() {
            Token::Sign(sign @ ('+' | '-')) => {
                self.token();
                self.signed()?;
                if sign == '-' {
                    self.out.operations.push(Operation::Negate);
                }
            }
            _ => {
                self.operand()?;
                if self.peek() == Token::Sign('^') {
                    self.token();
                    self.signed()?;
                    self.out.operations.push(Operation::Binary(f64::powf));
                }
            }
        }
        self.depth -= 1;
        Ok(())
    }

    fn operand(&mut self) -> Result<(), SyntaxError> {
        match self.token() {
            (Token::Number(text), at) => match text.parse::<f64>() {
                Ok(value) if value.is_finite() => self.out.operations.push(Operation::Number(value)),
                _ => return Err(self.error(Token::Number(text), at, "a finite number with a decimal point")),
            },
            (Token::Quoted(name), _) => self.name(name),
            (Token::Name(name), at) if self.peek() == Token::Sign('(') => return self.call(name, at),
            (Token::Name(name), _) => self.name(name),
            (Token::Sign('('), _) => {
                self.sum()?;
                self.expect(')', "`)` or an operator")?;
            }
            (token, at) => return Err(self.error(token, at, OPERAND)),
        }
        Ok(())
    }

    /// Adds a column or a constant.
    fn name(&mut self, name: &str) {
        if let Some(index) = (self.locate)(name) {
            self.out.add_column(index);
        } else if let Some((_, value)) = CONSTANTS.iter().find(|(known, _)| *known == name) {
            self.out.operations.push(Operation::Number(*value));
        } else {
            if !self.out.unknown.iter().any(|known| known == name) {
                self.out.unknown.push(name.to_owned());
            }
            self.out.operations.push(Operation::Number(f64::NAN));
        }
    }

    /// Adds a function with its arguments in parentheses.
    fn call(&mut self, name: &str, at: usize) -> Result<(), SyntaxError> {
        let one = FUNCTIONS.iter().find(|(known, _)| *known == name);
        let two = FUNCTIONS_OF_TWO.iter().find(|(known, _)| *known == name);
        self.token();
        if let Some((_, function)) = one {
            self.sum()?;
            self.out.operations.push(Operation::Unary(*function));
        } else if let Some((_, function)) = two {
            self.sum()?;
            self.expect(',', "`,` and a second argument")?;
            self.sum()?;
            self.out.operations.push(Operation::Binary(*function));
        } else if name == "column" {
            match self.token() {
                (Token::Number(text), at) => match text.parse() {
                    Ok(index) => self.out.add_column(index),
                    Err(_) => return Err(self.error(Token::Number(text), at, "an index from 0")),
                },
                (token, at) => return Err(self.error(token, at, "an index from 0")),
            }
        } else {
            let expected = "an operator, or one of the functions abs, sqrt, sin, cos, tan, atan2, column";
            return Err(self.error(Token::Name(name), at, expected));
        }
        self.expect(')', "`)` or an operator")
    }

    fn expect(&mut self, sign: char, expected: &'static str) -> Result<(), SyntaxError> {
        match self.token() {
            (Token::Sign(found), _) if found == sign => Ok(()),
            (token, at) => Err(self.error(token, at, expected)),
        }
    }

    fn error(&self, token: Token<'_>, at: usize, expected: &'static str) -> SyntaxError {
        let found = match token {
            Token::End => "the end".into(),
            Token::Sign('`') => "a backtick without a second one".into(),
            Token::Sign(sign) => format!("`{sign}`"),
            Token::Number(text) | Token::Name(text) | Token::Quoted(text) => format!("`{text}`"),
        };
        SyntaxError { found, position: self.position(at), expected }
    }

    /// Character at a byte, from 1.
    fn position(&self, at: usize) -> usize {
        self.text.get(..at).unwrap_or(self.text).chars().count() + 1
    }

    fn peek(&mut self) -> Token<'a> {
        let at = self.at;
        let (token, _) = self.token();
        self.at = at;
        token
    }

    /// Takes the next token and returns it with its first byte.
    fn token(&mut self) -> (Token<'a>, usize) {
        let text = self.text;
        let rest = text.get(self.at..).unwrap_or_default();
        let start = self.at + rest.len() - rest.trim_start().len();
        let rest = rest.trim_start();
        let Some(first) = rest.chars().next() else { return (Token::End, start) };
        let span = |length: usize| rest.get(..length).unwrap_or(rest);
        let (token, length) = match first {
            '0'..='9' | '.' => {
                let length = number_length(rest);
                (Token::Number(span(length)), length)
            }
            '`' => match rest.get(1..).and_then(|rest| rest.split_once('`')) {
                Some((name, _)) => (Token::Quoted(name), name.len() + 2),
                None => (Token::Sign('`'), 1),
            },
            _ if is_of_name(first) => {
                let length = rest.find(|c| !is_of_name(c)).unwrap_or(rest.len());
                (Token::Name(span(length)), length)
            }
            sign => (Token::Sign(sign), sign.len_utf8()),
        };
        self.at = start + length;
        (token, start)
    }
}

fn is_of_name(letter: char) -> bool {
    letter.is_alphanumeric() || letter == '_' || letter == '.'
}

/// Length of a number at the start of a text: digits, points, and an exponent.
fn number_length(text: &str) -> usize {
    let is_of_number = |c: char| c.is_ascii_digit() || c == '.';
    let mantissa = text.find(|c| !is_of_number(c)).unwrap_or(text.len());
    let rest = text.get(mantissa..).unwrap_or_default();
    let Some(exponent) = rest.strip_prefix(['e', 'E']) else { return mantissa };
    let digits = exponent.strip_prefix(['+', '-']).unwrap_or(exponent);
    let count = digits.find(|c: char| !c.is_ascii_digit()).unwrap_or(digits.len());
    if count == 0 { mantissa } else { mantissa + rest.len() - digits.len() + count }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const NAMES: [&str; 4] = ["a", "b", "p A [bar]", "data.qm"];
    const READINGS: [f64; 4] = [3.0, -2.0, 5.0, 7.0];

    fn parsed(text: &str) -> Result<Expression, SyntaxError> {
        Expression::parse(text, &|name| NAMES.iter().position(|known| *known == name))
    }

    fn value(text: &str) -> f64 {
        let expression = parsed(text).unwrap_or_else(|error| panic!("{text}: {error:?}"));
        assert!(expression.unknown.is_empty(), "{text}");
        let readings: Vec<f64> = expression.columns.iter().map(|index| READINGS[*index]).collect();
        expression.value(&readings, &mut Vec::new())
    }

    #[test]
    fn expressions_have_the_usual_precedence() {
        for (text, expected) in [
            ("1 + 2 * 3", 7.0),
            ("(1 + 2) * 3", 9.0),
            ("8 / 4 / 2", 1.0),
            ("8 - 4 - 2", 2.0),
            ("2 ^ 3 ^ 2", 512.0),
            ("-2 ^ 2", -4.0),
            ("2 ^ -1 * 4", 2.0),
            ("2 * -3", -6.0),
            ("- - 3", 3.0),
            ("1.5e1 + .5 - 2.", 13.5),
            ("(a - b) * 4.9e-4", 5.0 * 4.9e-4),
            ("`p A [bar]` / a", 5.0 / 3.0),
            ("data.qm * deg", 7.0 * core::f64::consts::PI / 180.0),
            ("abs(b) + sqrt(a * a + 16)", 7.0),
            ("atan2(a - 3, b)", core::f64::consts::PI),
            ("sin(pi / 2) + cos(0) + tan(0)", 2.0),
            ("column(1) + column( 3 )", 5.0),
        ] {
            assert_eq!(value(text), expected, "{text}");
        }
        assert_eq!(parsed("a * a + b").unwrap().columns, [0, 1]);
        assert_eq!(parsed("c - a + d * c").unwrap().unknown, ["c", "d"]);
        let hides = Expression::parse("pi", &|name| (name == "pi").then_some(0)).unwrap();
        assert_eq!(hides.columns, [0]);
    }

    #[test]
    fn syntax_errors_have_a_position() {
        let nested = format!("{}1", "(".repeat(4_000));
        for (text, found, position, expected) in [
            ("", "the end", 1, OPERAND),
            ("(a - b", "the end", 7, "`)` or an operator"),
            ("a b", "`b`", 3, "an operator or the end"),
            ("Weg [mm]", "`[`", 5, "an operator or the end"),
            ("a + * b", "`*`", 5, OPERAND),
            ("\u{e4} + )", "`)`", 5, OPERAND),
            ("0,5 * a", "`,`", 2, "an operator or the end"),
            ("1.2.3", "`1.2.3`", 1, "a finite number with a decimal point"),
            ("1e999", "`1e999`", 1, "a finite number with a decimal point"),
            ("atan2(a)", "`)`", 8, "`,` and a second argument"),
            ("column(a)", "`a`", 8, "an index from 0"),
            (
                "a(2)",
                "`a`",
                1,
                "an operator, or one of the functions abs, sqrt, sin, cos, tan, atan2, column",
            ),
            ("`a", "a backtick without a second one", 1, OPERAND),
            // Deep nesting does not overflow the stack.
            (&nested, "more than 64 nested parentheses, signs or powers", 65, "a simpler expression"),
        ] {
            let error = SyntaxError { found: found.into(), position, expected };
            assert_eq!(parsed(text).unwrap_err(), error, "{}", &text[..text.len().min(40)]);
        }
    }

    /// A random expression with its value, written with all parentheses or with some of them.
    fn written() -> impl Strategy<Value = (String, f64)> {
        let number =
            (-1000_i32..1000).prop_map(|n| (format!("({n}e-1)"), format!("{n}e-1").parse().unwrap()));
        let column = (0..4_usize).prop_map(|i| (format!("`{}`", NAMES[i]), READINGS[i]));
        prop_oneof![number, column].prop_recursive(5, 64, 2, |inner| {
            (inner.clone(), inner, 0..4).prop_map(|((left, a), (right, b), kind)| match kind {
                0 => (format!("({left} + {right})"), a + b),
                1 => (format!("({left}-{right})"), a - b),
                2 => (format!("( {left} * {right} )"), a * b),
                _ => (format!("(-({left})/({right}))"), -a / b),
            })
        })
    }

    proptest! {
        #[test]
        fn random_expressions_have_the_value_of_their_parts((text, expected) in written()) {
            let found = value(&text);
            prop_assert!(found == expected || found.is_nan() && expected.is_nan(), "{text}: {found}");
        }

        #[test]
        fn any_text_is_parsed_or_refused(
            text in "[-+*/^(),.`a-e0-9 \u{e4}]{0,80}|(\\(|-|2\\^|sin\\(){0,300}"
        ) {
            if let Ok(expression) = parsed(&text) {
                let readings = vec![1.0; expression.columns.len()];
                let mut stack = Vec::new();
                expression.value(&readings, &mut stack);
                prop_assert!(stack.is_empty(), "{text}");
            }
        }
    }
}
