//! Draws the pictures of docs/simulation.md:
//! `cargo run --release -p aurt-simulation --example pictures [folder]`.

mod experiments;
mod plot;

use aurt_simulation::SimulationError;
use aurt_simulation::plant::Bristle;
use aurt_simulation::plant::bristles::{Gms, LuGre, Masing};

use experiments::{along, break_away_nm, stick_slip};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = std::env::args().nth(1).unwrap_or_else(|| "docs/pictures".into());
    std::fs::create_dir_all(&folder)?;
    for (name, content) in pictures()? {
        std::fs::write(std::path::Path::new(&folder).join(name), content)?;
    }
    Ok(())
}

fn pictures() -> Result<Vec<(&'static str, String)>, SimulationError> {
    let level_nm = 10.0;
    let gms = Gms::from_displacements(level_nm, &[0.0005, 0.001, 0.002, 0.004], &[0.25; 4]);
    let lugre = LuGre { stiffness_nm_rad: 1e4, damping_nm_s: 0.0 };
    let masing = Masing { half_way_rad: 1e-3 };
    let loops = |bristle: &dyn Bristle| along(bristle, level_nm, &[6e-3, -6e-3, 6e-3], 2e-5, 1e-2);
    let inner = |bristle: &dyn Bristle| along(bristle, level_nm, &[5e-3, 0.0, 2e-3, 0.0, -4e-3], 2e-5, 1e-2);
    let textbook = || Box::new(LuGre { stiffness_nm_rad: 1e5, damping_nm_s: 1e5_f64.sqrt() });
    let slip = Gms::from_displacements(experiments::COULOMB_NM, &[5e-6, 1e-5, 2e-5, 4e-5], &[0.25; 4]);
    let (position, velocity, friction) = stick_slip(textbook(), 30.0)?;
    let (gms_position, gms_velocity, _) = stick_slip(Box::new(slip), 30.0)?;
    let rates: Vec<f64> = (0..13).map(|k| 0.5 * 10_f64.powf(f64::from(k) / 6.0)).collect();
    let break_away = rates
        .iter()
        .map(|rate| Ok([*rate, break_away_nm(textbook(), *rate)?]))
        .collect::<Result<Vec<_>, SimulationError>>()?;
    let way = ["angle [rad]", "friction torque [Nm]"];
    Ok(vec![
        (
            "presliding_loops.svg",
            plot::svg(
                "Presliding: from rest, back, and forth again",
                way,
                &[("LuGre", loops(&lugre)), ("GMS", loops(&gms)), ("Masing", loops(&masing))],
            ),
        ),
        (
            "nonlocal_memory.svg",
            plot::svg(
                "An inner loop closes where memory is nonlocal",
                way,
                &[("LuGre", inner(&lugre)), ("GMS", inner(&gms)), ("Masing", inner(&masing))],
            ),
        ),
        (
            "break_away.svg",
            plot::svg(
                "Break-away torque falls with the rate of the pull (LuGre)",
                ["rate [Nm/s]", "break-away torque [Nm]"],
                &[("", break_away)],
            ),
        ),
        (
            "stick_slip_position.svg",
            plot::svg(
                "Stick and slip: a wheel drawn by a spring",
                ["time [s]", "angle [rad]"],
                &[("LuGre", position), ("GMS", gms_position)],
            ),
        ),
        (
            "stick_slip_velocity.svg",
            plot::svg(
                "Its velocity",
                ["time [s]", "velocity [rad/s]"],
                &[("LuGre", velocity), ("GMS", gms_velocity)],
            ),
        ),
        (
            "stick_slip_friction.svg",
            plot::svg("Its friction (LuGre)", ["time [s]", "friction torque [Nm]"], &[("", friction)]),
        ),
    ])
}
