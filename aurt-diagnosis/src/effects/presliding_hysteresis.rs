//! `presliding_hysteresis`: friction that builds up over the first travel after each reversal.
//!
//! # What it is
//! Before surfaces slide, their contacts give like springs and let go one after the other. Here the sum of
//! parallel Maxwell-slip elements, τ = Σ_i W_i clamp((q − a_i)/Δ_i, −1, 1): each element's anchor a_i follows the
//! joint at the distance Δ_i once the element slips, so friction depends on where the joint reversed. Dahl, LuGre
//! and Bouc–Wen models describe the same loops.
//!
//! - `thresholds_rad`: Δ_i, 10⁻³–10⁻¹ rad on geared joints (five elements; the range is estimated);
//! - `weights_nm`: W_i ≥ 0, Nm; their sum joins the level of full sliding.
//!
//! # How it shows
//! Plotted against angle, the residual runs through loops: after a reversal it rises over some hundredths of a
//! rad to the level that a model with sgn q̇ reaches at once. Real joints nearly always have it: on a UR10e it
//! was the first thing that a Coulomb and viscous model lacked, on all six joints.
//!
//! # Easily confused with
//! - `coulomb`: the same far from reversals.
//! - `stribeck`: confined to the same stretches, but following speed instead of travel.
//! - `backlash`, which also acts after reversals, within the play only and with an impact at its end.
//! - the smear of filters on sgn q̇, which follows time since the reversal.
//! - its own variants: which of the models describes the loop best is rarely decidable.
//!
//! # What to record to be sure
//! Slow triangular motion of one joint with amplitudes from 0.001 to 0.1 rad, nested, so that loops close
//! within loops.
//!
//! # References
//! - W. D. Iwan (1966), *A distributed-element model for hysteresis and its steady-state dynamic response*.
//! - P. R. Dahl (1968), *A solid friction model*.
//! - C. Canudas de Wit, H. Olsson, K. J. Åström, P. Lischinsky (1995), *A new model for control of systems with
//!   friction*.
//! - V. Lampaert, F. Al-Bender, J. Swevers (2003), *A generalized Maxwell-slip friction model appropriate for
//!   control purposes*.

use serde_json::json;

use crate::parameters::{FittedColumn, ParameterValue, Parameters};
use crate::vocabulary::shape::Shape;
use crate::vocabulary::{Context, Effect, Family, OwnFriction, Parameter, Proposal, Unit};

/// Number of Maxwell-slip elements.
const ELEMENTS: usize = 5;
/// Smallest and largest threshold from which the search begins, rad; those between are evenly spaced in logarithms.
const THRESHOLDS_RAD: [f64; 2] = [0.0005, 0.12];

/// Where the smallest threshold is sought, and in no case below what the recordings resolve of the travel: an element
/// that slips within one step of the encoder is sgn q̇ at an uncertain time. …
const SMALLEST: Shape = Shape::logarithmic("smallest_rad", "/hysteresis/smallest_rad", [1e-4, 0.01], 0.7);
/// … and the largest: presliding over a quarter of a radian is a spring.
const LARGEST: Shape = Shape::logarithmic("largest_rad", "/hysteresis/largest_rad", [0.012, 0.25], 0.5);

pub static EFFECT: Effect = Effect {
    id: "presliding_hysteresis",
    family: Family::H,
    title: "presliding hysteresis (friction builds up over the first travel after each reversal)",
    decider: "slow triangular motion of one joint with amplitudes from 0.001 to 0.1 rad",
    source: include_str!("presliding_hysteresis.rs"),
    parameters: &[
        Parameter::new("thresholds_rad", Unit::Angle).of(&["1", "2", "3", "4", "5"]),
        Parameter::new("weights_nm", Unit::Torque).of(&["1", "2", "3", "4", "5"]),
    ],
    stays_beside_delays: true,
    propose,
    estimate: Some(estimate),
    ..Effect::FRICTION
};

fn propose(context: &Context<'_>) -> Vec<Proposal> {
    let [smallest, largest] = THRESHOLDS_RAD;
    let [least, most] = SMALLEST.bounds;
    (0..context.joints)
        .filter(|j| context.resolution_rad[*j] < most)
        .map(|j| {
            let least = context.resolution_rad[j].max(least);
            let elements = json!({
                "model": "maxwell_slip", "elements": ELEMENTS, "smallest_rad": smallest.max(least),
                "largest_rad": largest,
            });
            Proposal::friction(j, json!({"model": "constant"}), elements, &[])
                .bound(&[true; ELEMENTS])
                .shaped(Shape { bounds: [least, most], ..SMALLEST })
                .shaped(LARGEST)
        })
        .collect()
}

fn estimate(proposal: &Proposal, fitted: &[FittedColumn], _: &OwnFriction) -> Parameters {
    let of = |shape: &Shape, start: f64| proposal.fixed.get(shape.name).copied().unwrap_or(start);
    let (smallest, largest) = (of(&SMALLEST, THRESHOLDS_RAD[0]), of(&LARGEST, THRESHOLDS_RAD[1]));
    let steps = (ELEMENTS - 1) as f64;
    let thresholds: Vec<f64> =
        (0..ELEMENTS).map(|i| smallest * (largest / smallest).powf(i as f64 / steps)).collect();
    let (weights, deviations): (Vec<f64>, Vec<f64>) = fitted.iter().map(|f| (f.1, f.2)).unzip();
    Parameters::from([
        ("thresholds_rad".to_owned(), ParameterValue::exact(thresholds)),
        ("weights_nm".to_owned(), ParameterValue::new(weights, deviations)),
    ])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thresholds_are_sought_where_positions_are_told_apart() {
        let context = Context {
            joints: 3,
            links: 3,
            apart: &[],
            recordings: &[],
            residual: &[],
            inertial: &[],
            resolution_rad: &[1e-5, 0.002, 0.02],
        };
        let proposals = propose(&context);
        let joints: Vec<usize> = proposals.iter().map(|p| p.joints[0]).collect();
        assert_eq!(joints, [0, 1], "joint 2 shows no travel as short as presliding");
        let least: Vec<f64> = proposals.iter().map(|p| p.shapes[0].bounds[0]).collect();
        assert_eq!(least, [1e-4, 0.002]);
        assert!(proposals.iter().all(|p| p.fixed[SMALLEST.name] >= p.shapes[0].bounds[0]));
    }
}
