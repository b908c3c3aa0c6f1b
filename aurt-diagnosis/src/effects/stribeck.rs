//! `stribeck`: friction that is highest as motion sets in and falls with speed.
//!
//! # What it is
//! τ = (F_C + (F_S − F_C) s(q̇)) sgn q̇ with s = e^(−|q̇/v_S|^δ) or 1/(1 + |q̇/v_S|^δ), whichever leaves less: at rest
//! surfaces touch, with speed a film of lubricant separates them, and friction falls from F_S to F_C over a few v_S before
//! viscous friction takes over.
//!
//! - `static_nm`: F_S, Nm, above F_C; `coulomb_nm`: F_C, Nm, with the model's own level;
//! - `stribeck_velocity_rad_s`: v_S, 0.02–0.1 rad/s on geared joints, and `stribeck_exponent`, δ: both are
//!   estimated;
//! - `half_speed_rad_s`: the speed at which half of F_S − F_C is gone, v_S (ln 2)^(1/δ) or v_S. Fitted to each other the two
//!   laws differ by a fifth in it, and the exponential one states an exponent that is half as large.
//!
//! # How it shows
//! A hump of residual at |q̇| below about 2 v_S, of the sign of velocity, after every break-away and before
//! every stop; nothing at higher speed.
//!
//! # Easily confused with
//! - `presliding_hysteresis`: also confined to the neighbourhood of reversals, but it follows the angle
//!   travelled since the reversal, whereas this follows speed. Only reversals of different acceleration
//!   separate them.
//! - the smear of filters: within ±0.03 rad/s of a reversal, filtered sgn q̇ alone leaves 1.2–3 times the
//!   noise.
//! - `viscous_nonlinear`, if slow motion is rare.
//!
//! # What to record to be sure
//! Constant velocities from 0.001 to 0.2 rad/s, some seconds each, in both directions. Reversals alone cannot
//! decide.
//!
//! # References
//! - R. Stribeck (1902), *Die wesentlichen Eigenschaften der Gleit- und Rollenlager*.
//! - L. C. Bo, D. Pavelescu (1982), *The friction-speed relation and its influence on the critical velocity of
//!   stick-slip motion*, Wear.
//! - D. P. Hess, A. Soom (1990), *Friction at a lubricated line contact operating at oscillating sliding velocities*,
//!   J. Tribology.
//! - B. Armstrong-Hélouvry, P. Dupont, C. Canudas de Wit (1994), *A survey of models, analysis tools and
//!   compensation methods for the control of machines with friction*, Automatica.

use serde_json::{Value, json};

use crate::effects::coulomb;
use crate::parameters::ParameterValue;
use crate::vocabulary::shape::Shape;
use crate::vocabulary::{Addition, Context, Effect, Family, Parameter, Proposal, Unit};

/// Velocities v_S from which the search begins; the exponential is so wide in logarithms that steps of about two suffice.
const STRIBECK_VELOCITIES_RAD_S: [f64; 5] = [0.01, 0.02, 0.05, 0.1, 0.2];

/// v_S is sought within what filters and recordings can show, …
const VELOCITY: Shape =
    Shape::logarithmic("stribeck_velocity_rad_s", "/coulomb/stribeck_velocity_rad_s", [0.002, 0.6], 0.35);
/// … and the exponent within what has been reported (Armstrong-Hélouvry 1994: 0.5 to 2).
const EXPONENT: Shape =
    Shape::logarithmic("stribeck_exponent", "/coulomb/stribeck_exponent", [0.5, 3.0], 0.3);

/// The usual exponent, from which the search begins.
const USUAL_EXPONENT: f64 = 2.0;

/// Leaves the level of dry friction out of a term of joint friction, if it is Stribeck's.
pub(crate) fn leave_out_level(term: &mut Value) {
    if let Some(Value::Object(coulomb)) = term.get_mut("coulomb")
        && coulomb.get("model").is_some_and(|name| name == "stribeck")
    {
        coulomb.insert("level".into(), false.into());
    }
}

/// The level alone is `coulomb`.
pub static EFFECT: Effect = Effect {
    id: "stribeck",
    family: Family::F,
    title: "Stribeck friction (friction falls as motion sets in)",
    decider: "constant slow velocities between 0.001 and 0.2 rad/s",
    source: include_str!("stribeck.rs"),
    parameters: &[
        Parameter::new("coulomb_nm", Unit::Torque).never_negative(),
        Parameter::new("static_nm", Unit::Torque).never_negative(),
        Parameter::new("stribeck_velocity_rad_s", Unit::Velocity),
        Parameter::new("stribeck_exponent", Unit::One),
        Parameter::new("half_speed_rad_s", Unit::Velocity),
    ],
    generalises: &[&coulomb::EFFECT],
    is_essential: |coefficient| coefficient > 0,
    propose,
    estimate: Some(|proposal, fitted, own| {
        let mut parameters = proposal.fixed_parameters();
        parameters.extend(half_speed(proposal).map(|speed| ("half_speed_rad_s".to_owned(), speed)));
        if let [level, excess, ..] = fitted {
            let coulomb_nm = own.coulomb_nm + level.1;
            parameters.insert("coulomb_nm".to_owned(), ParameterValue::exact(coulomb_nm));
            // Motion shows no level at rest: it is as certain as the law that leads there, and with that at a bound not at all.
            let is_known = [VELOCITY, EXPONENT].iter().all(|s| proposal.deviations.contains_key(s.name));
            let std = is_known.then_some(excess.2);
            parameters.insert("static_nm".to_owned(), ParameterValue::new(coulomb_nm + excess.1, std));
        }
        parameters
    }),
    ..Effect::FRICTION
};

/// The speed at which half of the excess is gone, to first order as uncertain as v_S and δ are.
fn half_speed(proposal: &Proposal) -> Option<ParameterValue> {
    let [velocity, exponent] = [VELOCITY, EXPONENT]
        .map(|shape| Some((*proposal.fixed.get(shape.name)?, proposal.deviations.get(shape.name))));
    let ((velocity, velocity_std), (exponent, exponent_std)) = (velocity?, exponent?);
    let log = if is_rational(proposal) { 0.0 } else { libm::log(std::f64::consts::LN_2) };
    let half = velocity * libm::exp(log / exponent);
    let std = velocity_std.zip(exponent_std).map(|(of_velocity, of_exponent)| {
        half * (of_velocity / velocity).hypot(log * of_exponent / exponent.powi(2))
    });
    Some(ParameterValue::new(half, std))
}

fn is_rational(proposal: &Proposal) -> bool {
    matches!(&proposal.addition, Addition::Term(term) if term["coulomb"]["law"] == "rational")
}

fn propose(context: &Context<'_>) -> Vec<Proposal> {
    let proposal = |j: usize, velocity: f64| {
        let level = json!({
            "model": "stribeck", "stribeck_velocity_rad_s": velocity, "stribeck_exponent": USUAL_EXPONENT,
            "law": "exponential",
        });
        // The first column is a plain Coulomb level, of which the model may have too much.
        Proposal::friction(j, level, json!({"model": "sign"}), &[])
            .bound(&[false, true])
            .shaped(VELOCITY)
            .shaped(EXPONENT)
            .or_law("/coulomb/law", "rational".into())
    };
    (0..context.joints)
        .flat_map(|j| STRIBECK_VELOCITIES_RAD_S.map(|velocity| proposal(j, velocity)))
        .collect()
}
