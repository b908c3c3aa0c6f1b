//! Names and comments that targets accept.

use std::collections::HashSet;

use aurt_files::is_harmful;
use aurt_rbd::SerialChain;

use crate::ExportError;

/// Words of C99 and of C++ that cannot name anything, as far as they are lower-case words.
const RESERVED: &str = "\
    auto break case char class const continue default delete do double else enum extern float for goto \
    if inline int long main namespace new private protected public register restrict return short signed \
    sizeof static struct switch template this typedef void";

/// Headers of C: a model's own, found in their place, would hide them.
const HEADERS: &str = "\
    assert complex ctype errno fenv float inttypes iso646 limits locale math setjmp signal stdarg \
    stdbool stddef stdint stdio stdlib string tgmath time wchar wctype";

/// Words of Rust that are none of C, and crates that a crate would hide.
const RUST: &str = "\
    alloc as async await become box core crate dyn final fn gen impl in let libm loop macro match mod \
    move mut priv proc_macro pub ref self std super test trait try type use";

fn among(words: &str, name: &str) -> bool {
    words.split(' ').any(|word| word == name)
}

pub(crate) fn check_crate(name: &str) -> Result<(), ExportError> {
    check_identifier(name)?;
    if among(RUST, name) {
        return Err(ExportError::Name { name: name.to_owned(), reason: "is a word or a crate of Rust" });
    }
    Ok(())
}

pub(crate) fn check_identifier(name: &str) -> Result<(), ExportError> {
    let refuse = |reason| Err(ExportError::Name { name: name.to_owned(), reason });
    if name.len() > 40 {
        return refuse("is longer than 40 letters");
    }
    if !name.starts_with(|c: char| c.is_ascii_alphabetic()) {
        return refuse("does not begin with a letter");
    }
    if !name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_') {
        return refuse("is no identifier");
    }
    if among(RESERVED, name) {
        return refuse("is a word of the language");
    }
    if among(HEADERS, name) {
        return refuse("is the name of a header of C");
    }
    Ok(())
}

/// Text for a comment of C or XML: nothing in it ends the comment, begins another, is a trigraph or turns the direction of
/// writing, which compilers of Rust refuse.
pub(crate) fn for_comment(text: &str) -> String {
    let safe = |c: char| match c {
        '*' | '?' | '\\' | '<' | '>' => '_',
        c if c.is_control() => ' ',
        c if is_harmful(c) => '_',
        c => c,
    };
    let mut out: String = text.chars().map(safe).collect();
    while out.contains("--") {
        out = out.replace("--", "-_");
    }
    out
}

/// The joints' names as `written` makes them safe for a target, no two alike and none in `taken`; `joint_0`, … where the
/// model has none.
pub(crate) fn joint_names(
    chain: &SerialChain,
    written: impl Fn(&str) -> String,
    taken: &[String],
) -> Vec<String> {
    let mut taken: HashSet<String> = taken.iter().cloned().collect();
    let names = chain.joint_names();
    let name = |j: usize| names.get(j).map_or_else(|| format!("joint_{j}"), |name| written(name));
    (0..chain.joints().len())
        .map(|j| {
            let mut unique = name(j);
            while !taken.insert(unique.clone()) {
                unique.push_str(&format!("_{j}"));
            }
            unique
        })
        .collect()
}

pub(crate) fn attribute(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            // No document may have these.
            '\u{fffe}' | '\u{ffff}' => out.push('_'),
            c if c.is_control() => out.push(' '),
            // The same text to every reader of XML, and no turn of the direction of writing to people.
            c if is_harmful(c) => out.push_str(&format!("&#x{:x};", u32::from(c))),
            c => out.push(c),
        }
    }
    out
}

/// A string literal of C99 with the bytes of a text: no trigraph, no escape that the next character would lengthen.
pub(crate) fn c_string(text: &str) -> String {
    let mut out = String::from("\"");
    for byte in text.bytes() {
        match byte {
            b'"' | b'\\' | b'?' => out.extend(['\\', char::from(byte)]),
            b' '..=b'~' => out.push(char::from(byte)),
            other => out.push_str(&format!("\\{other:03o}")),
        }
    }
    out + "\""
}

#[cfg(test)]
mod tests {
    use aurt_rbd::{Joint, Placement};

    use super::*;

    #[test]
    fn names_of_other_people_are_safe_in_every_target() {
        let names = ["a\"*/\n?\u{e9}", "a<b>&-->", "x::y", "x:_y", "${HOME}\\"].map(str::to_owned);
        let joints = vec![Joint::revolute(Placement::from_roll_pitch_yaw([0.0; 3], [0.0; 3])); 5];
        let chain = SerialChain::new(joints, [0.0; 3]).unwrap();
        assert_eq!(
            joint_names(&chain, str::to_owned, &["joint_1".to_owned()])[..2],
            ["joint_0", "joint_1_1"]
        );
        let chain = chain.with_joint_names(names.to_vec()).unwrap();
        let sdf = joint_names(&chain, |name| attribute(&name.replace("::", ":_")), &[]);
        assert_eq!(sdf, ["a&quot;*/ ?\u{e9}", "a&lt;b&gt;&amp;--&gt;", "x:_y", "x:_y_3", "${HOME}\\"]);
        assert_eq!(attribute("\u{ffff}\t"), "_ ");
        assert_eq!(c_string(&names[0]), r#""a\"*/\012\?\303\251""#);
        assert_eq!(c_string(&names[4]), r#""${HOME}\\""#);
    }

    #[test]
    fn identifiers_and_comments_are_safe() {
        for name in ["ur5e", "UR_10", "a"] {
            assert!(check_identifier(name).is_ok(), "{name}");
        }
        for name in ["", "5bar", "_x", "my robot", "kräftig", "double", "math", "a-b", &"a".repeat(41)] {
            assert!(check_identifier(name).is_err(), "{name}");
        }
        assert!(check_crate("ur5e").is_ok());
        for name in ["core", "libm", "test", "fn", "a-b"] {
            assert!(check_crate(name).is_err(), "{name}");
        }
        assert_eq!(for_comment("a*/b\n--->c??/"), "a_/b -_-_c__/");
        assert_eq!(for_comment("a\u{202e}b\u{1b}[8m"), "a_b [8m");
        assert_eq!(attribute("a\u{202e}b"), "a&#x202e;b");
    }
}
