//! Straight-line programs: operations on doubles, with constants folded and no operation written twice.

use std::collections::HashMap;
use std::fmt::Write;

use super::language::{Language, literal};

#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Value {
    /// Known when the program is written.
    Constant(f64),
    /// The result of an operation, by its number.
    Node(usize),
}

pub(crate) const ZERO: Value = Value::Constant(0.0);

/// A function of `math.h`, by its name there, or the one that the source defines.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum Function {
    Sin,
    Cos,
    Tanh,
    Exp,
    Abs,
    Pow,
    /// Sign of the first argument where it exceeds the second in magnitude, else 0.
    SignBeyond,
}

impl Function {
    const fn name(self) -> &'static str {
        match self {
            Self::Sin => "sin",
            Self::Cos => "cos",
            Self::Tanh => "tanh",
            Self::Exp => "exp",
            Self::Abs => "fabs",
            Self::Pow => "pow",
            Self::SignBeyond => "sign_beyond",
        }
    }
}

#[derive(Debug, Clone, PartialEq, Eq, Hash)]
enum Operation {
    Input(String),
    Add(Key, Key),
    Subtract(Key, Key),
    Multiply(Key, Key),
    Divide(Key, Key),
    Negate(Key),
    Call(Function, Vec<Key>),
}

/// A value that can be looked up: constants by their bits.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
enum Key {
    Constant(u64),
    Node(usize),
}

impl From<Value> for Key {
    fn from(value: Value) -> Self {
        match value {
            Value::Constant(c) => Self::Constant(c.to_bits()),
            Value::Node(n) => Self::Node(n),
        }
    }
}

/// Operations that a program needs at run time.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(crate) struct Operations {
    /// Multiplications and divisions.
    pub multiplications: usize,
    /// Additions and subtractions.
    pub additions: usize,
    /// Calls of functions.
    pub calls: usize,
}

impl std::fmt::Display for Operations {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { multiplications, additions, calls } = self;
        write!(f, "{multiplications} multiplications, {additions} additions, {calls} calls")
    }
}

#[derive(Debug, Clone, Default)]
pub(crate) struct Tape {
    operations: Vec<Operation>,
    known: HashMap<Operation, usize>,
}

impl Tape {
    /// An argument of the function, as C and Rust write it.
    pub fn input(&mut self, text: String) -> Value {
        self.push(Operation::Input(text))
    }

    pub fn add(&mut self, a: Value, b: Value) -> Value {
        match (a, b) {
            (Value::Constant(x), Value::Constant(y)) => Value::Constant(x + y),
            (Value::Constant(0.0), other) | (other, Value::Constant(0.0)) => other,
            _ => match (self.negated(a), self.negated(b)) {
                (_, Some(b)) => self.subtract(a, b),
                (Some(a), None) => self.subtract(b, a),
                _ => {
                    let (a, b) = ordered(a, b);
                    self.push(Operation::Add(a, b))
                }
            },
        }
    }

    pub fn subtract(&mut self, a: Value, b: Value) -> Value {
        match (a, b) {
            (Value::Constant(x), Value::Constant(y)) => Value::Constant(x - y),
            (other, Value::Constant(0.0)) => other,
            (Value::Constant(0.0), other) => self.negate(other),
            _ if a == b => ZERO,
            _ => match self.negated(b) {
                Some(b) => self.add(a, b),
                None => self.push(Operation::Subtract(a.into(), b.into())),
            },
        }
    }

    pub fn multiply(&mut self, a: Value, b: Value) -> Value {
        match (a, b) {
            (Value::Constant(x), Value::Constant(y)) => Value::Constant(x * y),
            (Value::Constant(0.0), _) | (_, Value::Constant(0.0)) => ZERO,
            (Value::Constant(1.0), other) | (other, Value::Constant(1.0)) => other,
            (Value::Constant(-1.0), other) | (other, Value::Constant(-1.0)) => self.negate(other),
            _ => match (self.negated(a), self.negated(b)) {
                (Some(a), Some(b)) => self.multiply(a, b),
                (Some(a), None) => {
                    let product = self.multiply(a, b);
                    self.negate(product)
                }
                (None, Some(b)) => {
                    let product = self.multiply(a, b);
                    self.negate(product)
                }
                (None, None) => {
                    let (a, b) = ordered(a, b);
                    self.push(Operation::Multiply(a, b))
                }
            },
        }
    }

    /// a divided by a constant that is not zero.
    pub fn divide(&mut self, a: Value, divisor: f64) -> Value {
        match a {
            Value::Constant(x) => Value::Constant(x / divisor),
            Value::Node(_) if divisor == 1.0 => a,
            Value::Node(_) => self.push(Operation::Divide(a.into(), Value::Constant(divisor).into())),
        }
    }

    /// a divided by a value that is not constant.
    pub fn quotient(&mut self, a: Value, divisor: Value) -> Value {
        match (a, divisor) {
            (_, Value::Constant(d)) => self.divide(a, d),
            (Value::Constant(0.0), _) => ZERO,
            _ => self.push(Operation::Divide(a.into(), divisor.into())),
        }
    }

    pub fn negate(&mut self, a: Value) -> Value {
        match (a, self.negated(a)) {
            (Value::Constant(x), _) => Value::Constant(-x),
            (_, Some(inner)) => inner,
            _ => self.push(Operation::Negate(a.into())),
        }
    }

    pub fn call(&mut self, function: Function, arguments: &[Value]) -> Value {
        self.push(Operation::Call(function, arguments.iter().map(|a| Key::from(*a)).collect()))
    }

    fn negated(&self, a: Value) -> Option<Value> {
        let Value::Node(node) = a else { return None };
        match &self.operations[node] {
            Operation::Negate(inner) => Some(value(*inner)),
            _ => None,
        }
    }

    fn push(&mut self, operation: Operation) -> Value {
        if let Some(node) = self.known.get(&operation) {
            return Value::Node(*node);
        }
        let node = self.operations.len();
        self.operations.push(operation.clone());
        self.known.insert(operation, node);
        Value::Node(node)
    }

    /// The statements that assign `results` to `targets`, without those that no result needs.
    pub fn statements(&self, language: Language, targets: &[String], results: &[Value]) -> String {
        let needed = self.needed(results);
        let mut text = String::new();
        let names = self.names(&needed);
        for (node, operation) in self.operations.iter().enumerate() {
            if !needed[node] || matches!(operation, Operation::Input(_)) {
                continue;
            }
            let value = self.right_side(operation, &names);
            let _ = writeln!(text, "    {}", language.binding(&names[node], &value));
        }
        for (target, result) in targets.iter().zip(results) {
            let _ = writeln!(text, "    {target} = {};", written((*result).into(), &names));
        }
        text
    }

    /// How many operations the results need.
    pub fn operations(&self, results: &[Value]) -> Operations {
        let mut count = Operations::default();
        let needed = self.needed(results);
        for operation in self.operations.iter().zip(&needed).filter(|(_, n)| **n).map(|(o, _)| o) {
            match operation {
                Operation::Multiply(..) | Operation::Divide(..) => count.multiplications += 1,
                Operation::Add(..) | Operation::Subtract(..) => count.additions += 1,
                Operation::Call(..) => count.calls += 1,
                Operation::Input(_) | Operation::Negate(_) => {}
            }
        }
        count
    }

    /// The names of all operations: arguments by their text, others numbered in the order in which they are written.
    fn names(&self, needed: &[bool]) -> Vec<String> {
        let mut number = 0;
        self.operations
            .iter()
            .zip(needed)
            .map(|(operation, needed)| match operation {
                Operation::Input(text) => text.clone(),
                _ => {
                    number += usize::from(*needed);
                    format!("t{number}")
                }
            })
            .collect()
    }

    fn needed(&self, results: &[Value]) -> Vec<bool> {
        let mut needed = vec![false; self.operations.len()];
        let mut open: Vec<Key> = results.iter().map(|r| Key::from(*r)).collect();
        while let Some(key) = open.pop() {
            let Key::Node(node) = key else { continue };
            if std::mem::replace(&mut needed[node], true) {
                continue;
            }
            match &self.operations[node] {
                Operation::Input(_) => {}
                Operation::Add(a, b)
                | Operation::Subtract(a, b)
                | Operation::Multiply(a, b)
                | Operation::Divide(a, b) => open.extend([*a, *b]),
                Operation::Negate(a) => open.push(*a),
                Operation::Call(_, arguments) => open.extend(arguments),
            }
        }
        needed
    }

    fn right_side(&self, operation: &Operation, names: &[String]) -> String {
        let of = |key: &Key| written(*key, names);
        match operation {
            Operation::Input(text) => text.clone(),
            Operation::Add(a, b) => format!("{} + {}", of(a), of(b)),
            Operation::Subtract(a, b) => format!("{} - {}", of(a), of(b)),
            Operation::Multiply(a, b) => format!("{} * {}", of(a), of(b)),
            Operation::Divide(a, b) => format!("{} / {}", of(a), of(b)),
            Operation::Negate(a) => format!("-{}", of(a)),
            Operation::Call(function, arguments) => {
                let arguments: Vec<String> = arguments.iter().map(of).collect();
                format!("{}({})", function.name(), arguments.join(", "))
            }
        }
    }
}

fn value(key: Key) -> Value {
    match key {
        Key::Constant(bits) => Value::Constant(f64::from_bits(bits)),
        Key::Node(node) => Value::Node(node),
    }
}

fn ordered(a: Value, b: Value) -> (Key, Key) {
    let (a, b) = (Key::from(a), Key::from(b));
    if a <= b { (a, b) } else { (b, a) }
}

fn written(key: Key, names: &[String]) -> String {
    match key {
        Key::Constant(bits) => literal(f64::from_bits(bits)),
        Key::Node(node) => names[node].clone(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn constants_fold_and_nothing_is_written_twice_or_in_vain() {
        let mut tape = Tape::default();
        let [x, y] = ["x[0]", "y[0]"].map(|name| tape.input(name.into()));
        let two = Value::Constant(2.0);
        assert_eq!(tape.multiply(x, ZERO), ZERO);
        assert_eq!(tape.add(ZERO, x), x);
        assert_eq!(tape.multiply(two, two), Value::Constant(4.0));
        let minus = tape.negate(x);
        assert_eq!(tape.negate(minus), x);
        let _in_vain = tape.call(Function::Exp, &[x]);
        let first = tape.multiply(two, x);
        let second = tape.multiply(x, two);
        assert_eq!(first, second);
        let difference = tape.add(y, minus);
        let sum = tape.add(first, difference);
        let text = tape.statements(Language::C, &["out".into()], &[sum]);
        assert_eq!(
            text,
            "    const double t1 = 2.0 * x[0];\n    const double t2 = y[0] - x[0];\n    \
             const double t3 = t1 + t2;\n    out = t3;\n"
        );
        let count = Operations { multiplications: 1, additions: 2, calls: 0 };
        assert_eq!(tape.operations(&[sum]), count);
    }
}
