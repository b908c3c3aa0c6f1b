//! Table of every effect at medium strength: the torque that the experiment's structure cannot absorb over
//! noise, per joint, and what it does to the residual of held-out recordings:
//! `cargo run --release -p aurt-lab --example effects_table [strength] [robot]`.

use aurt_lab::case::{CaseRequest, CaseType, RecordingSettings, World, make_case};
use aurt_lab::{Strength, effects::all_kinds};
use aurt_simulation::{Robot, SimulationError};

fn main() -> Result<(), SimulationError> {
    let mut arguments = std::env::args().skip(1);
    let strength = match arguments.next().as_deref() {
        Some("weak") => Strength::Weak,
        Some("strong") => Strength::Strong,
        _ => Strength::Medium,
    };
    let robot = Robot::named(&arguments.next().unwrap_or_else(|| "ur10e".into()))?;
    println!(
        "{} on {}: torque over noise per joint | residual over floor, held out",
        strength.name(),
        robot.name
    );
    for kind in all_kinds() {
        if !CaseRequest::is_possible(&robot, &[kind]) {
            println!("{:31} not on this robot", kind.identifier);
            continue;
        }
        let request = CaseRequest {
            robot: robot.name.clone(),
            case_type: CaseType::Single,
            effects: vec![kind.identifier.into()],
            strength,
        };
        let started = std::time::Instant::now();
        let truth = make_case(World::Clean, "table", &request, &RecordingSettings::default(), 7)?.truth;
        let show = |v: &[f64]| v.iter().map(|x| format!("{x:5.2}")).collect::<Vec<_>>().join(" ");
        let held_out = &truth.validation[0];
        let ratio: Vec<f64> = held_out.before_nm.iter().zip(&held_out.floor_nm).map(|(b, f)| b / f).collect();
        let effect = &truth.effects[0];
        println!(
            "{:31} {:12} {} | {}   {:.1} s",
            effect.effect,
            format!("{:?}", effect.joints),
            show(&effect.achieved),
            show(&ratio),
            started.elapsed().as_secs_f64()
        );
    }
    Ok(())
}
