//! A link on its gear, driven by the measured motion of its motor.
//!
//! With the encoder at the motor, the link's angle is θ + x. What the gear transmits moves the link,
//! M_jj ẍ + F(x, ẋ) + (∂g_j/∂q_j) x = −τ_j, to first order in x, with the torque τ_j that the rigid model needs for the
//! motor's motion and, for a gear of stiffness K and damping D whose flanks stand ± b apart,
//! F = K (x ∓ b) + D ẋ in touch with a flank, 0 between them. The drives of all joints i then feel
//! M_ij ẍ + (∂g_i/∂q_j) x beside the rigid model's torque. With b = 0 it is an elastic gear: for a small motion
//! M e_j [ω²/(s² + 2ζωs + ω²) − 1] q̈ (M. W. Spong 1987). Gravity and the couplings act on the link's own angle, so it holds
//! for a resonance within the band of the motion, too.

/// What lies between motor and link.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Gear {
    pub stiffness_nm_rad: f64,
    pub damping_nm_s: f64,
    /// Half the play; 0 for a gear without.
    pub half_gap_rad: f64,
    /// Inertia of the rotor that a fit has put into M_jj: it moves with the motor, not with the link.
    pub rotor_kg_m2: f64,
}

/// What drives a link, row after row.
pub(super) struct Drive<'a> {
    pub period_s: f64,
    /// τ_j.
    pub load_nm: &'a [f64],
    /// M_jj.
    pub inertia_kg_m2: &'a [f64],
    /// ∂g_j/∂q_j.
    pub gradient_nm_rad: &'a [f64],
}

/// How a link moves against its motor, row after row.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Deflection {
    pub angle_rad: Vec<f64>,
    pub acceleration_rad_s2: Vec<f64>,
}

/// Steps of the integration are at most this share of 1/ω: the trapezoidal rule then errs by (ωh)²/12 = 0.5 % in frequency.
const STEP_SHARE: f64 = 0.25;
/// With play, impacts are within a step; shorter ones keep their instant.
const STEP_SHARE_IN_PLAY: f64 = 0.2;
/// More steps a row are not needed where rows resolve the resonance.
const MOST_STEPS: usize = 24;

impl Gear {
    /// Simulates the link by the trapezoidal rule from the twist that bears the first load at rest.
    /// Rows of a gear with play are means over the row's period, since impacts are shorter than that.
    pub fn deflection(self, drive: &Drive<'_>) -> Deflection {
        if self.half_gap_rad > 0.0 { self.simulated::<true>(drive) } else { self.simulated::<false>(drive) }
    }

    fn simulated<const PLAY: bool>(self, drive: &Drive<'_>) -> Deflection {
        let rows = drive.load_nm.len();
        let mut out =
            Deflection { angle_rad: Vec::with_capacity(rows), acceleration_rad_s2: Vec::with_capacity(rows) };
        let Some(first) = drive.load_nm.first() else { return out };
        let lightest = drive.inertia_kg_m2.iter().copied().fold(f64::INFINITY, f64::min);
        let omega = (self.stiffness_nm_rad / lightest.max(f64::MIN_POSITIVE)).sqrt();
        let share = if PLAY { STEP_SHARE_IN_PLAY } else { STEP_SHARE };
        let steps = ((omega * drive.period_s / share).ceil() as usize).clamp(1, MOST_STEPS);
        let h = drive.period_s / steps as f64;
        let mut x = -first / self.stiffness_nm_rad - self.half_gap_rad * first.signum();
        let (mut v, mut a) = (0.0_f64, 0.0_f64);
        for row in 0..rows {
            // The row's value is at its instant; with play, the mean over the steps that lead there.
            let (mut mean_x, mut mean_a) = (0.0, 0.0);
            let (inertia, gradient) = (drive.inertia_kg_m2[row], drive.gradient_nm_rad[row]);
            let (from, to) = (drive.load_nm[row.saturating_sub(1)], drive.load_nm[row]);
            let count = if row == 0 { 1 } else { steps };
            let free = (inertia + 0.25 * h * h * gradient).recip();
            let touching =
                (inertia + 0.5 * h * self.damping_nm_s + 0.25 * h * h * (self.stiffness_nm_rad + gradient))
                    .recip();
            for step in 1..=count {
                let load = if row == 0 { to } else { from + (to - from) * step as f64 / steps as f64 };
                if row > 0 {
                    let ahead = x + h * (v + 0.5 * h * a);
                    let pressed = ahead - ahead.clamp(-self.half_gap_rad, self.half_gap_rad);
                    let mut touches = !PLAY || pressed != 0.0;
                    if PLAY && touches {
                        // Flanks push; they do not pull when they part.
                        let push = self.stiffness_nm_rad * pressed + self.damping_nm_s * (v + h * a);
                        touches = push * pressed > 0.0;
                    }
                    let (k, d, rest, mobility) = if touches {
                        let rest = if PLAY { self.half_gap_rad * pressed.signum() } else { 0.0 };
                        (self.stiffness_nm_rad, self.damping_nm_s, rest, touching)
                    } else {
                        (0.0, 0.0, 0.0, free)
                    };
                    let next = (-load + k * rest
                        - d * (v + 0.5 * h * a)
                        - (k + gradient) * (x + h * v + 0.25 * h * h * a))
                        * mobility;
                    x += h * v + 0.25 * h * h * (a + next);
                    v += 0.5 * h * (a + next);
                    a = next;
                }
                mean_x += x;
                mean_a += a;
            }
            out.angle_rad.push(if PLAY { mean_x / count as f64 } else { x });
            out.acceleration_rad_s2.push(if PLAY { mean_a / count as f64 } else { a });
        }
        if PLAY {
            // The mean of what leads to a row and what leads on from it is centred on the row.
            for series in [&mut out.angle_rad, &mut out.acceleration_rad_s2] {
                for k in 1..series.len() {
                    series[k - 1] = 0.5 * (series[k - 1] + series[k]);
                }
            }
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PERIOD_S: f64 = 5e-3;

    fn driven(gear: Gear, load: &[f64]) -> Deflection {
        let (inertia, gradient) = (vec![2.0; load.len()], vec![0.0; load.len()]);
        gear.deflection(&Drive {
            period_s: PERIOD_S,
            load_nm: load,
            inertia_kg_m2: &inertia,
            gradient_nm_rad: &gradient,
        })
    }

    /// x of M ẍ + D ẋ + K x = −τ̂ sin(ωt) in its steady state.
    #[test]
    fn an_elastic_link_answers_a_sine_as_a_resonator_does() {
        let gear = Gear { stiffness_nm_rad: 7900.0, damping_nm_s: 20.0, half_gap_rad: 0.0, rotor_kg_m2: 0.0 };
        for hz in [2.0, 8.0, 10.0, 14.0] {
            let omega = std::f64::consts::TAU * hz;
            let load: Vec<f64> = (0..4000).map(|k| 30.0 * (omega * k as f64 * PERIOD_S).sin()).collect();
            let found = driven(gear, &load);
            let peak = found.angle_rad[3000..].iter().fold(0.0_f64, |m, x| m.max(x.abs()));
            let (real, imaginary) = (7900.0 - 2.0 * omega * omega, 20.0 * omega);
            let expected = 30.0 / real.hypot(imaginary);
            assert!((peak / expected - 1.0).abs() < 0.05, "{hz} Hz: {peak}, {expected}");
        }
    }

    #[test]
    fn a_link_crosses_the_gap_once_when_its_load_changes_sides() {
        let gear = Gear { stiffness_nm_rad: 5e4, damping_nm_s: 150.0, half_gap_rad: 0.002, rotor_kg_m2: 0.0 };
        let load: Vec<f64> = (0..400).map(|k| (k as f64 - 200.0) * 0.2).collect();
        let found = driven(gear, &load);
        assert!((found.angle_rad[100] - (0.002 + 20.0 / 5e4)).abs() < 2e-4, "{}", found.angle_rad[100]);
        assert!((found.angle_rad[390] + (0.002 + 38.0 / 5e4)).abs() < 2e-4, "{}", found.angle_rad[390]);
        // Free of its load, the link accelerates by −τ/M: until it strikes, the torque of the rigid model is missing.
        let missing = found.acceleration_rad_s2[206] * 2.0 + load[206];
        assert!(missing.abs() < 0.5, "{missing}");
    }

    #[test]
    fn no_load_moves_nothing() {
        let gear = Gear { stiffness_nm_rad: 5e4, damping_nm_s: 150.0, half_gap_rad: 0.0, rotor_kg_m2: 0.0 };
        assert!(driven(gear, &[0.0; 50]).angle_rad.iter().all(|x| *x == 0.0));
        assert!(driven(gear, &[]).angle_rad.is_empty());
    }
}
