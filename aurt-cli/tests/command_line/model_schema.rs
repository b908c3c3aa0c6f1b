//! Saved models against the JSON Schema in `docs/`, and where they come from.

use serde_json::{Value, json};

use crate::support::Folder;

const SCHEMA: &str = include_str!("../../../docs/rd_calibrated.schema.json");

/// What of a value a schema does not allow, as `place: reason`; of JSON Schema the words that ours uses.
fn complaints(schema: &Value, root: &Value, value: &Value, place: &str) -> Vec<String> {
    let mut found = Vec::new();
    let mut refuse = |reason: String| found.push(format!("{place}: {reason}"));
    let mut inner = Vec::new();
    for (word, rule) in schema.as_object().unwrap() {
        let length = value.as_array().map_or(0, Vec::len) as u64;
        let entries = value.as_object().map_or(0, serde_json::Map::len) as u64;
        match word.as_str() {
            "$schema" | "$defs" | "title" | "description" => {}
            "$ref" => {
                let name = rule.as_str().unwrap().strip_prefix("#/$defs/").unwrap();
                inner.extend(complaints(&root["$defs"][name], root, value, place));
            }
            "type" => {
                let is = |kind: &Value| match kind.as_str().unwrap() {
                    "object" => value.is_object(),
                    "array" => value.is_array(),
                    "string" => value.is_string(),
                    "boolean" => value.is_boolean(),
                    "null" => value.is_null(),
                    "number" => value.is_number(),
                    "integer" => value.is_u64() || value.is_i64(),
                    other => panic!("the type {other}"),
                };
                let fits = rule.as_array().map_or_else(|| is(rule), |kinds| kinds.iter().any(is));
                if !fits {
                    refuse(format!("is no {rule}"));
                }
            }
            "const" if value != rule => refuse(format!("is not {rule}")),
            "enum" if !rule.as_array().unwrap().contains(value) => refuse(format!("is none of {rule}")),
            "const" | "enum" => {}
            "anyOf" => {
                let fits = |s: &Value| complaints(s, root, value, place).is_empty();
                if !rule.as_array().unwrap().iter().any(fits) {
                    refuse("is nothing that is allowed".into());
                }
            }
            "required" => {
                let missing = |k: &&Value| value.get(k.as_str().unwrap()).is_none();
                let missing: Vec<&Value> = rule.as_array().unwrap().iter().filter(missing).collect();
                if value.is_object() && !missing.is_empty() {
                    refuse(format!("lacks {missing:?}"));
                }
            }
            "properties" => {
                for (key, rule) in rule.as_object().unwrap() {
                    if let Some(value) = value.get(key) {
                        inner.extend(complaints(rule, root, value, &format!("{place}/{key}")));
                    }
                }
            }
            "additionalProperties" => {
                for (key, value) in value.as_object().into_iter().flatten() {
                    if schema["properties"].get(key).is_some() {
                        continue;
                    }
                    if rule == &json!(false) {
                        refuse(format!("has the unknown key {key}"));
                    } else {
                        inner.extend(complaints(rule, root, value, &format!("{place}/{key}")));
                    }
                }
            }
            "items" => {
                for (n, value) in value.as_array().into_iter().flatten().enumerate() {
                    inner.extend(complaints(rule, root, value, &format!("{place}/{n}")));
                }
            }
            "minItems" if value.is_array() && length < rule.as_u64().unwrap() => {
                refuse("is too short".into())
            }
            "maxItems" if value.is_array() && length > rule.as_u64().unwrap() => refuse("is too long".into()),
            "minProperties" if entries < rule.as_u64().unwrap() => refuse("has too few keys".into()),
            "maxProperties" if entries > rule.as_u64().unwrap() => refuse("has too many keys".into()),
            "minimum" if value.as_f64().is_some_and(|v| v < rule.as_f64().unwrap()) => {
                refuse(format!("is below {rule}"));
            }
            "minItems" | "maxItems" | "minProperties" | "maxProperties" | "minimum" => {}
            "pattern" => {
                assert_eq!(rule, "^[0-9a-f]{64}$");
                let hash = |t: &str| t.len() == 64 && t.chars().all(|c| matches!(c, '0'..='9' | 'a'..='f'));
                if value.as_str().is_some_and(|text| !hash(text)) {
                    refuse("is no hash".into());
                }
            }
            other => panic!("the word {other}"),
        }
    }
    found.extend(inner);
    found
}

fn judged(model: &Value) -> Vec<String> {
    let schema: Value = serde_json::from_str(SCHEMA).unwrap();
    complaints(&schema, &schema, model, "")
}

#[test]
fn saved_models_are_what_the_schema_describes_and_damaged_ones_are_not() {
    let folder = Folder::new().with_whole_demo();
    let text = folder.read("experiment.toml");
    let estimators =
        [("wls", false), ("ols", false), ("irls", false), ("consistent", false), ("essential", true)];
    for (estimator, tanh) in estimators {
        let with = text.replace("\"sign\"", if tanh { "\"tanh\"" } else { "\"sign\"" });
        folder.write("again.toml", &format!("{with}\n[calibration]\nestimator = \"{estimator}\"\n"));
        folder.run("run again.toml --out results").succeeded();
        let model = folder.json("results/rd_calibrated.json");
        assert_eq!(judged(&model), Vec::<String>::new(), "{estimator}");
    }
    folder.run("run experiment.toml --out results").succeeded();
    let model = folder.json("results/rd_calibrated.json");
    let damages: [(&str, Value, &str); 9] = [
        ("/schema", json!(2), "/schema: is not 1"),
        ("/calibration/unit", json!("Nmm"), "/calibration/unit: is none of"),
        ("/calibration/sigma/2", Value::Null, "/calibration/sigma/2: is no \"number\""),
        ("/calibration/load", json!("sum"), "/calibration/load: is nothing that is allowed"),
        ("/calibration/parameters/0/value", json!("8.3"), "/parameters/0/value: is no \"number\""),
        ("/model/rigid_body_dynamics/rigid_body/gravity_m_s2", json!([0.0, 1.0]), "is too short"),
        ("/model/rigid_body_dynamics/rigid_body/joints/1/sign", json!(0.5), "/sign: is none of"),
        ("/model/joint_dynamics/3/viscous", json!({ "powers": [1] }), "lacks [String(\"model\")]"),
        ("/provenance/calibration/0/blake3", json!("0123"), "/blake3: is no hash"),
    ];
    for (place, damage, reason) in damages {
        let mut damaged = model.clone();
        *damaged.pointer_mut(place).unwrap() = damage;
        let found = judged(&damaged);
        assert!(found.len() == 1 && found[0].contains(reason), "{place}: {found:?}");
    }
    let mut more = model.clone();
    more["calibration"]["gravity"] = json!(9.81);
    assert_eq!(judged(&more), ["/calibration: has the unknown key gravity"]);
    more["calibration"].as_object_mut().unwrap().remove("gravity");
    more["calibration"].as_object_mut().unwrap().remove("sigma");
    assert_eq!(judged(&more).len(), 1);
}

#[test]
fn models_name_the_files_that_they_come_from() {
    let folder = Folder::new().with_whole_demo();
    folder.run("run experiment.toml --out results").succeeded();
    let model = folder.json("results/rd_calibrated.json");
    let hash = |name: &str| blake3::hash(folder.read(name).as_bytes()).to_hex().to_string();
    let origins = &model["provenance"];
    assert_eq!(origins["experiment_blake3"], hash("experiment.toml"));
    assert_eq!(origins["calibration"][0]["file"], "exciting_motion.csv");
    assert_eq!(origins["calibration"][0]["blake3"], hash("exciting_motion.csv"));
    let validation = origins["validation"].as_array().unwrap();
    assert!(validation.iter().any(|v| v["blake3"] == hash("other_motion.csv")), "{origins}");

    // Exports name them as well; a model of an earlier program, which has none, is read.
    folder.run("export c results/rd_calibrated.json --out exported").succeeded();
    let header = folder.read("exported/robot.h");
    assert!(
        header.contains(&format!("exciting_motion.csv (BLAKE3 {})", hash("exciting_motion.csv"))),
        "{header}"
    );
    let mut earlier = model.clone();
    earlier.as_object_mut().unwrap().remove("provenance");
    folder.write("earlier.json", &earlier.to_string());
    let predict = ["predict", "--model", "earlier.json", "--data", "other_motion.csv", "--out", "p.csv"];
    folder.aurt(predict).succeeded();
}
