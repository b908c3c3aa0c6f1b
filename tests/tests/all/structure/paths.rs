//! The paths that a source file names, read as text.

use std::collections::BTreeMap;

/// What a file takes from elsewhere and hands on, tests aside.
pub struct Paths {
    /// Every path that it names, as segments; `crate`, `self` and `super` are resolved to segments from the crate's root.
    pub named: Vec<Vec<String>>,
    /// What its `use` declarations bring in, by name.
    pub imported: BTreeMap<String, Vec<String>>,
    /// Modules whose items it brings in all at once.
    pub globs: Vec<Vec<String>>,
    /// Names of the items that it defines.
    pub defined: Vec<String>,
}

impl Paths {
    /// Reads the text of the module at a path from the crate's root.
    pub fn read(text: &str, module: &[String]) -> Self {
        let code = without_tests(&code_of(text));
        let words = words(&code);
        let mut paths =
            Self { named: Vec::new(), imported: BTreeMap::new(), globs: Vec::new(), defined: Vec::new() };
        let mut inline = Vec::new();
        let mut i = 0;
        while i < words.len() {
            match words[i] {
                "use" => {
                    let end = words[i..].iter().position(|w| *w == ";").map_or(words.len(), |k| i + k);
                    paths.tree(&words[i + 1..end], &[], module);
                    i = end;
                }
                "struct" | "enum" | "trait" | "type" | "fn" | "const" | "static" | "mod" | "macro_rules"
                    if i + 1 < words.len() =>
                {
                    let name = words[i + 1..].iter().find(|w| !["mut", "fn", "!", "unsafe"].contains(w));
                    paths.defined.extend(name.map(|n| (*n).to_owned()));
                }
                word if is_name(word)
                    && words.get(i + 1) == Some(&"::")
                    && (i == 0 || words[i - 1] != "::") =>
                {
                    let (mut path, mut at) = (Vec::new(), i);
                    while let Some(name) = words.get(at).filter(|w| is_name(w)) {
                        path.push((*name).to_owned());
                        at = if words.get(at + 1) == Some(&"::") { at + 2 } else { words.len() };
                    }
                    inline.push(path);
                }
                _ => {}
            }
            i += 1;
        }
        for path in inline {
            let from_import = paths.imported.get(&path[0]).map(|to| [to.as_slice(), &path[1..]].concat());
            paths.named.push(from_import.unwrap_or_else(|| absolute(&path, module)));
        }
        paths
    }

    fn tree(&mut self, words: &[&str], prefix: &[String], module: &[String]) {
        let mut path = prefix.to_vec();
        let mut k = 0;
        while k < words.len() && words[k] != "," {
            match words[k] {
                "::" => {}
                "{" => {
                    let (mut depth, mut start) = (0, k + 1);
                    for (at, word) in words.iter().enumerate().skip(k) {
                        depth += i32::from(*word == "{") - i32::from(*word == "}");
                        if depth == 0 || (depth == 1 && *word == ",") {
                            self.tree(&words[start..at], &path, module);
                            start = at + 1;
                        }
                        if depth == 0 {
                            break;
                        }
                    }
                    return;
                }
                "*" => return self.globs.push(absolute(&path, module)),
                "as" => {
                    let full = absolute(&path, module);
                    self.named.push(full.clone());
                    self.imported.insert(words.get(k + 1).copied().unwrap_or("_").to_owned(), full);
                    return;
                }
                "self" if !path.is_empty() => {}
                word => path.push(word.to_owned()),
            }
            k += 1;
        }
        if let Some(name) = path.last().cloned() {
            let full = absolute(&path, module);
            self.named.push(full.clone());
            self.imported.insert(name, full);
        }
    }
}

/// A path from the crate's root. One that begins with a name is taken to begin at a child of the module; what is no child is of
/// another crate.
fn absolute(path: &[String], module: &[String]) -> Vec<String> {
    let mut from = module.to_vec();
    let mut rest = path;
    while let Some((first, after)) = rest.split_first() {
        match first.as_str() {
            "crate" => from.clear(),
            "super" => drop(from.pop()),
            "self" => {}
            _ => break,
        }
        rest = after;
    }
    from.extend(rest.iter().cloned());
    from
}

fn is_name(word: &str) -> bool {
    word.starts_with(|c: char| c.is_alphabetic() || c == '_')
}

fn words(code: &str) -> Vec<&str> {
    let mut words = Vec::new();
    let mut rest = code;
    while let Some(c) = rest.chars().next() {
        let length = match c {
            _ if c.is_alphanumeric() || c == '_' => {
                rest.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(rest.len())
            }
            ':' if rest.starts_with("::") => 2,
            _ => c.len_utf8(),
        };
        if !c.is_whitespace() {
            words.push(&rest[..length]);
        }
        rest = &rest[length..];
    }
    words
}

/// A text without comments, strings and characters.
fn code_of(text: &str) -> String {
    let mut code = String::with_capacity(text.len());
    let mut rest = text;
    let after = |rest: &str, end: &str| rest.find(end).map_or(rest.len(), |at| at + end.len());
    while let Some(c) = rest.chars().next() {
        let follows_name = code.ends_with(|c: char| c.is_alphanumeric() || c == '_');
        let hashes = rest[1.min(c.len_utf8())..].bytes().take_while(|b| *b == b'#').count();
        let skipped = match c {
            '/' if rest.starts_with("//") => rest.find('\n').unwrap_or(rest.len()),
            '/' if rest.starts_with("/*") => after(rest, "*/"),
            'r' if !follows_name && rest[1 + hashes..].starts_with('"') => {
                let open = 2 + hashes;
                open + after(&rest[open..], &format!("\"{}", "#".repeat(hashes)))
            }
            '"' => 1 + end_of_string(&rest[1..]),
            '\'' => end_of_character(rest),
            _ => 0,
        };
        if skipped == 0 {
            code.push(c);
            rest = &rest[c.len_utf8()..];
        } else {
            code.push(' ');
            rest = &rest[skipped..];
        }
    }
    code
}

/// Where a string ends whose opening quote is left behind.
fn end_of_string(rest: &str) -> usize {
    let mut escaped = false;
    for (at, c) in rest.char_indices() {
        match c {
            '"' if !escaped => return at + 1,
            _ => escaped = c == '\\' && !escaped,
        }
    }
    rest.len()
}

/// The length of a character in quotes; 0 for a lifetime.
fn end_of_character(rest: &str) -> usize {
    let mut chars = rest.char_indices().skip(1);
    match (chars.next(), chars.next()) {
        (Some((_, '\\')), Some((at, c))) => {
            let from = at + c.len_utf8();
            rest[from..].find('\'').map_or(0, |end| from + end + 1)
        }
        (Some(_), Some((at, '\''))) => at + 1,
        _ => 0,
    }
}

fn without_tests(code: &str) -> String {
    let mut kept = String::with_capacity(code.len());
    let mut rest = code;
    while let Some(at) = rest.find("#[cfg(test)]") {
        kept.push_str(&rest[..at]);
        rest = &rest[at..];
        let mut depth = 0;
        let end = rest.char_indices().find(|(_, c)| {
            depth += i32::from(*c == '{') - i32::from(*c == '}');
            depth == 0 && (*c == '}' || *c == ';')
        });
        rest = end.map_or("", |(at, _)| &rest[at + 1..]);
    }
    kept + rest
}
