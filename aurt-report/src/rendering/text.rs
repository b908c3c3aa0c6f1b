//! Running text on lines of limited width.

/// Columns of the narrowest usual terminal.
pub const WIDTH: usize = 80;

/// `text` on lines of at most `width` columns, each begun by `indent` and ended by a newline.
pub fn wrapped_at(text: &str, width: usize, indent: &str) -> String {
    wrapped_with(text, width, indent, indent)
}

/// A sentence of a report: indented, continued lines indented further.
pub fn wrapped(sentence: &str) -> String {
    wrapped_with(sentence, WIDTH, "  ", "    ")
}

/// `text` on lines of at most `width` columns, the first begun by `first`, the others by `further`.
pub fn wrapped_with(text: &str, width: usize, first: &str, further: &str) -> String {
    let mut out = String::from(first);
    let mut column = first.chars().count();
    let mut fresh = true;
    for word in text.split_whitespace() {
        let length = word.chars().count();
        if !fresh && column + 1 + length > width {
            out.push('\n');
            out.push_str(further);
            column = further.chars().count();
        } else if !fresh {
            out.push(' ');
            column += 1;
        }
        out.push_str(word);
        column += length;
        fresh = false;
    }
    out.push('\n');
    out
}

/// The words of `text` on lines of at most `width` columns.
pub fn lines(text: &str, width: usize) -> Vec<String> {
    wrapped_at(text, width, "").lines().map(str::to_owned).collect()
}

/// `0, 2 and 5`.
pub fn listed(items: &[String]) -> String {
    match items {
        [] => String::new(),
        [one] => one.clone(),
        [first @ .., last] => format!("{} and {last}", first.join(", ")),
    }
}

pub fn capital(sentence: &str) -> String {
    let mut rest = sentence.chars();
    rest.next().map_or_else(String::new, |first| first.to_uppercase().chain(rest).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_end_before_the_edge_and_long_words_stay_whole() {
        assert_eq!(wrapped_at("aa bb cc", 5, ""), "aa bb\ncc\n");
        assert_eq!(wrapped_at("aa bb cc", 5, "  "), "  aa\n  bb\n  cc\n");
        assert_eq!(lines("a /very/long/path b", 6), ["a", "/very/long/path", "b"]);
        assert_eq!(lines("", 6), [""]);
    }
}
