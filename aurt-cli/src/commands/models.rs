//! `aurt models`: what can be named in an experiment.

use aurt_experiment::workbench::failure::Failure;
use aurt_friction::drives::DriveListing;
use aurt_plugins::{ModelListing, Origin, Registry};
use aurt_report::rendering::table::Table;
use aurt_traits::Slot;
use clap::Args;
use serde_json::{Value, json};

use super::Session;
use crate::rendering::terminal::{Emphasis, Report};

/// Joints of the robot for which arm terms tell their parameters.
pub const EXAMPLE_JOINTS: usize = 6;

/// List the friction models, arm terms and drives that experiments can use.
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  aurt models\n  aurt explain maxwell_slip")]
pub struct Models {}

impl Models {
    pub fn run(&self, session: &Session<'_>) -> Result<Report, Failure> {
        let registry = &session.registry;
        let mut text = String::new();
        for slot in Registry::SLOTS {
            let mut table = Table::new(["model", "summary"]).left(2);
            for model in registry.models_of(slot) {
                let summary = match &model.origin {
                    Origin::Crate(_) => model.summary.clone(),
                    library => format!("{} ({library})", model.summary),
                };
                table.row([model.name.clone(), summary]);
            }
            let title = session.terminal.emphasise(Emphasis::Title, &title(slot));
            text.push_str(&format!("{title}\n{}\n", table.render()));
        }
        let mut table = Table::new(["model", "command", "numbers"]).left(3);
        let mut drives = Vec::new();
        for listing in aurt_friction::drives::listings() {
            let drive = &listing.drive;
            let command = format!("{:?}", drive.command()).to_lowercase();
            let numbers = drive.parameters();
            let names: Vec<&str> = numbers.iter().map(|n| n.parameter.name.as_str()).collect();
            table.row([drive.name().to_owned(), command, names.join(" ")]);
            drives.push(describe_drive(&listing));
        }
        let title = session
            .terminal
            .emphasise(Emphasis::Title, "drives, from commands to torques: [drive] model = …");
        text.push_str(&format!("{title}\n{}\n", table.render()));
        text.push_str("`aurt explain MODEL` prints equation, parameters and an example.\n");
        let models: Vec<Value> =
            registry.models().map(|model| describe(registry, model)).collect::<Result<_, _>>()?;
        Ok(Report {
            text,
            json: json!({ "command": "models", "models": models, "drives": drives }),
            findings: false,
        })
    }
}

fn title(slot: Slot) -> String {
    match slot {
        Slot::Coulomb => "Coulomb friction, f_C(τ_J): coulomb = { model = … }".into(),
        Slot::Hysteresis => "hysteresis, H(z, q̇): hysteresis = { model = … }".into(),
        Slot::Viscous => "viscous friction, f_v(q̇): viscous = { model = … }".into(),
        Slot::ArmTerm => "other physics of the arm: [[arm_terms]] model = …".into(),
    }
}

/// Everything that is known of a drive.
pub fn describe_drive(listing: &DriveListing) -> Value {
    let numbers = listing.drive.parameters();
    let numbers = numbers.iter().zip(&listing.meanings).map(|(n, meaning)| {
        json!({ "name": n.parameter.name, "meaning": meaning, "unit": n.parameter.unit, "value": n.value, "bounds": n.bounds })
    });
    json!({
        "kind": "drive",
        "name": listing.drive.name(),
        "command": format!("{:?}", listing.drive.command()).to_lowercase(),
        "between_commands": listing.drive.usual_signal(),
        "numbers": numbers.collect::<Vec<_>>(),
        "text": listing.explanation(),
    })
}

/// Everything that is known of a model.
pub fn describe(registry: &Registry, model: &ModelListing) -> Result<Value, Failure> {
    let description = registry.describe(model, EXAMPLE_JOINTS).map_err(aurt_plugins::model::Error::Build)?;
    let columns: Vec<Value> =
        description.columns.iter().map(|p| json!({ "name": p.name, "unit": p.unit })).collect();
    let shape: Vec<Value> = description
        .shape_parameters
        .iter()
        .map(|p| json!({ "name": p.name, "unit": p.unit, "value": p.value, "lower": p.lower, "upper": p.upper }))
        .collect();
    Ok(json!({
        "kind": model.slot.name(),
        "name": model.name,
        "summary": model.summary,
        "equation": model.equation,
        "use_when": model.use_when,
        "source": model.source,
        "example": model.example,
        "origin": model.origin.to_string(),
        "parameters": columns,
        "shape_parameters": shape,
        "invariants": description.invariants.iter().map(|i| i.in_words()).collect::<Vec<_>>(),
    }))
}
