//! What has changed between two recordings? A simulated robot takes up a load; the diagnosis says which.

use aurt::prelude::*;
use aurt::simulate;
use aurt::simulation::{Motion, Scenario, effects, robots};

pub(crate) fn main() -> Result<(), aurt::Error> {
    let machine = robots::ur10e();
    let recorded = |seed, later: bool| {
        let motion = Motion::MultiSine { duration_s: 15.0, harmonics: 8, top_hz: 1.0, share: 0.6 };
        let mut scenario = Scenario::new(machine.clone(), motion.plan(&machine, seed)?, seed);
        scenario.logger.rate_hz = 125.0;
        if later {
            let load =
                effects::Payload { link: 5, mass_kg: 2.0, com_m: [0.02, -0.03, 0.08], edges_m: [0.1; 3] };
            scenario.effects.push(Box::new(load));
        }
        simulate(&scenario)
    };
    let (monday, tuesday) = (recorded(1, false)?, recorded(2, true)?);

    let robot = Robot::from_mdh(&machine.mdh_csv(), machine.gravity_m_s2)?;
    let model = robot.model().arm_term(RotorInertia::default()).build()?;
    let preprocessing = PreprocessOptions { f_dyn_hz: 8.0, ..PreprocessOptions::default() };
    // The drives' currents become torques, so that masses are in kg.
    let constants = machine.drives.iter().map(|drive| drive.torque_constant_nm_per_a).collect();
    let instrument = Instrument { torque_constants_nm_per_a: Some(constants), ..Instrument::default() };
    let diagnosis = Diagnoser::new(model)
        .settings(Settings { preprocessing, instrument, ..Settings::default() })
        .without([EffectKind::TorqueRipple])
        .calibration(&monday.named("monday"))
        .target(&tuesday.named("tuesday"))
        .diagnose(&Progress::silent())?;
    let mut mass_kg = None;
    for found in diagnosis.effects() {
        println!("{} ({:?})", found.finding.sentence, found.presence());
        if let Effect::Payload(load) = found.effect {
            mass_kg = load.mass_kg.map(|mass| mass.value);
            println!("{mass_kg:?} kg on link {}", load.link);
        }
    }
    assert!(mass_kg.is_some_and(|mass| (mass - 2.0).abs() < 0.2), "the load was not found: {mass_kg:?}");
    Ok(())
}
