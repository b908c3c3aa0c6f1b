//! Structures concealed in simulated servo arms are named, and nothing else is.

use aurt_calibration::drives::{DriveRecording, DrivenArm, DrivenJoint, Mechanics, Options, Selection};
use aurt_diagnosis::drives::{Answer, Demands, Diagnosis, STRUCTURES, diagnose};
use aurt_friction::drives::PositionServo;
use aurt_rbd::{Joint, LinkBody, Placement, SerialChain};
use aurt_traits::CommandSignal;

use crate::dice::Dice;

impl Dice {
    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.uniform()
    }
}

/// A shoulder and an elbow under gravity, with numbers of small servos.
fn arm(dice: &mut Dice) -> DrivenArm {
    let turned = Placement::from_roll_pitch_yaw([0.0; 3], [std::f64::consts::FRAC_PI_2, 0.0, 0.0]);
    let beyond = Placement::from_roll_pitch_yaw([0.2, 0.0, 0.0], [0.0; 3]);
    let chain = SerialChain::new(vec![Joint::revolute(turned), Joint::revolute(beyond)], [0.0, 0.0, -9.81]);
    let rod = |mass_kg: f64| {
        let bend = mass_kg * 0.2 * 0.2 / 12.0;
        let body = LinkBody {
            mass_kg,
            com_m: [0.1, 0.0, 0.0],
            inertia_at_com_kg_m2: [1e-5, 0.0, 0.0, bend, 0.0, bend],
        };
        body.standard_parameters()
    };
    let standard_parameters = [rod(dice.between(0.15, 0.3)), rod(dice.between(0.1, 0.2))].concat();
    let joints = (0..2).map(|_| DrivenJoint {
        drive: Box::new(PositionServo {
            gain_nm_per_rad: dice.between(8.0, 14.0),
            back_emf_nm_s_per_rad: dice.between(0.3, 0.6),
            delay_s: 0.0,
            ..PositionServo::default()
        }),
        mechanics: Mechanics {
            rotor_inertia_kg_m2: dice.between(0.005, 0.015),
            coulomb_nm: dice.between(0.03, 0.08),
            ..Mechanics::default()
        },
    });
    let joints = joints.collect();
    DrivenArm {
        chain: chain.unwrap(),
        standard_parameters,
        joints,
        command: CommandSignal::Hold,
        floor: None,
    }
}

/// Commands of 24 s at 50 Hz: slow and fast sines, then steps and ramps between random poses with rests.
fn command(dice: &mut Dice) -> Vec<f64> {
    let waves: Vec<[f64; 3]> = [0.5_f64, 1.5, 4.5]
        .map(|w| [dice.between(0.2, 0.4) / w.sqrt(), w * dice.between(0.8, 1.2), dice.between(0.0, 6.0)])
        .to_vec();
    let sine = |t: f64| waves.iter().map(|[a, w, p]| a * (w * t + p).sin()).sum::<f64>();
    let mut all: Vec<f64> = (0..500).map(|k| sine(k as f64 * 0.02)).collect();
    while all.len() < 1200 {
        let (from, to) = (all[all.len() - 1], dice.between(-0.7, 0.7));
        let ramp = if dice.uniform() < 0.5 { 1 } else { dice.between(30.0, 120.0) as usize };
        all.extend((1..=ramp).map(|k| from + (to - from) * k as f64 / ramp as f64));
        all.extend(std::iter::repeat_n(to, dice.between(20.0, 60.0) as usize));
    }
    all.truncate(1200);
    all
}

/// What the arm does, read by encoders of 4096 ticks a turn.
fn recorded(truth: &DrivenArm, dice: &mut Dice) -> DriveRecording {
    let command = vec![command(dice), command(dice)];
    let mut recording = DriveRecording {
        time_s: (0..1200).map(|k| f64::from(k) * 0.02).collect(),
        position_rad: command.iter().map(|c| vec![c[0]; 1200]).collect(),
        command,
        ..DriveRecording::default()
    };
    let tick = std::f64::consts::TAU / 4096.0;
    let ticks = |s: &Vec<f64>| s.iter().map(|q| (q / tick).round() * tick).collect();
    recording.position_rad = truth.rollout(&recording).unwrap().iter().map(ticks).collect();
    recording
}

/// The diagnosis of an arm of which the model lacks the value of a key.
fn diagnosed(key: &str, value: f64, seed: u64, demands: &Demands) -> Diagnosis {
    let mut dice = Dice(seed.wrapping_mul(7919) + 17);
    dice.0 ^= dice.0 >> 31;
    let mut model = arm(&mut dice);
    let mut truth = model.clone();
    let names = truth.names();
    let mut numbers: Vec<f64> = truth.numbers().iter().map(|n| n.value).collect();
    (0..names.len()).filter(|k| names[*k].starts_with(key)).for_each(|k| numbers[k] = value);
    truth.set_numbers(&numbers);
    let recordings: Vec<DriveRecording> = (0..4).map(|_| recorded(&truth, &mut dice)).collect();
    // Starts are not the truth.
    for joint in &mut model.joints {
        let mut numbers: Vec<f64> = joint.drive.parameters().iter().map(|p| p.value).collect();
        (numbers[0], numbers[1]) = (10.0, 0.4);
        joint.drive.set_parameters(&numbers);
        joint.mechanics.rotor_inertia_kg_m2 = 0.01;
        joint.mechanics.coulomb_nm = 0.06;
    }
    let estimate = vec!["gain_nm_per_rad", "back_emf_nm_s_per_rad", "rotor_inertia_kg_m2", "coulomb_nm"];
    let selection =
        Selection { estimate: estimate.into_iter().map(str::to_owned).collect(), ..Selection::default() };
    let options = Options { deviation_rad: 1e-3, ..Options::default() };
    let parts = [&recordings[..2], &recordings[2..]];
    diagnose(&model, &selection, parts, &options, demands, |_| ()).unwrap()
}

fn claims(diagnosis: &Diagnosis) -> Vec<(&'static str, Vec<&'static str>)> {
    let missing = diagnosis.findings.iter().filter(|f| f.answer == Answer::Missing);
    missing.map(|f| (f.structure.id, f.alternatives.clone())).collect()
}

#[test]
fn a_concealed_delay_is_named_with_its_size_and_what_is_complete_lacks_nothing() {
    let all = Demands::default();
    let found = diagnosed("delay_s", 0.03, 1, &all);
    assert_eq!(claims(&found), [("time_delay", vec![])]);
    let delay = &found.findings.iter().find(|f| f.structure.id == "time_delay").unwrap().numbers[0];
    assert!((delay.value - 0.03).abs() < 1e-3, "{delay:?}");
    assert!(found.missed_improved.rms_all_rad() < 1e-3);
    let needed = found.findings.iter().filter(|f| f.answer == Answer::Needed).count();
    assert_eq!(needed, 3, "dry friction, viscous friction, rotor");
    let found = diagnosed("delay_s", 0.0, 2, &all);
    assert_eq!(claims(&found), []);
    assert!(found.findings.iter().any(|f| f.structure.id == "dead_band" && f.answer == Answer::NotSupported));
}

/// A limit of the torque that acts in few blocks lowers the rms to a part: it is named, and a dead band that stands for it in the
/// other blocks is not.
#[test]
fn a_limit_that_acts_seldom_is_named() {
    let tried = ["saturation", "dead_band", "viscous_asymmetry"];
    let without = STRUCTURES.iter().map(|s| s.id.to_owned()).filter(|id| !tried.contains(&&**id)).collect();
    let found = diagnosed("torque_limit_nm", 2.2, 3, &Demands { without, ..Demands::default() });
    for f in &found.findings {
        println!("{} {:?} {:?} {:?}", f.structure.id, f.answer, f.objection, f.comparison);
    }
    assert_eq!(claims(&found), [("saturation", vec![])]);
    let limit = &found.findings[0];
    let [with, without] = limit.comparison.rms_rad;
    assert!(limit.structure.id == "saturation" && with < 0.5 * without, "{limit:?}");
    assert!(limit.comparison.blocks < limit.comparison.all_blocks, "{limit:?}");
}
