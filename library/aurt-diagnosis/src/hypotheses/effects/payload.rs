//! `payload`: a load attached to a link.
//!
//! # What it is
//! A body fixed to a link adds its ten inertial parameters to the link's, τ = Y_link(q, q̇, q̈) π_load, on the
//! link's joint and on all joints before it.
//!
//! - `link`: the link that carries it;
//! - `mass_kg`, `com_m` (its centre of mass in the link's frame, x y z), `inertia_kg_m2` (about that frame's
//!   origin, in the order XX XY XZ YY YZ ZZ). A negative mass means that something was taken off.
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

use std::collections::BTreeMap;

use aurt_calibration::with_deviation;
use serde_json::json;

use super::{
    Addition, Context, Effect, Family, FittedColumn, ParameterValue, Parameters, Presence, Proposal,
};

pub(super) struct Payload;

impl Effect for Payload {
    fn id(&self) -> &'static str {
        "payload"
    }

    fn family(&self) -> Family {
        Family::I
    }

    fn title(&self) -> &'static str {
        "a load attached to a link"
    }

    fn decider(&self) -> &'static str {
        "the same motion without the load, as calibration recording"
    }

    fn source(&self) -> &'static str {
        include_str!("payload.rs")
    }

    fn whole_arm(&self) -> bool {
        true
    }

    fn proposals(&self, context: &Context<'_>) -> Vec<Proposal> {
        (0..context.links)
            .map(|link| {
                Proposal {
                    joints: (0..context.joints).collect(),
                    addition: Addition::Term(json!({"model": "payload", "link": link})),
                    // A load that was taken off has a negative mass.
                    nonnegative: vec![],
                    presence: Presence::Change,
                    fixed: BTreeMap::new(),
                    shapes: Vec::new(),
                    starts: Vec::new(),
                    deviations: BTreeMap::new(),
                }
                .with("link", link as f64)
            })
            .collect()
    }

    fn parameters(&self, proposal: &Proposal, fitted: &[FittedColumn]) -> Parameters {
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
            parameters.insert("mass_kg".to_owned(), (json!(mass), json!(std)));
            let com = (json!(moments.map(|m| m.0 / mass)), json!(moments.map(|m| m.1 / mass.abs())));
            parameters.insert("com_m".to_owned(), com);
            let inertia = (json!(inertias.map(|i| i.0)), json!(inertias.map(|i| i.1)));
            parameters.insert("inertia_kg_m2".to_owned(), inertia);
        }
        parameters
    }

    fn phrase(&self, parameters: &BTreeMap<String, ParameterValue>) -> Option<String> {
        let number = |name: &str| parameters.get(name)?.value.as_f64();
        let (mass_kg, link) = (number("mass_kg")?, number("link")?);
        let mass = match parameters.get("mass_kg")?.std.as_f64() {
            Some(std) => with_deviation(mass_kg.abs(), std),
            None => format!("{:.3}", mass_kg.abs()),
        };
        Some(if mass_kg < 0.0 {
            format!("a load of {mass} kg removed from link {link}")
        } else {
            format!("a payload of {mass} kg on link {link}")
        })
    }

    /// A load hangs within reach of the arm.
    fn impossible(&self, parameters: &Parameters, reach_m: f64) -> Option<String> {
        let (centre, deviation) = parameters.get("com_m")?;
        let length = |of: &serde_json::Value| -> Option<f64> {
            let squares = of.as_array()?.iter().map(|v| v.as_f64().map(|v| v * v));
            squares.sum::<Option<f64>>().map(f64::sqrt)
        };
        let (distance_m, std_m) = (length(centre)?, length(deviation).unwrap_or(0.0));
        (distance_m - 2.0 * std_m > reach_m).then(|| {
            format!(
                "the centre of mass is {distance_m:.2} ± {std_m:.2} m from the link's frame, and the arm reaches {reach_m:.2} m"
            )
        })
    }
}
