//! Table of what a fit of the true structure leaves on robots without any concealed effect, against the
//! injected noise as it propagates through the chain: `cargo run --release -p aurt-simulation --example nulls`.

use aurt_simulation::fit::{ProcessedFit, Structure, processed_motion};
use aurt_simulation::sensors::Instrument;
use aurt_simulation::{Motion, Robot, Rotors, Scenario, SimulationError, simulate};

fn main() -> Result<(), SimulationError> {
    println!(
        "robot     rotors    f_dyn  per joint: residual over propagated noise | noise-free residual over it"
    );
    for robot in Robot::all() {
        for rotors in [Rotors::Geared, Rotors::InLinks] {
            for f_dyn_hz in [5.0, 10.0, 20.0] {
                let robot = robot.clone().with_rotors(rotors);
                let (ratio, artefact) = null(&robot, f_dyn_hz, 40.0, 1)?;
                let show = |v: &[f64]| v.iter().map(|r| format!("{r:5.2}")).collect::<Vec<_>>().join(" ");
                println!(
                    "{:9} {rotors:8?} {f_dyn_hz:5.1}   {} | {}",
                    robot.name,
                    show(&ratio),
                    show(&artefact)
                );
            }
        }
    }
    Ok(())
}

fn rms(v: impl Iterator<Item = f64>) -> f64 {
    let (sum, n) = v.fold((0.0, 0.0), |(s, n), x| (s + x * x, n + 1.0));
    (sum / n).sqrt()
}

fn null(
    robot: &Robot,
    f_dyn_hz: f64,
    duration_s: f64,
    seed: u64,
) -> Result<(Vec<f64>, Vec<f64>), SimulationError> {
    let structure = Structure::of(robot);
    let mut noisy = Vec::new();
    let mut clean = Vec::new();
    for k in 0..2 {
        let motion = Motion::MultiSine { duration_s, harmonics: 10, top_hz: 1.0, share: 0.7 };
        let mut scenario = Scenario::new(robot.clone(), motion.plan(robot, seed + k)?, seed + k);
        noisy.push(processed_motion(&simulate(&scenario)?, robot, f_dyn_hz)?);
        scenario.instrument = Some(Instrument::ideal(robot));
        scenario.logger.position_decimals = 12;
        scenario.logger.measurement_decimals = 12;
        clean.push(processed_motion(&simulate(&scenario)?, robot, f_dyn_hz)?);
    }
    let fit = ProcessedFit::new(robot, &structure, &noisy.iter().collect::<Vec<_>>())?;
    let (mut left, mut undisturbed) = (vec![Vec::new(); robot.joints()], vec![Vec::new(); robot.joints()]);
    for (n, c) in noisy.iter().zip(&clean) {
        for (all, r) in left.iter_mut().zip(fit.residuals(n)?) {
            all.extend(r);
        }
        for (all, r) in undisturbed.iter_mut().zip(fit.residuals(c)?) {
            all.extend(r);
        }
    }
    Ok((0..robot.joints())
        .map(|j| {
            let noise = rms(left[j].iter().zip(&undisturbed[j]).map(|(a, b)| a - b));
            (rms(left[j].iter().copied()) / noise, rms(undisturbed[j].iter().copied()) / noise)
        })
        .unzip())
}
