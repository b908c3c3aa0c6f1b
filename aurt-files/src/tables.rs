//! Bound on the tables of a TOML text.

/// Tables of a TOML text, those in lists (`[[…]]`) not counted: the time of the parser grows with the square of their number, a second
/// for as many.
pub const MOST_TABLES: usize = 4000;

/// The byte at which a TOML text has a table (`[name]`) more than [`MOST_TABLES`].
///
/// ```
/// assert_eq!(aurt_files::table_beyond("[robot]\nname = \"ur10e\"\n"), None);
/// ```
pub fn table_beyond(text: &str) -> Option<usize> {
    let (mut tables, mut at) = (0, 0);
    for line in text.split_inclusive('\n') {
        let begin = line.trim_start();
        // Rows of a list that begin lines are followed by a comma, or one is the last.
        let ends = |line: &str| line.split('#').next().is_some_and(|line| line.trim_end().ends_with(']'));
        if begin.starts_with('[') && !begin.starts_with("[[") && ends(begin) {
            tables += 1;
            if tables > MOST_TABLES {
                return Some(at);
            }
        }
        at += line.len();
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_are_counted_and_lists_are_not() {
        let most = "[a]\n".repeat(MOST_TABLES);
        assert_eq!(table_beyond(&most), None);
        assert_eq!(table_beyond(&format!("x = 1\n{most} [a] # more\n")), Some(6 + most.len()));
        for other in ["[[a]]\n", "[1, 2],\n", "a = [1]\n", "# [a]\n"] {
            assert_eq!(table_beyond(&other.repeat(2 * MOST_TABLES)), None, "{other}");
        }
    }
}
