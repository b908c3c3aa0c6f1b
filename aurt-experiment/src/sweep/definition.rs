//! `[sweep]`: what is varied, how points are judged.

use crate::Complaint;
use aurt_plugins::{Node, NodeKind, Span, suggestion};

use crate::sweep::place::Place;

/// Length of the blocks of time over which errors are summed, unless given.
const BLOCK_S: f64 = 1.0;

#[derive(Debug, Clone, PartialEq)]
pub struct Definition {
    /// Axes whose values are combined, each with each; the later ones change faster.
    pub axes: Vec<Vec<Step>>,
    pub validate: Validate,
    /// `block_s`: length of the blocks of time over which errors are summed for comparisons, s; 1 by default.
    pub block_s: f64,
    /// `reference`: name of the point that others are compared with, and where it is written; the first by default.
    pub reference: Option<(String, Span)>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Validate {
    /// `"held_out"`: fitted to all calibration recordings, judged on the validation recordings.
    #[default]
    HeldOut,
    /// `"leave_one_out"`: for each calibration recording, fitted to the others and judged on it.
    LeaveOneOut,
}

#[derive(Debug, Clone, PartialEq)]
pub struct Step {
    /// Its name, if it has one; otherwise its settings name it.
    pub name: Option<String>,
    pub settings: Vec<Setting>,
}

/// A key with the value that it gets.
#[derive(Debug, Clone, PartialEq)]
pub struct Setting {
    pub place: Place,
    pub key_span: Span,
    pub value: Node,
}

const KEYS: [&str; 6] = ["block_s", "grid", "reference", "validate", "variant", "zip"];
const VARIANT_KEYS: [&str; 2] = ["name", "set"];

impl Definition {
    pub(crate) fn read(sweep: &Node) -> Result<Self, Vec<Complaint>> {
        let mut complaints = Vec::new();
        if !matches!(sweep.kind, NodeKind::Table(_)) {
            return Err(vec![Complaint::new(&sweep.span, "`sweep` expects a table, write [sweep]")]);
        }
        unknown(sweep, "[sweep]", &KEYS, &mut complaints);
        // Of the grid every key is an axis.
        let of_one = |setting: Setting| Step { name: None, settings: vec![setting] };
        let grid = lists(sweep, "grid", &mut complaints).into_iter();
        let mut axes: Vec<Vec<Step>> =
            grid.map(|settings| settings.into_iter().map(of_one).collect()).collect();
        axes.extend(zip(sweep, &mut complaints));
        axes.extend(variants(sweep, &mut complaints));
        let validate = match sweep.get("validate").map(|n| (n, n.as_str())) {
            None => Validate::default(),
            Some((_, Some("held_out"))) => Validate::HeldOut,
            Some((_, Some("leave_one_out"))) => Validate::LeaveOneOut,
            Some((node, word)) => {
                let help =
                    suggestion::help(word.unwrap_or_default(), "values", ["held_out", "leave_one_out"]);
                complaints.push(Complaint::new(&node.span, "`validate` cannot be this").help(help));
                Validate::default()
            }
        };
        let block_s = match sweep.get("block_s").map(|n| (n, n.as_number())) {
            None => BLOCK_S,
            Some((_, Some(x))) if x.is_finite() && x > 0.0 => x,
            Some((node, _)) => {
                complaints
                    .push(Complaint::new(&node.span, "`block_s` expects a number of seconds above zero"));
                BLOCK_S
            }
        };
        let reference = sweep.get("reference").and_then(|node| {
            if node.as_str().is_none() {
                complaints.push(Complaint::new(&node.span, "`reference` expects the name of a point"));
            }
            Some((node.as_str()?.to_owned(), node.span.clone()))
        });
        if axes.is_empty() && complaints.is_empty() {
            complaints.push(
                Complaint::new(&sweep.span, "[sweep] varies nothing")
                    .help("give it [sweep.grid], [sweep.zip] or [[sweep.variant]]"),
            );
        }
        if complaints.is_empty() { Ok(Self { axes, validate, block_s, reference }) } else { Err(complaints) }
    }
}

/// `[sweep.zip]`: all keys step together.
fn zip(sweep: &Node, complaints: &mut Vec<Complaint>) -> Option<Vec<Step>> {
    let lists = lists(sweep, "zip", complaints);
    let first = lists.first()?;
    if let Some(other) = lists.iter().find(|list| list.len() != first.len()) {
        let message = format!(
            "the lists of [sweep.zip] step together, but `{}` has {} values and `{}` has {}",
            other[0].place,
            other.len(),
            first[0].place,
            first.len()
        );
        complaints.push(Complaint::new(&other[0].key_span, message));
        return None;
    }
    let step = |k: usize| Step { name: None, settings: lists.iter().map(|list| list[k].clone()).collect() };
    Some((0..first.len()).map(step).collect())
}

/// `[[sweep.variant]]`: named alternatives.
fn variants(sweep: &Node, complaints: &mut Vec<Complaint>) -> Option<Vec<Step>> {
    let node = sweep.get("variant")?;
    let NodeKind::Array(tables) = &node.kind else {
        complaints.push(
            Complaint::new(&node.span, "`variant` expects tables")
                .help("write [[sweep.variant]], two brackets"),
        );
        return None;
    };
    let mut steps: Vec<Step> = Vec::new();
    for table in tables {
        unknown(table, "[[sweep.variant]]", &VARIANT_KEYS, complaints);
        let Some(name) = table.get("name").and_then(Node::as_str) else {
            complaints.push(Complaint::new(&table.span, "a variant needs a `name`, a string"));
            continue;
        };
        if steps.iter().any(|s| s.name.as_deref() == Some(name)) {
            let span = table.get("name").map_or(&table.span, |n| &n.span);
            complaints.push(Complaint::new(span, format!("there is a variant \"{name}\" above already")));
        }
        let set = table.get("set");
        if let Some(node) = set.filter(|n| !matches!(n.kind, NodeKind::Table(_))) {
            complaints.push(
                Complaint::new(&node.span, "`set` expects a table of keys and their values")
                    .help("for example: set = { \"joint_dynamics.coulomb\" = { model = \"square\" } }"),
            );
        }
        let settings = set.map_or(&[][..], Node::entries).iter().map(|entry| Setting {
            place: Place::new(&entry.key),
            key_span: entry.key_span.clone(),
            value: entry.value.clone(),
        });
        steps.push(Step { name: Some(name.to_owned()), settings: settings.collect() });
    }
    Some(steps)
}

/// The lists of `[sweep.grid]` or `[sweep.zip]`, none of them empty; dots in a key may stand outside quotes.
fn lists(sweep: &Node, key: &str, complaints: &mut Vec<Complaint>) -> Vec<Vec<Setting>> {
    let mut found = Vec::new();
    let Some(table) = sweep.get(key) else { return found };
    if !matches!(table.kind, NodeKind::Table(_)) {
        complaints.push(Complaint::new(&table.span, format!("`{key}` expects a table, write [sweep.{key}]")));
    }
    collect_lists(table, "", &mut found, complaints);
    found
}

fn collect_lists(table: &Node, prefix: &str, found: &mut Vec<Vec<Setting>>, complaints: &mut Vec<Complaint>) {
    for entry in table.entries() {
        let key = format!("{prefix}{}", entry.key);
        match &entry.value.kind {
            NodeKind::Array(values) if !values.is_empty() => {
                let (place, key_span) = (Place::new(&key), entry.key_span.clone());
                let setting = |value: &Node| Setting {
                    place: place.clone(),
                    key_span: key_span.clone(),
                    value: value.clone(),
                };
                found.push(values.iter().map(setting).collect());
            }
            NodeKind::Table(_) => collect_lists(&entry.value, &format!("{key}."), found, complaints),
            _ => complaints.push(
                Complaint::new(&entry.value.span, format!("`{key}` expects a list of the values to try"))
                    .help("for example: \"joint_dynamics.coulomb.model\" = [\"none\", \"square\"]"),
            ),
        }
    }
}

/// Complains about keys that nobody knows.
fn unknown(table: &Node, title: &str, known: &[&str], complaints: &mut Vec<Complaint>) {
    for entry in table.entries().iter().filter(|e| !known.contains(&e.key.as_str())) {
        complaints.push(
            Complaint::new(&entry.key_span, format!("{title} has no key `{}`", entry.key))
                .help(suggestion::help(&entry.key, "keys", known.iter().copied())),
        );
    }
}
