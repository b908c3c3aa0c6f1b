//! Joints in files for programs: by number, and by name where they have names.

use serde_json::{Value, json};

/// `document` with the name of every joint beside its number: `joint_name` at each `joint`, `joint_names` at each list
/// `joints`. Tables of models, which are read again, stay as they are.
pub fn with_names(mut document: Value, names: &[String]) -> Value {
    if !names.is_empty() {
        add_names(&mut document, names);
    }
    document
}

fn add_names(value: &mut Value, names: &[String]) {
    let entries = match value {
        Value::Array(items) => return items.iter_mut().for_each(|item| add_names(item, names)),
        Value::Object(entries) if !entries.contains_key("model") => entries,
        _ => return,
    };
    entries.values_mut().for_each(|entry| add_names(entry, names));
    let name = |joint: &Value| names.get(usize::try_from(joint.as_u64()?).ok()?).cloned();
    if let Some(name) = entries.get("joint").and_then(name) {
        entries.insert("joint_name".into(), json!(name));
    }
    let all = |joints: &Vec<Value>| joints.iter().map(name).collect::<Option<Vec<String>>>();
    let list = entries.get("joints").and_then(Value::as_array).filter(|joints| !joints.is_empty());
    if let Some(listed) = list.and_then(all) {
        entries.insert("joint_names".into(), json!(listed));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_stand_beside_numbers_but_not_in_models() {
        let names = ["a".to_owned(), "<b>\"".to_owned()];
        let document = json!({ "effects": [{ "joints": [1, 0], "term": { "model": "x", "joints": [1] } }], "joint": 1,
            "joints": [{ "joint": 0 }] });
        let named = with_names(document.clone(), &names);
        assert_eq!(named["effects"][0]["joint_names"], json!(["<b>\"", "a"]));
        assert_eq!(named["effects"][0]["term"], document["effects"][0]["term"]);
        assert_eq!((&named["joint_name"], &named["joints"][0]["joint_name"]), (&json!("<b>\""), &json!("a")));
        assert_eq!(with_names(document.clone(), &[]), document);
    }
}
