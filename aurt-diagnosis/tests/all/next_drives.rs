//! Motions that tell structures of drives apart: a delay and a back-EMF leave the same distance at every speed, and differ where it
//! changes.

use aurt_calibration::drives::{
    DriveRecording, DrivenArm, DrivenJoint, Mechanics, Options, Selection, output_error,
};
use aurt_diagnosis::discrimination::{DeviationGoal, Discriminator, Doubt, DriveDiscrimination};
use aurt_diagnosis::drives::{Demands, Missed, STRUCTURES, compare, diagnose};
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
    let joint = Joint::revolute(Placement::from_roll_pitch_yaw([0.0; 3], [0.0; 3]));
    let drive = PositionServo {
        gain_nm_per_rad: 10.0,
        delay_s,
        back_emf_nm_s_per_rad: 0.0,
        ..PositionServo::default()
    };
    let mechanics = Mechanics { rotor_inertia_kg_m2: 0.01, coulomb_nm: 0.02, ..Mechanics::default() };
    DrivenArm {
        chain: SerialChain::new(vec![joint], [0.0; 3]).unwrap(),
        standard_parameters: vec![0.0; 10],
        joints: vec![DrivenJoint { drive: Box::new(drive), mechanics }],
        command: CommandSignal::Hold,
        floor: None,
    }
}

/// A cosine of so many rad/s and 0.3 rad, for some seconds, as a motion.
fn sine(rad_s: f64, seconds: f64) -> Recording {
    let time_s: Vec<f64> = (0..(seconds * RATE_HZ) as usize).map(|k| k as f64 / RATE_HZ).collect();
    let command = time_s.iter().map(|t| 0.3 * (rad_s * t).cos()).collect();
    Recording::from_arrays(time_s, vec![command]).unwrap()
}

fn recorded(arm: &DrivenArm, motion: Recording, dice: &mut Dice) -> DriveRecording {
    let command = motion.position_rad;
    let mut recording = DriveRecording {
        time_s: motion.time_s,
        position_rad: vec![vec![command[0][0]; command[0].len()]],
        command,
        ..DriveRecording::default()
    };
    let keeps = (-1.0 / (0.5 * RATE_HZ)).exp();
    let mut error = ERROR_RAD * dice.normal();
    recording.position_rad = arm.rollout(&recording).unwrap();
    for q in &mut recording.position_rad[0] {
        error = keeps * error + ERROR_RAD * (1.0 - keeps * keeps).sqrt() * dice.normal();
        *q += error;
    }
    recording
}

fn selection(estimate: &[&str]) -> Selection {
    Selection { estimate: estimate.iter().map(|e| (*e).to_owned()).collect(), ..Selection::default() }
}

#[test]
fn a_motion_that_tells_a_delay_from_a_back_emf_is_foreseen_to_decide_as_often_as_it_does() {
    let truth = servo(0.03);
    let mut dice = Dice(5 * 7919);
    let [fitted, held_out] = [(); 2].map(|()| vec![recorded(&truth, sine(0.8, 16.0), &mut dice)]);
    let tried = ["time_delay", "viscous"];
    let without = STRUCTURES.iter().map(|s| s.id.to_owned()).filter(|id| !tried.contains(&&**id)).collect();
    let (demands, parts) = (Demands { without, ..Demands::default() }, [&fitted[..], &held_out]);
    let options = Options { deviation_rad: ERROR_RAD, ..Options::default() };
    let found =
        diagnose(&servo(0.0), &selection(&["coulomb_nm"]), parts, &options, &demands, |_| ()).unwrap();
    let planned_s = 8.0;
    let wanted = [DeviationGoal { parameter: "coulomb_nm".into(), std: 1e-3 }];
    let doubts = DriveDiscrimination::new(&found, parts, &wanted, planned_s).unwrap();
    let [Doubt::Rivals { .. }, Doubt::Wide(_, wide), ..] = doubts.doubts() else {
        panic!("{:?}", doubts.doubts());
    };
    assert_eq!(wide.parameter, "coulomb_nm");
    let outlook = |rad_s: f64| doubts.outlook(&doubts.planned(&sine(rad_s, planned_s)).unwrap());
    let foreseen = |rad_s: f64| outlook(rad_s)[0].settled;
    let speeds = [0.8, 4.0, 8.0];
    let all = speeds.map(foreseen);
    assert!(all[0] < 0.3 && all[2] > 0.95 && all.windows(2).all(|w| w[0] <= w[1] + 0.05), "{all:?}");
    let interval = outlook(8.0)[1].interval.clone().unwrap();
    assert!(interval.after < interval.now && interval.after > 0.0, "{interval:?}");

    // The same in fact, whichever is true: recorded twice, fitted and held out, both models estimated anew.
    let fit = |key: &str, fitted: &[DriveRecording]| -> DrivenArm {
        let arm = if key == "delay_s" { servo(0.02) } else { servo(0.0) };
        output_error(&arm, &selection(&["coulomb_nm", key]), fitted, &options).unwrap().arm
    };
    let keys = ["delay_s", "viscous_nm_s_per_rad"];
    let share = |rad_s: f64, [own, other]: [&str; 2]| {
        let truth = fit(own, &fitted);
        let decides = |mut dice: Dice| {
            let mut again = || recorded(&truth, sine(rad_s, planned_s), &mut dice);
            let (fitted, held_out) = ([fitted[0].clone(), again()], [held_out[0].clone(), again()]);
            let missed = |key| Missed::of(&fit(key, &fitted), &held_out, &options).unwrap();
            compare(&missed(own), &missed(other), &options).probability < 0.05
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
