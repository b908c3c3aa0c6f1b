//! Listing and (de)serialisation: both registries agree, examples work, unknown keys are refused.

use aurt_traits::{ModelEntry, Slot};

use super::models::{Model, entries, examples};

/// The names that `typetag` knows for a slot, from the error for a name that it cannot know.
fn typetag_names(slot: Slot) -> Vec<String> {
    let Err(message) = Model::from_json(slot, r#"{ "model": "no such model" }"#) else {
        panic!("an unknown model was accepted")
    };
    let (_, known) = message.split_once("expected ").unwrap_or_else(|| panic!("{message}"));
    let mut names: Vec<String> = known.split('`').skip(1).step_by(2).map(str::to_owned).collect();
    names.sort_unstable();
    names
}

#[test]
fn both_registries_hold_the_same_names() {
    for slot in [Slot::Coulomb, Slot::Hysteresis, Slot::Viscous, Slot::ArmTerm] {
        let listed: Vec<&str> = entries().iter().filter(|e| e.slot == slot).map(|e| e.name).collect();
        assert_eq!(listed, typetag_names(slot), "{slot:?}");
        assert!(listed.windows(2).all(|w| w[0] != w[1]), "a name occurs twice in {listed:?}");
    }
}

#[test]
fn the_models_that_experiments_rely_on_are_there() {
    let listed = entries();
    let terms = "base_tilt coulomb_asymmetric counterbalance coupling current_offset drive_efficiency encoder_offset \
                 joint_compliance lugre_damped payload rotor_inertia spring torque_ripple viscous_asymmetric";
    for (slot, names) in [
        (Slot::Coulomb, "absent absolute constant square stribeck"),
        (Slot::Hysteresis, "bouc_wen dahl gms lugre maxwell_slip sign tanh"),
        (Slot::Viscous, "polynomial power_law saturating"),
        (Slot::ArmTerm, terms),
    ] {
        for name in names.split(' ') {
            assert!(listed.iter().any(|e| e.slot == slot && e.name == name), "{slot:?} {name}");
        }
    }
}

#[test]
fn every_example_is_a_valid_model_of_its_name_and_returns_from_json() {
    for (entry, model) in examples() {
        assert_eq!(model.name(), entry.name);
        let complaints = match &model {
            Model::Coulomb(m) => m.validate(),
            Model::Hysteresis(m) => m.validate(),
            Model::Viscous(m) => m.validate(),
            Model::Arm(m) => m.validate(6),
        };
        assert_eq!(complaints, Ok(()), "{}", entry.name);
        let json = model.to_json();
        assert!(json.starts_with(&format!(r#"{{"model":"{}""#, entry.name)), "{json}");
        assert_eq!(Model::from_json(entry.slot, &json).unwrap().to_json(), json);
    }
}

#[test]
fn unknown_keys_are_refused_by_every_model() {
    for (entry, model) in examples() {
        let json = model.to_json();
        let spoiled = json.replacen('{', r#"{"no_such_key": 1, "#, 1);
        let Err(message) = Model::from_json(entry.slot, &spoiled) else {
            panic!("`{}` accepts an unknown key", entry.name)
        };
        assert!(message.contains("no_such_key"), "`{}`: {message}", entry.name);
        let spoiled = entry.example.replacen('{', "{ no_such_key = 1, ", 1);
        assert!(Model::from_toml(entry.slot, &spoiled).is_err(), "`{}` in TOML", entry.name);
    }
}

#[test]
fn the_short_forms_of_the_paper_parse() {
    for (slot, table) in [
        (Slot::Coulomb, r#"{ model = "square" }"#),
        (Slot::Hysteresis, r#"{ model = "sign" }"#),
        (Slot::Hysteresis, r#"{ model = "maxwell_slip" }"#),
        (Slot::Hysteresis, r#"{ model = "maxwell_slip", thresholds_rad = [0.001, 0.01] }"#),
        (Slot::Hysteresis, r#"{ model = "lugre", presliding_rad = 0.02 }"#),
        (Slot::Viscous, r#"{ model = "polynomial", powers = [] }"#),
        (Slot::ArmTerm, r#"{ model = "rotor_inertia" }"#),
        (Slot::ArmTerm, r#"{ model = "payload", link = 5 }"#),
        (Slot::ArmTerm, r#"{ model = "coupling", joint = 5, partner = 4 }"#),
        (Slot::ArmTerm, r#"{ model = "base_tilt" }"#),
    ] {
        if let Err(message) = Model::from_toml(slot, table) {
            panic!("{table}: {message}");
        }
    }
}

#[test]
fn every_entry_says_what_a_reader_needs() {
    for ModelEntry { name, summary, equation, use_when, source, example, origin, .. } in entries() {
        for text in [summary, equation, use_when, source, example] {
            assert!(text.len() > 4 && !text.contains("  "), "`{name}`: {text:?}");
        }
        assert!(!summary.ends_with('.') && summary.len() < 90, "`{name}`: {summary}");
        assert_eq!(origin, "aurt-friction");
    }
}

#[test]
fn shape_parameters_are_called_as_their_keys() {
    for (entry, model) in examples() {
        let parameters = match &model {
            Model::Coulomb(m) => m.shape_parameters(),
            Model::Hysteresis(m) => m.shape_parameters(),
            Model::Viscous(m) => m.shape_parameters(),
            Model::Arm(m) => m.shape_parameters(),
        };
        let json: serde_json::Value = serde_json::from_str(&model.to_json()).unwrap();
        for p in parameters {
            assert_eq!(json[&p.name].as_f64(), Some(p.value), "`{}` {}", entry.name, p.name);
        }
    }
}
