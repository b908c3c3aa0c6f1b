//! What has changed between two recordings? A simulated robot takes up a load; the diagnosis says which.

use aurt::prelude::*;

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
    let model = robot.model().arm_term("rotor_inertia").build()?;
    let verdict = Diagnoser::new(model)
        .calibration(&monday.named("monday"))
        .target(&tuesday.named("tuesday"))
        .diagnose()?;
    for effect in &verdict.effects {
        println!("{}", effect.sentence);
    }
    assert!(verdict.effects.iter().any(|effect| effect.effect == "payload"), "the load was not found");
    Ok(())
}
