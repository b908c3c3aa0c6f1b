//! Every effect explains itself, and every identifier of the vocabulary is there.

use std::collections::BTreeSet;
use std::path::Path;

use aurt_diagnosis::effects;
use aurt_diagnosis::vocabulary::Family;

/// The vocabulary: families and their identifiers.
const VOCABULARY: [(Family, &str); 10] = [
    (Family::F, "coulomb coulomb_asymmetry stribeck friction_level_changed"),
    (Family::V, "viscous viscous_nonlinear viscous_asymmetry temperature_dependent_friction"),
    (Family::H, "presliding_hysteresis"),
    (Family::L, "load_dependent_friction drive_efficiency"),
    (Family::I, "rotor_inertia payload base_tilt"),
    (Family::P, "spring torque_ripple joint_elasticity backlash"),
    (Family::D, "torque_constant current_offset encoder_offset time_delay saturation"),
    (Family::C, "joint_coupling_friction"),
    (Family::X, "external_contact"),
    (Family::Q, "dropped_samples"),
];

const SECTIONS: [&str; 5] = [
    "# What it is",
    "# How it shows",
    "# Easily confused with",
    "# What to record to be sure",
    "# References",
];

#[test]
fn the_vocabulary_is_complete() {
    let there: BTreeSet<_> = effects::ALL.iter().map(|e| (e.id, e.family)).collect();
    let of = |(family, ids): (Family, &'static str)| ids.split(' ').map(move |id| (id, family));
    let wanted: BTreeSet<_> = VOCABULARY.into_iter().flat_map(of).collect();
    assert_eq!(there, wanted);
    for (id, _) in wanted {
        assert_eq!(effects::find(id).map(|e| e.id), Some(id));
    }
    assert!(effects::find("mystery").is_none());
    assert!(effects::ALL.is_sorted_by_key(|e| (e.family, e.id)));
}

#[test]
fn one_file_per_effect_named_like_it() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/effects");
    let files: BTreeSet<String> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path().file_stem().unwrap().to_string_lossy().into_owned())
        .filter(|stem| stem != "mod")
        .collect();
    let ids: BTreeSet<String> = effects::ALL.iter().map(|e| e.id.to_owned()).collect();
    assert_eq!(files, ids);
}

#[test]
fn every_explanation_has_all_sections_and_says_something_in_each() {
    for effect in effects::ALL {
        let text = effect.explanation();
        let first = text.lines().next().unwrap_or_default();
        assert!(first.starts_with(&format!("`{}`: ", effect.id)), "{}: {first}", effect.id);
        let headings: Vec<&str> = text.lines().filter(|l| l.starts_with('#')).collect();
        assert_eq!(headings, SECTIONS, "{}", effect.id);
        for section in text.split("\n# ").skip(1) {
            let (heading, body) = section.split_once('\n').unwrap_or((section, ""));
            assert!(body.trim().len() > 30, "{}: `{heading}` says {body:?}", effect.id);
        }
        let lines = text.lines().count();
        assert!((15..=45).contains(&lines), "{}: {lines} lines", effect.id);
    }
}

#[test]
fn every_parameter_has_a_meaning() {
    for effect in effects::ALL {
        for parameter in effect.parameters {
            let meaning = effect.meaning(parameter.name);
            assert!(meaning.is_some_and(|m| m.len() > 15), "{}: `{}`", effect.id, parameter.name);
        }
        assert_eq!(effect.meaning("no_parameter"), None);
    }
}

#[test]
fn what_an_explanation_names_as_confusable_exists() {
    let known: BTreeSet<&str> = effects::ALL.iter().map(|e| e.id).collect();
    for effect in effects::ALL {
        let text = effect.explanation();
        let confused = text.split("# Easily confused with").nth(1).unwrap_or_default();
        let confused = confused.split("\n# ").next().unwrap_or_default();
        let mut named = 0;
        for word in confused.split('`').skip(1).step_by(2) {
            assert!(known.contains(word), "{}: `{word}` is no effect", effect.id);
            assert_ne!(word, effect.id);
            named += 1;
        }
        assert!(named > 0, "{} names nothing that it is confused with", effect.id);
    }
}

/// What the rest of the crate has to know of an effect is a field of its descriptor. Structures of drives are named as effects are, and
/// are none.
#[test]
fn no_effect_is_known_by_its_name_elsewhere() {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut folders = vec![src.clone()];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                let own = ["effects", "drives"].map(|folder| src.join(folder));
                folders.extend((!own.contains(&path)).then_some(path));
                continue;
            }
            let text = std::fs::read_to_string(&path).unwrap();
            let code =
                if path.ends_with("tests.rs") { "" } else { text.split("#[cfg(test)]").next().unwrap() };
            for effect in effects::ALL {
                // A key of a term's table is no effect.
                let named =
                    code.replace(&format!("\"{}\":", effect.id), "").contains(&format!("\"{}\"", effect.id));
                assert!(!named, "{} knows `{}` by its name", path.display(), effect.id);
            }
        }
    }
}
