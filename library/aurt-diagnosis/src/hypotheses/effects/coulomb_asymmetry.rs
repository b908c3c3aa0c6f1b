//! `coulomb_asymmetry`: dry friction of another size in each direction.
//!
//! # What it is
//! τ = F_C+ for q̇ > 0 and −F_C− for q̇ < 0. Gears, seals and belts that are preloaded on one side resist one
//! direction more than the other.
//!
//! - `coulomb_pos_nm`, `coulomb_neg_nm`: F_C+ and F_C−, Nm, both ≥ 0; they usually differ by a few per cent.
//!
//! # How it shows
//! While the joint moves, the difference is a constant, (F_C+ − F_C−)/2, on top of symmetric friction. It
//! vanishes at rest, since a resting joint has no kinetic friction.
//!
//! # Easily confused with
//! - `current_offset`: identical while the joint moves, so on recordings without rest the two are one class. An
//!   offset is also there at rest.
//! - `spring` with a constant torque, and the gravity of a joint that moves over a small range: constant there,
//!   too.
//! - `viscous_asymmetry`: grows with speed, which needs several speeds to be seen.
//!
//! # What to record to be sure
//! The current at rest, with the brakes released and with them set, beside slow motion in both directions: what
//! is there at rest with the brakes set is an offset, what only comes with motion is friction.
//!
//! # References
//! - B. Armstrong-Hélouvry (1991), *Control of Machines with Friction*.

use serde_json::json;

use super::{Context, Effect, Family, FittedColumn, Kind, OwnFriction, Parameters, Proposal, named, raised};

pub(super) struct CoulombAsymmetry;

impl Effect for CoulombAsymmetry {
    fn id(&self) -> &'static str {
        "coulomb_asymmetry"
    }

    fn family(&self) -> Family {
        Family::F
    }

    fn kind(&self) -> Kind {
        Kind::Friction
    }

    fn generalises(&self) -> &'static [&'static str] {
        &["coulomb"]
    }

    /// F₊ ≠ F₋ beside a Coulomb level is a constant while the joint moves.
    fn same_force(&self) -> &'static [&'static str] {
        &["current_offset"]
    }

    fn title(&self) -> &'static str {
        "Coulomb friction that differs by direction"
    }

    fn decider(&self) -> &'static str {
        "the current at rest, with the brakes released and with them set: an offset shows there, asymmetric \
         friction does not"
    }

    fn source(&self) -> &'static str {
        include_str!("coulomb_asymmetry.rs")
    }

    fn proposals(&self, context: &Context<'_>) -> Vec<Proposal> {
        // Beside the model's own level, the change in one direction may be negative.
        (0..context.joints)
            .map(|j| Proposal::on_joint(j, json!({"model": "coulomb_asymmetric", "joints": [j]}), vec![]))
            .collect()
    }

    fn parameters(&self, _proposal: &Proposal, fitted: &[FittedColumn]) -> Parameters {
        named(&["coulomb_pos_nm", "coulomb_neg_nm"], fitted)
    }

    fn parameters_beside(
        &self,
        _proposal: &Proposal,
        fitted: &[FittedColumn],
        own: &OwnFriction,
    ) -> Parameters {
        named(&["coulomb_pos_nm", "coulomb_neg_nm"], &raised(fitted, own.coulomb_nm))
    }
}
