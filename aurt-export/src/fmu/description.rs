//! `modelDescription.xml` of FMI 2.0.

use std::fmt::Write;

use super::variables::{Role, Variable, Variables};
use super::{FMI, Kind};
use crate::Source;
use crate::naming::attribute;

/// Exponents of SI units, for units that importers may convert; others are words to them.
fn base_unit(unit: &str) -> &'static str {
    match unit {
        "s" => "s=\"1\"",
        "kg" => "kg=\"1\"",
        "m" => "m=\"1\"",
        "m/s" => "m=\"1\" s=\"-1\"",
        "m/s2" => "m=\"1\" s=\"-2\"",
        "rad" => "rad=\"1\"",
        "rad/s" => "rad=\"1\" s=\"-1\"",
        "rad/s2" => "rad=\"1\" s=\"-2\"",
        "N" => "kg=\"1\" m=\"1\" s=\"-2\"",
        "N/s" => "kg=\"1\" m=\"1\" s=\"-3\"",
        "N.m" | "Nm" => "kg=\"1\" m=\"2\" s=\"-2\"",
        "N.m/s" => "kg=\"1\" m=\"2\" s=\"-3\"",
        "A" => "A=\"1\"",
        "A/s" => "A=\"1\" s=\"-1\"",
        _ => "",
    }
}

fn units(variables: &Variables) -> String {
    let mut names: Vec<&str> = variables.all.iter().map(|v| v.unit.as_str()).collect();
    names.sort_unstable();
    names.dedup();
    let mut text = String::from("  <UnitDefinitions>\n");
    for name in names {
        let _ = match base_unit(name) {
            "" => writeln!(text, "    <Unit name=\"{}\"/>", attribute(name)),
            base => {
                writeln!(text, "    <Unit name=\"{}\"><BaseUnit {base}/></Unit>", attribute(name))
            }
        };
    }
    text.push_str("  </UnitDefinitions>\n");
    text
}

/// Causality, variability and initial of a variable.
const fn words(role: Role) -> (&'static str, &'static str, &'static str) {
    match role {
        Role::Time => ("independent", "continuous", ""),
        Role::Input => ("input", "continuous", ""),
        Role::Jumping => ("input", "discrete", ""),
        Role::Output => ("output", "continuous", " initial=\"calculated\""),
        Role::Tunable => ("parameter", "tunable", " initial=\"exact\""),
        Role::Fixed => ("parameter", "fixed", " initial=\"exact\""),
    }
}

fn variable(reference: usize, v: &Variable) -> String {
    let (causality, variability, initial) = words(v.role);
    let start = match v.role {
        Role::Time | Role::Output => String::new(),
        _ => format!(" start=\"{:?}\"", v.start),
    };
    let head = format!(
        "name=\"{}\" valueReference=\"{reference}\" causality=\"{causality}\" variability=\"{variability}\"{initial} \
         description=\"{}\"",
        attribute(&v.name),
        attribute(&v.description)
    );
    let unit = attribute(&v.unit);
    format!("    <ScalarVariable {head}><Real unit=\"{unit}\"{start}/></ScalarVariable>\n")
}

/// The outputs, once as such and once as what initialisation computes.
fn structure(variables: &Variables) -> String {
    let mut text = String::from("  <ModelStructure>\n");
    for group in ["Outputs", "InitialUnknowns"] {
        let _ = writeln!(text, "    <{group}>");
        for (k, _) in variables.all.iter().enumerate().filter(|(_, v)| v.role == Role::Output) {
            let _ = writeln!(text, "      <Unknown index=\"{}\"/>", k + 1);
        }
        let _ = writeln!(text, "    </{group}>");
    }
    text.push_str("  </ModelStructure>\n");
    text
}

pub(super) fn model(
    source: &Source<'_>,
    kind: Kind,
    variables: &Variables,
    token: &str,
    sources: &[(String, String)],
) -> String {
    let name = source.name;
    let mut text = format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<fmiModelDescription fmiVersion=\"{FMI}\" modelName=\"{name}\" \
         guid=\"{token}\" description=\"{} dynamics of {name}. {}\" generationTool=\"aurt {}\" \
         variableNamingConvention=\"flat\">\n",
        match kind {
            Kind::Inverse => "Inverse",
            Kind::Forward => "Forward",
        },
        attribute(&source.provenance.lines().join("; ")),
        env!("CARGO_PKG_VERSION"),
    );
    let _ = writeln!(
        text,
        "  <CoSimulation modelIdentifier=\"{name}\" canHandleVariableCommunicationStepSize=\"true\" \
         canGetAndSetFMUstate=\"true\" canSerializeFMUstate=\"true\" canNotUseMemoryManagementFunctions=\"true\">"
    );
    text.push_str("    <SourceFiles>\n");
    for (file, _) in sources.iter().filter(|(file, _)| file.ends_with(".c")) {
        let _ = writeln!(text, "      <File name=\"{file}\"/>");
    }
    text.push_str("    </SourceFiles>\n  </CoSimulation>\n");
    text.push_str(&units(variables));
    text.push_str("  <LogCategories>\n    <Category name=\"logStatusError\"/>\n  </LogCategories>\n");
    text.push_str(
        "  <DefaultExperiment startTime=\"0\" stopTime=\"10\" stepSize=\"0.002\"/>\n  <ModelVariables>\n",
    );
    for (reference, v) in variables.all.iter().enumerate() {
        text.push_str(&variable(reference, v));
    }
    text.push_str("  </ModelVariables>\n");
    text.push_str(&structure(variables));
    text.push_str("</fmiModelDescription>\n");
    text
}
