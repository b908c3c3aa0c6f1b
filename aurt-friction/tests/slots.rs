//! The slots of equation (6) refuse models that do not declare what the slot asks for.

use aurt_friction::coulomb::constant::Constant;
use aurt_friction::hysteresis::sign::Sign;
use aurt_friction::viscous::polynomial::Polynomial;
use aurt_traits::{
    Columns, CoulombModel, HysteresisModel, Invariant, Invariants, JointModel, JointSeries, JointStack,
    ModelError, Parameter, ViscousBasis,
};
use serde::{Deserialize, Serialize};

/// A model of every slot that declares what it is told to.
#[derive(Debug, Clone, Serialize, Deserialize)]
struct Declares(Vec<Invariant>);

impl JointModel for Declares {
    fn name(&self) -> &str {
        "declares"
    }

    fn columns(&self) -> Vec<Parameter> {
        vec![Parameter::new("c", "Nm")]
    }

    fn invariants(&self) -> Invariants {
        Invariants::of(&self.0)
    }

    fn evaluate(
        &self,
        _series: &JointSeries<'_>,
        _state: &mut [f64],
        out: &mut Columns<'_>,
    ) -> Result<(), ModelError> {
        out.column_mut(0).fill(1.0);
        Ok(())
    }
}

#[typetag::serde(name = "declares")]
impl CoulombModel for Declares {
    fn boxed_clone(&self) -> Box<dyn CoulombModel> {
        Box::new(self.clone())
    }
}

#[typetag::serde(name = "declares")]
impl HysteresisModel for Declares {
    fn boxed_clone(&self) -> Box<dyn HysteresisModel> {
        Box::new(self.clone())
    }
}

#[typetag::serde(name = "declares")]
impl ViscousBasis for Declares {
    fn boxed_clone(&self) -> Box<dyn ViscousBasis> {
        Box::new(self.clone())
    }
}

/// The invariants that a stack misses with models that declare these.
fn missing(
    coulomb: &[Invariant],
    hysteresis: &[Invariant],
    viscous: &[Invariant],
) -> Vec<(&'static str, &'static str)> {
    let model = |list: &[Invariant]| Box::new(Declares(list.to_vec()));
    let Err(errors) = JointStack::new(model(coulomb), model(hysteresis), model(viscous)) else {
        return Vec::new();
    };
    errors
        .into_iter()
        .map(|e| match e {
            ModelError::SlotRefused { slot, invariant, .. } => (slot, invariant),
            other => panic!("{other}"),
        })
        .collect()
}

#[test]
fn every_slot_asks_for_its_own_invariants() {
    use Invariant::{
        BoundedByOne, ContinuousInVelocity, EvenInLoad, OddInVelocity, Positive, SignOfVelocity,
    };
    let level = [EvenInLoad, Positive];
    let shape = [BoundedByOne];
    let viscous = [OddInVelocity, ContinuousInVelocity, SignOfVelocity];
    assert_eq!(missing(&level, &shape, &viscous), []);
    assert_eq!(missing(&[Positive], &shape, &viscous), [("coulomb", EvenInLoad.in_words())]);
    assert_eq!(missing(&[EvenInLoad], &shape, &viscous), [("coulomb", Positive.in_words())]);
    assert_eq!(missing(&level, &[], &viscous), [("hysteresis", BoundedByOne.in_words())]);
    for lacking in viscous {
        let rest: Vec<Invariant> = viscous.into_iter().filter(|i| *i != lacking).collect();
        assert_eq!(missing(&level, &shape, &rest), [("viscous", lacking.in_words())]);
    }
}

#[test]
fn refusals_and_invalid_configurations_come_together() {
    let errors = JointStack::new(
        Box::new(Declares(Vec::new())),
        Box::new(Sign { rest_velocity_rad_s: -1.0 }),
        Box::new(Polynomial { powers: vec![0] }),
    )
    .unwrap_err();
    assert_eq!(errors.len(), 4, "{errors:?}");
    let valid = JointStack::new(
        Box::new(Constant {}),
        Box::new(Sign::default()),
        Box::new(Polynomial { powers: Vec::new() }),
    );
    assert_eq!(valid.unwrap().columns().len(), 1);
}
