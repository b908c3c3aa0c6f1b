//! `aurt explain`: what an effect, a model or a term of the reports means.

use aurt_calibration::drives::Mechanics;
use aurt_diagnosis::effects;
use aurt_experiment::workbench::failure::Failure;
use aurt_friction::drives::{DriveListing, listings};
use aurt_plugins::{ModelListing, suggestion};
use aurt_report::glossary::{self, terms};
use aurt_report::rendering::number::significant;
use aurt_report::rendering::table::Table;
use aurt_report::rendering::text::{wrapped_at, wrapped_with};
use clap::Args;
use serde_json::{Value, json};

use aurt_traits::{CommandSignal, DriveParameter};

use super::Session;
use super::models::{describe, describe_drive};
use crate::rendering::terminal::{Emphasis, Report, Terminal};

/// Columns of running text.
const WIDTH: usize = 78;

/// Explain an effect, a model, or a term of the reports.
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  aurt explain payload\n  aurt explain square\n  aurt explain nmse\n  \
    aurt explain        lists what there is")]
pub struct Explain {
    /// An effect of a diagnosis or a parameter of one, a model or drive of `aurt models`, or a term such as nmse, rest, load_torque
    #[arg(value_name = "NAME")]
    name: Option<String>,
}

impl Explain {
    pub fn run(&self, session: &Session<'_>) -> Result<Report, Failure> {
        let Some(name) = &self.name else { return Ok(listing(session)) };
        let wanted = name.trim().to_lowercase().replace(['-', ' '], "_");
        let mut text = Vec::new();
        let mut explained = Vec::new();
        if let Some(effect) = effects::find(&wanted) {
            let page = effect.explanation();
            text.push(page_text(session.terminal, &page));
            explained
                .push(json!({ "kind": "effect", "name": effect.id, "title": effect.title, "text": page }));
        }
        for effect in effects::ALL {
            let Some(item) = effect.meaning(&wanted) else { continue };
            let title = session.terminal.emphasise(Emphasis::Title, &format!("{wanted} of `{}`", effect.id));
            text.push(format!("{title}\n\n{}", wrapped_at(&item.replace('`', ""), WIDTH, "")));
            explained.push(json!({ "kind": "parameter", "name": wanted, "effect": effect.id, "text": item }));
        }
        for model in session.registry.named(&wanted) {
            let description = describe(&session.registry, model)?;
            text.push(model_text(session.terminal, model, &description));
            explained.push(description);
        }
        for listing in listings().iter().filter(|listing| listing.drive.name() == wanted) {
            text.push(drive_text(session.terminal, listing));
            explained.push(describe_drive(listing));
        }
        if let Some(term) = glossary::term(&wanted) {
            let title = session.terminal.emphasise(Emphasis::Title, term.title);
            text.push(format!("{title}\n\n{}", wrapped_at(&term.text, WIDTH, "")));
            explained
                .push(json!({ "kind": "term", "name": term.name, "title": term.title, "text": term.text }));
        }
        if explained.is_empty() {
            return Err(unknown(session, name, &wanted));
        }
        let json = json!({ "command": "explain", "explained": explained });
        Ok(Report { text: text.join("\n"), json, findings: false })
    }
}

fn unknown(session: &Session<'_>, written: &str, wanted: &str) -> Failure {
    let drives = listings();
    let models = session.registry.models().map(|m| m.name.as_str());
    let models = models.chain(drives.iter().map(|listing| listing.drive.name()));
    let effects =
        effects::ALL.into_iter().flat_map(|e| [e.id].into_iter().chain(e.parameters.iter().map(|p| p.name)));
    let known = models.chain(effects).chain(terms().iter().map(|t| t.name));
    let meant = suggestion::likely(wanted, known).map(|k| format!("did you mean `{k}`? "));
    Failure::argument(
        "NAME",
        format!("there is no effect, parameter, model or term `{written}`"),
        format!("{}`aurt explain` lists what there is", meant.unwrap_or_default()),
    )
}

fn listing(session: &Session<'_>) -> Report {
    let effects: Vec<&str> = effects::ALL.into_iter().map(|e| e.id).collect();
    let mut models: Vec<&str> = session.registry.models().map(|m| m.name.as_str()).collect();
    models.dedup();
    let drives = listings();
    let drives: Vec<&str> = drives.iter().map(|listing| listing.drive.name()).collect();
    let terms: Vec<&str> = terms().iter().map(|t| t.name).collect();
    let section = |title: &str, names: &[&str]| {
        let title = session.terminal.emphasise(Emphasis::Title, title);
        format!("{title}\n{}\n", wrapped_at(&names.join("  "), WIDTH, "  "))
    };
    Report {
        text: section("effects that a diagnosis can name", &effects)
            + &section("models", &models)
            + &section("drives", &drives)
            + &section("terms of the reports", &terms),
        json: json!({ "command": "explain", "effects": effects, "models": models, "drives": drives, "terms": terms }),
        findings: false,
    }
}

/// A page of plain Markdown for a terminal: headings set off, paragraphs and list items wrapped.
fn page_text(terminal: &Terminal, page: &str) -> String {
    let mut text = String::new();
    let mut block = String::new();
    let flush = |block: &mut String, text: &mut String| {
        match block.strip_prefix("- ") {
            Some(item) => text.push_str(&wrapped_with(item, WIDTH, "  - ", "    ")),
            None if !block.is_empty() => text.push_str(&wrapped_at(block, WIDTH, "")),
            None => {}
        }
        block.clear();
    };
    for (k, line) in page.replace(['`', '*'], "").lines().enumerate() {
        if k == 0 || line.starts_with("# ") {
            flush(&mut block, &mut text);
            let heading = line.trim_start_matches("# ");
            text.push_str(&terminal.emphasise(Emphasis::Title, heading));
            text.push('\n');
        } else if line.trim().is_empty() {
            flush(&mut block, &mut text);
            text.push('\n');
        } else {
            if line.starts_with("- ") {
                flush(&mut block, &mut text);
            }
            block.push_str(line);
            block.push(' ');
        }
    }
    flush(&mut block, &mut text);
    text
}

fn model_text(terminal: &Terminal, model: &ModelListing, description: &Value) -> String {
    let title = format!("{} ({} model, {})", model.name, model.slot.name(), model.origin);
    let mut text = format!("{}\n", terminal.emphasise(Emphasis::Title, &title));
    let mut paragraph = |heading: &str, body: &str| {
        if !body.is_empty() {
            text.push_str(&format!("\n{heading}\n{}", wrapped_at(body, WIDTH, "  ")));
        }
    };
    paragraph("what it is", &model.summary);
    paragraph("equation", &model.equation);
    paragraph("use it when", &model.use_when);
    paragraph("source", &model.source);
    paragraph("it is", &list(&description["invariants"]).join(", "));
    let mut coefficients = Table::new(["coefficient", "unit"]).left(2);
    for parameter in description["parameters"].as_array().into_iter().flatten() {
        coefficients.row([string(&parameter["name"]), string(&parameter["unit"])]);
    }
    let mut shape = Table::new(["shape parameter", "unit", "example", "from", "to"]).left(2);
    for parameter in description["shape_parameters"].as_array().into_iter().flatten() {
        let number = |key: &str| significant(parameter[key].as_f64().unwrap_or(f64::NAN), 4);
        let (name, unit) = (string(&parameter["name"]), string(&parameter["unit"]));
        shape.row([name, unit, number("value"), number("lower"), number("upper")]);
    }
    text.push_str(&format!("\n{}", coefficients.render()));
    if !shape.is_empty() {
        text.push_str(&format!("\n{}", shape.render()));
    }
    text.push_str(&format!("\nexample\n  {} = {}\n", model.slot.name(), model.example));
    text
}

fn drive_text(terminal: &Terminal, listing: &DriveListing) -> String {
    let (name, command) = (listing.drive.name(), format!("{:?}", listing.drive.command()).to_lowercase());
    let between = match listing.drive.usual_signal() {
        CommandSignal::Hold => "hold",
        CommandSignal::Linear => "linear",
    };
    let table = |numbers: &[DriveParameter], meanings: &[String]| {
        let mut table = Table::new(["key", "unit", "default", "from", "to", "symbol and meaning"]).left(6);
        for (number, meaning) in numbers.iter().zip(meanings) {
            let [lower, upper] = number.bounds;
            let [value, lower, upper] = [number.value, lower, upper].map(|v| significant(v, 4));
            let (name, unit) = (number.parameter.name.clone(), number.parameter.unit.clone());
            table.row([name, unit, value, lower, upper, meaning.clone()]);
        }
        table.render()
    };
    format!(
        "{}\n\nIts numbers; a limit of 1e9 is none\n{}\nThose of every joint\n{}\nexample\n  [drive]\n  model = \"{name}\"\n  \
         command = \"{between}\"  # the {command} between two rows: \"hold\" or \"linear\"\n",
        page_text(terminal, &listing.explanation().replace('*', "∗")).trim_end(),
        table(&listing.drive.parameters(), &listing.meanings),
        table(&Mechanics::default().numbers(), &Mechanics::meanings()),
    )
}

fn string(value: &Value) -> String {
    value.as_str().unwrap_or_default().to_owned()
}

fn list(value: &Value) -> Vec<&str> {
    value.as_array().into_iter().flatten().filter_map(Value::as_str).collect()
}
