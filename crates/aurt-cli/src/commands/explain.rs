//! `aurt explain`: what a model or a term of the reports means.

use aurt_plugins::{ModelListing, suggestion};
use clap::Args;
use serde_json::{Value, json};

use super::{Session, models::describe};
use crate::{
    failure::Failure,
    glossary::{self, TERMS},
    rendering::{
        number::significant,
        table::Table,
        terminal::{Emphasis, Report, Terminal},
        text::wrapped_at,
    },
};

/// Explain a model, or a term of the reports.
#[derive(Debug, Args)]
#[command(
    after_help = "Example:\n  aurt explain square\n  aurt explain nmse\n  aurt explain        lists what there is"
)]
pub struct Explain {
    /// A model of `aurt models`, or a term such as nmse, rest, load_torque
    #[arg(value_name = "NAME")]
    name: Option<String>,
}

impl Explain {
    /// Explains.
    pub fn run(&self, session: &Session<'_>) -> Result<Report, Failure> {
        let Some(name) = &self.name else { return Ok(listing(session)) };
        let wanted = name.trim().to_lowercase().replace(['-', ' '], "_");
        let models: Vec<&ModelListing> = session.registry.named(&wanted).collect();
        let term = glossary::term(&wanted);
        if models.is_empty() && term.is_none() {
            return Err(self.unknown(session, &wanted));
        }
        let mut text = String::new();
        let mut explained = Vec::new();
        for model in models {
            let description = describe(&session.registry, model)?;
            text.push_str(&model_text(session.terminal, model, &description));
            explained.push(description);
        }
        if let Some(term) = term {
            let title = session.terminal.emphasise(Emphasis::Title, term.title);
            text.push_str(&format!("{title}\n\n{}", wrapped_at(term.text, 78, "")));
            explained
                .push(json!({ "kind": "term", "name": term.name, "title": term.title, "text": term.text }));
        }
        Ok(Report { text, json: json!({ "command": "explain", "explained": explained }), findings: false })
    }

    fn unknown(&self, session: &Session<'_>, wanted: &str) -> Failure {
        let models = session.registry.models().map(|m| m.name.as_str());
        let known: Vec<&str> = models.chain(TERMS.iter().map(|t| t.name)).collect();
        Failure::Argument {
            option: "NAME",
            reason: format!(
                "there is neither a model nor a term `{}`",
                self.name.as_deref().unwrap_or_default()
            ),
            remedy: suggestion::help(wanted, "names", known),
        }
    }
}

/// What can be explained.
fn listing(session: &Session<'_>) -> Report {
    let models: Vec<&str> = session.registry.models().map(|m| m.name.as_str()).collect();
    let terms: Vec<&str> = TERMS.iter().map(|t| t.name).collect();
    let section = |title: &str, names: &[&str]| {
        let title = session.terminal.emphasise(Emphasis::Title, title);
        format!("{title}\n{}\n", wrapped_at(&names.join("  "), 78, "  "))
    };
    Report {
        text: section("models", &models) + &section("terms of the reports", &terms),
        json: json!({ "command": "explain", "models": models, "terms": terms }),
        findings: false,
    }
}

fn model_text(terminal: &Terminal, model: &ModelListing, description: &Value) -> String {
    let title = format!("{} ({} model, {})", model.name, model.slot.name(), model.origin);
    let mut text = format!("{}\n", terminal.emphasise(Emphasis::Title, &title));
    let mut paragraph = |heading: &str, body: &str| {
        if !body.is_empty() {
            text.push_str(&format!("\n{heading}\n{}", wrapped_at(body, 78, "  ")));
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
    text.push_str(&format!("\nexample\n  {} = {}\n\n", model.slot.name(), model.example));
    text
}

fn string(value: &Value) -> String {
    value.as_str().unwrap_or_default().to_owned()
}

fn list(value: &Value) -> Vec<&str> {
    value.as_array().into_iter().flatten().filter_map(Value::as_str).collect()
}
