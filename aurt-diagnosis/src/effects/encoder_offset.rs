//! `encoder_offset`: a joint's encoder whose zero is not that of the model.
//!
//! # What it is
//! Where the joint stands at q, the recording has q + o: y = τ(q_recorded − o), with τ the torque of the fitted rigid
//! bodies. An encoder, a motor or a gear was exchanged, a belt has jumped a tooth, a spline sits one tooth further, a
//! robot was mastered anew. Play whose joint hangs on one flank does the same.
//!
//! - `offset_rad`: o, rad; above zero where the encoder shows too much; usually some hundredths.
//!
//! # How it shows
//! Gravity as of another pose: the residual is the slope of the holding torque along the joint's angle, on the joint
//! itself and on all that carry it. It is the largest where the joint's links hang or stand upright, and their weight
//! has the least lever.
//!
//! # Easily confused with
//! - `base_tilt`: an offset of the first horizontal axis is a tilt about it, as long as no joint before it turns.
//! - `backlash` of a joint that gravity holds on one flank: the same offset while the load keeps its sign.
//! - `payload`: follows the pose, too, and is the largest where the lever is long.
//! - `spring` and `torque_ripple`, on one joint alone.
//! - first moments of the links: those of a fit have a zero that was wrong already, so that only a change is looked for.
//!
//! # What to record to be sure
//! The joint at its mark or against its stop, the angle that the controller shows beside it.
//!
//! # References
//! - W. Khalil, E. Dombre (2002), *Modeling, Identification and Control of Robots*, on the calibration of joint zeros.

use serde_json::json;

use crate::effects::backlash;
use crate::vocabulary::{Context, Effect, Family, Kind, Parameter, Proposal, Unit};

pub static EFFECT: Effect = Effect {
    id: "encoder_offset",
    family: Family::D,
    kind: Kind::Position,
    title: "an encoder whose zero is not that of the model",
    decider: "the joint at its mark, beside the angle that is shown",
    source: include_str!("encoder_offset.rs"),
    parameters: &[Parameter::new("offset_rad", Unit::Angle)],
    reads_model: true,
    same_under: play_on_one_flank,
    propose,
    ..Effect::BASE
};

/// A joint whose load keeps its sign does not cross its play.
fn play_on_one_flank(load_nm: &[f64]) -> Option<&'static Effect> {
    let keeps = load_nm.iter().all(|l| *l > 0.0) || load_nm.iter().all(|l| *l < 0.0);
    (keeps && !load_nm.is_empty()).then_some(&backlash::EFFECT)
}

/// A zero that was wrong in the calibration recordings, too, is in the fitted first moments: what is left of it is as good as
/// anything for what else bends a little with the pose.
fn propose(context: &Context<'_>) -> Vec<Proposal> {
    let (columns, values): (Vec<usize>, Vec<f64>) = context.inertial.iter().copied().unzip();
    let term = |j: usize| {
        json!({
            "model": "encoder_offset", "joints": [j], "around_rad": [0.0], "inertial_columns": columns, "inertial_values": values,
        })
    };
    (0..context.joints).map(|j| Proposal::term(vec![j], term(j)).of_targets()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn play_is_crossed_where_the_load_changes_its_sign() {
        let id = |load_nm: &[f64]| play_on_one_flank(load_nm).map(|effect| effect.id);
        assert_eq!([id(&[3.0, 0.1]), id(&[-3.0, -0.1])], [Some("backlash"); 2]);
        assert_eq!([id(&[3.0, -0.1]), id(&[0.0, 1.0]), id(&[])], [None; 3]);
    }
}
