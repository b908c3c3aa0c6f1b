//! `payload`: a load attached to a link.
//!
//! # What it is
//! A body fixed to a link adds its ten inertial parameters to the link's, τ = Y_link(q, q̇, q̈) π_load, on the
//! link's joint and on all joints before it.
//!
//! - `link`: the link that carries it;
//! - `mass_kg`, `com_m` (its centre of mass in the link's frame, x y z), `inertia_kg_m2` (about that frame's
//!   origin, in the order XX XY XZ YY YZ ZZ). A negative mass means that a load was removed.
//!
//! # How it shows
//! Residuals on several joints that follow pose and acceleration and stand in the ratios that one body
//! dictates: with a load of 2.8 kg on its flange the residual of a UR10e grew 4–19 times on joints 1–5 and
//! hardly on joint 0.
//!
//! # Easily confused with
//! - the robot's own last link: refitted on the same recordings it absorbs a payload exactly. Only a reference
//!   recording without the load, or a frozen model, shows it.
//! - `torque_constant`: in amperes the mass scales with the drives' gains; a common factor of all gains is a
//!   mass.
//! - `base_tilt`: gravity alone, and on a vertical first axis, too.
//! - `external_contact`: local in time.
//!
//! # What to record to be sure
//! The same motion with and without the load, on the same day. A load may be turned on the flange between two
//! recordings; validate it on the rest of its own.
//!
//! # References
//! - W. Khalil, M. Gautier, P. Lemoine (2007), *Identification of the payload inertial parameters of industrial
//!   manipulators*.
//! - S. Mamedov, S. Mikhel (2020), *Practical aspects of model-based collision detection*.

use aurt_calibration::with_deviation;
use aurt_traits::MeasurementUnit;
use serde_json::{Value, json};

use crate::parameters::{FittedColumn, ParameterValue, Parameters};
use crate::vocabulary::{Context, Effect, Family, OwnFriction, Parameter, Proposal, Unit};

/// The effect.
pub static EFFECT: Effect = Effect {
    id: "payload",
    family: Family::I,
    title: "a load attached to a link",
    decider: "the same motion without the load, as calibration recording",
    source: include_str!("payload.rs"),
    parameters: &[
        Parameter::new("mass_kg", Unit::Mass),
        Parameter::new("com_m", Unit::Length).of(&["x", "y", "z"]),
        Parameter::new("inertia_kg_m2", Unit::Inertia).of(&["xx", "xy", "xz", "yy", "yz", "zz"]),
        Parameter::new("link", Unit::One),
    ],
    is_whole_arm: true,
    propose,
    estimate: Some(estimate),
    phrase: Some(phrase),
    excludes,
    ..Effect::BASE
};

/// On every link. A load that was taken off has a negative mass.
fn propose(context: &Context<'_>) -> Vec<Proposal> {
    let on = |link: usize| {
        let term = json!({"model": "payload", "link": link});
        Proposal::term((0..context.joints).collect(), term).of_targets().with("link", link as f64)
    };
    (0..context.links).map(on).collect()
}

fn estimate(proposal: &Proposal, fitted: &[FittedColumn], _: &OwnFriction) -> Parameters {
    let mut parameters = proposal.fixed_parameters();
    let find = |wanted: &str| {
        fitted
            .iter()
            .find(|(name, _, _)| name.split('_').next() == Some(wanted))
            .map_or((0.0, f64::INFINITY), |(_, value, std)| (*value, *std))
    };
    let (mass, std) = find("m");
    if mass != 0.0 {
        let moments = ["mX", "mY", "mZ"].map(find);
        let inertias = ["XX", "XY", "XZ", "YY", "YZ", "ZZ"].map(find);
        parameters.extend([
            ("mass_kg".to_owned(), ParameterValue::new(mass, std)),
            (
                "com_m".to_owned(),
                ParameterValue::new(moments.map(|m| m.0 / mass), moments.map(|m| m.1 / mass.abs())),
            ),
            ("inertia_kg_m2".to_owned(), ParameterValue::new(inertias.map(|i| i.0), inertias.map(|i| i.1))),
        ]);
    }
    parameters
}

fn phrase(parameters: &Parameters, measured: MeasurementUnit) -> Option<String> {
    let mass_kg = parameters.get("mass_kg")?;
    let (value, link) = (mass_kg.value.as_f64()?, parameters.get("link")?.value.as_f64()?);
    let mass = match mass_kg.std.as_f64() {
        Some(std) => with_deviation(value.abs(), std),
        None => format!("{:.3}", value.abs()),
    };
    let unit = Unit::Mass.symbol(measured);
    Some(if value < 0.0 {
        format!("a load of {mass} {unit} removed from link {link}")
    } else {
        format!("a payload of {mass} {unit} on link {link}")
    })
}

/// A load hangs within reach of the arm.
fn excludes(parameters: &Parameters, reach_m: f64) -> Option<String> {
    let com_m = parameters.get("com_m")?;
    let length = |of: &Value| -> Option<f64> {
        let squares = of.as_array()?.iter().map(|v| v.as_f64().map(|v| v * v));
        squares.sum::<Option<f64>>().map(f64::sqrt)
    };
    let (distance_m, std_m) = (length(&com_m.value)?, length(&com_m.std).unwrap_or(0.0));
    (distance_m - 2.0 * std_m > reach_m).then(|| {
        format!(
            "the centre of mass is {distance_m:.2} ± {std_m:.2} m from the link's frame, and the arm reaches {reach_m:.2} m"
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn masses_of_a_model_in_amperes_are_not_kilograms() {
        let parameters = Parameters::from([
            ("mass_kg".to_owned(), ParameterValue::new(0.2506, 0.005)),
            ("link".to_owned(), ParameterValue::exact(5.0)),
        ]);
        let said = phrase(&parameters, MeasurementUnit::Ampere);
        assert_eq!(said.as_deref(), Some("a payload of 0.2506 ± 0.0050 A/Nm kg on link 5"));
    }
}
