//! The terms of reports and files, in words: what `aurt explain` prints.

mod calibration;
mod diagnosis;
mod experiment;
mod recorded_as;
mod recording;

/// A term.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Term {
    /// What to ask for, snake_case.
    pub name: &'static str,
    /// Its full name.
    pub title: &'static str,
    /// What it means, when to heed it, what to do.
    pub text: &'static str,
}

/// All terms, sorted by name.
pub fn terms() -> Vec<&'static Term> {
    let pages =
        [calibration::TERMS, diagnosis::TERMS, experiment::TERMS, recorded_as::TERMS, recording::TERMS];
    let mut terms: Vec<&Term> = pages.into_iter().flatten().collect();
    terms.sort_by_key(|t| t.name);
    terms
}

/// Keys of files that are explained under another name.
const ALIASES: [(&str, &str); 12] = [
    ("delay_s", "instrument"),
    ("f_dyn_hz", "f_dyn"),
    ("gains", "instrument"),
    ("gravity_m_s2", "gravity"),
    ("libraries", "plugins"),
    ("mdh_rows", "mdh"),
    ("not_physical", "unphysical"),
    ("nrmse", "nrms"),
    ("offsets", "instrument"),
    ("prior_weight", "prior"),
    ("rest_velocity_rad_s", "rest"),
    ("torque_constants_nm_per_a", "torque_constants"),
];

/// The term of a name.
pub fn term(name: &str) -> Option<&'static Term> {
    let name = ALIASES.iter().find(|(alias, _)| *alias == name).map_or(name, |(_, of)| of);
    terms().into_iter().find(|t| t.name == name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn terms_have_one_meaning_and_are_found() {
        assert!(terms().windows(2).all(|w| w[0].name < w[1].name));
        assert_eq!(term("nrmse").unwrap().name, "nrms");
        assert!(ALIASES.iter().all(|(alias, of)| term(alias).is_some_and(|t| t.name == *of)));
        assert_eq!(term("absent"), None);
    }
}
