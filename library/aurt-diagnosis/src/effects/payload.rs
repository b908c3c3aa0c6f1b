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
use aurt_traits::{MeasurementUnit, RobotNames};
use serde_json::{Value, json};

use crate::parameters::{FittedColumn, ParameterValue, Parameters};
use crate::vocabulary::{Context, Effect, Family, OwnFriction, Parameter, Proposal, Unit, Wording};

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
    wording: Some(wording),
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

/// A centre of mass that is known to this, m, is worth a place in a sentence.
const KNOWN_CENTRE_M: f64 = 0.05;

fn wording(parameters: &Parameters, measured: MeasurementUnit, names: RobotNames<'_>) -> Wording {
    let link = parameters.get("link").and_then(|link| link.value.as_f64());
    let on = link.map_or_else(|| "a link".to_owned(), |link| names.link(link as usize));
    let known = parameters.get("mass_kg").and_then(|mass| Some((mass.value.as_f64()?, mass.std.as_f64())));
    let Some((value, std)) = known else {
        return Wording { phrase: format!("a load of undetermined mass on {on}"), detail: String::new() };
    };
    let mass = match std {
        Some(std) => with_deviation(value.abs(), std),
        None => format!("{:.3}", value.abs()),
    };
    let unit = Unit::Mass.symbol(measured);
    let phrase = if value < 0.0 {
        format!("a load of {mass} {unit} removed from {on}")
    } else {
        format!("a payload of {mass} {unit} on {on}")
    };
    Wording { phrase, detail: centre(parameters).unwrap_or_default() }
}

/// The centre of mass, where it is determined.
fn centre(parameters: &Parameters) -> Option<String> {
    let com_m = parameters.get("com_m")?;
    let numbers = |of: &Value| of.as_array()?.iter().map(Value::as_f64).collect::<Option<Vec<f64>>>();
    let (values, stds) = (numbers(&com_m.value)?, numbers(&com_m.std)?);
    let largest = stds.iter().copied().fold(0.0, f64::max);
    (largest.is_finite() && largest <= KNOWN_CENTRE_M && !stds.is_empty()).then(|| {
        let values: Vec<String> = values.iter().map(|v| format!("{v:.3}")).collect();
        format!(
            "centre of mass [{}] ± {largest:.3} m in the frame of its joint, z along the axis",
            values.join(", ")
        )
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
    fn a_load_is_told_with_its_link_its_unit_and_a_centre_that_is_determined() {
        let mut parameters = Parameters::from([("link".to_owned(), ParameterValue::exact(1.0))]);
        let links = ["upper_arm", "wrist_link"].map(str::to_owned);
        let names = RobotNames { joints: &[], links: &links };
        let said = wording(&parameters, MeasurementUnit::NewtonMetre, names);
        assert_eq!(said.phrase, "a load of undetermined mass on wrist_link");
        parameters.insert("mass_kg".to_owned(), ParameterValue::new(0.2506, 0.005));
        let said = wording(&parameters, MeasurementUnit::Ampere, RobotNames::default());
        assert_eq!(said.phrase, "a payload of 0.2506 ± 0.0050 A/Nm kg on link 1");
        for (std, detail) in [
            (
                0.01,
                "centre of mass [0.000, 0.020, -0.100] ± 0.010 m in the frame of its joint, z along the axis",
            ),
            (0.2, ""),
            (f64::INFINITY, ""),
        ] {
            parameters
                .insert("com_m".to_owned(), ParameterValue::new([0.0, 0.02, -0.1], [0.001, 0.002, std]));
            assert_eq!(wording(&parameters, MeasurementUnit::NewtonMetre, names).detail, detail);
        }
    }
}
