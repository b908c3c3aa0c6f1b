//! What a model is, beyond its listing: asked of the model that its own example describes.

use aurt_traits::{
    ArmTerm, CoulombModel, HysteresisModel, Invariants, JointModel, Parameter, ShapeParameter, Slot,
    ViscousBasis,
};
use toml::de::DeTable;

use crate::{BuildError, ModelListing, Node, Registry};

/// Coefficients, shape parameters and declarations of a model in the configuration of its example.
#[derive(Debug, Clone, PartialEq)]
pub struct ModelDescription {
    /// The linear coefficients.
    pub columns: Vec<Parameter>,
    /// The parameters in which the model is not linear, with the example's values.
    pub shape_parameters: Vec<ShapeParameter>,
    /// What the model declares of itself.
    pub invariants: Invariants,
}

impl ModelListing {
    /// The example as a table, to be handed to [`Registry::build`].
    ///
    /// # Errors
    /// [`BuildError::Configuration`] if the example is no TOML.
    pub fn example_table(&self) -> Result<Node, BuildError> {
        let text = format!("example = {}", self.example);
        let table = DeTable::parse(&text).map(|table| Node::from_toml(table.get_ref(), 0..0).0);
        let example = table.ok().and_then(|table| table.get("example").cloned());
        example.ok_or_else(|| BuildError::Configuration {
            model: self.name.clone(),
            key: None,
            reason: "its own example is no TOML table".to_owned(),
            example: self.example.clone(),
            span: 0..0,
        })
    }
}

impl Registry {
    /// What a model is in the configuration of its example, for a robot of `robot_joints` joints.
    ///
    /// # Errors
    /// If the example does not give a model, which the tests of every linked model exclude.
    pub fn describe(
        &self,
        listing: &ModelListing,
        robot_joints: usize,
    ) -> Result<ModelDescription, Vec<BuildError>> {
        let example = listing.example_table().map_err(|e| vec![e])?;
        Ok(match listing.slot {
            Slot::Coulomb => of_joint_model(&*self.build::<dyn CoulombModel>(&example)?),
            Slot::Hysteresis => of_joint_model(&*self.build::<dyn HysteresisModel>(&example)?),
            Slot::Viscous => of_joint_model(&*self.build::<dyn ViscousBasis>(&example)?),
            Slot::ArmTerm => {
                let term = self.build::<dyn ArmTerm>(&example)?;
                ModelDescription {
                    columns: term.columns(robot_joints),
                    shape_parameters: term.shape_parameters(),
                    invariants: term.invariants(),
                }
            }
        })
    }
}

fn of_joint_model(model: &dyn JointModel) -> ModelDescription {
    ModelDescription {
        columns: model.columns(),
        shape_parameters: model.shape_parameters(),
        invariants: model.invariants(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_linked_model_can_be_described() {
        let registry = Registry::linked().unwrap();
        for listing in registry.models() {
            let description = registry.describe(listing, 6).unwrap();
            assert!(!description.columns.is_empty() || listing.name == "absent", "{}", listing.name);
        }
    }

    #[test]
    fn a_description_holds_names_and_units() {
        let registry = Registry::linked().unwrap();
        let listing = registry.model(Slot::Coulomb, "absolute").unwrap();
        let units: Vec<String> =
            registry.describe(listing, 6).unwrap().columns.into_iter().map(|p| p.unit).collect();
        assert_eq!(units, ["Nm", "1"]);
    }
}
