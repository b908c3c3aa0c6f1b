//! Arms with drives: simulations with answers on paper, estimates of what was simulated, and what armature and damping stand
//! for where delay and dry friction are left out.

use aurt_calibration::drives::{
    DriveError, DriveRecording, DrivenArm, DrivenJoint, Floor, Mechanics, Options, Selection, absorbed,
    output_error,
};
use aurt_friction::drives::{PositionServo, TorqueDrive, VoltageDrive};
use aurt_rbd::{Joint, LinkBody, Placement, SerialChain};
use aurt_traits::{CommandSignal, DriveModel};

const UPRIGHT: [f64; 3] = [0.0, 0.0, -9.81];

const QUARTER_RAD: f64 = std::f64::consts::FRAC_PI_2;

fn driven(
    joints: Vec<Joint>,
    standard_parameters: Vec<f64>,
    drives: Vec<(Box<dyn DriveModel>, Mechanics)>,
    command: CommandSignal,
) -> DrivenArm {
    let chain = SerialChain::new(joints, UPRIGHT).unwrap();
    let joints = drives.into_iter().map(|(drive, mechanics)| DrivenJoint { drive, mechanics }).collect();
    DrivenArm { chain, standard_parameters, joints, floor: None, command }
}

/// A mass of 2 kg that slides along x, driven by a force.
fn slide(mechanics: Mechanics, drive: Box<dyn DriveModel>) -> DrivenArm {
    let placement = Placement::from_roll_pitch_yaw([0.0; 3], [0.0, QUARTER_RAD, 0.0]);
    let mechanics = Mechanics { rotor_inertia_kg_m2: 2.0, ..mechanics };
    driven(vec![Joint::prismatic(placement)], vec![0.0; 10], vec![(drive, mechanics)], CommandSignal::Linear)
}

/// Servos with a rod on each shaft, in a vertical plane.
fn servos(mass_kg: f64, bend_kg_m2: f64, drives: Vec<(PositionServo, Mechanics)>) -> DrivenArm {
    let turned = Placement::from_roll_pitch_yaw([0.0; 3], [QUARTER_RAD, 0.0, 0.0]);
    let beyond = Placement::from_roll_pitch_yaw([0.2, 0.0, 0.0], [0.0; 3]);
    let joints = [turned, beyond].into_iter().take(drives.len()).map(Joint::revolute).collect();
    let inertia_at_com_kg_m2 = [1e-5, 0.0, 0.0, bend_kg_m2, 0.0, bend_kg_m2];
    let rod = LinkBody { mass_kg, com_m: [0.1, 0.0, 0.0], inertia_at_com_kg_m2 };
    let standard = vec![rod.standard_parameters(); drives.len()].concat();
    let boxed = |(drive, mechanics)| -> (Box<dyn DriveModel>, _) { (Box::new(drive), mechanics) };
    driven(joints, standard, drives.into_iter().map(boxed).collect(), CommandSignal::Hold)
}

fn selected(keys: &[&str]) -> Selection {
    let estimate = keys.iter().map(|key| (*key).to_owned()).collect();
    Selection { estimate, ..Selection::default() }
}

/// Positions are known to a milliradian.
fn options() -> Options {
    Options { deviation_rad: 1e-3, ..Options::default() }
}

fn recorded(rate_hz: f64, seconds: f64, command: &dyn Fn(f64) -> Vec<f64>, start: &[f64]) -> DriveRecording {
    let time_s: Vec<f64> = (0..(rate_hz * seconds) as usize).map(|k| k as f64 / rate_hz).collect();
    let commands: Vec<Vec<f64>> = time_s.iter().map(|t| command(*t)).collect();
    let of = |j: usize| commands.iter().map(|c| c[j]).collect();
    let position_rad = start.iter().map(|q| vec![*q; time_s.len()]).collect();
    DriveRecording {
        command: (0..start.len()).map(of).collect(),
        position_rad,
        time_s,
        ..DriveRecording::default()
    }
}

/// Two servos under gravity: a shoulder and an elbow.
fn arm() -> DrivenArm {
    let mechanics = Mechanics {
        rotor_inertia_kg_m2: 0.01,
        coulomb_nm: 0.06,
        coulomb_per_load: 0.1,
        ..Mechanics::default()
    };
    let servo = |gain_nm_per_rad: f64| PositionServo {
        gain_nm_per_rad,
        back_emf_nm_s_per_rad: 0.4,
        delay_s: 0.03,
        ..PositionServo::default()
    };
    servos(0.2, 7e-4, vec![(servo(12.0), mechanics), (servo(8.0), mechanics)])
}

fn waves(t: f64) -> Vec<f64> {
    vec![
        0.5 * (1.1 * t).sin() + 0.2 * (3.7 * t).sin(),
        -0.6 * (0.9 * t).sin() + 0.15 * (4.3 * t).cos() - 0.15,
    ]
}

#[test]
fn dry_friction_holds_lets_go_and_stops_as_on_paper() {
    let friction = Mechanics { coulomb_nm: 3.0, ..Mechanics::default() };
    let slide = slide(friction, Box::new(TorqueDrive::default()));
    // 2.9 N do not move 3 N of friction in 100 s; 5 N accelerate by 1 m/s² for 2 s; without force it stops after 4/3 m.
    let force = |t: f64| {
        vec![if t < 100.0 {
            2.9
        } else if t < 102.0 {
            5.0
        } else {
            0.0
        }]
    };
    let q = slide.rollout(&recorded(100.0, 106.0, &force, &[0.3])).unwrap().swap_remove(0);
    assert!(q[..9990].iter().all(|q| *q == 0.3), "it creeps");
    assert!((q[10200] - 2.3).abs() < 0.05, "{}", q[10200]);
    let stop = q[10200] + 2.0f64.powi(2) / (2.0 * 1.5);
    assert!((q[10599] - stop).abs() < 0.05, "{} {stop}", q[10599]);
    assert_eq!(q[10599], q[10500]);
}

#[test]
fn smooth_motion_converges_with_the_square_of_the_step() {
    let viscous = Mechanics { viscous_nm_s_per_rad: 4.0, ..Mechanics::default() };
    let slide = slide(viscous, Box::new(VoltageDrive { torque_nm_per_v: 1.5, ..VoltageDrive::default() }));
    let (force, rate, mass) = (6.0, 2.0, 2.0);
    let error = |hz: f64| {
        let q = slide.rollout(&recorded(hz, 2.0 + 1.0 / hz, &|_| vec![4.0], &[0.0])).unwrap().swap_remove(0);
        let t = (q.len() - 1) as f64 / hz;
        let exact = force / (rate * mass) * (t - (1.0 - (-rate * t).exp()) / rate);
        (q[q.len() - 1] - exact).abs()
    };
    let (coarse, fine) = (error(400.0), error(800.0));
    assert!(coarse < 1e-5 && (coarse / fine - 4.0).abs() < 0.3, "{coarse} {fine}");
}

#[test]
fn stops_and_the_floor_bear_what_pushes_against_them() {
    let mut arm = arm();
    arm.joints[1].mechanics.lower_stop_rad = -0.2;
    let q = arm.rollout(&recorded(50.0, 10.0, &waves, &[0.0, 0.0])).unwrap();
    assert!(q[1].iter().all(|q| *q >= -0.2) && q[1].iter().filter(|q| **q == -0.2).count() > 20);
    // The tip of the elbow on the floor, under which the command aims.
    let mut arm = self::arm();
    arm.floor = Some(Floor { height_m: -0.05, x_m: 0.2, friction: 0.3, ..Floor::default() });
    let q = arm.rollout(&recorded(50.0, 6.0, &|t| vec![-0.3 * t.min(1.0), 0.0], &[0.0, 0.0])).unwrap();
    let height = |k: usize| 0.2 * (q[0][k].sin() + (q[0][k] + q[1][k]).sin());
    assert!((height(290) + 0.05).abs() < 5e-3, "{}", height(290));
    assert!((height(290) - height(200)).abs() < 1e-4, "it creeps");
}

#[test]
fn what_was_simulated_is_estimated_within_its_deviations() {
    let truth = arm();
    let mut recordings = Vec::new();
    for start in [[0.0, 0.0], [0.2, -0.1]] {
        let mut recording = recorded(50.0, 12.0, &|t| waves(t + start[0] * 20.0), &start);
        let q = truth.rollout(&recording).unwrap();
        // Encoders of 4096 ticks a turn.
        let tick = std::f64::consts::TAU / 4096.0;
        let ticks = |s: &Vec<f64>| s.iter().map(|q| (q / tick).round() * tick).collect();
        recording.position_rad = q.iter().map(ticks).collect();
        recordings.push(recording);
    }
    let mut start = truth.clone();
    start.joints.iter_mut().for_each(|j| {
        j.drive = Box::new(PositionServo {
            gain_nm_per_rad: 10.0,
            back_emf_nm_s_per_rad: 0.3,
            ..PositionServo::default()
        });
        j.mechanics.coulomb_nm = 0.04;
        j.mechanics.rotor_inertia_kg_m2 = 0.015;
    });
    let keys = ["gain_nm_per_rad", "back_emf_nm_s_per_rad", "delay_s", "rotor_inertia_kg_m2", "coulomb_nm"];
    let selection = Selection { shared: vec!["delay_s".to_owned()], ..selected(&keys) };
    let fit = output_error(&start, &selection, &recordings, &options()).unwrap();
    assert!(fit.converged, "{fit:?}");
    assert!(fit.rms_rad.iter().flatten().all(|r| *r < 7e-4), "{:?}", fit.rms_rad);
    let names = truth.names();
    let numbers = truth.numbers();
    for estimate in &fit.numbers {
        let place = names.iter().position(|n| *n == estimate.name || n.starts_with(&estimate.name)).unwrap();
        let error = (estimate.value - numbers[place].value).abs();
        assert!(
            error < 4.0 * estimate.deviation + 0.02 * numbers[place].value,
            "{estimate:?} {}",
            numbers[place].value
        );
        assert!(estimate.deviation < 0.3 * estimate.value, "{estimate:?}");
    }
    assert!(fit.undetermined.is_empty(), "{:?}", fit.undetermined);
}

/// A servo of 8 Nm/rad with a limit of 2.6 Nm receives a command every 20 ms, 32 ms late, and holds it. Its motion is simulated at
/// 1 kHz from commands that are written out as a staircase, read every 20 ms, and estimated from the commands as they were sent.
#[test]
fn held_commands_are_estimated_as_held() {
    let mut truth = slide(Mechanics::default(), Box::new(PositionServo::default()));
    truth.joints[0] = DrivenJoint {
        drive: Box::new(PositionServo {
            gain_nm_per_rad: 8.0,
            back_emf_nm_s_per_rad: 0.35,
            delay_s: 0.032,
            torque_limit_nm: 2.6,
            ..PositionServo::default()
        }),
        mechanics: Mechanics { rotor_inertia_kg_m2: 0.02, coulomb_nm: 0.1, ..Mechanics::default() },
    };
    let sent = |t: f64| {
        let step = if ((t / 1.7) as usize).is_multiple_of(2) { 0.45 } else { -0.35 };
        vec![if t < 8.0 { step } else { 0.0 } + 0.25 * (3.1 * t).sin()]
    };
    let stairs = recorded(1000.0, 16.0, &|t| sent(((t + 1e-9) * 50.0).floor() / 50.0), &[sent(0.0)[0]]);
    let q = truth.rollout(&stairs).unwrap().swap_remove(0);
    let mut recording = recorded(50.0, 16.0, &sent, &[0.0]);
    recording.position_rad = vec![q.into_iter().step_by(20).collect()];
    let mut start = truth.clone();
    start.joints[0].drive = Box::new(PositionServo { torque_limit_nm: 3.0, ..PositionServo::default() });
    let keys = ["gain_nm_per_rad", "back_emf_nm_s_per_rad", "delay_s", "torque_limit_nm"];
    let selection = selected(&keys);
    let fit = |command| {
        let arm = DrivenArm { command, ..start.clone() };
        let fit = output_error(&arm, &selection, std::slice::from_ref(&recording), &options()).unwrap();
        (fit.numbers.iter().map(|n| n.value).collect::<Vec<_>>(), fit.rms_rad[0][0])
    };
    let (held, rms) = fit(CommandSignal::Hold);
    for (value, truth) in held.iter().zip([8.0, 0.35, 0.032, 2.6]) {
        assert!((value / truth - 1.0).abs() < 0.02, "{held:?}");
    }
    // On the line between two commands the servo seems to be later by half their period.
    let (linear, rms_linear) = fit(CommandSignal::Linear);
    println!("hold {held:?} {rms}; linear {linear:?} {rms_linear}");
    assert!(linear[2] > 0.038 && rms < 3e-4 && rms_linear > 2.0 * rms, "{linear:?} {rms} {rms_linear}");
}

/// A reference that slews sets out when the command jumps: its delay and its limit are both told by when and how fast it moves.
#[test]
fn a_limited_reference_tells_its_delay() {
    let servo = PositionServo {
        gain_nm_per_rad: 8.0,
        back_emf_nm_s_per_rad: 0.35,
        delay_s: 0.013,
        speed_limit_rad_s: 4.8,
        ..PositionServo::default()
    };
    let mut truth = slide(Mechanics::default(), Box::new(servo));
    truth.joints[0].mechanics =
        Mechanics { rotor_inertia_kg_m2: 0.02, coulomb_nm: 0.1, ..Mechanics::default() };
    truth.command = CommandSignal::Hold;
    let sent =
        |t: f64| vec![[0.5, -0.4, 0.1, -0.6][((t + 1e-9) / 0.37) as usize % 4] + 0.2 * (2.3 * t).sin()];
    // Commands come at stamps that are no whole steps of any simulation.
    let period_s = 0.0193;
    let stairs =
        recorded(2000.0, 12.0, &|t| sent(((t + 1e-9) / period_s).floor() * period_s), &[sent(0.0)[0]]);
    let q = truth.rollout(&stairs).unwrap().swap_remove(0);
    let mut recording = recorded(1.0 / period_s, 11.9, &sent, &[0.0]);
    recording.position_rad =
        vec![recording.time_s.iter().map(|t| q[((t + 1e-9) * 2000.0).round() as usize]).collect()];
    let mut start = truth.clone();
    let off = PositionServo { delay_s: 0.02, speed_limit_rad_s: 6.0, ..servo };
    start.joints[0].drive = Box::new(off);
    let selection = selected(&["delay_s", "speed_limit_rad_s"]);
    let fit = output_error(&start, &selection, std::slice::from_ref(&recording), &options()).unwrap();
    let [delay, limit] = [0, 1].map(|k| fit.numbers[k].value);
    assert!((delay - 0.013).abs() < 3e-4 && (limit / 4.8 - 1.0).abs() < 0.01, "{delay} {limit}");
}

/// A gain is known no better than the masses that it lifts.
#[test]
fn what_is_given_widens_what_is_estimated() {
    let truth = arm();
    let mut recording = recorded(50.0, 12.0, &waves, &[0.0, 0.0]);
    recording.position_rad = truth.rollout(&recording).unwrap();
    let deviation = |deviations: Vec<(String, f64)>| {
        let selection = Selection { deviations, ..selected(&["gain_nm_per_rad_0"]) };
        let fit = output_error(&truth, &selection, std::slice::from_ref(&recording), &options()).unwrap();
        fit.numbers[0].deviation / fit.numbers[0].value
    };
    let of_mass = |share: f64| deviation(vec![("mass_scale".to_owned(), share)]);
    let (exact, unstated, stated) = (of_mass(1e-9), deviation(Vec::new()), of_mass(0.05));
    // All torques but those of the rotors are in proportion to the masses, that of both links together.
    assert!(exact < 2e-3 && unstated > 0.005 && unstated < 0.02, "{exact} {unstated}");
    assert!((stated / unstated / 2.5 - 1.0).abs() < 0.1, "{stated} {unstated}");
    // A deviation stated for no limit changes nothing; one of a single joint leaves the other joints the usual one.
    let beside = |key: &str, deviation_of: f64| deviation(vec![(key.to_owned(), deviation_of)]);
    assert_eq!(beside("speed_limit_rad_s", 2.0), unstated);
    let one = beside("mass_scale_1", 1e-9);
    assert!(one > exact && one < unstated, "{exact} {one} {unstated}");
}

#[test]
fn pieces_that_are_too_short_are_refused() {
    let slide = slide(Mechanics::default(), Box::new(TorqueDrive::default()));
    let recording = recorded(50.0, 10.0, &|_| vec![1.0], &[0.0]);
    for piece_s in [5e-324, 1e-9, 0.19, 0.0, -1.0, f64::NAN] {
        let options = Options { piece_s: Some(piece_s), ..Options::default() };
        let error = output_error(&slide, &Selection::default(), std::slice::from_ref(&recording), &options);
        assert!(matches!(error, Err(DriveError::ShortPieces { rows: 10, .. })), "{piece_s}: {error:?}");
    }
    for (piece_s, pieces) in [(0.2, 50), (1e308, 1), (f64::INFINITY, 1)] {
        assert_eq!(recording.pieces(Some(piece_s)).unwrap().len(), pieces);
    }
}

#[test]
fn pieces_find_what_an_open_loop_drifts_away_from() {
    let viscous = Mechanics { viscous_nm_s_per_rad: 4.0, coulomb_nm: 1.0, ..Mechanics::default() };
    let truth = slide(viscous, Box::new(TorqueDrive::default()));
    let mut recording =
        recorded(500.0, 20.0, &|t| vec![9.0 * (1.9 * t).cos() + 3.0 * (4.1 * t).sin()], &[0.0]);
    recording.position_rad = truth.rollout(&recording).unwrap();
    let mut start = truth.clone();
    start.joints[0].mechanics = Mechanics {
        rotor_inertia_kg_m2: 1.5,
        viscous_nm_s_per_rad: 2.0,
        coulomb_nm: 0.5,
        ..Mechanics::default()
    };
    let estimated = ["rotor_inertia_kg_m2", "viscous_nm_s_per_rad", "coulomb_nm"];
    let deviations = estimated.map(|key| (key.to_owned(), 5.0)).to_vec();
    let selection = Selection { deviations, ..selected(&estimated) };
    let options = Options { deviation_rad: 1e-4, piece_s: Some(2.0), ..Options::default() };
    let fit = output_error(&start, &selection, &[recording], &options).unwrap();
    for (number, truth) in fit.numbers.iter().zip([2.0, 4.0, 1.0]) {
        assert!((number.value - truth).abs() < 2e-3 * truth, "{number:?}");
    }
}

#[test]
fn numbers_that_are_one_column_are_named() {
    let truth = arm();
    let mut recording = recorded(50.0, 8.0, &waves, &[0.0, 0.0]);
    recording.position_rad = truth.rollout(&recording).unwrap();
    let selection = selected(&["back_emf_nm_s_per_rad_0", "viscous_nm_s_per_rad_0"]);
    let fit = output_error(&truth, &selection, &[recording], &Options::default()).unwrap();
    let said = fit.undetermined.iter().map(ToString::to_string).collect::<Vec<_>>();
    assert_eq!(said.len(), 1);
    assert!(
        said[0].contains("back_emf_nm_s_per_rad_0") && said[0].contains("viscous_nm_s_per_rad_0"),
        "{said:?}"
    );
}

#[test]
fn mistakes_are_detected() {
    let arm = arm();
    let good = recorded(50.0, 1.0, &waves, &[0.0, 0.0]);
    let select = |key| selected(&[key]);
    let of = |selection: &Selection, recording: &DriveRecording| {
        output_error(&arm, selection, std::slice::from_ref(recording), &Options::default()).unwrap_err()
    };
    assert!(matches!(of(&select("gain"), &good), DriveError::Unknown { .. }));
    assert!(matches!(of(&select("speed_limit_rad_s"), &good), DriveError::NoStart { .. }));
    let one_joint = DriveRecording { command: good.command[..1].to_vec(), ..good.clone() };
    assert!(matches!(of(&select("delay_s"), &one_joint), DriveError::Recording { recording: 0, .. }));
    let mut backwards = good.clone();
    backwards.time_s[7] = 0.0;
    assert!(of(&select("delay_s"), &backwards).to_string().contains("does not follow"));
    let mut outside = arm.clone();
    outside.joints[1].mechanics.coulomb_nm = -1.0;
    assert!(matches!(outside.validate(), Err(DriveError::Bounds { .. })));
    let text = serde_json::to_string(&arm).unwrap();
    let back: DrivenArm = serde_json::from_str(&text).unwrap();
    assert_eq!(back.numbers(), arm.numbers());
}

#[test]
fn armature_and_damping_stand_for_the_delay_and_dry_friction_that_are_left_out() {
    let servo = |delay_s: f64, coulomb_nm: f64| {
        let drive = PositionServo {
            gain_nm_per_rad: 10.0,
            back_emf_nm_s_per_rad: 0.4,
            delay_s,
            ..PositionServo::default()
        };
        let mechanics = Mechanics { rotor_inertia_kg_m2: 0.01, coulomb_nm, ..Mechanics::default() };
        servos(0.1, 3e-4, vec![(drive, mechanics)])
    };
    let truth = servo(0.03, 0.06);
    let command = |t: f64| vec![0.4 * (1.3 * t).sin() + 0.15 * (6.1 * t).sin()];
    let mut recordings = [recorded(50.0, 20.0, &command, &[0.0])];
    recordings[0].position_rad = truth.rollout(&recordings[0]).unwrap();
    let selection = selected(&["gain_nm_per_rad", "rotor_inertia_kg_m2", "back_emf_nm_s_per_rad"]);
    let kept = output_error(&servo(0.0, 0.0), &selection, &recordings, &options()).unwrap();
    let parts = absorbed(&kept.arm, &selection, &truth, &recordings, &options()).unwrap();
    let change = |key: &str, name: &str| {
        let part = parts.iter().find(|p| p.key == key).unwrap();
        part.changes.iter().find(|c| c.0 == name).unwrap().1
    };
    let number = |name: &str| kept.numbers.iter().find(|n| n.name == name).unwrap().value;
    // A servo that is late by T lags like one with K_p T more damping, and is as slow as one with more inertia.
    let [armature, damping] = ["rotor_inertia_kg_m2_0", "back_emf_nm_s_per_rad_0"];
    assert!((change("delay_s", damping) - 10.0 * 0.03).abs() < 0.05, "{parts:?}");
    assert!(number(armature) > 2.0 * 0.01 && change("delay_s", armature) > 0.5 * (number(armature) - 0.01));
    let split = change("delay_s", damping) + change("coulomb_nm", damping);
    assert!((split - (number(damping) - 0.4)).abs() < 0.02, "{split} {}", number(damping));
    assert!(change("coulomb_nm", damping) > 0.05);
    assert_eq!(parts.len(), 2, "what both have alike absorbs nothing: {parts:?}");
}
