//! Motions that tell structures of drives apart: a delay and a back-EMF leave the same distance at every speed, and differ where it
//! changes.

use aurt_calibration::drives::{
    DriveRecording, DrivenArm, DrivenJoint, Mechanics, Options, Selection, output_error,
};
use aurt_diagnosis::discrimination::{DeviationGoal, Discriminator, Doubt, DriveDiscrimination, Outlook};
use aurt_diagnosis::drives::{Demands, Diagnosis, Missed, STRUCTURES, compare, diagnose};
use aurt_friction::drives::PositionServo;
use aurt_rbd::{Joint, Placement, SerialChain};
use aurt_recording::Recording;
use aurt_traits::CommandSignal;

use crate::dice::Dice;

const RATE_HZ: f64 = 50.0;
/// Standard deviation of errors that last for half a second, rad.
const ERROR_RAD: f64 = 1.5e-3;

/// A servo that turns a rotor.
fn servo(delay_s: f64) -> DrivenArm {
    let chain =
        SerialChain::new(vec![Joint::revolute(Placement::from_roll_pitch_yaw([0.0; 3], [0.0; 3]))], [0.0; 3])
            .unwrap();
    let drive = PositionServo {
        gain_nm_per_rad: 10.0,
        delay_s,
        back_emf_nm_s_per_rad: 0.0,
        ..PositionServo::default()
    };
    let mechanics = Mechanics { rotor_inertia_kg_m2: 0.01, coulomb_nm: 0.02, ..Mechanics::default() };
    DrivenArm {
        chain,
        standard_parameters: vec![0.0; 10],
        joints: vec![DrivenJoint { drive: Box::new(drive), mechanics }],
        command: CommandSignal::Hold,
        floor: None,
    }
}

/// A cosine of so many rad/s and 0.3 rad, for some seconds.
fn sine(rad_s: f64, seconds: f64) -> Vec<f64> {
    (0..(seconds * RATE_HZ) as usize).map(|k| 0.3 * (rad_s * k as f64 / RATE_HZ).cos()).collect()
}

fn recorded(arm: &DrivenArm, command: &[f64], dice: &mut Dice) -> DriveRecording {
    let mut recording = DriveRecording {
        time_s: (0..command.len()).map(|k| k as f64 / RATE_HZ).collect(),
        position_rad: vec![vec![command[0]; command.len()]],
        command: vec![command.to_vec()],
        ..DriveRecording::default()
    };
    let keeps = (-1.0 / (0.5 * RATE_HZ)).exp();
    let mut error = ERROR_RAD * dice.normal();
    let rolled = arm.rollout(&recording).unwrap();
    recording.position_rad[0] = rolled[0]
        .iter()
        .map(|q| {
            error = keeps * error + ERROR_RAD * (1.0 - keeps * keeps).sqrt() * dice.normal();
            q + error
        })
        .collect();
    recording
}

fn selection(estimate: &[&str]) -> Selection {
    Selection { estimate: estimate.iter().map(|e| (*e).to_owned()).collect(), ..Selection::default() }
}

/// Options of positions that are off as these are.
fn options() -> Options {
    Options { deviation_rad: ERROR_RAD, ..Options::default() }
}

/// A delay, judged on slow sines alone.
fn diagnosed(parts: [&[DriveRecording]; 2]) -> Diagnosis {
    let tried = ["time_delay", "viscous"];
    let without = STRUCTURES.iter().map(|s| s.id.to_owned()).filter(|id| !tried.contains(&&**id)).collect();
    let demands = Demands { without, ..Demands::default() };
    diagnose(&servo(0.0), &selection(&["coulomb_nm"]), parts, &options(), &demands, |_| ()).unwrap()
}

fn motion(command: &[f64]) -> Recording {
    let time_s = (0..command.len()).map(|k| k as f64 / RATE_HZ).collect();
    Recording::from_arrays(time_s, vec![command.to_vec()]).unwrap()
}

#[test]
fn a_motion_that_tells_a_delay_from_a_back_emf_is_foreseen_to_decide_as_often_as_it_does() {
    let truth = servo(0.03);
    let mut dice = Dice(5 * 7919);
    let slow = || sine(0.8, 16.0);
    let [fitted, held_out] = [(); 2].map(|()| vec![recorded(&truth, &slow(), &mut dice)]);
    let found = diagnosed([&fitted, &held_out]);
    let planned_s = 8.0;
    let wanted = [DeviationGoal { parameter: "coulomb_nm".into(), std: 1e-3 }];
    let doubts = DriveDiscrimination::new(&found, [&fitted, &held_out], &wanted, planned_s).unwrap();
    let (rivals, wide) = (&doubts.doubts()[0], &doubts.doubts()[1]);
    assert!(matches!(rivals, Doubt::Rivals { .. }), "{rivals:?}");
    assert!(matches!(wide, Doubt::Wide { wanted, .. } if wanted.parameter == "coulomb_nm"), "{wide:?}");
    let outlook =
        |command: &[f64]| -> Vec<Outlook> { doubts.outlook(&doubts.planned(&motion(command)).unwrap()) };
    let foreseen = |rad_s: f64| outlook(&sine(rad_s, planned_s))[0].settled;
    let speeds = [0.8, 4.0, 8.0];
    let all = speeds.map(foreseen);
    assert!(all[0] < 0.3 && all[2] > 0.95 && all.windows(2).all(|w| w[0] <= w[1] + 0.05), "{all:?}");
    let interval = outlook(&sine(8.0, planned_s))[1].interval.clone().unwrap();
    assert!(interval.after < interval.now && interval.after > 0.0, "{interval:?}");

    // The same in fact, whichever is true: recorded twice, fitted and held out, both models estimated anew.
    let fit = |key: &str, fitted: &[DriveRecording]| -> DrivenArm {
        let arm = if key == "delay_s" { servo(0.02) } else { servo(0.0) };
        output_error(&arm, &selection(&["coulomb_nm", key]), fitted, &options()).unwrap().arm
    };
    let keys = ["delay_s", "viscous_nm_s_per_rad"];
    let share = |rad_s: f64, [own, other]: [&str; 2]| {
        let truth = fit(own, &fitted);
        let decides = |mut dice: Dice| {
            let mut again = || recorded(&truth, &sine(rad_s, planned_s), &mut dice);
            let (fitted, held_out) = ([fitted[0].clone(), again()], [held_out[0].clone(), again()]);
            let missed = |key| Missed::of(&fit(key, &fitted), &held_out, &options()).unwrap();
            compare(&missed(own), &missed(other), &options()).probability < 0.05
        };
        let trials = 20;
        (0..trials).filter(|k| decides(Dice(1000 + 7919 * k))).count() as f64 / trials as f64
    };
    for (rad_s, foreseen) in speeds.into_iter().zip(all) {
        let [one, other] = [share(rad_s, keys), share(rad_s, [keys[1], keys[0]])];
        println!("{rad_s} rad/s: {one} and {other} of trials, foreseen {foreseen}");
        assert!(
            (one.min(other) - foreseen).abs() < 0.25,
            "{rad_s} rad/s: {one} {other} of trials, foreseen {foreseen}"
        );
    }
}
