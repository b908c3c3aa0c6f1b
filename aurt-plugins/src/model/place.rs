//! The way to a value of a model file.

/// One step from a value to one inside it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Step {
    /// Into an object.
    Key(String),
    /// Into a list.
    Item(usize),
}

/// The way to a value in words: `joint_dynamics[2].coulomb: `.
pub(crate) fn in_words(steps: &[Step]) -> String {
    let mut words = String::new();
    for step in steps {
        match step {
            Step::Key(key) if words.is_empty() => words.push_str(key),
            Step::Key(key) => words.extend([".", key]),
            Step::Item(i) => words.push_str(&format!("[{i}]")),
        }
    }
    if words.is_empty() { words } else { format!("`{words}` ") }
}
