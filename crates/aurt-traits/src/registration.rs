use serde::{Deserialize, Serialize};

/// Which trait a registered model implements, and so where an experiment may name it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Slot {
    /// [`CoulombModel`](crate::CoulombModel), `coulomb = { model = … }`.
    Coulomb,
    /// [`HysteresisModel`](crate::HysteresisModel), `hysteresis = { model = … }`.
    Hysteresis,
    /// [`ViscousBasis`](crate::ViscousBasis), `viscous = { model = … }`.
    Viscous,
    /// [`ArmTerm`](crate::ArmTerm), `[[arm_terms]] model = …`.
    ArmTerm,
}

impl Slot {
    /// The slot's name as experiments spell it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Coulomb => "coulomb",
            Self::Hysteresis => "hysteresis",
            Self::Viscous => "viscous",
            Self::ArmTerm => "arm_terms",
        }
    }
}

/// The listing of a statically linked model: `typetag` finds a model by its name but cannot list the names,
/// so each model submits this beside its `#[typetag::serde(name = "…")]`.
///
/// Use [`register_model!`](crate::register_model).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ModelEntry {
    /// Where the model may be named.
    pub slot: Slot,
    /// Name in experiments, equal to the `typetag` name.
    pub name: &'static str,
    /// One line for listings.
    pub summary: &'static str,
    /// The equation, in plain text.
    pub equation: &'static str,
    /// When to use the model, and when another.
    pub use_when: &'static str,
    /// Where the equation is from.
    pub source: &'static str,
    /// A working configuration, as a TOML inline table.
    pub example: &'static str,
    /// The crate that registered it.
    pub origin: &'static str,
}

inventory::collect!(ModelEntry);

/// Lists a statically linked model; see [`ModelEntry`] for the fields.
///
/// ```
/// aurt_traits::register_model! {
///     slot: Viscous,
///     name: "my_viscous",
///     summary: "linear viscous friction",
///     equation: "f_v = F_v q̇",
///     use_when: "always as a first guess",
///     source: "textbook",
///     example: r#"{ model = "my_viscous" }"#,
/// }
/// ```
#[macro_export]
macro_rules! register_model {
    (slot: $slot:ident, name: $name:literal, summary: $summary:expr, equation: $equation:expr,
     use_when: $use_when:expr, source: $source:expr, example: $example:expr $(,)?) => {
        $crate::reexport::inventory::submit! {
            $crate::ModelEntry {
                slot: $crate::Slot::$slot,
                name: $name,
                summary: $summary,
                equation: $equation,
                use_when: $use_when,
                source: $source,
                example: $example,
                origin: env!("CARGO_PKG_NAME"),
            }
        }
    };
}
