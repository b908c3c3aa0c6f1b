//! The registered models, built from their own examples.

use aurt_traits::{ArmTerm, CoulombModel, HysteresisModel, ModelEntry, Slot, ViscousBasis};
use serde::de::DeserializeOwned;

/// A model of any slot.
pub enum Model {
    Coulomb(Box<dyn CoulombModel>),
    Hysteresis(Box<dyn HysteresisModel>),
    Viscous(Box<dyn ViscousBasis>),
    Arm(Box<dyn ArmTerm>),
}

impl Model {
    pub fn name(&self) -> &str {
        match self {
            Self::Coulomb(m) => m.name(),
            Self::Hysteresis(m) => m.name(),
            Self::Viscous(m) => m.name(),
            Self::Arm(m) => m.name(),
        }
    }

    pub fn to_json(&self) -> String {
        match self {
            Self::Coulomb(m) => serde_json::to_string(m),
            Self::Hysteresis(m) => serde_json::to_string(m),
            Self::Viscous(m) => serde_json::to_string(m),
            Self::Arm(m) => serde_json::to_string(m),
        }
        .unwrap()
    }

    pub fn from_json(slot: Slot, text: &str) -> Result<Self, String> {
        fn parse<M: DeserializeOwned>(text: &str) -> Result<M, String> {
            serde_json::from_str(text).map_err(|e| e.to_string())
        }
        Ok(match slot {
            Slot::Coulomb => Self::Coulomb(parse(text)?),
            Slot::Hysteresis => Self::Hysteresis(parse(text)?),
            Slot::Viscous => Self::Viscous(parse(text)?),
            Slot::ArmTerm => Self::Arm(parse(text)?),
        })
    }

    /// A model from a TOML inline table.
    pub fn from_toml(slot: Slot, table: &str) -> Result<Self, String> {
        #[derive(serde::Deserialize)]
        struct Document<M> {
            model: M,
        }
        fn parse<M: DeserializeOwned>(table: &str) -> Result<M, String> {
            let document: Document<M> =
                toml::from_str(&format!("model = {table}")).map_err(|e| e.to_string())?;
            Ok(document.model)
        }
        Ok(match slot {
            Slot::Coulomb => Self::Coulomb(parse(table)?),
            Slot::Hysteresis => Self::Hysteresis(parse(table)?),
            Slot::Viscous => Self::Viscous(parse(table)?),
            Slot::ArmTerm => Self::Arm(parse(table)?),
        })
    }
}

/// Every registered model, sorted by slot and name.
pub fn entries() -> Vec<ModelEntry> {
    // Naming a model links the crate, and with it all registrations.
    let _ = aurt_friction::coulomb::constant::Constant {};
    let mut entries: Vec<ModelEntry> = inventory::iter::<ModelEntry>.into_iter().copied().collect();
    entries.sort_by_key(|e| (e.slot, e.name));
    entries
}

/// Every registered model with an instance of its example.
pub fn examples() -> Vec<(ModelEntry, Model)> {
    entries()
        .into_iter()
        .map(|entry| {
            let model = Model::from_toml(entry.slot, entry.example)
                .unwrap_or_else(|e| panic!("example of `{}` does not parse: {e}", entry.name));
            (entry, model)
        })
        .collect()
}
