//! The physics that AURT can name: one effect a file.
//!
//! An effect proposes terms that, added to the model, would describe it, or is found by other means
//! ([`Means`](crate::vocabulary::Means)). Selection decides among all proposals of all effects without knowing which is
//! which. The module documentation of each file is what `aurt explain <identifier>` prints.

automod::dir!(pub "src/effects");

use crate::vocabulary::Effect;

/// All effects, by family and identifier.
pub static ALL: [&Effect; 26] = [
    &coulomb::EFFECT,
    &coulomb_asymmetry::EFFECT,
    &friction_level_changed::EFFECT,
    &stribeck::EFFECT,
    &temperature_dependent_friction::EFFECT,
    &viscous::EFFECT,
    &viscous_asymmetry::EFFECT,
    &viscous_nonlinear::EFFECT,
    &presliding_hysteresis::EFFECT,
    &drive_efficiency::EFFECT,
    &load_dependent_friction::EFFECT,
    &base_tilt::EFFECT,
    &payload::EFFECT,
    &rotor_inertia::EFFECT,
    &backlash::EFFECT,
    &joint_elasticity::EFFECT,
    &spring::EFFECT,
    &torque_ripple::EFFECT,
    &current_offset::EFFECT,
    &encoder_offset::EFFECT,
    &saturation::EFFECT,
    &time_delay::EFFECT,
    &torque_constant::EFFECT,
    &joint_coupling_friction::EFFECT,
    &external_contact::EFFECT,
    &dropped_samples::EFFECT,
];

/// The effect of an identifier.
pub fn find(id: &str) -> Option<&'static Effect> {
    ALL.into_iter().find(|e| e.id == id)
}

#[cfg(test)]
mod tests {
    use aurt_traits::MeasurementUnit;

    use super::*;
    use crate::vocabulary::{Addition, Context, Means, OwnFriction};

    const CONTEXT: Context<'_> = Context {
        joints: 2,
        links: 2,
        apart: &[],
        recordings: &[],
        residual: &[],
        inertial: &[(0, 1.0)],
        resolution_rad: &[1e-5, 1e-5],
    };

    #[test]
    fn estimates_have_the_parameters_that_are_declared() {
        let own = OwnFriction { coulomb_nm: 1.0, viscous_nm_s: 1.0 };
        for effect in ALL {
            for parameter in effect.parameters {
                let in_nm = parameter.name_in(MeasurementUnit::NewtonMetre, false);
                assert_eq!(in_nm, parameter.name, "the name of a {:?} says its unit", parameter.unit);
            }
            for proposal in (effect.propose)(&CONTEXT) {
                let names: &[&str] = match &proposal.addition {
                    Addition::Term(term) if term["model"] == "payload" => {
                        &["XX", "XY", "XZ", "YY", "YZ", "ZZ", "mX", "mY", "mZ", "m"]
                    }
                    _ => &["first", "second"],
                };
                let fitted: Vec<_> = names.iter().map(|n| ((*n).to_owned(), 0.5, 0.1)).collect();
                for name in effect.estimated(&proposal, &fitted, &own).keys() {
                    assert!(effect.parameter(name).is_some(), "{}: `{name}` is not declared", effect.id);
                }
            }
        }
    }

    #[test]
    fn what_is_found_by_columns_proposes_them() {
        for effect in ALL.into_iter().filter(|e| !e.reads_residual) {
            let proposes = !(effect.propose)(&CONTEXT).is_empty();
            let below_its_resonance = effect == &joint_elasticity::EFFECT;
            assert_eq!(proposes, effect.means == Means::Columns || below_its_resonance, "{}", effect.id);
        }
    }

    #[test]
    fn losses_are_not_negative() {
        let losses = |driven: f64| {
            let number = |value: f64| crate::parameters::ParameterValue::new(value, 0.02);
            let parameters =
                [("driving".to_owned(), number(0.11)), ("driven".to_owned(), number(driven))].into();
            drive_efficiency::EFFECT.impossible(&parameters, 1.0)
        };
        assert!(losses(-0.03).is_none() && losses(-0.11).unwrap().contains("driven"));
    }

    #[test]
    fn units_that_follow_gains_differ_in_a_model_of_currents() {
        for parameter in ALL.iter().flat_map(|e| e.parameters) {
            let [nm, a] =
                [MeasurementUnit::NewtonMetre, MeasurementUnit::Ampere].map(|m| parameter.name_in(m, false));
            assert_eq!(nm != a, parameter.unit.follows_gains(), "{nm}");
        }
    }
}
