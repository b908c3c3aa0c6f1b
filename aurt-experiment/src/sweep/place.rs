//! Keys of an experiment, as a sweep names them, and values put there.

use aurt_plugins::{Node, NodeKind, suggestion};
use toml::{Table, Value};

/// A key: `joint_dynamics.coulomb.model`, `arm_terms.0.joints` (lists count from 0).
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Place(Vec<String>);

impl Place {
    pub fn new(key: &str) -> Self {
        Self(key.split('.').map(|part| part.trim().to_owned()).collect())
    }

    pub fn parts(&self) -> &[String] {
        &self.0
    }

    /// The shortest form that a reader understands: without `joint_dynamics`.
    pub fn short(&self) -> String {
        let parts = match self.0.split_first() {
            Some((first, rest)) if first == "joint_dynamics" && !rest.is_empty() => rest,
            _ => &self.0,
        };
        parts.join(".")
    }

    /// Puts a value at this place of a document, in the place of what stands there; tables that are missing on the
    /// way are made.
    pub fn put(&self, document: &mut Table, value: Value) -> Result<(), String> {
        let Some((last, way)) = self.0.split_last() else { return Err("the key is empty".into()) };
        if self.0.iter().any(String::is_empty) {
            return Err(format!("`{}` has an empty part", self.0.join(".")));
        }
        if self.0[0] == "sweep" {
            return Err("a sweep cannot change [sweep] itself".into());
        }
        let mut here = Here::Table(document);
        for part in way {
            here = here.step(part)?;
        }
        match here {
            Here::Table(table) => {
                table.insert(last.clone(), value);
                Ok(())
            }
            Here::List(list) => {
                *element(list, last)? = value;
                Ok(())
            }
        }
    }

    /// The first part that `document` does not have, with the key that it has instead and that was probably meant.
    pub fn likely<'d>(&self, document: &'d Table) -> Option<(&str, &'d str)> {
        let mut table = document;
        for part in &self.0 {
            match table.get(part) {
                Some(Value::Table(below)) => table = below,
                Some(_) => return None,
                None => {
                    let meant = suggestion::likely(part, table.keys().map(String::as_str))?;
                    return Some((part, meant));
                }
            }
        }
        None
    }
}

impl std::fmt::Display for Place {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.0.join("."))
    }
}

/// Where a walk through a document has come to.
enum Here<'d> {
    Table(&'d mut Table),
    List(&'d mut Vec<Value>),
}

impl<'d> Here<'d> {
    fn step(self, part: &str) -> Result<Self, String> {
        let below = match self {
            Self::Table(table) => table.entry(part.to_owned()).or_insert_with(|| Value::Table(Table::new())),
            Self::List(list) => element(list, part)?,
        };
        match below {
            Value::Table(table) => Ok(Here::Table(table)),
            Value::Array(list) => Ok(Here::List(list)),
            other => Err(format!("`{part}` is {}, nothing can be below it", kind(other))),
        }
    }
}

fn element<'d>(list: &'d mut [Value], part: &str) -> Result<&'d mut Value, String> {
    let length = list.len();
    let wrong = || format!("`{part}` is no element of a list of {length}; they count from 0");
    part.parse::<usize>().ok().and_then(|k| list.get_mut(k)).ok_or_else(wrong)
}

const fn kind(value: &Value) -> &'static str {
    match value {
        Value::String(_) => "a string",
        Value::Integer(_) | Value::Float(_) => "a number",
        Value::Boolean(_) => "a boolean",
        Value::Datetime(_) => "a date or time",
        Value::Array(_) => "a list",
        Value::Table(_) => "a table",
    }
}

pub fn to_toml(node: &Node) -> Value {
    match &node.kind {
        NodeKind::Null => Value::String("null".into()),
        NodeKind::Boolean(b) => Value::Boolean(*b),
        NodeKind::Integer(n) => Value::Integer(*n),
        NodeKind::Float(x) => Value::Float(*x),
        NodeKind::String(text) => Value::String(text.clone()),
        NodeKind::Datetime(text) => {
            text.parse().map_or_else(|_| Value::String(text.clone()), Value::Datetime)
        }
        NodeKind::Array(list) => Value::Array(list.iter().map(to_toml).collect()),
        NodeKind::Table(entries) => {
            Value::Table(entries.iter().map(|e| (e.key.clone(), to_toml(&e.value))).collect())
        }
    }
}

/// A value in few words: `maxwell_slip(elements=5)` for a table that names a model.
pub fn brief(node: &Node) -> String {
    let listed = |items: &mut dyn Iterator<Item = String>| items.collect::<Vec<_>>().join(",");
    match &node.kind {
        NodeKind::String(text) | NodeKind::Datetime(text) => text.clone(),
        NodeKind::Array(list) => format!("[{}]", listed(&mut list.iter().map(brief))),
        NodeKind::Table(entries) => {
            let model = node.get("model").and_then(Node::as_str);
            let mut rest = entries
                .iter()
                .filter(|e| !(model.is_some() && e.key == "model"))
                .map(|e| format!("{}={}", e.key, brief(&e.value)));
            let rest = listed(&mut rest);
            match model {
                Some(model) if rest.is_empty() => model.to_owned(),
                Some(model) => format!("{model}({rest})"),
                None => format!("{{{rest}}}"),
            }
        }
        _ => to_toml(node).to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn document() -> Table {
        toml::from_str(
            "[joint_dynamics]\ncoulomb = { model = \"none\" }\n[[arm_terms]]\nmodel = \"spring\"\n",
        )
        .unwrap()
    }

    #[test]
    fn values_are_put_and_tables_made() {
        let mut d = document();
        Place::new("joint_dynamics.coulomb.model").put(&mut d, "square".into()).unwrap();
        Place::new("calibration.estimator").put(&mut d, "ols".into()).unwrap();
        Place::new("arm_terms.0.joints").put(&mut d, Value::Array(vec![1.into()])).unwrap();
        assert_eq!(d["joint_dynamics"]["coulomb"]["model"].as_str(), Some("square"));
        assert_eq!(d["calibration"]["estimator"].as_str(), Some("ols"));
        assert_eq!(d["arm_terms"][0]["joints"][0].as_integer(), Some(1));
    }

    #[test]
    fn what_is_in_the_way_is_named() {
        let mut d = document();
        let mut refusal = |key: &str| Place::new(key).put(&mut d, 1.into()).unwrap_err();
        assert!(refusal("joint_dynamics.coulomb.model.name").contains("`model` is a string"));
        assert!(refusal("arm_terms.1.joints").contains("list of 1"));
        assert!(refusal("sweep.grid").contains("[sweep] itself"));
        assert!(refusal("a..b").contains("empty part"));
    }

    #[test]
    fn the_likely_key_is_one_that_stands_there() {
        let d = document();
        assert_eq!(Place::new("joint_dynamic.coulomb").likely(&d), Some(("joint_dynamic", "joint_dynamics")));
        assert_eq!(Place::new("joint_dynamics.coulmb.model").likely(&d), Some(("coulmb", "coulomb")));
        assert_eq!(Place::new("joint_dynamics.coulomb.model").likely(&d), None);
    }
}
