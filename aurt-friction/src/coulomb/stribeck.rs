//! `stribeck`: a Coulomb level that is higher near rest.
//!
//! # Equation
//! f_C(τ_J, q̇) = Σ_l (F_C,l + ΔF_S,l s(q̇)) |τ_J|^l, where l runs over {0} for `load = "none"`, {0, 1}
//! for `"absolute"` and {0, 2} for `"square"`, and s(q̇) = e^(−|q̇/v_S|^δ) for `law = "exponential"`,
//! 1/(1 + |q̇/v_S|^δ) for `"rational"`.
//!
//! # Parameters
//! | key | unit | meaning |
//! |---|---|---|
//! | `stribeck_velocity_rad_s` | rad/s | v_S, shape, 0.001–1, searched in logarithms; 0.05 unless given |
//! | `stribeck_exponent` | 1 | δ, shape, 0.5–3; 2 (Gaussian) unless given |
//! | `law` | – | `"exponential"` (default) or `"rational"` |
//! | `load` | – | `"none"` (default), `"absolute"` or `"square"` |
//! | `level` | – | `false`: without F_C,l, beside friction that has them; `true` unless given |
//!
//! # Columns
//! | name | unit | column |
//! |---|---|---|
//! | `F_C0` | Nm | 1 |
//! | `dF_S0` | Nm | s(q̇); the coefficient is the excess F_S − F_C of break-away over sliding |
//! | `F_C1` | 1 or 1/Nm | \|τ_J\| or τ_J², with `load` |
//! | `dF_S1` | 1 or 1/Nm | their product with s(q̇), with `load` |
//!
//! # Use when
//! Friction dips after break-away and the recording holds slow motion (below about 2 v_S) apart from reversals.
//! Near reversals alone, presliding (`maxwell_slip`) and a sign that the filter smeared look alike.
//!
//! # Source
//! Stribeck (1902); Bo and Pavelescu (1982), *The friction-speed relation and its influence on the critical
//! velocity of stick-slip motion*, for the exponent; Hess, Soom (1990), *Friction at a lubricated line contact operating at
//! oscillating sliding velocities*, J. Tribology, for the rational law; Armstrong-Hélouvry, Dupont, Canudas de Wit (1994), *A survey
//! of models, analysis tools and compensation methods for the control of machines with friction*.

use aurt_traits::{
    Columns, Invariant, Invariants, JointModel, JointSeries, Parameter, Result, register_model,
};
use serde::{Deserialize, Serialize};

pub use crate::stribeck_curve::StribeckLaw;
use crate::stribeck_curve::{Decay, STRIBECK_EXPONENT, STRIBECK_VELOCITY};

/// How a Stribeck level grows with the load.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LoadDependence {
    /// Not at all.
    #[default]
    None,
    /// In proportion to |τ_J|.
    Absolute,
    /// In proportion to τ_J².
    Square,
}

/// A Coulomb level with the Stribeck effect.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Stribeck {
    /// Stribeck velocity v_S in rad/s.
    pub stribeck_velocity_rad_s: f64,
    /// Exponent δ.
    pub stribeck_exponent: f64,
    /// The law by which the excess falls with speed.
    #[serde(skip_serializing_if = "is_exponential")]
    pub law: StribeckLaw,
    /// Load dependence of both levels.
    pub load: LoadDependence,
    /// Whether it has the levels F_C,l; without them it is the excess alone, beside friction that has them.
    #[serde(skip_serializing_if = "is_true")]
    pub level: bool,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "the signature that serde asks for")]
const fn is_true(level: &bool) -> bool {
    *level
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "the signature that serde asks for")]
fn is_exponential(law: &StribeckLaw) -> bool {
    *law == StribeckLaw::Exponential
}

impl Default for Stribeck {
    fn default() -> Self {
        Self {
            stribeck_velocity_rad_s: 0.05,
            stribeck_exponent: 2.0,
            law: StribeckLaw::Exponential,
            load: LoadDependence::None,
            level: true,
        }
    }
}

register_model! {
    slot: Coulomb,
    model: Stribeck,
    name: "stribeck",
    summary: "Coulomb level that is higher near rest, optionally with load dependence",
    equation: "f_C = Σ_l (F_C,l + dF_S,l s(q̇)) |τ_J|^l, l = 0 and that of `load`; s = exp(−|q̇/v_S|^δ) or 1/(1 + |q̇/v_S|^δ)",
    use_when: "friction dips after break-away and the recording holds slow motion apart from reversals",
    source: "Stribeck (1902); Bo and Pavelescu (1982); Armstrong-Hélouvry, Dupont, Canudas de Wit (1994)",
    example: r#"{ model = "stribeck", stribeck_velocity_rad_s = 0.05, stribeck_exponent = 2.0, load = "absolute" }"#,
}

impl JointModel for Stribeck {
    declares! {
        shape: [stribeck_velocity_rad_s in STRIBECK_VELOCITY, stribeck_exponent in STRIBECK_EXPONENT],
        validate: within_bounds,
    }

    fn columns(&self) -> Vec<Parameter> {
        let mut columns = vec![Parameter::new("F_C0", "Nm"), Parameter::new("dF_S0", "Nm")];
        let unit = match self.load {
            LoadDependence::None => None,
            LoadDependence::Absolute => Some("1"),
            LoadDependence::Square => Some("1/Nm"),
        };
        columns.extend(unit.into_iter().flat_map(|unit| ["F_C1", "dF_S1"].map(|n| Parameter::new(n, unit))));
        columns.retain(|column| self.level || column.name.starts_with('d'));
        columns
    }

    fn invariants(&self) -> Invariants {
        Invariants::of(&[
            Invariant::EvenInLoad,
            Invariant::Positive,
            Invariant::ContinuousInVelocity,
            Invariant::Memoryless,
        ])
        .with(Invariant::BoundedByOne, self.load == LoadDependence::None)
    }

    fn evaluate(&self, series: &JointSeries<'_>, _state: &mut [f64], out: &mut Columns<'_>) -> Result {
        let (velocity_rad_s, exponent) = (self.stribeck_velocity_rad_s, self.stribeck_exponent);
        let decay = Decay { law: self.law, velocity_rad_s, exponent };
        // Of a level and its excess, the place of the excess.
        let excess = usize::from(self.level);
        if self.level {
            out.column_mut(0).fill(1.0);
        }
        for (o, v) in out.column_mut(excess).iter_mut().zip(series.velocity_rad_s) {
            *o = decay.at(*v);
        }
        let growth = match self.load {
            LoadDependence::None => return Ok(()),
            LoadDependence::Absolute => f64::abs,
            LoadDependence::Square => |load: f64| load * load,
        };
        let (samples, (data, stride)) = (out.samples(), out.raw_mut());
        let (near, far) = data.split_at_mut((excess + 1) * stride);
        for n in 0..samples {
            let level = growth(series.load_torque[n]);
            far[n] = level;
            far[excess * stride + n] = level * near[excess * stride + n];
        }
        Ok(())
    }
}
