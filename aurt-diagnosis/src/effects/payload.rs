//! `payload`: a load attached to a link.
//!
//! # What it is
//! A body fixed to a link adds its ten inertial parameters to the link's, τ = Y_link(q, q̇, q̈) π_load, on the
//! link's joint and on all joints before it.
//!
//! - `link`: the link that carries it;
//! - `mass_kg`, `com_m` (its centre of mass in the link's frame, x y z), `inertia_kg_m2` (about that frame's
//!   origin, in the order XX XY XZ YY YZ ZZ). A negative mass means that a load was removed;
//! - `first_moment_kg_m` (mass times centre of mass) in the place of `com_m` where the recordings do not determine the mass:
//!   on a link that only turns, say, or within two standard deviations of zero.
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
//! - `rotor_inertia`: inertia about the joint's own axis alone, without a mass.
//!
//! # What to record to be sure
//! The same motion with and without the load, on the same day. A load may be turned on the flange between two
//! recordings; validate it on the rest of its own.
//!
//! # References
//! - W. Khalil, M. Gautier, P. Lemoine (2007), *Identification of the payload inertial parameters of industrial
//!   manipulators*.
//! - S. Mamedov, S. Mikhel (2020), *Practical aspects of model-based collision detection*.

use aurt_calibration::{deviation_digits, with_deviation};
use aurt_traits::{MeasurementUnit, RobotNames};
use serde_json::{Value, json};

use crate::parameters::{FittedColumn, ParameterValue, Parameters};
use crate::vocabulary::{Context, Effect, Family, OwnFriction, Parameter, Proposal, Unit, Wording};

pub static EFFECT: Effect = Effect {
    id: "payload",
    family: Family::I,
    title: "a load attached to a link",
    decider: "the same motion without the load, as calibration recording",
    source: include_str!("payload.rs"),
    parameters: &[
        Parameter::new("mass_kg", Unit::Mass),
        Parameter::new("com_m", Unit::Length).of(&["x", "y", "z"]),
        Parameter::new("first_moment_kg_m", Unit::FirstMoment).of(&["x", "y", "z"]),
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
    let moments = ["mX", "mY", "mZ"].map(find);
    let inertias = ["XX", "XY", "XZ", "YY", "YZ", "ZZ"].map(find);
    let mut add = |name: &str, value: ParameterValue| parameters.insert(name.to_owned(), value);
    if std.is_finite() {
        add("mass_kg", ParameterValue::new(mass, std));
    }
    if is_determined(mass, std) {
        // As if moment and mass were independent: their covariance is not told.
        let of = |(moment, own): (f64, f64)| [moment / mass, own.hypot(moment / mass * std) / mass.abs()];
        let com_m = moments.map(of);
        add("com_m", ParameterValue::new(com_m.map(|[value, _]| value), com_m.map(|[_, std]| std)));
    } else if moments.iter().any(|(_, std)| std.is_finite()) {
        add("first_moment_kg_m", ParameterValue::new(moments.map(|m| m.0), moments.map(|m| m.1)));
    }
    if inertias.iter().any(|(_, std)| std.is_finite()) {
        add("inertia_kg_m2", ParameterValue::new(inertias.map(|i| i.0), inertias.map(|i| i.1)));
    }
    parameters
}

/// Whether a quantity differs from zero by more than two of its standard deviations.
fn is_determined(value: f64, std: f64) -> bool {
    value != 0.0 && value.abs() > 2.0 * std
}

/// A centre of mass that is known to this, m, is worth a place in a sentence.
const KNOWN_CENTRE_M: f64 = 0.05;

fn wording(parameters: &Parameters, measured: MeasurementUnit, names: RobotNames<'_>) -> Wording {
    let link = parameters.get("link").and_then(|link| link.value.as_f64());
    let on = link.map_or_else(|| "a link".to_owned(), |link| names.link(link as usize));
    let mass = parameters.get("mass_kg").and_then(|mass| Some((mass.value.as_f64()?, mass.std.as_f64())));
    let Some((value, std)) = mass.filter(|(value, std)| is_determined(*value, std.unwrap_or(0.0))) else {
        return Wording {
            phrase: format!("a load of undetermined mass on {on}"),
            detail: first_moment(parameters).unwrap_or_default(),
        };
    };
    let mass = match std {
        Some(std) => with_deviation(value.abs(), std),
        None => format!("{:.3}", value.abs()),
    };
    let unit = measured.express("kg");
    let phrase = if value < 0.0 {
        format!("a load of {mass} {unit} removed from {on}")
    } else {
        format!("a payload of {mass} {unit} on {on}")
    };
    Wording { phrase, detail: centre(parameters).unwrap_or_default() }
}

/// The entries of a vector, and the largest of their standard deviations.
fn vector(value: &ParameterValue) -> Option<(Vec<f64>, f64)> {
    let numbers = |of: &Value| of.as_array()?.iter().map(Value::as_f64).collect::<Option<Vec<f64>>>();
    let stds = numbers(&value.std)?;
    Some((numbers(&value.value)?, stds.iter().copied().fold(0.0, f64::max)))
}

/// The first moment of a load whose mass is not determined.
fn first_moment(parameters: &Parameters) -> Option<String> {
    let (values, std) = vector(parameters.get("first_moment_kg_m")?)?;
    let digits = deviation_digits(std);
    let values: Vec<String> = values.iter().map(|v| format!("{v:.digits$}")).collect();
    std.is_finite().then(|| {
        format!(
            "first moment [{}] ± {std:.digits$} kg m in the frame of its joint, z along the axis",
            values.join(", ")
        )
    })
}

/// The centre of mass, where it is determined.
fn centre(parameters: &Parameters) -> Option<String> {
    let (values, std) = vector(parameters.get("com_m")?)?;
    (std.is_finite() && std <= KNOWN_CENTRE_M).then(|| {
        let digits = deviation_digits(std);
        let values: Vec<String> = values.iter().map(|v| format!("{v:.digits$}")).collect();
        format!(
            "centre of mass [{}] ± {std:.digits$} m in the frame of its joint, z along the axis",
            values.join(", ")
        )
    })
}

/// A load has a mass, and hangs within reach of the arm. Inertia without it is a rotor's.
fn excludes(parameters: &Parameters, reach_m: f64) -> Option<String> {
    let Some(com_m) = parameters.get("com_m") else {
        let moments = parameters.get("first_moment_kg_m").map(entries).unwrap_or_default();
        let has_mass = moments.into_iter().any(|(value, std)| is_determined(value, std));
        return (!has_mass).then(|| {
            "neither mass nor first moments of the load differ from zero by two standard deviations".into()
        });
    };
    let length = |of: &Value| -> Option<f64> {
        let squares = of.as_array()?.iter().map(|v| v.as_f64().map(|v| v * v));
        squares.sum::<Option<f64>>().map(f64::sqrt)
    };
    let (distance_m, std_m) = (length(&com_m.value)?, length(&com_m.std).unwrap_or(0.0));
    (distance_m - 2.0 * std_m > reach_m).then(|| {
        format!(
            "the centre of mass is {} m from the link's frame, and the arm reaches {reach_m:.2} m",
            with_deviation(distance_m, std_m)
        )
    })
}

/// The entries of a list with their deviations.
fn entries(parameter: &ParameterValue) -> Vec<(f64, f64)> {
    let number = |of: &Value, k: usize| of.get(k).and_then(Value::as_f64);
    let count = parameter.value.as_array().map_or(0, Vec::len);
    let entry = |k| Some((number(&parameter.value, k)?, number(&parameter.std, k)?));
    (0..count).filter_map(entry).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fitted(values: [(&str, f64, f64); 4]) -> Vec<FittedColumn> {
        values.map(|(name, value, std)| (format!("{name}_2"), value, std)).to_vec()
    }

    #[test]
    fn a_centre_of_mass_needs_a_mass_and_a_load_a_size() {
        let proposal = Proposal::term(vec![0], json!({"model": "payload", "link": 2})).with("link", 2.0);
        let of = |values| estimate(&proposal, &fitted(values), &OwnFriction::default());
        let hung = of([("m", 2.0, 0.1), ("mX", 0.4, 0.01), ("mY", 0.0, 0.01), ("mZ", 0.1, 0.01)]);
        assert_eq!(hung["com_m"].value[0], 0.2);
        let std = hung["com_m"].std[0].as_f64().unwrap();
        assert!((std - 0.005_f64.hypot(0.2 * 0.05)).abs() < 1e-12, "that of the mass is in it: {std}");
        assert!(!hung.contains_key("first_moment_kg_m"), "{hung:?}");
        assert_eq!(excludes(&hung, 1.0), None);
        // What is left of a mass by rounding gives no centre of mass.
        for mass in [(1e-14, 1e-14), (0.0, f64::INFINITY), (0.1, 0.3)] {
            let turned =
                of([("m", mass.0, mass.1), ("mX", 0.4, 0.01), ("mY", 0.0, 0.01), ("mZ", 0.0, f64::INFINITY)]);
            assert!(!turned.contains_key("com_m"), "{turned:?}");
            assert_eq!(turned["first_moment_kg_m"].value[0], 0.4);
            assert_eq!(excludes(&turned, 1.0), None);
            let said = wording(&turned, MeasurementUnit::NewtonMetre, RobotNames::default());
            assert!(said.phrase.contains("of undetermined mass"), "{said:?}");
        }
        let nothing =
            of([("m", 0.1, 0.3), ("mX", 0.01, 0.01), ("mY", 0.0, 0.01), ("mZ", 0.0, f64::INFINITY)]);
        assert!(excludes(&nothing, 1.0).unwrap().contains("two standard deviations"), "{nothing:?}");
        let mut rotor = nothing;
        rotor.insert(
            "inertia_kg_m2".to_owned(),
            ParameterValue::new([0.0, 0.0, 0.0, 0.0, 0.0, 0.4], [0.01; 6]),
        );
        assert!(excludes(&rotor, 1.0).is_some(), "inertia without a mass: {rotor:?}");
    }

    #[test]
    fn a_load_is_told_with_its_link_its_unit_and_what_is_determined() {
        let mut parameters = Parameters::from([("link".to_owned(), ParameterValue::exact(1.0))]);
        let links = ["upper_arm", "wrist_link"].map(str::to_owned);
        let names = RobotNames { joints: &[], links: &links };
        let said = wording(&parameters, MeasurementUnit::NewtonMetre, names);
        assert_eq!(said.phrase, "a load of undetermined mass on wrist_link");
        let moment = ParameterValue::new([0.0, 0.0412, -0.003], [0.001, 0.0004, 0.001]);
        parameters.insert("first_moment_kg_m".to_owned(), moment);
        assert_eq!(
            wording(&parameters, MeasurementUnit::NewtonMetre, names).detail,
            "first moment [0.0000, 0.0412, -0.0030] ± 0.0010 kg m in the frame of its joint, z along the axis"
        );
        parameters.remove("first_moment_kg_m");
        parameters.insert("mass_kg".to_owned(), ParameterValue::new(0.2506, 0.005));
        parameters.insert("com_m".to_owned(), ParameterValue::new([0.0; 3], [0.1; 3]));
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
