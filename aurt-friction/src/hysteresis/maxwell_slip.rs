//! `maxwell_slip`: parallel elements, each a spring that slips at a threshold of its own.
//!
//! # Equation
//! H_i = clamp((q − a_i)/Δ_i, −1, 1), where the anchor a_i follows q at the distance Δ_i once the element slips.
//! Friction is Σ_i W_i H_i: linear in the levels W_i, whose sum is the level of full sliding. The stiffness at a
//! reversal is Σ_i W_i/Δ_i.
//!
//! # Parameters
//! | key | unit | meaning |
//! |---|---|---|
//! | `thresholds_rad` | rad | the Δ_i, ascending; or, instead, a grid with constant ratio: |
//! | `elements` | – | number of elements; 5 unless given |
//! | `smallest_rad` | rad | first threshold of the grid; 0.0005 unless given |
//! | `largest_rad` | rad | last threshold of the grid; 0.12 unless given |
//! | `fit_thresholds` | – | whether the grid's ends are shape parameters (10⁻⁵–0.005 and 0.01–1 rad, searched in logarithms); false unless given |
//!
//! # Columns
//! | name | unit | column |
//! |---|---|---|
//! | `m0`, `m1`, … | 1 | H_i, by ascending threshold |
//!
//! In equation (6) each is multiplied by each Coulomb column. `constant` × `maxwell_slip` is the plain model
//! (coefficients W_i). `absolute` × `maxwell_slip` has the columns H_i and |τ_J| H_i, levels that grow with the
//! load, W_i = F_i + G_i |τ_J|: the load-dependent generalised Maxwell-slip model after Madsen et al. (2021)
//! without velocity weakening, which `gms` adds. Physics asks for W_i ≥ 0; least squares does not enforce it.
//!
//! # State
//! The anchors; they lie at the first position of a series, so that all elements start relaxed. Only positions
//! enter; along the sampled path the evaluation is exact.
//!
//! # Use when
//! Recordings are rich in reversals: friction of geared joints builds up over 10⁻³–10⁻¹ rad. A first choice,
//! since it is linear in all its coefficients and keeps the nonlocal memory of inner loops. The largest threshold
//! should be smaller than the motions in the recording, or its element is a spring.
//!
//! # Source
//! Iwan (1966), *A distributed-element model for hysteresis and its steady-state dynamic response*; Lampaert,
//! Al-Bender, Swevers (2003), *A generalized Maxwell-slip friction model appropriate for control purposes*.

use aurt_traits::{
    Columns, JointModel, JointSeries, ModelError, Parameter, Result, ShapeParameter, register_model,
};
use serde::{Deserialize, Serialize};

use crate::shape::{accepted, verdict};
use crate::thresholds::Thresholds;

/// Parallel Maxwell-slip elements.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct MaxwellSlip {
    /// Thresholds Δ_i in rad, ascending; excludes the keys of a grid.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub thresholds_rad: Option<Vec<f64>>,
    /// Number of elements of a grid.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub elements: Option<usize>,
    /// First threshold of a grid in rad.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub smallest_rad: Option<f64>,
    /// Last threshold of a grid in rad.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub largest_rad: Option<f64>,
    /// Whether the ends of the grid are shape parameters.
    pub fit_thresholds: bool,
}

impl MaxwellSlip {
    fn thresholds(&self) -> Thresholds<'_> {
        Thresholds {
            list_rad: self.thresholds_rad.as_deref(),
            elements: self.elements,
            smallest_rad: self.smallest_rad,
            largest_rad: self.largest_rad,
        }
    }
}

register_model! {
    slot: Hysteresis,
    model: MaxwellSlip,
    name: "maxwell_slip",
    summary: "parallel elements that slip at thresholds on a grid; linear in their levels",
    equation: "H_i = clamp((q − a_i)/Δ_i, −1, 1), the anchor a_i dragged along when the element slips",
    use_when: "recordings rich in reversals; the first choice for presliding",
    source: "Iwan (1966); Lampaert, Al-Bender, Swevers (2003); with load-dependent levels Madsen et al. (2021)",
    example: r#"{ model = "maxwell_slip", elements = 5, smallest_rad = 0.0005, largest_rad = 0.12 }"#,
}

impl JointModel for MaxwellSlip {
    declares! {
        invariants: [BoundedByOne, OddInVelocity, ContinuousInVelocity, Passive, RateIndependent],
        reads_load: false,
    }

    fn columns(&self) -> Vec<Parameter> {
        (0..self.thresholds().len()).map(|i| Parameter::new(format!("m{i}"), "1")).collect()
    }

    fn shape_parameters(&self) -> Vec<ShapeParameter> {
        if self.fit_thresholds { self.thresholds().shape_parameters() } else { Vec::new() }
    }

    fn set_shape(&mut self, values: &[f64]) -> Result<(), ModelError> {
        if let [smallest, largest] = accepted(Self::NAME, &self.shape_parameters(), values)?[..] {
            self.smallest_rad = Some(smallest);
            self.largest_rad = Some(largest);
        }
        Ok(())
    }

    fn validate(&self) -> Result<(), Vec<ModelError>> {
        verdict(self.thresholds().complaints(Self::NAME, self.fit_thresholds))
    }

    fn state_len(&self) -> usize {
        self.thresholds().len()
    }

    fn initial_state(&self, first: &JointSeries<'_>) -> Vec<f64> {
        vec![first.position_rad[0]; self.state_len()]
    }

    fn evaluate(&self, series: &JointSeries<'_>, state: &mut [f64], out: &mut Columns<'_>) -> Result {
        for (i, (threshold, anchor)) in self.thresholds().values().into_iter().zip(state).enumerate() {
            let mut a = *anchor;
            for (o, q) in out.column_mut(i).iter_mut().zip(series.position_rad) {
                // Limiting the anchor itself, and not an accumulated deflection, makes inner loops close exactly.
                a = a.max(q - threshold).min(q + threshold);
                *o = ((q - a) / threshold).clamp(-1.0, 1.0);
            }
            *anchor = a;
        }
        Ok(())
    }
}
