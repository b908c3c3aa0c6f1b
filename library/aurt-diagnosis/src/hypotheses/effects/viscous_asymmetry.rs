//! `viscous_asymmetry`: speed-dependent friction with another slope in each direction.
//!
//! # What it is
//! τ = F_v+ q̇ for q̇ > 0 and F_v− q̇ for q̇ < 0. Preloaded gears, seals with a lip and belts rub harder one
//! way.
//!
//! - `viscous_pos_nm_s`, `viscous_neg_nm_s`: F_v+ and F_v−, Nm s/rad, both ≥ 0. The drive axis of the EMPS test
//!   bench has about 175 and 247 (in N s/m).
//!
//! # How it shows
//! Against velocity the residual has a kink at zero: what is left beside the mean slope is (F_v+ − F_v−)/2 ·
//! |q̇|, an even function of velocity.
//!
//! # Easily confused with
//! - `current_offset` and `coulomb_asymmetry`: even in velocity, too, and at one speed the same. They do not
//!   grow with speed.
//! - centrifugal torque, which is even in velocity as well; it depends on pose and the model usually has it.
//! - `viscous_nonlinear`: odd in velocity, so motion in both directions separates them.
//!
//! # What to record to be sure
//! Several constant velocities in both directions, over the same range of angles.
//!
//! # References
//! - B. Armstrong-Hélouvry (1991), *Control of Machines with Friction*.
//! - A. Janot, M. Gautier, M. Brunot (2019), *Data set and reference models of EMPS*.

use serde_json::json;

use super::{Context, Effect, Family, FittedColumn, Kind, OwnFriction, Parameters, Proposal, named, raised};

pub(super) struct ViscousAsymmetry;

impl Effect for ViscousAsymmetry {
    fn id(&self) -> &'static str {
        "viscous_asymmetry"
    }

    fn family(&self) -> Family {
        Family::V
    }

    fn kind(&self) -> Kind {
        Kind::Friction
    }

    fn generalises(&self) -> &'static [&'static str] {
        &["viscous"]
    }

    fn title(&self) -> &'static str {
        "viscous friction that differs by direction"
    }

    fn decider(&self) -> &'static str {
        "constant velocities in both directions"
    }

    fn source(&self) -> &'static str {
        include_str!("viscous_asymmetry.rs")
    }

    fn proposals(&self, context: &Context<'_>) -> Vec<Proposal> {
        // Beside the model's own slope, the change in one direction may be negative.
        (0..context.joints)
            .map(|j| Proposal::on_joint(j, json!({"model": "viscous_asymmetric", "joints": [j]}), vec![]))
            .collect()
    }

    fn parameters(&self, _proposal: &Proposal, fitted: &[FittedColumn]) -> Parameters {
        named(&["viscous_pos_nm_s", "viscous_neg_nm_s"], fitted)
    }

    fn parameters_beside(
        &self,
        _proposal: &Proposal,
        fitted: &[FittedColumn],
        own: &OwnFriction,
    ) -> Parameters {
        named(&["viscous_pos_nm_s", "viscous_neg_nm_s"], &raised(fitted, own.viscous_nm_s))
    }
}
