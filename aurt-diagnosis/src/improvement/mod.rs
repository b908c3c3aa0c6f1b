//! The experiment that has the named physics.

use std::path::PathBuf;

use aurt_plugins::Origin;
use aurt_traits::JointStack;
use serde_json::Value;
use toml_edit::{Array, ArrayOfTables, DocumentMut, InlineTable, Item, Table};

use crate::effects::stribeck;
use crate::error::DiagnosisError;
use crate::evidence::baseline::weighted_fit;
use crate::investigation::Investigation;
use crate::recordings::rows::{Instrument, JointRows, Role};
use crate::request::Question;
use crate::vocabulary::{AROUND, Addition};

/// What has to be added to an experiment.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Improvement {
    /// Arm terms, each as its configuration, with the recordings in which it acts if not in all.
    pub terms: Vec<(Value, Option<Vec<String>>)>,
    /// Factors on the instrument's gains, joint by joint.
    pub gain_factors: Option<Vec<f64>>,
    /// Delays of the measurement, joint by joint, s.
    pub delay_s: Option<Vec<f64>>,
    /// Whether target recordings join the calibration ones.
    pub calibrate_on_target: bool,
    /// True if the calibration leaves out rows of joints that stand, as the diagnosis does.
    pub exclude_rest: bool,
    /// Libraries that the terms' models are from.
    pub libraries: Vec<PathBuf>,
    /// What could not be put into the experiment, and why.
    pub notes: Vec<String>,
}

/// What the chosen effects add to an experiment.
pub fn improvement(question: &Question<'_>, investigation: &Investigation) -> Improvement {
    let joints = question.model.joints();
    let all = investigation.switches();
    let (fit, _) = weighted_fit(&investigation.problem, &all, &investigation.floor);
    let value = |column: usize, target_only: bool| {
        all.iter()
            .position(|s| s.column == column && s.target_only == target_only)
            .map_or(0.0, |k| fit.coefficients[k])
    };
    let targets: Vec<String> = question
        .recordings
        .iter()
        .filter(|r| r.role != Role::Calibration)
        .map(|r| r.data.name.clone())
        .collect::<std::collections::BTreeSet<_>>()
        .into_iter()
        .collect();
    let mut improvement = Improvement {
        calibrate_on_target: question.recordings.iter().any(|r| r.role == Role::Target),
        exclude_rest: investigation.rows.iter().flat_map(|r| &r.joints).any(JointRows::stands_long),
        ..Improvement::default()
    };
    // What is in the targets and in no term of the improved model.
    let mut left_in_targets = false;
    if let Some(late) = &investigation.late {
        if late.delay.target_only && investigation.problem.has_reference() {
            left_in_targets = true;
            improvement.notes.push(
                "the delay is in the target recordings only; `[instrument]` holds for all recordings, so it was not \
                 added"
                    .into(),
            );
        } else {
            improvement.delay_s = Some(vec![late.delay.delay_s; joints]);
        }
    }
    for gear in investigation.shaking.iter().filter(|s| s.confirmed) {
        left_in_targets |= !gear.present[0];
        improvement.notes.push(format!(
            "the gear of {} ({:.3e} Nm/rad, play ± {:.1e} rad) is not in the improved experiment: no term that is linear \
             in its parameters describes a link that rings on its motor",
            question.names().joint(gear.joint), gear.stiffness_nm_rad[0], gear.gap_rad[0]
        ));
    }
    for chosen in &investigation.selection.chosen {
        let group = &investigation.groups[chosen.group];
        let candidate = &investigation.candidates[group.candidate];
        if let Some(Origin::Library(library)) = candidate.registered.as_ref().map(|r| &r.origin)
            && !improvement.libraries.contains(&library.path)
        {
            improvement.libraries.push(library.path.clone());
        }
        let scope = (group.target_only() && investigation.problem.has_reference()).then(|| targets.clone());
        match &candidate.proposal.addition {
            Addition::Term(configuration) => {
                let mut configuration = configuration.clone();
                if scope.is_none() {
                    leave_out_level(&mut configuration, question.model.stacks());
                }
                add_term(&mut improvement.terms, &configuration, scope);
            }
            Addition::Instrument(joint, which) => {
                let found = value(candidate.columns[0], group.target_only());
                if scope.is_some() {
                    left_in_targets = true;
                    improvement.notes.push(format!(
                        "{} on {} is in the target recordings only; `[instrument]` holds for all \
                         recordings, so it was not added",
                        group.effect.id,
                        question.names().joint(*joint)
                    ));
                    continue;
                }
                match which {
                    Instrument::Gain => {
                        improvement.gain_factors.get_or_insert_with(|| vec![1.0; joints])[*joint] /=
                            1.0 + found;
                    }
                    // Undone by a shift; see above.
                    Instrument::Delay | Instrument::DelayOfAll => {}
                }
            }
        }
    }
    if left_in_targets && improvement.calibrate_on_target {
        // Terms of the targets alone are calibrated on the targets alone.
        improvement.calibrate_on_target = improvement.terms.iter().any(|(_, scope)| scope.is_some());
        let consequence = if improvement.calibrate_on_target {
            "the improved model is calibrated on targets that differ in something that it lacks"
        } else {
            "the target recordings take no part in the calibration of the improved model"
        };
        improvement.notes.push(consequence.into());
    }
    improvement
}

/// Leaves the level out of Stribeck friction on a joint whose own friction has it: two columns would be the same.
fn leave_out_level(term: &mut Value, stacks: &[JointStack]) {
    let joint = term.pointer("/joints/0").and_then(Value::as_u64).map(|j| j as usize);
    let Some(own) = joint.and_then(|joint| stacks.get(joint)) else { return };
    let hysteresis = serde_json::to_value(own.hysteresis()).unwrap_or_default();
    let is_same = term.pointer("/hysteresis/model") == hysteresis.get("model");
    let has_level = own.coulomb().columns().iter().any(|column| column.name == "F_C0");
    if is_same && has_level {
        stribeck::leave_out_level(term);
    }
}

/// Adds a term; one that differs from an earlier one in its joints alone joins it, but for one around values of each joint.
fn add_term(
    terms: &mut Vec<(Value, Option<Vec<String>>)>,
    configuration: &Value,
    scope: Option<Vec<String>>,
) {
    let key = |value: &Value| {
        let mut rest = value.clone();
        if let Some(table) = rest.as_object_mut() {
            table.remove("joints");
        }
        rest
    };
    let joined = terms.iter_mut().find(|(other, s)| {
        *s == scope
            && AROUND.iter().all(|key| other.get(key).is_none())
            && other.get("joints").is_some()
            && configuration.get("joints").is_some()
            && key(other) == key(configuration)
    });
    match joined {
        Some((other, _)) => {
            if let (Some(Value::Array(list)), Some(Value::Array(more))) =
                (other.get_mut("joints"), configuration.get("joints"))
            {
                list.extend(more.iter().cloned());
                list.sort_by_key(Value::as_u64);
            }
        }
        None => terms.push((configuration.clone(), scope)),
    }
}

/// The experiment's text with the improvement in it; comments and order are kept.
///
/// # Errors
/// [`DiagnosisError::Improvement`] if the text is not an experiment that can be extended.
pub fn improved_experiment(source: &str, improvement: &Improvement) -> Result<String, DiagnosisError> {
    let refuse = |reason: String| DiagnosisError::Improvement { reason };
    let mut document: DocumentMut = source.parse().map_err(|e| refuse(format!("{e}")))?;
    if improvement.calibrate_on_target
        && let Some(recordings) = document.get_mut("recordings").and_then(Item::as_table_like_mut)
    {
        let targets: Vec<toml_edit::Value> = recordings
            .remove("target")
            .and_then(|t| t.as_array().cloned())
            .map(|a| a.iter().cloned().collect())
            .unwrap_or_default();
        if let Some(calibration) = recordings.get_mut("calibration").and_then(Item::as_array_mut) {
            for mut target in targets {
                target.decor_mut().clear();
                calibration.push(target);
            }
        }
    }
    if improvement.exclude_rest {
        let calibration = document.entry("calibration").or_insert_with(|| Item::Table(Table::new()));
        if let Some(calibration) = calibration.as_table_like_mut() {
            calibration.entry("rest").or_insert(Item::Value("exclude".into()));
        }
    }
    if !improvement.libraries.is_empty() {
        let plugins = document.entry("plugins").or_insert_with(|| Item::Table(Table::new()));
        let list = plugins
            .as_table_like_mut()
            .map(|table| table.entry("libraries").or_insert_with(|| Item::Value(Array::new().into())));
        let Some(list) = list.and_then(Item::as_array_mut) else {
            return Err(refuse("`libraries` of `plugins` is not a list".into()));
        };
        list.extend(improvement.libraries.iter().map(|path| path.to_string_lossy().into_owned()));
    }
    for (configuration, scope) in &improvement.terms {
        let mut table = Table::new();
        for (name, value) in configuration.as_object().into_iter().flatten() {
            table.insert(name, Item::Value(toml_value(value)));
        }
        if let Some(names) = scope {
            table.insert(
                "recordings",
                Item::Value(names.iter().map(String::as_str).collect::<Array>().into()),
            );
        }
        let terms = document.entry("arm_terms").or_insert_with(|| Item::ArrayOfTables(ArrayOfTables::new()));
        match terms {
            Item::ArrayOfTables(terms) => terms.push(table),
            Item::Value(toml_edit::Value::Array(terms)) => {
                terms.push(toml_edit::Value::InlineTable(table.into_inline_table()));
            }
            _ => return Err(refuse("`arm_terms` is neither a list of tables nor an array".into())),
        }
    }
    if improvement.gain_factors.is_some() || improvement.delay_s.is_some() {
        let instrument = document.entry("instrument").or_insert_with(|| Item::Table(Table::new()));
        let Some(instrument) = instrument.as_table_like_mut() else {
            return Err(refuse("`instrument` is not a table".into()));
        };
        if let Some(factors) = &improvement.gain_factors {
            combine(instrument, "gains", factors, |old, factor| old * factor, 1.0);
        }
        if let Some(delays) = &improvement.delay_s {
            combine(instrument, "delay_s", delays, |old, delay| old + delay, 0.0);
        }
    }
    Ok(document.to_string())
}

/// Combines a list of an instrument's key with another, joint by joint.
fn combine(
    table: &mut dyn toml_edit::TableLike,
    key: &str,
    with: &[f64],
    how: impl Fn(f64, f64) -> f64,
    default: f64,
) {
    let old: Vec<f64> = table
        .get(key)
        .and_then(Item::as_array)
        .map(|a| {
            a.iter().map(|v| v.as_float().or(v.as_integer().map(|i| i as f64)).unwrap_or(default)).collect()
        })
        .unwrap_or_default();
    let combined: Array =
        with.iter().enumerate().map(|(j, w)| how(old.get(j).copied().unwrap_or(default), *w)).collect();
    table.insert(key, Item::Value(combined.into()));
}

/// A JSON value as a TOML value; null, which TOML does not have, becomes false.
fn toml_value(value: &Value) -> toml_edit::Value {
    match value {
        Value::Null => false.into(),
        Value::Bool(b) => (*b).into(),
        Value::Number(n) => match n.as_i64() {
            Some(i) => i.into(),
            None => n.as_f64().unwrap_or(0.0).into(),
        },
        Value::String(s) => s.as_str().into(),
        Value::Array(list) => list.iter().map(toml_value).collect::<Array>().into(),
        Value::Object(map) => {
            let mut table = InlineTable::new();
            for (name, item) in map {
                table.insert(name, toml_value(item));
            }
            table.into()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use aurt_plugins::Registry;
    use serde_json::json;

    #[test]
    fn comments_stay_and_terms_of_equal_kind_share_a_table() {
        let source = "schema = 1 # first\n[recordings]\ncalibration = [\"a.csv\"]\ntarget = [\"b.csv\"]\n";
        let mut improvement = Improvement { calibrate_on_target: true, ..Improvement::default() };
        add_term(&mut improvement.terms, &json!({"model": "spring", "joints": [2]}), None);
        add_term(&mut improvement.terms, &json!({"model": "spring", "joints": [0]}), None);
        for joint in [1, 2] {
            let term = json!({"model": "joint_compliance", "joints": [joint], "around_rad_nm": [0.0]});
            add_term(&mut improvement.terms, &term, None);
        }
        add_term(&mut improvement.terms, &json!({"model": "payload", "link": 5}), Some(vec!["b.csv".into()]));
        improvement.gain_factors = Some(vec![1.0, 0.5]);
        improvement.exclude_rest = true;
        let text = improved_experiment(source, &improvement).unwrap();
        assert!(text.starts_with("schema = 1 # first"), "{text}");
        assert!(text.contains("calibration = [\"a.csv\", \"b.csv\"]") && !text.contains("target"), "{text}");
        assert!(text.contains("joints = [0, 2]"), "{text}");
        assert_eq!(text.matches("joint_compliance").count(), 2, "{text}");
        assert!(text.contains("recordings = [\"b.csv\"]"), "{text}");
        assert!(text.contains("gains = [1.0, 0.5]"), "{text}");
        assert!(text.contains("[calibration]\nrest = \"exclude\""), "{text}");
        let kept = format!("{source}[calibration]\nrest = \"keep\"\n");
        assert!(!improved_experiment(&kept, &improvement).unwrap().contains("exclude"));
    }

    /// The level of dry friction is the joint's own; where it has none, or another law of motion, the term keeps it.
    #[test]
    fn stribeck_friction_beside_dry_friction_has_no_level_of_its_own() {
        let level = |coulomb: &str, hysteresis: &str| {
            let registry = Registry::linked().unwrap();
            let own = JointStack::new(
                registry.build_from_json(&json!({ "model": coulomb })).unwrap(),
                registry.build_from_json(&json!({ "model": hysteresis })).unwrap(),
                registry.build_from_json(&json!({ "model": "polynomial", "powers": [1] })).unwrap(),
            );
            let mut term = json!({
                "model": "joint_friction", "joints": [1], "coulomb": { "model": "stribeck" }, "hysteresis": { "model": "sign" },
            });
            leave_out_level(&mut term, &[own.clone().unwrap(), own.unwrap()]);
            term.pointer("/coulomb/level").cloned()
        };
        for coulomb in ["constant", "absolute", "square"] {
            assert_eq!(level(coulomb, "sign"), Some(false.into()), "{coulomb}");
        }
        assert_eq!((level("absent", "sign"), level("constant", "tanh")), (None, None));
    }
}
