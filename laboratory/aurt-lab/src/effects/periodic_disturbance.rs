use serde::{Deserialize, Serialize};
use serde_json::Value;

use aurt_simulation::{
    Random, SimulationError,
    effects::{Draw, Effect, EffectKind, Factor, Family, Presence, Setup, check_joints, fields, kind},
    error::Complaints,
    plant::{Instant, ShaftTorque},
    robots::Robot,
};

pub(super) const KIND: EffectKind = EffectKind {
    identifier: "periodic_disturbance",
    family: Family::X,
    summary: "a torque of a fixed frequency in time, whatever the joint does",
    presence: Presence::Either,
    rotors: None,
    takes: kind::Takes::One,
    suits: kind::any_joint,
    draw,
    read: kind::read::<PeriodicDisturbance>,
};

/// A torque of a fixed frequency in time, as of a fan or a pump on the arm.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PeriodicDisturbance {
    /// The joint.
    pub joint: usize,
    /// Amplitude, Nm.
    pub amplitude_nm: f64,
    /// Frequency, Hz.
    pub frequency_hz: f64,
}

fn draw(context: &Draw<'_>, random: &mut Random) -> Box<dyn Effect> {
    let joint = context.joint();
    let drive = &context.robot.drives[joint];
    Box::new(PeriodicDisturbance {
        joint,
        amplitude_nm: 1.5 * drive.torque_noise_nm,
        frequency_hz: random.between(1.7, 6.0),
    })
}

impl Effect for PeriodicDisturbance {
    fn identifier(&self) -> &'static str {
        KIND.identifier
    }

    fn joints(&self) -> Vec<usize> {
        vec![self.joint]
    }

    fn parameters(&self) -> Vec<(&'static str, Vec<f64>)> {
        vec![("amplitude_nm", vec![self.amplitude_nm]), ("frequency_hz", vec![self.frequency_hz])]
    }

    fn scale(&mut self, factor: Factor<'_>, robot: &Robot) {
        let most = 0.4 * robot.drives[self.joint].torque_limit_nm;
        self.amplitude_nm = (self.amplitude_nm * factor.on(self.joint)).clamp(-most, most);
    }

    fn validate(&self, robot: &Robot) -> Result<(), SimulationError> {
        let mut complaints = Complaints::default();
        check_joints(&mut complaints, KIND.identifier, &[self.joint], robot);
        complaints.within("amplitude of the disturbance in Nm", self.amplitude_nm, -1e4, 1e4);
        complaints.within("frequency of the disturbance in Hz", self.frequency_hz, 0.0, 200.0);
        complaints.finish()
    }

    fn install(&self, setup: &mut Setup) -> Result<(), SimulationError> {
        setup.machine.shaft_torques.push(Box::new(*self));
        Ok(())
    }

    fn fields(&self) -> Value {
        fields(self)
    }
}

impl ShaftTorque for PeriodicDisturbance {
    fn add(&self, at: &Instant<'_>, opposing_nm: &mut [f64]) {
        let angle = std::f64::consts::TAU * self.frequency_hz * at.time_s;
        opposing_nm[self.joint] += self.amplitude_nm * libm::sin(angle);
    }
}
