//! What C and Rust write differently of a line of operations.

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Language {
    C,
    Rust,
}

impl Language {
    /// A value that gets a name.
    pub fn binding(self, name: &str, value: &str) -> String {
        match self {
            Self::C => format!("const double {name} = {value};"),
            Self::Rust => format!("let {name} = {value};"),
        }
    }

    /// A member of the state.
    pub fn member(self, name: &str) -> String {
        match self {
            Self::C => format!("state->{name}"),
            Self::Rust => format!("state.{name}"),
        }
    }

    /// Elements of an array that a function changes.
    pub fn changed(self, array: &str, first: usize, count: usize) -> String {
        match self {
            Self::C => format!("&{array}[{first}]"),
            Self::Rust => format!("&mut {array}[{first}..{}]", first + count),
        }
    }

    /// A table at file scope, as an argument; C states its length beside it.
    pub fn table(self, name: &str, length: usize) -> String {
        match self {
            Self::C => format!("{name}, {length}"),
            Self::Rust => format!("&{}", name.to_uppercase()),
        }
    }

    /// The definition of a table at file scope.
    pub fn table_definition(self, name: &str, values: &[f64]) -> String {
        let count = values.len();
        let values = list(values);
        match self {
            Self::C => format!("\nstatic const double {name}[{count}] = {{{values}}};\n"),
            Self::Rust => format!("\nconst {}: [f64; {count}] = [{values}];\n", name.to_uppercase()),
        }
    }
}

/// Numbers with commas between them.
pub(crate) fn list(values: &[f64]) -> String {
    values.iter().map(|v| literal(*v)).collect::<Vec<String>>().join(", ")
}

/// A finite number as C and Rust write it, with all its digits.
pub(crate) fn literal(number: f64) -> String {
    // Minus zero would read as a negation of nothing.
    let number = if number == 0.0 { 0.0 } else { number };
    if number < 0.0 { format!("({number:?})") } else { format!("{number:?}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn literals_keep_all_digits() {
        assert_eq!(literal(-0.1), "(-0.1)");
        assert_eq!(literal(-0.0), "0.0");
        assert_eq!(literal(1e-300), "1e-300");
        assert_eq!(literal(1.0 / 3.0).parse::<f64>().unwrap(), 1.0 / 3.0);
    }
}
