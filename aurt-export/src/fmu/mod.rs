//! Functional mock-up units: co-simulation by FMI 2.0, of inverse and of forward dynamics.
//!
//! The archive holds a description, the C of the model with a layer of functions of the standard, and, where there is a C
//! compiler for Linux, the library made of them. Coefficients of friction and arm terms, the size of gravity and a point
//! mass on the last link are parameters that can be changed while the model runs; those of the bodies are constants.

mod archive;
mod description;
mod library;
mod moves;
mod variables;

use aurt_traits::MeasurementUnit;

use crate::c::{RANGES, text};
use crate::naming::check_identifier;
use crate::program::{Tunable, tunable_step};
use crate::{ExportError, Source};
use variables::Variables;

/// What a unit computes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Torques or currents of a motion.
    Inverse,
    /// The motion that torques or currents make.
    Forward,
}

/// A unit, as an archive.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Fmu {
    /// Name of the archive.
    pub file: String,
    /// The archive.
    pub bytes: Vec<u8>,
    /// What of the model the unit has no word for.
    pub lost: Vec<String>,
    /// What a person should know of it.
    pub notes: Vec<String>,
}

impl Kind {
    /// Its name, as descriptions state it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Inverse => "inverse",
            Self::Forward => "forward",
        }
    }
}

/// Version of the standard: the one that nearly every simulator imports; 3.0 adds nothing that these units use.
const FMI: &str = "2.0";

/// Names that the sources of every unit have for themselves.
const TAKEN: [&str; 5] = ["component", "fmi2", "forward", "inverse", "model"];

/// The unit of a model.
///
/// # Errors
/// Names that C cannot have; models that cannot be written, by their names; for [`Kind::Forward`] mass matrices that are not
/// positive definite ([`ExportError::MassMatrix`]).
pub fn export(source: &Source<'_>, kind: Kind) -> Result<Fmu, ExportError> {
    check_identifier(source.name)?;
    if TAKEN.contains(&source.name) {
        let reason = "is a name of the sources of every FMU";
        return Err(ExportError::Name { name: source.name.to_owned(), reason });
    }
    let chain = source.chain_in_any_unit()?;
    let tunable = Tunable::new(source, chain);
    let program = tunable_step(source, chain, &tunable)?;
    if kind == Kind::Forward {
        moves::check(source, chain)?;
    }
    let variables = Variables::new(kind, source.unit, chain, &tunable);
    let name = source.name;
    let mut sources = vec![
        (format!("{name}.h"), text::header(source, chain, &program, Some(&tunable))),
        (format!("{name}.c"), text::implementation(source, &program)),
    ];
    sources.extend(archive::layer(kind));
    let token = archive::token(source, kind, &sources);
    sources.push(("model.h".into(), variables.header(name, kind, &token)));

    let mut files = vec![(
        "modelDescription.xml".to_owned(),
        description::model(source, kind, &variables, &token, &sources).into_bytes(),
    )];
    let (library, note) = library::build(name, &sources);
    files.extend(sources.into_iter().map(|(file, text)| (format!("sources/{file}"), text.into_bytes())));
    files.extend(library);
    let bytes = archive::zipped(&files)?;

    let unit = if source.unit == MeasurementUnit::Ampere { "A" } else { "Nm" };
    let dynamics = format!("FMI {FMI} co-simulation, {} dynamics in {unit}", kind.name());
    let operations = program.functions.iter().map(|f| f.operations);
    let mut notes: Vec<String> =
        operations.map(|o| format!("{dynamics}; a step of the model takes {o}")).collect();
    notes.push(note);
    let lost = vec![
        RANGES.into(),
        "the values of base parameters as parameters: they are constants of the sources".into(),
    ];
    Ok(Fmu { file: format!("{name}.fmu"), bytes, lost, notes })
}
