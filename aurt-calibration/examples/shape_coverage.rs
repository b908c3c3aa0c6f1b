//! How often 95 % intervals of shape parameters and of a load hold the truth: a UR10e with a Stribeck effect on two joints,
//! and one without and with a load.
//!
//! `cargo run --release -p aurt-calibration --example shape_coverage -- 500` prints the tables of docs/estimation.md; the
//! number is that of the seeds of each row.

#![expect(clippy::unwrap_used, reason = "an example that cannot go on has nothing to say")]

#[expect(dead_code, reason = "examples share it, and each uses a part")]
mod known_robot;

use aurt_calibration::{
    Calibration, CalibrationOptions, NamedRecording, ShapeOptions, TermScopes, calibrate_scoped,
    calibrate_shapes,
};
use aurt_rbd::LinkBody;
use aurt_recording::{PreprocessOptions, Recording};
use aurt_traits::{ColumnGroup, MeasurementUnit};
use known_robot::{F_DYN_HZ, KnownRobot, Noise, Positions, Stribeck, measured_and};
use rayon::prelude::*;

const DURATION_S: f64 = 20.0;
const UNIT: MeasurementUnit = MeasurementUnit::NewtonMetre;
const NOISES: [(&str, Noise); 2] =
    [("white", Noise::White), ("Gauss–Markov, 0.1 s", Noise::GaussMarkov { time_s: 0.1 })];
const POSITIONS: [(&str, Positions); 4] = [
    ("exact", Positions::Exact),
    ("19 bit", Positions::Bits(19)),
    ("16 bit", Positions::Bits(16)),
    ("12 bit", Positions::Bits(12)),
];
/// On joints that move, in [`MOTIONS`], without standing still between two reversals.
const LAWS: [Stribeck; 2] = [
    Stribeck { joint: 1, rise_nm: 7.0, velocity_rad_s: 0.1, exponent: 2.0 },
    Stribeck { joint: 2, rise_nm: 4.0, velocity_rad_s: 0.06, exponent: 1.5 },
];

const MOTIONS: [usize; 2] = [0, 3];

fn main() {
    let seeds: u64 = std::env::args().nth(1).map_or(100, |text| text.parse().unwrap());
    println!(
        "{seeds} seeds; UR10e, {DURATION_S} s a recording, f_dyn {F_DYN_HZ} Hz; share of 95 % intervals that hold the truth, %, and of the estimates that have one"
    );
    shapes(seeds);
    loads(seeds);
}

fn recorded(clean: &Recording, name: &str, seed: u64, noise: Noise, positions: Positions) -> NamedRecording {
    measured_and(clean, name, seed, noise, 1.0, positions, &PreprocessOptions::new(F_DYN_HZ))
}

/// Intervals that hold, those that are told, and all estimates: at a bound there is no interval.
#[derive(Debug, Clone, Copy, Default)]
struct Count {
    held: usize,
    told: usize,
    all: usize,
}

impl Count {
    fn of(interval: Option<[f64; 2]>, truth: f64) -> Self {
        let held = interval.is_some_and(|[low, high]| (low..=high).contains(&truth));
        Self { held: usize::from(held), told: usize::from(interval.is_some()), all: 1 }
    }

    fn with(self, other: Self) -> Self {
        Self { held: self.held + other.held, told: self.told + other.told, all: self.all + other.all }
    }

    fn cell(self) -> String {
        let share = |part: usize, of: usize| 100.0 * part as f64 / of as f64;
        if self.told == self.all {
            format!("{:.1}", share(self.held, self.told))
        } else {
            format!("{:.1} of {:.0} %", share(self.held, self.told), share(self.told, self.all))
        }
    }
}

fn print(names: &[&str], cells: &[Count]) {
    let cells: String = cells.iter().map(|c| format!(" {} |", c.cell())).collect();
    println!("| {} |{cells}", names.join(" | "));
}

fn sum<const N: usize>(found: &[[Count; N]]) -> [Count; N] {
    std::array::from_fn(|k| found.iter().fold(Count::default(), |a, c| a.with(c[k])))
}

fn shapes(seeds: u64) {
    let mut robot = KnownRobot::with_stribeck(None, LAWS.to_vec());
    let clean = MOTIONS.map(|kind| robot.clean_at_ends(kind, DURATION_S));
    println!(
        "| noise of the currents | positions | v_S | δ | F_C, F_S − F_C of these joints | other coefficients |"
    );
    println!("|---|---|---|---|---|---|");
    for (noise_name, noise) in NOISES {
        for (name, positions) in POSITIONS {
            let found: Vec<[Count; 4]> = (1..=seeds)
                .into_par_iter()
                .map(|seed| of_shapes(&robot, &clean, seed, noise, positions))
                .collect();
            print(&[noise_name, name], &sum(&found));
        }
    }
}

fn of_shapes(
    robot: &KnownRobot,
    clean: &[Recording],
    seed: u64,
    noise: Noise,
    positions: Positions,
) -> [Count; 4] {
    let recordings: Vec<_> = clean
        .iter()
        .enumerate()
        .map(|(k, c)| recorded(c, &format!("{k}"), 1000 * seed + k as u64, noise, positions))
        .collect();
    let (_, found) = calibrate_shapes(
        &robot.model,
        &recordings,
        &TermScopes::everywhere(),
        UNIT,
        F_DYN_HZ,
        &CalibrationOptions::default(),
        &ShapeOptions::default(),
    )
    .unwrap();
    let mut counts = [Count::default(); 4];
    // Two shapes a law, in the order of the joints.
    for (shapes, law) in found.shape_fit.as_ref().unwrap().shapes.chunks(2).zip(LAWS) {
        for (k, truth) in [law.velocity_rad_s, law.exponent].into_iter().enumerate() {
            counts[k] = counts[k].with(Count::of(shapes[k].interval_95, truth));
        }
    }
    let of_laws: Vec<usize> = LAWS
        .iter()
        .flat_map(|law| robot.model.group(ColumnGroup::JointDynamics(law.joint)).take(2))
        .collect();
    for (k, (parameter, truth)) in found.parameters.iter().zip(&robot.truth).enumerate() {
        let group = if of_laws.contains(&k) { 2 } else { 3 };
        counts[group] = counts[group].with(Count::of(parameter.interval_95, *truth));
    }
    counts
}

fn loads(seeds: u64) {
    println!(
        "| load, kg | noise of the currents | positions | its mass | its first moments | its inertia | median deviation of the mass, kg |"
    );
    println!("|---|---|---|---|---|---|---|");
    for mass_kg in [2.6, 2.8] {
        let side = mass_kg / 12.0 * 0.02;
        let load = LinkBody {
            mass_kg,
            com_m: [0.0, 0.01, 0.07],
            inertia_at_com_kg_m2: [side, 0.0, 0.0, side, 0.0, side],
        };
        let mut robot = KnownRobot::new(Some(&load));
        let clean = [KnownRobot::new(None).clean_at_ends(0, DURATION_S), robot.clean_at_ends(1, DURATION_S)];
        for (noise_name, noise) in NOISES {
            for (name, positions) in POSITIONS {
                let found: Vec<([Count; 3], f64)> = (1..=seeds)
                    .into_par_iter()
                    .map(|seed| of_load(&robot, &clean, seed, noise, positions))
                    .collect();
                let mut deviations: Vec<f64> = found.iter().map(|f| f.1).collect();
                deviations.sort_by(f64::total_cmp);
                let counts: Vec<[Count; 3]> = found.iter().map(|f| f.0).collect();
                let cells: String = sum(&counts).iter().map(|c| format!(" {} |", c.cell())).collect();
                println!(
                    "| {mass_kg} | {noise_name} | {name} |{cells} {:.4} |",
                    deviations[deviations.len() / 2]
                );
            }
        }
    }
}

fn of_load(
    robot: &KnownRobot,
    [empty, loaded]: &[Recording; 2],
    seed: u64,
    noise: Noise,
    positions: Positions,
) -> ([Count; 3], f64) {
    let recordings = [
        recorded(empty, "empty", 1000 * seed, noise, positions),
        recorded(loaded, "loaded", 1000 * seed + 1, noise, positions),
    ];
    let scopes = TermScopes::new(vec![Some(vec!["loaded".into()])]);
    let options = CalibrationOptions::default();
    let found: Calibration =
        calibrate_scoped(&robot.model, &recordings, &scopes, UNIT, F_DYN_HZ, &options).unwrap();
    let at = found.parameters.len() - 10;
    let mut counts = [Count::default(); 3];
    for (k, (parameter, truth)) in found.parameters[at..].iter().zip(&robot.truth[at..]).enumerate() {
        // Six moments of inertia, three first moments, the mass.
        let group = [2, 2, 2, 2, 2, 2, 1, 1, 1, 0][k];
        counts[group] = counts[group].with(Count::of(parameter.interval_95, *truth));
    }
    (counts, found.parameters[at + 9].std_dev.unwrap())
}
