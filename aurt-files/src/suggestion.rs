//! "Did you mean …": the likely name among known ones.

/// Similarity from which a known name is offered as what was probably meant.
const LIKELY: f64 = 0.75;

/// Longest name, in characters, that is compared with others: likeness takes time with the square of lengths.
const LONGEST: usize = 64;
/// Known names that are compared and listed.
const MOST: usize = 500;

/// The known name that `written` most probably stands for, if any is close; of equals the first.
///
/// Beside mistyped letters this catches a name written without its unit (`gravity` for `gravity_m_s2`).
pub fn likely<'k>(written: &str, known: impl IntoIterator<Item = &'k str>) -> Option<&'k str> {
    if written.chars().count() > LONGEST {
        return None;
    }
    known
        .into_iter()
        .take(MOST)
        .filter(|name| name.len() <= 4 * LONGEST)
        .map(|name| (similarity(written, name), name))
        .filter(|(score, _)| *score >= LIKELY)
        .reduce(|best, next| if next.0 > best.0 { next } else { best })
        .map(|(_, name)| name)
}

fn similarity(written: &str, name: &str) -> f64 {
    let (written, name) = (written.to_lowercase(), name.to_lowercase());
    let by_letters = strsim::normalized_damerau_levenshtein(&written, &name);
    let by_beginning = strsim::jaro_winkler(&written, &name);
    let without_unit = if written.len() >= 3 && name.starts_with(&format!("{written}_")) { 0.9 } else { 0.0 };
    // Jaro-Winkler alone finds likeness in unrelated short words, so its word counts only where the letters agree too.
    let spelling = if by_letters >= 0.5 { by_letters.max(by_beginning) } else { 0.0 };
    spelling.max(without_unit)
}

/// Help that names the likely and all known names: "did you mean `a`? known: `a`, `b`".
///
/// `what` names the known things ("models of this slot", "keys").
pub fn help<'k>(written: &str, what: &str, known: impl IntoIterator<Item = &'k str>) -> String {
    let mut known: Vec<&str> = known.into_iter().collect();
    known.sort_unstable();
    let list = known.iter().map(|k| format!("`{k}`")).collect::<Vec<_>>().join(", ");
    match (likely(written, known.iter().copied()), known.len()) {
        (Some(name), 1) => format!("did you mean `{name}`?"),
        (Some(name), _) => format!("did you mean `{name}`? known {what}: {list}"),
        (None, 0) => format!("there are no {what}"),
        (None, _) => format!("known {what}: {list}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slips_of_the_pen_are_recognised() {
        let known = ["none", "square", "absolute", "asymmetric"];
        assert_eq!(likely("sqare", known), Some("square"));
        assert_eq!(likely("absolut", known), Some("absolute"));
        assert_eq!(likely("Square", known), Some("square"));
        assert_eq!(likely("assymetric", known), Some("asymmetric"));
    }

    #[test]
    fn a_name_without_its_unit_is_recognised() {
        assert_eq!(likely("gravity", ["mdh", "mdh_rows", "gravity_m_s2"]), Some("gravity_m_s2"));
        assert_eq!(likely("f_dyn", ["f_dyn_hz", "trim_rest"]), Some("f_dyn_hz"));
    }

    #[test]
    fn unrelated_names_are_not_offered() {
        assert_eq!(likely("temperature", ["none", "square", "absolute"]), None);
        assert_eq!(help("temperature", "models", ["square", "none"]), "known models: `none`, `square`");
    }
}
