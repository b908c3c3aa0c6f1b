//! Coefficients that no motion tells apart are said to be so, with the sum that is determined.

use crate::arm;

use arm::{Friction, RICH, Sines, linear, model, named, recording};
use aurt_calibration::{Calibration, CalibrationOptions, calibrate};
use aurt_traits::MeasurementUnit;

fn calibrated(sines: [Sines; 2]) -> Calibration {
    let model = model(named("none"), named("sign"), linear(), &[named("rotor_inertia")]);
    let friction = || -> Friction { Box::new(|state, _| 1.2 * state[1].signum() + 0.8 * state[1]) };
    let recordings = [recording("arm.csv", sines, (0.0, 20.0), [friction(), friction()], 0.05)];
    let options = CalibrationOptions::default();
    calibrate(&model, &recordings, MeasurementUnit::NewtonMetre, 10.0, &options).unwrap()
}

/// The rotor of the first joint turns with the first link.
#[test]
fn a_rotor_that_adds_to_a_link_is_inseparable_from_it() {
    let found = calibrated(RICH);
    let said = found.warnings.join("; ");
    let words = "structurally inseparable and set to zero: rotor_inertia.I_a_0 (determined: ZZ_0 + rotor_inertia.I_a_0)";
    assert!(said.contains(words), "{said}");
    assert!(!said.contains("not determined by the calibration recordings"), "{said}");
}

/// A joint that stands shows nothing of itself, which another motion would.
#[test]
fn what_a_standing_joint_hides_is_not_structural() {
    let found = calibrated([RICH[0], &[]]);
    let said = found.warnings.join("; ");
    let (reach, structure) = said.split_once("structurally inseparable").unwrap();
    assert!(
        reach.contains("not determined by the calibration recordings") && reach.contains("F_v1_1"),
        "{said}"
    );
    assert!(!structure.contains("F_v1_1") && structure.contains("I_a_0 (determined: "), "{said}");
}
