//! Draws the pictures of docs/simulation.md:
//! `cargo run --release -p aurt-lab --example pictures [folder]`.

#[path = "../../aurt-simulation/tests/all/experiments.rs"]
mod experiments;

use aurt_report::{Axis, Figure, Layer, Mark, Panel, Plot, Style, decimated};
use aurt_simulation::SimulationError;
use aurt_simulation::plant::Bristle;
use aurt_simulation::plant::bristles::{Gms, LuGre, Masing};

use experiments::{Curve, along, break_away_nm, stick_slip};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = std::env::args().nth(1).unwrap_or_else(|| "docs/pictures".into());
    std::fs::create_dir_all(&folder)?;
    for plot in plots()? {
        let figure = Figure::Plot(plot);
        let path = std::path::Path::new(&folder).join(figure.name()).with_extension("svg");
        std::fs::write(path, figure.to_svg())?;
    }
    Ok(())
}

fn plot(name: &str, title: &str, [x, y]: [[&str; 2]; 2], curves: &[(&str, Curve)]) -> Plot {
    let styles = [Style::Measured, Style::Predicted, Style::After];
    let layer = |((name, curve), style): (&(&str, Curve), Style)| {
        let (x, y): (Vec<f64>, Vec<f64>) = curve.iter().map(|[x, y]| (x, y)).unzip();
        let kept = decimated(&[&x, &y], 200);
        let of = |values: &[f64]| kept.iter().map(|k| values[*k]).collect();
        Layer { name: (*name).into(), style, mark: Mark::Line, x: of(&x), y: of(&y) }
    };
    let layers = curves.iter().zip(styles).map(layer).collect();
    Plot {
        title: title.into(),
        name: name.into(),
        caption: String::new(),
        x: Axis::new(x[0], x[1]),
        panels: vec![Panel { y: Axis::new(y[0], y[1]), height: 240.0, layers, windows: Vec::new() }],
        link: None,
        small: true,
    }
}

fn plots() -> Result<Vec<Plot>, SimulationError> {
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
    let way = [["angle", "rad"], ["friction torque", "Nm"]];
    let over_time = |quantity| [["time", "s"], quantity];
    Ok(vec![
        plot(
            "presliding_loops",
            "Presliding: from rest, back, and forth again",
            way,
            &[("LuGre", loops(&lugre)), ("GMS", loops(&gms)), ("Masing", loops(&masing))],
        ),
        plot(
            "nonlocal_memory",
            "An inner loop closes where memory is nonlocal",
            way,
            &[("LuGre", inner(&lugre)), ("GMS", inner(&gms)), ("Masing", inner(&masing))],
        ),
        plot(
            "break_away",
            "Break-away torque falls with the rate of the pull (LuGre)",
            [["rate", "Nm/s"], ["break-away torque", "Nm"]],
            &[("", break_away)],
        ),
        plot(
            "stick_slip_position",
            "Stick and slip: a wheel drawn by a spring",
            over_time(["angle", "rad"]),
            &[("LuGre", position), ("GMS", gms_position)],
        ),
        plot(
            "stick_slip_velocity",
            "Its velocity",
            over_time(["velocity", "rad/s"]),
            &[("LuGre", velocity), ("GMS", gms_velocity)],
        ),
        plot("stick_slip_friction", "Its friction (LuGre)", over_time(way[1]), &[("", friction)]),
    ])
}
