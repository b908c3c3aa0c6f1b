//! How much noise a laboratory's filter lets through, as the white noise that effects are measured in.

use std::f64::consts::{FRAC_2_PI, TAU};

use aurt_rbd::ChainDynamics;

use aurt_simulation::SimulationError;
use aurt_simulation::robots::Robot;
use aurt_simulation::sensors::Instrument;

/// Band of the parallel filter over `f_dyn_hz`.
pub(super) const BAND_PER_F_DYN: f64 = 2.0;
/// Rate and filter band of the clean world, Hz: 500 rows per second, twice 10 Hz.
const CLEAN: (f64, f64) = (500.0, 20.0);

/// For each joint the standard deviation σ of that white noise which, sampled at 500 Hz and filtered at 20 Hz as in the
/// clean world, leaves as much as this laboratory's noise leaves behind its own filter, Nm. An effect of a given size
/// over σ stands out of the filtered noise as far here as there.
///
/// With the band B = 2 f_dyn, rows at f_s, and an ideal low-pass for the filter's steep one, the parts are
/// - white current noise: σ_w² · 2B/f_s;
/// - current noise with memory T: σ_c² · (2/π) atan(2π B T);
/// - positions: encoder noise and steps, s² = σ_q² + Δ²/12, taken as white, give q̈ the variance
///   (2 s²/f_s)(2π)⁴ B⁵/5 and q̇ (2 s²/f_s)(2π)² B³/3, and each joint j Σ_k M_jk² var q̈_k + F_v² var q̇_j with the mass
///   matrix M at home.
pub(super) fn equivalent_nm(
    robot: &Robot,
    instrument: &Instrument,
    rate_hz: f64,
    f_dyn_hz: f64,
) -> Result<Vec<f64>, SimulationError> {
    let n = robot.joints();
    let band_hz = BAND_PER_F_DYN * f_dyn_hz;
    let rotors: Vec<f64> = robot.drives.iter().map(|d| d.rotor_inertia_kg_m2).collect();
    let home: Vec<f64> = robot.drives.iter().map(|d| d.home_rad).collect();
    let mut mass = vec![0.0; n * n];
    ChainDynamics::new(robot.chain()?, &robot.standard_parameters())?
        .with_rotor_inertia(&rotors)?
        .mass_matrix(&home, &mut mass);
    let density: Vec<f64> = instrument
        .channels
        .iter()
        .map(|c| 2.0 * (c.encoder_noise_rad.powi(2) + c.encoder_resolution_rad.powi(2) / 12.0) / rate_hz)
        .collect();
    let share = 2.0 * CLEAN.1 / CLEAN.0;
    Ok((0..n)
        .map(|j| {
            let channel = &instrument.channels[j];
            let white = channel.torque_noise_nm.powi(2) * 2.0 * band_hz / rate_hz;
            let corner = libm::atan(TAU * band_hz * channel.memory.time_constant_s);
            let coloured = channel.memory.deviation_nm.powi(2) * FRAC_2_PI * corner;
            let acceleration: f64 = (0..n)
                .map(|k| mass[j * n + k].powi(2) * density[k] * TAU.powi(4) * band_hz.powi(5) / 5.0)
                .sum();
            let velocity =
                robot.drives[j].viscous_nm_s.powi(2) * density[j] * TAU.powi(2) * band_hz.powi(3) / 3.0;
            ((white + coloured + acceleration + velocity) / share).sqrt()
        })
        .collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use aurt_simulation::robots;

    /// In the clean world a robot's noise is that of its currents, and nearly nothing of its encoders.
    #[test]
    fn clean_noise_is_its_own_measure() {
        for robot in Robot::all() {
            let mut instrument = Instrument::of(&robot);
            for channel in &mut instrument.channels {
                (channel.encoder_noise_rad, channel.encoder_resolution_rad) = (0.0, 0.0);
            }
            let noise = equivalent_nm(&robot, &instrument, 500.0, 10.0).unwrap();
            for (found, drive) in noise.iter().zip(&robot.drives) {
                assert!((found / drive.torque_noise_nm - 1.0).abs() < 1e-12, "{found}");
            }
        }
    }

    /// Encoder noise grows with the band's power 5/2, and noise with a long memory passes whole.
    #[test]
    fn each_part_grows_as_it_should() {
        let robot = robots::ur10e();
        let mut instrument = Instrument::of(&robot);
        for channel in &mut instrument.channels {
            (channel.encoder_noise_rad, channel.encoder_resolution_rad) = (1e-3, 0.0);
            channel.torque_noise_nm = 0.0;
        }
        let at = |f_dyn_hz| equivalent_nm(&robot, &instrument, 500.0, f_dyn_hz).unwrap()[1];
        assert!((at(10.0) / at(5.0) - 2.0_f64.powf(2.5)).abs() < 0.01);
        for channel in &mut instrument.channels {
            channel.encoder_noise_rad = 0.0;
            channel.memory.deviation_nm = 1.0;
            channel.memory.time_constant_s = 100.0;
        }
        let whole = equivalent_nm(&robot, &instrument, 500.0, 10.0).unwrap()[0];
        assert!((whole * 0.08_f64.sqrt() - 1.0).abs() < 1e-3);
    }
}
