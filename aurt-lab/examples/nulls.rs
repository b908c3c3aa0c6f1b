//! Table of what a fit of the true structure leaves on robots without any concealed effect, against the
//! injected noise as it propagates through the chain:
//! `cargo run --release -p aurt-lab --example nulls [f_dyn in Hz]`.
//!
//! The structure is fitted to four noisy recordings at once (two multi-sines, triangles rich in reversals, sweeps)
//! and to nothing else. Propagated noise is what the same recordings without noise do not leave: current noise,
//! and encoder noise and steps through q, q̇, sgn q̇ and q̈.

use aurt_lab::fit::processed_motion;
use aurt_recording::Preprocessed;
use aurt_simulation::inject::{OwnModel, Structure, StructureColumns};
use aurt_simulation::sensors::Instrument;
use aurt_simulation::{Motion, Robot, Rotors, Scenario, SimulationError, simulate};

const DURATION_S: f64 = 40.0;

fn motions() -> [(&'static str, Motion, u64); 4] {
    let duration_s = DURATION_S;
    let sines = Motion::MultiSine { duration_s, harmonics: 10, top_hz: 1.0, share: 0.7 };
    [
        ("multi-sine", sines.clone(), 1),
        ("multi-sine", sines, 2),
        ("triangles", Motion::Triangles { duration_s, speed_rad_s: 0.12, amplitude_rad: 0.4 }, 3),
        ("sweeps", Motion::Sweeps { duration_s, share: 0.6 }, 4),
    ]
}

fn main() -> Result<(), SimulationError> {
    let f_dyn_hz = std::env::args().nth(1).and_then(|text| text.parse().ok()).unwrap_or(10.0);
    println!(
        "f_dyn {f_dyn_hz} Hz\nrobot     rotors    motion       residual over propagated noise, per joint | \
         artefacts over it"
    );
    for robot in Robot::all() {
        for rotors in [Rotors::Geared, Rotors::InLinks] {
            null(&robot.clone().with_rotors(rotors), rotors, f_dyn_hz)?;
        }
    }
    Ok(())
}

fn rms(v: impl Iterator<Item = f64>) -> f64 {
    let (sum, n) = v.fold((0.0, 0.0), |(s, n), x| (s + x * x, n + 1.0));
    (sum / n).sqrt()
}

fn null(robot: &Robot, rotors: Rotors, f_dyn_hz: f64) -> Result<(), SimulationError> {
    let (mut noisy, mut clean) = (Vec::new(), Vec::new());
    for (_, motion, seed) in motions() {
        let mut scenario = Scenario::new(robot.clone(), motion.plan(robot, seed)?, seed);
        noisy.push(processed_motion(&simulate(&scenario)?, robot, f_dyn_hz)?);
        scenario.instrument = Some(Instrument::ideal(robot));
        scenario.logger.position_decimals = 12;
        scenario.logger.measurement_decimals = 12;
        clean.push(processed_motion(&simulate(&scenario)?, robot, f_dyn_hz)?);
    }
    let columns = StructureColumns::of_robot(robot, &Structure::of(robot))?;
    let fit = OwnModel::of_columns(columns, &noisy.iter().collect::<Vec<&Preprocessed>>())?;
    for (((name, ..), noisy), clean) in motions().iter().zip(&noisy).zip(&clean) {
        let (left, undisturbed) = (fit.residuals(noisy)?, fit.residuals(clean)?);
        let ratios: Vec<[f64; 2]> = left
            .iter()
            .zip(&undisturbed)
            .map(|(left, undisturbed)| {
                let noise = rms(left.iter().zip(undisturbed).map(|(a, b)| a - b));
                [rms(left.iter().copied()) / noise, rms(undisturbed.iter().copied()) / noise]
            })
            .collect();
        let show = |k: usize| ratios.iter().map(|r| format!("{:5.2}", r[k])).collect::<Vec<_>>().join(" ");
        println!("{:9} {:8} {name:12} {} | {}", robot.name, format!("{rotors:?}"), show(0), show(1));
    }
    Ok(())
}
