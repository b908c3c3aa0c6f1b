//! What is concealed in servo arms.

use aurt_simulation::Random;
use aurt_simulation::effects::Family;

use super::arm::{Servo, ServoArm};
use super::plant::WAITS_S;

/// A parameter by its name in verdicts, whether it is that of all joints, and its value.
type Parameter = (&'static str, bool, fn(&Servo) -> f64);

/// Something that an arm has and its experiment lacks.
#[derive(Debug)]
pub(super) struct ServoEffect {
    /// As `verdict.json` names it.
    pub id: &'static str,
    pub family: Family,
    /// The least and the greatest size; the second acts most.
    pub sizes: [f64; 2],
    pub in_vocabulary: bool,
    parameter: Option<Parameter>,
    /// Puts it in at a size; joints of one kind differ by a factor.
    put: fn(&mut ServoArm, f64, &[f64]),
}

/// All of them, those without a name last.
pub(super) const EFFECTS: [ServoEffect; 11] = [
    ServoEffect {
        id: "time_delay",
        family: Family::D,
        sizes: [1e-3, 0.08],
        in_vocabulary: true,
        parameter: Some(("delay_s", true, |s| s.delay_s + WAITS_S)),
        put: |arm, size, _| arm.servos.iter_mut().for_each(|s| s.delay_s = size),
    },
    ServoEffect {
        id: "dead_band",
        family: Family::D,
        sizes: [1e-3, 0.08],
        in_vocabulary: true,
        parameter: Some(("dead_band_rad", false, |s| s.dead_band_rad)),
        put: |arm, size, _| arm.servos.iter_mut().for_each(|s| s.dead_band_rad = size),
    },
    ServoEffect {
        id: "coulomb",
        family: Family::F,
        sizes: [5e-3, 0.4],
        in_vocabulary: true,
        parameter: Some(("coulomb_nm", false, |s| s.coulomb_nm)),
        put: |arm, size, factors| each(arm, factors, |s, f| s.coulomb_nm = size * f),
    },
    ServoEffect {
        id: "stribeck",
        family: Family::F,
        sizes: [5e-3, 0.6],
        in_vocabulary: true,
        parameter: Some(("static_nm", false, |s| s.static_nm)),
        put: |arm, size, factors| each(arm, factors, |s, f| s.static_nm = size * f),
    },
    ServoEffect {
        id: "load_dependent_friction",
        family: Family::L,
        sizes: [0.01, 0.9],
        in_vocabulary: true,
        parameter: Some(("coulomb_per_load", false, |s| s.coulomb_per_load)),
        put: |arm, size, factors| each(arm, factors, |s, f| s.coulomb_per_load = size * f),
    },
    ServoEffect {
        id: "payload",
        family: Family::I,
        sizes: [3e-3, 0.3],
        in_vocabulary: true,
        parameter: None,
        put: |arm, size, _| arm.payload_kg = size,
    },
    ServoEffect {
        id: "speed_limit",
        family: Family::D,
        sizes: [15.0, 0.4],
        in_vocabulary: true,
        parameter: Some(("speed_limit_rad_s", true, |s| s.speed_limit_rad_s)),
        put: |arm, size, _| arm.servos.iter_mut().for_each(|s| s.speed_limit_rad_s = size),
    },
    ServoEffect {
        id: "saturation",
        family: Family::D,
        sizes: [12.0, 0.4],
        in_vocabulary: true,
        parameter: Some(("torque_limit_nm", false, |s| s.torque_limit_nm)),
        put: |arm, size, _| arm.servos.iter_mut().for_each(|s| s.torque_limit_nm = size),
    },
    ServoEffect {
        id: "torque_constant",
        family: Family::D,
        sizes: [0.99, 0.4],
        in_vocabulary: true,
        parameter: Some(("gain_nm_per_rad", false, |s| s.gain_nm_per_rad)),
        put: |arm, size, _| arm.servos.iter_mut().for_each(|s| s.gain_nm_per_rad *= size),
    },
    ServoEffect {
        id: "backlash",
        family: Family::P,
        sizes: [5e-4, 0.06],
        in_vocabulary: false,
        parameter: None,
        put: |arm, size, factors| each(arm, factors, |s, f| s.play_rad = size * f),
    },
    ServoEffect {
        id: "supply_sag",
        family: Family::D,
        sizes: [3e-3, 0.4],
        in_vocabulary: false,
        parameter: None,
        put: |arm, size, _| arm.sag_per_nm = size,
    },
];

fn each(arm: &mut ServoArm, factors: &[f64], set: impl Fn(&mut Servo, f64)) {
    arm.servos.iter_mut().zip(factors).for_each(|(servo, factor)| set(servo, *factor));
}

/// How much the joints of one kind of servo differ.
pub(super) fn factors(joints: usize, random: &mut Random) -> Vec<f64> {
    (0..joints).map(|_| random.between(0.75, 1.25)).collect()
}

impl ServoEffect {
    /// The size at a share of the way from the least to the greatest.
    pub fn size(&self, share: f64) -> f64 {
        self.sizes[0] * libm::pow(self.sizes[1] / self.sizes[0], share)
    }

    pub fn on(&self, arm: &ServoArm, size: f64, factors: &[f64]) -> ServoArm {
        let mut arm = arm.clone();
        (self.put)(&mut arm, size, factors);
        arm
    }

    /// The arm without it: what the experiment describes.
    pub fn without(&self, arm: &mut ServoArm) {
        match self.id {
            "time_delay" => arm.servos.iter_mut().for_each(|s| s.delay_s = 0.0),
            "coulomb" => arm.servos.iter_mut().for_each(|s| s.coulomb_nm = 0.0),
            _ => {}
        }
    }

    pub fn parameters(&self, arm: &ServoArm) -> Vec<(String, Vec<f64>)> {
        let Some((name, is_shared, value)) = self.parameter else { return Vec::new() };
        if is_shared {
            return vec![(name.to_owned(), arm.servos.first().map(value).into_iter().collect())];
        }
        arm.servos.iter().enumerate().map(|(j, s)| (format!("{name}_{j}"), vec![value(s)])).collect()
    }
}
