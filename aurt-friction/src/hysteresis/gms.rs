//! `gms`: Maxwell-slip elements whose level falls with velocity while they slip.
//!
//! # Equation
//! With ξ_i = F_i/W_i, the force of element i relative to its break-away level, s = sgn q̇ and
//! g(q̇) = r + (1 − r) e^(−|q̇/v_S|^δ), r = F_C/F_S:
//!
//! - stick: dξ_i/dt = q̇/Δ_i, until s ξ_i ≥ g(q̇);
//! - slip: dξ_i/dt = s C (1 − s ξ_i/g(q̇)), until velocity changes its sign or vanishes.
//!
//! Friction is Σ_i W_i ξ_i, linear in the break-away levels W_i. C is the attraction rate of the original model,
//! divided by the break-away level. With r = 1 this is `maxwell_slip`.
//!
//! Between two samples velocity is taken as constant (displacement over duration), and then both modes and the
//! instant of the transition between them are exact.
//!
//! # Parameters
//! | key | unit | meaning |
//! |---|---|---|
//! | `thresholds_rad` or `elements`, `smallest_rad`, `largest_rad` | rad, – | the Δ_i, as for `maxwell_slip` |
//! | `stribeck_velocity_rad_s` | rad/s | v_S, shape, 0.001–1, searched in logarithms; 0.05 unless given |
//! | `coulomb_ratio` | 1 | r, shape, 0.05–1; 0.8 unless given |
//! | `attraction_per_s` | 1/s | C, shape, 1–1000, searched in logarithms; 100 unless given |
//! | `stribeck_exponent` | 1 | δ, 0.5–3, not searched for; 2 unless given |
//!
//! # Columns
//! | name | unit | column |
//! |---|---|---|
//! | `m0`, `m1`, … | 1 | ξ_i, by ascending threshold |
//!
//! Multiplied by the Coulomb columns of `absolute` (1 and |τ_J|) these are the columns of the load-dependent
//! generalised Maxwell-slip model after Madsen et al. (2021): Σ_i (F_i + G_i |τ_J|) ξ_i, break-away and sliding
//! levels that grow with the load at fixed presliding distances. With the Coulomb model `constant`: the model of 2003.
//!
//! # State
//! Time and position of the previous sample; for each element ξ_i and the direction in which it slips (0: it
//! sticks). All elements start relaxed and sticking.
//!
//! # Use when
//! `maxwell_slip` leaves a dip after break-away in the residual, and the sampling resolves it.
//!
//! # Source
//! Lampaert, Al-Bender, Swevers (2003), *A generalized Maxwell-slip friction model appropriate for control
//! purposes*; Al-Bender, Lampaert, Swevers (2005); Madsen, Rosenlund, Brandt, Zhang (2021), *Adaptive feedforward
//! control of a collaborative industrial robot manipulator using a novel extension of the Generalized Maxwell-Slip
//! friction model*.
//!
//! # Invariants
//! Bounded by one, odd, continuous. Passivity is not declared: an element that slips into rest gains force
//! without a displacement that would pay for it.

use aurt_traits::{Columns, JointModel, JointSeries, ModelError, Parameter, Result, register_model};
use serde::{Deserialize, Serialize};

use crate::path_step::PathStep;
use crate::shape::{Shape, out_of_bounds, verdict};
use crate::stribeck_curve::{COULOMB_RATIO, Decay, STRIBECK_EXPONENT, STRIBECK_VELOCITY, StribeckCurve};
use crate::thresholds::Thresholds;

const ATTRACTION: Shape = Shape::logarithmic("attraction_per_s", "1/s", 1.0, 1e3);

/// Generalised Maxwell-slip elements.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Gms {
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
    /// Stribeck velocity v_S in rad/s.
    pub stribeck_velocity_rad_s: f64,
    /// Ratio r = F_C/F_S of sliding to break-away.
    pub coulomb_ratio: f64,
    /// Attraction rate C in 1/s.
    pub attraction_per_s: f64,
    /// Stribeck exponent δ.
    pub stribeck_exponent: f64,
}

impl Default for Gms {
    fn default() -> Self {
        Self {
            thresholds_rad: None,
            elements: None,
            smallest_rad: None,
            largest_rad: None,
            stribeck_velocity_rad_s: 0.05,
            coulomb_ratio: 0.8,
            attraction_per_s: 100.0,
            stribeck_exponent: 2.0,
        }
    }
}

impl Gms {
    fn thresholds(&self) -> Thresholds<'_> {
        Thresholds {
            list_rad: self.thresholds_rad.as_deref(),
            elements: self.elements,
            smallest_rad: self.smallest_rad,
            largest_rad: self.largest_rad,
        }
    }

    const fn curve(&self) -> StribeckCurve {
        StribeckCurve {
            coulomb_ratio: self.coulomb_ratio,
            decay: Decay::exponential(self.stribeck_velocity_rad_s, self.stribeck_exponent),
        }
    }

    /// Moves one element, its relative force and slip direction, over a step whose level is `level`.
    #[inline]
    fn move_element(&self, [force, slip]: &mut [f64; 2], threshold: f64, step: PathStep, level: f64) {
        let distance = step.displacement_rad.abs();
        if distance == 0.0 {
            *slip = 0.0;
            return;
        }
        let direction = step.displacement_rad.signum();
        let mut along = *force * direction;
        let mut slipping_s = step.duration_s;
        if *slip != direction {
            let to_slip = (level - along) * threshold;
            if to_slip >= distance {
                *force = (along + distance / threshold) * direction;
                *slip = 0.0;
                return;
            }
            if to_slip > 0.0 {
                along = level;
                slipping_s *= 1.0 - to_slip / distance;
            }
            *slip = direction;
        }
        // At the level already, as always without velocity weakening, nothing is left to relax.
        if along != level {
            along = level + (along - level) * libm::exp(-slipping_s * self.attraction_per_s / level);
        }
        *force = along.clamp(-1.0, 1.0) * direction;
    }
}

register_model! {
    slot: Hysteresis,
    model: Gms,
    name: "gms",
    summary: "generalised Maxwell-slip: elements whose level falls with velocity while they slip",
    equation: "stick: dξ_i/dt = q̇/Δ_i until s ξ_i ≥ g(q̇); slip: dξ_i/dt = s C (1 − s ξ_i/g(q̇)); s = sgn q̇, \
               g = r + (1 − r) exp(−|q̇/v_S|^δ), C = attraction_per_s, r = coulomb_ratio",
    use_when: "`maxwell_slip` leaves a dip after break-away; with coulomb `absolute` the load-dependent GMS",
    source: "Lampaert, Al-Bender, Swevers (2003); Madsen, Rosenlund, Brandt, Zhang (2021)",
    example: r#"{ model = "gms", elements = 5, smallest_rad = 0.0005, largest_rad = 0.12, stribeck_velocity_rad_s = 0.05, coulomb_ratio = 0.8, attraction_per_s = 100.0, stribeck_exponent = 2.0 }"#,
}

impl JointModel for Gms {
    declares! {
        invariants: [BoundedByOne, OddInVelocity, ContinuousInVelocity],
        reads_load: false,
        shape: [stribeck_velocity_rad_s in STRIBECK_VELOCITY, coulomb_ratio in COULOMB_RATIO, attraction_per_s in ATTRACTION],
    }

    fn columns(&self) -> Vec<Parameter> {
        (0..self.thresholds().len()).map(|i| Parameter::new(format!("m{i}"), "1")).collect()
    }

    fn validate(&self) -> Result<(), Vec<ModelError>> {
        let mut complaints = self.thresholds().complaints(Self::NAME, false);
        let mut bounded = self.shape_parameters();
        bounded.push(STRIBECK_EXPONENT.at(self.stribeck_exponent));
        complaints.extend(out_of_bounds(Self::NAME, &bounded));
        verdict(complaints)
    }

    fn state_len(&self) -> usize {
        2 + 2 * self.thresholds().len()
    }

    fn initial_state(&self, first: &JointSeries<'_>) -> Vec<f64> {
        let mut state = vec![0.0; self.state_len()];
        state[0] = first.time_s[0];
        state[1] = first.position_rad[0];
        state
    }

    fn evaluate(&self, series: &JointSeries<'_>, state: &mut [f64], out: &mut Columns<'_>) -> Result {
        let thresholds = self.thresholds().values();
        let curve = self.curve();
        let (mut time, mut position) = (state[0], state[1]);
        let elements = state[2..].as_chunks_mut::<2>().0;
        let (samples, (data, stride)) = (out.samples(), out.raw_mut());
        for n in 0..samples {
            let sample = (series.time_s[n], series.position_rad[n], series.velocity_rad_s[n]);
            let step = PathStep::advance(&mut time, &mut position, sample);
            let level = curve.level(step.velocity_rad_s);
            for (i, (element, threshold)) in elements.iter_mut().zip(&thresholds).enumerate() {
                self.move_element(element, *threshold, step, level);
                data[i * stride + n] = element[0];
            }
        }
        (state[0], state[1]) = (time, position);
        Ok(())
    }
}
