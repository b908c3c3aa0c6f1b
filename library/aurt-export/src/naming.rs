//! Names and comments that targets accept.

use crate::ExportError;

/// Words of C99 and of C++ that cannot name anything, as far as they are lower-case words.
const RESERVED: [&str; 40] = [
    "auto",
    "break",
    "case",
    "char",
    "class",
    "const",
    "continue",
    "default",
    "delete",
    "do",
    "double",
    "else",
    "enum",
    "extern",
    "float",
    "for",
    "goto",
    "if",
    "inline",
    "int",
    "long",
    "main",
    "namespace",
    "new",
    "private",
    "protected",
    "public",
    "register",
    "restrict",
    "return",
    "short",
    "signed",
    "sizeof",
    "static",
    "struct",
    "switch",
    "template",
    "this",
    "typedef",
    "void",
];

/// Headers of C: a model's own, found in their place, would hide them.
const HEADERS: [&str; 24] = [
    "assert", "complex", "ctype", "errno", "fenv", "float", "inttypes", "iso646", "limits", "locale", "math",
    "setjmp", "signal", "stdarg", "stdbool", "stddef", "stdint", "stdio", "stdlib", "string", "tgmath",
    "time", "wchar", "wctype",
];

/// Words of Rust that are none of C, and crates that a crate would hide.
const RUST: [&str; 34] = [
    "alloc",
    "as",
    "async",
    "await",
    "become",
    "box",
    "core",
    "crate",
    "dyn",
    "final",
    "fn",
    "gen",
    "impl",
    "in",
    "let",
    "libm",
    "loop",
    "macro",
    "match",
    "mod",
    "move",
    "mut",
    "priv",
    "proc_macro",
    "pub",
    "ref",
    "self",
    "std",
    "super",
    "test",
    "trait",
    "try",
    "type",
    "use",
];

/// Whether a crate may be called `name`.
///
/// # Errors
/// [`ExportError::Name`].
pub(crate) fn check_crate(name: &str) -> Result<(), ExportError> {
    check_identifier(name)?;
    if RUST.contains(&name) {
        return Err(ExportError::Name { name: name.to_owned(), reason: "is a word or a crate of Rust" });
    }
    Ok(())
}

/// Whether names may begin with `name`.
///
/// # Errors
/// [`ExportError::Name`].
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
    if RESERVED.contains(&name) {
        return refuse("is a word of the language");
    }
    if HEADERS.contains(&name) {
        return refuse("is the name of a header of C");
    }
    Ok(())
}

/// Text for a comment of C or XML: nothing in it ends the comment, begins another or is a trigraph.
pub(crate) fn for_comment(text: &str) -> String {
    let safe = |c: char| match c {
        '*' | '?' | '\\' | '<' | '>' => '_',
        c if c.is_control() => ' ',
        c => c,
    };
    let mut out: String = text.chars().map(safe).collect();
    while out.contains("--") {
        out = out.replace("--", "-_");
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

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
    }
}
