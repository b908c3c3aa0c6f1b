//! What armature and damping stand for where delay and dry friction are left out.

use aurt_calibration::drives::{
    DriveRecording, DrivenArm, DrivenJoint, Mechanics, Options, Selection, absorbed, output_error,
};
use aurt_friction::drives::PositionServo;
use aurt_rbd::{Joint, LinkBody, Placement, SerialChain};
use aurt_traits::CommandSignal;

/// One servo with a rod on its shaft, in a vertical plane.
fn servo(delay_s: f64, coulomb_nm: f64) -> DrivenArm {
    let turned = Placement::from_roll_pitch_yaw([0.0; 3], [std::f64::consts::FRAC_PI_2, 0.0, 0.0]);
    let chain = SerialChain::new(vec![Joint::revolute(turned)], [0.0, 0.0, -9.81]).unwrap();
    let rod = LinkBody {
        mass_kg: 0.1,
        com_m: [0.1, 0.0, 0.0],
        inertia_at_com_kg_m2: [1e-5, 0.0, 0.0, 3e-4, 0.0, 3e-4],
    };
    let drive = PositionServo {
        gain_nm_per_rad: 10.0,
        back_emf_nm_s_per_rad: 0.4,
        delay_s,
        ..PositionServo::default()
    };
    let mechanics = Mechanics { rotor_inertia_kg_m2: 0.01, coulomb_nm, ..Mechanics::default() };
    DrivenArm {
        chain,
        standard_parameters: rod.standard_parameters().to_vec(),
        joints: vec![DrivenJoint { drive: Box::new(drive), mechanics }],
        floor: None,
        command: CommandSignal::Hold,
    }
}

#[test]
fn armature_and_damping_stand_for_the_delay_and_dry_friction_that_are_left_out() {
    let truth = servo(0.03, 0.06);
    let command = |t: f64| 0.4 * (1.3 * t).sin() + 0.15 * (6.1 * t).sin();
    let time_s: Vec<f64> = (0..1000).map(|k| 0.02 * f64::from(k)).collect();
    let command = vec![time_s.iter().map(|t| command(*t)).collect::<Vec<f64>>()];
    let mut recording =
        DriveRecording { position_rad: command.clone(), command, time_s, ..DriveRecording::default() };
    recording.position_rad = truth.rollout(&recording).unwrap();
    let options = Options { deviation_rad: 1e-3, ..Options::default() };
    let estimate =
        ["gain_nm_per_rad", "rotor_inertia_kg_m2", "back_emf_nm_s_per_rad"].map(str::to_owned).to_vec();
    let selection = Selection { estimate, ..Selection::default() };
    let recordings = [recording];
    let kept = output_error(&servo(0.0, 0.0), &selection, &recordings, &options).unwrap();
    let parts = absorbed(&kept.arm, &selection, &truth, &recordings, &options).unwrap();
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
