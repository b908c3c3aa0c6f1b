//! The terms of reports and files, in words: what `aurt explain` prints. They stand in `terms.md`, one under each heading.

use std::sync::LazyLock;

#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Term {
    /// What to ask for, snake_case.
    pub name: &'static str,
    /// Keys of files that are explained under it.
    pub keys: Vec<&'static str>,
    pub title: &'static str,
    /// What it means, when to heed it, what to do.
    pub text: String,
}

static TERMS: LazyLock<Vec<Term>> = LazyLock::new(|| {
    let sections = include_str!("terms.md").split("\n## ").skip(1);
    let terms = sections.filter_map(|section| {
        let (heading, text) = section.split_once('\n')?;
        let (names, title) = heading.split_once(": ")?;
        let mut keys: Vec<&str> = names.split(", ").collect();
        let name = keys.remove(0);
        Some(Term { name, keys, title, text: text.trim().replace('\n', " ") })
    });
    terms.collect()
});

pub fn terms() -> &'static [Term] {
    &TERMS
}

/// The term of a name, or of a key of files that is explained under it.
pub fn term(name: &str) -> Option<&'static Term> {
    terms().iter().find(|t| t.name == name || t.keys.contains(&name))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn terms_have_one_meaning_and_are_found() {
        assert_eq!(terms().len(), include_str!("terms.md").matches("\n## ").count());
        assert!(terms().windows(2).all(|w| w[0].name < w[1].name));
        assert_eq!(term("nrmse").unwrap().name, "nrms");
        let keys = || terms().iter().flat_map(|t| t.keys.iter().map(move |key| (key, t.name)));
        assert!(keys().all(|(key, of)| term(key).is_some_and(|t| t.name == of)) && keys().count() > 20);
        assert_eq!(term("absent"), None);
    }
}
