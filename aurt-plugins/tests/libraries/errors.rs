//! What people read when a library, or what is asked of it, is wrong.

use std::fs;
use std::path::Path;

use aurt_experiment::Experiment;
use aurt_plugins::{Error, Registry, Trust};
use aurt_traits::{Columns, HysteresisModel, JointModel, JointSeries, ModelError};
use serde_json::json;

use crate::built;

/// The error of loading a library into the linked models, with the library's folder left out.
fn refusal(library: &Path) -> String {
    let mut registry = built::trusting();
    let models = registry.models().count();
    let error = registry.load_library(library).unwrap_err();
    assert_eq!(registry.models().count(), models, "a refused library left models behind");
    let folder = library.parent().unwrap();
    let shown = error.to_string();
    let shown =
        shown.replace(&format!("{}/", folder.canonicalize().unwrap_or(folder.to_owned()).display()), "");
    shown.replace(&format!("{}/", folder.display()), "")
}

#[test]
fn what_is_no_plugin_is_refused() {
    assert_eq!(
        refusal(Path::new("/nowhere/libx.so")),
        "the library libx.so does not exist; build it (`cargo build --release` for a Rust crate) and give the path of \
         the built file"
    );
    let folder = tempfile::tempdir().unwrap();
    let text = folder.path().join("notes.txt");
    fs::write(&text, "not a library\n").unwrap();
    let shown = refusal(&text);
    assert!(
        shown.starts_with("the library notes.txt is not a library that this system can load: "),
        "{shown}"
    );
    let Some(no_entry) = built::faulty("NO_ENTRY") else { return };
    let shown = refusal(&no_entry);
    assert!(shown.contains("is a library, but no plugin: it does not export `aurt_plugin`"), "{shown}");
}

/// What stands in the file by the time of the loading does not matter, nor what lies beside it.
#[cfg(target_os = "linux")]
#[test]
fn the_bytes_that_are_trusted_are_loaded_and_no_neighbours() {
    let (Some(good), Some(other)) = (built::faulty("ANOTHER"), built::faulty("NO_ENTRY")) else { return };
    let folder = tempfile::tempdir().unwrap();
    let link = folder.path().join("libplugin.so");
    let point_to = |library: &Path| {
        let next = folder.path().join("next");
        std::os::unix::fs::symlink(library, &next).unwrap();
        fs::rename(next, &link).unwrap();
    };
    point_to(&good);
    let list = folder.path().join("list");
    Trust::add(&list, &link).unwrap();
    let hash = Trust::listed(&list).unwrap().remove(0).0;
    let stop = std::sync::atomic::AtomicBool::new(false);
    let load = || {
        let mut registry = Registry::linked().unwrap();
        let mut trust = Trust::default();
        trust.insert(hash.clone());
        registry.trust(trust);
        registry.load_named_library(&link).map(|()| registry.libraries()[0].blake3.clone())
    };
    let outcomes: Vec<_> = std::thread::scope(|scope| {
        scope.spawn(|| {
            while !stop.load(std::sync::atomic::Ordering::Relaxed) {
                [&other, &good].into_iter().for_each(|library| point_to(library));
            }
        });
        let outcomes = (0..300).map(|_| load()).collect();
        stop.store(true, std::sync::atomic::Ordering::Relaxed);
        outcomes
    });
    for outcome in outcomes {
        match outcome {
            Ok(loaded) => assert_eq!(loaded, hash),
            // Never that of the other library, which has no entry.
            Err(error) => assert!(error.to_string().contains("is not trusted"), "{error}"),
        }
    }
    let Some(needy) = built::needs_neighbour(folder.path()) else { return };
    let shown = refusal(&needy);
    assert!(shown.contains("libneighbour.so") && shown.contains("a plugin is one file"), "{shown}");
}

#[test]
fn faulty_declarations_are_refused() {
    for (fault, expected) in [
        ("OTHER_MAGIC", "exports `aurt_plugin`, but that does not return a plugin's declaration"),
        ("NOTHING", "exports `aurt_plugin`, but that does not return a plugin's declaration"),
        (
            "OTHER_MAJOR",
            "was built for version 2.0 of the plugin interface, this program has version 1.0; build it again with \
             this program's `aurt-traits` or `aurt_plugin.h`",
        ),
        ("SMALL", "has a faulty declaration: its model table has 8 bytes, version 1.0 has 104"),
        (
            "MANY_MODELS",
            "has a faulty declaration: it claims 1152921504606846976 models; a library has at most 100000",
        ),
        ("NO_EVALUATE", "has a faulty declaration: model `no_evaluate` has no function `evaluate`"),
        ("NO_SLOT", "has a faulty declaration: model `no_slot` is for slot 9, which does not exist"),
    ] {
        let Some(library) = built::faulty(fault) else { return };
        let file = library.file_name().unwrap().to_string_lossy();
        assert_eq!(refusal(&library), format!("the library {file} {expected}"));
    }
}

#[test]
fn a_later_minor_version_is_accepted() {
    let Some(library) = built::faulty("LATER_MINOR") else { return };
    assert!(built::with(&library).names(aurt_traits::Slot::Hysteresis).contains(&"faulty".to_owned()));
}

#[test]
fn a_name_that_exists_is_refused() {
    let Some(library) = built::faulty("TWICE") else { return };
    let shown = refusal(&library);
    assert!(
        shown.starts_with("the hysteresis model `faulty` exists twice: from library faulty 0.1.0 ("),
        "{shown}"
    );
    // Another library with a model of the same name.
    let (Some(first), Some(second)) = (built::faulty("ANOTHER"), built::faulty("LATER_MINOR")) else {
        return;
    };
    let error = built::with(&first).load_library(&second).unwrap_err();
    assert!(matches!(error, Error::DuplicateModel { .. }), "{error}");
}

fn model(fault: &str) -> Option<Box<dyn HysteresisModel>> {
    let registry = built::with(&built::faulty(fault)?);
    Some(registry.build_from_json::<dyn HysteresisModel>(&json!({ "model": "faulty" })).unwrap())
}

fn evaluated(model: &dyn JointModel) -> Result<(), ModelError> {
    let zeros = [0.0; 3];
    let series = JointSeries {
        time_s: &zeros,
        position_rad: &zeros,
        velocity_rad_s: &zeros,
        acceleration_rad_s2: &zeros,
        load_torque: &zeros,
    };
    let mut state = model.initial_state(&series.slice(0..1));
    model.evaluate(&series, &mut state, &mut Columns::new(&mut [0.0; 3], 1, 3, 3))
}

#[test]
fn what_goes_wrong_in_evaluation_names_the_model() {
    for (fault, expected) in [
        ("NOT_FINITE", "model `faulty` failed: column `c` is NaN at sample 2 of a batch (faulty)"),
        ("PANICS", "model `faulty` failed: it panicked: index out of bounds (faulty)"),
        ("ODD_CODE", "model `faulty` failed: it returned the unknown code 77:  (faulty)"),
        ("NO_STATE", "model `faulty` failed: it has no initial state: I forgot how to begin (faulty)"),
    ] {
        let Some(model) = model(fault) else { return };
        let shown = evaluated(&*model).unwrap_err().to_string();
        // The sign of a NaN is the processor's affair.
        assert_eq!(shown.replace("-NaN", "NaN"), expected);
    }
}

#[test]
fn a_faulty_description_is_refused() {
    for (fault, expected) in [
        ("NO_COLUMNS", "it names 1 columns but does not give them"),
        ("MANY_COLUMNS", "it names 1152921504606846976 columns"),
        ("MANY_SHAPES", "it names 1152921504606846976 shape parameters"),
        ("MANY_JOINTS", "it names 1152921504606846976 joints"),
        ("MANY_STATES", "it asks for 1152921504606846976 state variables"),
    ] {
        let Some(library) = built::faulty(fault) else { return };
        let registry = built::with(&library);
        let errors =
            registry.build_from_json::<dyn HysteresisModel>(&json!({ "model": "faulty" })).unwrap_err();
        assert_eq!(errors[0].to_string(), format!("model `faulty`: {expected}"));
    }
}

/// What people read of an experiment with these lines about friction.
fn problems(library: &Path, friction: &str) -> String {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("mdh.csv"), "alpha,a,d\n0,0.5,0\n0,0.4,0\n").unwrap();
    fs::write(folder.path().join("a.csv"), "").unwrap();
    let text = format!(
        "schema = 1\nrobot = {{ mdh = \"mdh.csv\", gravity_m_s2 = [0.0, -9.81, 0.0] }}\nrecordings.calibration = \"a.csv\"\n\
         plugins.libraries = [\"{}\"]\n{friction}\n",
        library.display()
    );
    let mut registry = built::trusting();
    let error = Experiment::parse(&text, &folder.path().join("e.toml"), &mut registry).unwrap_err();
    error.to_string().replace(&format!("{}/", folder.path().display()), "")
}

#[test]
fn wrong_keys_of_a_rust_library_are_underlined() {
    for (keys, expected) in [
        (
            ", transition_velocity_rad_s = \"fast\"",
            "74: model `eyring`, key `transition_velocity_rad_s`: invalid type: string \"fast\", expected f64;",
        ),
        (
            ", transition_velocity = 1.0",
            "46: model `eyring`, key `transition_velocity`: unknown key `transition_velocity`, expected \
             `transition_velocity_rad_s`; did you mean `transition_velocity_rad_s`?",
        ),
        (
            ", transition_velocity_rad_s = -1",
            "74: model `eyring`, key `transition_velocity_rad_s`: must be positive, is -1;",
        ),
        ("", "36: model `eyring`: missing key `transition_velocity_rad_s`;"),
    ] {
        let friction = format!("joint_dynamics.viscous = {{ model = \"eyring\"{keys} }}");
        let example = "a working example: { model = \"eyring\", transition_velocity_rad_s = 0.5 }";
        assert_eq!(problems(&built::rust_example(), &friction), format!("e.toml:5:{expected} {example}"));
    }
}

#[test]
fn an_arm_term_that_does_not_fit_the_robot_is_underlined() {
    let friction = "arm_terms = [{ model = \"dress_pack\", joints = [1, 7] }]";
    assert_eq!(
        problems(&built::rust_example(), friction),
        "e.toml:5:47: model `dress_pack`: `joints` names joint 7, but the robot has 2 joints"
    );
}

#[test]
fn wrong_keys_of_a_c_library_are_underlined() {
    let Some(library) = built::c_example() else { return };
    for (key, expected) in [
        ("distance_rad = \"far\"", "64: model `stop_c`, key `distance_rad`: expected a number;"),
        (
            "distance = 1.0",
            "49: model `stop_c`, key `distance`: unknown key, expected `distance_rad`; did you mean `distance_rad`?",
        ),
        ("distance_rad = 0", "64: model `stop_c`, key `distance_rad`: must be positive, is 0;"),
    ] {
        let friction = format!("joint_dynamics.hysteresis = {{ model = \"stop_c\", {key} }}");
        let example = "a working example: { model = \"stop_c\", distance_rad = 0.01 }";
        assert_eq!(problems(&library, &friction), format!("e.toml:5:{expected} {example}"));
    }
}

#[test]
fn every_complaint_of_a_c_library_is_reported() {
    let Some(library) = built::faulty("ANOTHER") else { return };
    let shown = |keys: &str| {
        problems(&library, &format!("joint_dynamics.hysteresis = {{ model = \"faulty\", {keys} }}"))
            .replace("; a working example: { model = \"faulty\" }", "")
    };
    assert_eq!(
        shown(r#"word = "x", strength = -1.5"#),
        "e.toml:5:56: model `faulty`, key `word`: has nothing to do with it\n\
         e.toml:5:72: model `faulty`, key `strength`: must not be negative, is -1.5"
    );
    for (key, value, expected) in [
        ("list", "[1, 2, true]", "expected a list of numbers"),
        ("list", "[1, 2, 3, 4, 5]", "has more than 4 numbers"),
        ("flag", "1", "expected true or false"),
        ("word", "1", "expected a string"),
    ] {
        let expected = format!("e.toml:5:56: model `faulty`, key `{key}`: {expected}");
        assert_eq!(shown(&format!("{key} = {value}")), expected);
    }
}

#[test]
fn a_slot_refuses_a_library_model_that_does_not_declare_its_invariant() {
    let Some(library) = built::faulty("UNBOUNDED") else { return };
    assert_eq!(
        problems(&library, "joint_dynamics.hysteresis = { model = \"faulty\" }"),
        "e.toml:5:39: model `faulty` cannot be the hysteresis model: it is not bounded by one in magnitude (equation \
         (6) asks for it); enter it as an arm term, outside equation (6), instead"
    );
}

#[test]
fn a_library_that_cannot_be_loaded_is_underlined_in_the_experiment() {
    let Some(library) = built::faulty("OTHER_MAJOR") else { return };
    let shown = problems(&library, "");
    assert!(shown.starts_with("e.toml:4:22: the library "), "{shown}");
    assert!(shown.contains("was built for version 2.0 of the plugin interface"), "{shown}");
}
