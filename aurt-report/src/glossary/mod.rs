//! The terms of reports and files, in words: what `aurt explain` prints. They stand in `terms.md`, one under each heading.

use std::sync::LazyLock;

#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Term {
    /// What to ask for, snake_case.
    pub name: &'static str,
    pub title: &'static str,
    /// What it means, when to heed it, what to do.
    pub text: String,
}

static TERMS: LazyLock<Vec<Term>> = LazyLock::new(|| {
    let sections = include_str!("terms.md").split("\n## ").skip(1);
    let terms = sections.filter_map(|section| {
        let (heading, text) = section.split_once('\n')?;
        let (name, title) = heading.split_once(": ")?;
        Some(Term { name, title, text: text.trim().replace('\n', " ") })
    });
    terms.collect()
});

pub fn terms() -> &'static [Term] {
    &TERMS
}

/// Keys of files that are explained under another name.
const ALIASES: [(&str, &str); 26] = [
    ("block_s", "sweep"),
    ("coulomb", "joint_dynamics"),
    ("delay_s", "instrument"),
    ("f_dyn_hz", "f_dyn"),
    ("gains", "instrument"),
    ("gravity_m_s2", "gravity"),
    ("grid", "sweep"),
    ("hysteresis", "joint_dynamics"),
    ("level", "diagnosis"),
    ("libraries", "plugins"),
    ("mdh_rows", "mdh"),
    ("measurement", "columns"),
    ("not_physical", "unphysical"),
    ("nrmse", "nrms"),
    ("offsets", "instrument"),
    ("position", "columns"),
    ("prior_weight", "prior"),
    ("reduction", "diagnosis"),
    ("rest_velocity_rad_s", "rest"),
    ("tips", "tip"),
    ("torque_constants_nm_per_a", "torque_constants"),
    ("validate", "sweep"),
    ("variant", "sweep"),
    ("velocity", "columns"),
    ("viscous", "joint_dynamics"),
    ("zip", "sweep"),
];

pub fn term(name: &str) -> Option<&'static Term> {
    let name = ALIASES.iter().find(|(alias, _)| *alias == name).map_or(name, |(_, of)| of);
    terms().iter().find(|t| t.name == name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn terms_have_one_meaning_and_are_found() {
        assert_eq!(terms().len(), include_str!("terms.md").matches("\n## ").count());
        assert!(terms().windows(2).all(|w| w[0].name < w[1].name));
        assert_eq!(term("nrmse").unwrap().name, "nrms");
        assert!(ALIASES.iter().all(|(alias, of)| term(alias).is_some_and(|t| t.name == *of)));
        assert_eq!(term("absent"), None);
    }
}
