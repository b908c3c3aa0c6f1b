//! The conformance checks over every registered model, and the slots of equation (6).

use aurt_friction::conformance::{arm, joint};
use aurt_traits::{
    CoulombModel, HysteresisModel, Invariant, JointModel, JointStack, ModelError, ViscousBasis,
};
use proptest::prelude::*;

use super::models::{Model, examples};
use super::planar_arm::PlanarArm;

/// Configurations beside the examples whose behaviour differs from them.
fn variants() -> Vec<Model> {
    use aurt_traits::Slot::{ArmTerm, Coulomb, Hysteresis, Viscous};
    [
        (Coulomb, r#"{ model = "stribeck", stribeck_exponent = 0.7 }"#),
        (Coulomb, r#"{ model = "stribeck", load = "square" }"#),
        (Coulomb, r#"{ model = "stribeck", law = "rational", stribeck_exponent = 1.6 }"#),
        (Hysteresis, r#"{ model = "sign", rest_velocity_rad_s = 0.2 }"#),
        (Hysteresis, r#"{ model = "bouc_wen", presliding_rad = 0.003, exponent = 1.7, beta = 0.8 }"#),
        (Hysteresis, r#"{ model = "lugre", coulomb_ratio = 0.3, stribeck_exponent = 1.0 }"#),
        (Hysteresis, r#"{ model = "maxwell_slip", thresholds_rad = [0.002] }"#),
        (Hysteresis, r#"{ model = "maxwell_slip", fit_thresholds = true }"#),
        (Hysteresis, r#"{ model = "gms", elements = 3, coulomb_ratio = 0.4, attraction_per_s = 900.0 }"#),
        (Viscous, r#"{ model = "polynomial", powers = [4, 1, 7] }"#),
        (Viscous, r#"{ model = "power_law", exponent = 2.5 }"#),
        (Viscous, r#"{ model = "saturating", linear = true }"#),
        (ArmTerm, r#"{ model = "coupling", joint = 3, partner = 4, ratio = -0.5, inertia = false }"#),
        (ArmTerm, r#"{ model = "spring", rest_rad = 0.3 }"#),
        (ArmTerm, r#"{ model = "payload", link = 2 }"#),
        (ArmTerm, r#"{ model = "base_tilt", first_axis = true }"#),
        (
            ArmTerm,
            r#"{ model = "joint_compliance", joints = [1], around_rad_nm = [1e-4], inertial_columns = [6, 9], inertial_values = [0.9, 3.0] }"#,
        ),
        (ArmTerm, r#"{ model = "coulomb_asymmetric", rest_velocity_rad_s = 0.1 }"#),
    ]
    .into_iter()
    .map(|(slot, table)| Model::from_toml(slot, table).unwrap())
    .collect()
}

fn all() -> Vec<Model> {
    examples().into_iter().map(|(_, model)| model).chain(variants()).collect()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 6, ..ProptestConfig::default() })]

    #[test]
    fn models_hold_to_their_contract_and_invariants(seed in any::<u64>()) {
        let body = PlanarArm::new(6);
        for model in all() {
            let verdict = match &model {
                Model::Coulomb(m) => joint::check(&**m, seed),
                Model::Hysteresis(m) => joint::check(&**m, seed),
                Model::Viscous(m) => joint::check(&**m, seed),
                Model::Arm(m) => arm::check(&**m, &body, seed),
            };
            prop_assert_eq!(verdict, Ok(()), "{}", model.to_json());
        }
    }

    #[test]
    fn shape_parameters_are_kept_bounded_and_matter(seed in any::<u64>()) {
        let body = PlanarArm::new(6);
        for model in all() {
            let verdict = match &model {
                Model::Coulomb(m) => joint::check_shape(m, seed),
                Model::Hysteresis(m) => joint::check_shape(m, seed),
                Model::Viscous(m) => joint::check_shape(m, seed),
                Model::Arm(m) => arm::check_shape(m, &body, seed),
            };
            prop_assert_eq!(verdict, Ok(()), "{}", model.to_json());
        }
    }
}

fn stack(
    coulomb: Box<dyn CoulombModel>,
    hysteresis: Box<dyn HysteresisModel>,
    viscous: Box<dyn ViscousBasis>,
) -> Result<JointStack, Vec<ModelError>> {
    JointStack::new(coulomb, hysteresis, viscous)
}

/// The paper's simplest stack with one model replaced.
pub fn in_its_slot(model: &Model) -> Result<JointStack, Vec<ModelError>> {
    use aurt_friction::coulomb::constant::Constant;
    use aurt_friction::hysteresis::sign::Sign;
    use aurt_friction::viscous::polynomial::Polynomial;
    let level = Box::new(Constant {});
    let sign = Box::new(Sign::default());
    let linear = Box::new(Polynomial { powers: vec![1] });
    match model {
        Model::Coulomb(m) => stack(m.clone(), sign, linear),
        Model::Hysteresis(m) => stack(level, m.clone(), linear),
        Model::Viscous(m) => stack(level, sign, m.clone()),
        Model::Arm(_) => stack(level, sign, linear),
    }
}

#[test]
fn slots_take_every_model_that_is_registered_for_them() {
    for model in all() {
        assert!(in_its_slot(&model).is_ok(), "{}", model.to_json());
    }
}

#[test]
fn declarations_are_not_made_by_accident() {
    let declared = |model: &dyn JointModel| model.invariants().iter().collect::<Vec<_>>();
    for (entry, model) in examples() {
        let (Model::Hysteresis(m), true) = (&model, ["gms", "lugre", "tanh"].contains(&entry.name)) else {
            continue;
        };
        assert!(!declared(&**m).contains(&Invariant::RateIndependent), "{} depends on velocity", entry.name);
    }
}
