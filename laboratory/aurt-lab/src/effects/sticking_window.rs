use serde::{Deserialize, Serialize};
use serde_json::Value;

use aurt_simulation::{
    Random, SimulationError,
    effects::{Draw, Effect, EffectKind, Factor, Family, Presence, Setup, check_joints, fields, kind},
    error::Complaints,
    plant::{DryTerm, Instant},
    robots::Robot,
};

pub(super) const KIND: EffectKind = EffectKind {
    identifier: "sticking_window",
    family: Family::P,
    summary: "dry friction that is higher within a range of angles",
    presence: Presence::Structural,
    rotors: None,
    takes: kind::Takes::One,
    suits: kind::any_joint,
    draw,
    read: kind::read::<StickingWindow>,
};

/// A worn or dirty place: dry friction is higher by `excess_nm` between two angles, with soft edges.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StickingWindow {
    /// The joint.
    pub joint: usize,
    /// Excess of dry friction, Nm.
    pub excess_nm: f64,
    /// The place, rad.
    pub place_rad: [f64; 2],
}

fn draw(context: &Draw<'_>, random: &mut Random) -> Box<dyn Effect> {
    let joint = context.joint();
    let drive = &context.robot.drives[joint];
    let start = drive.home_rad + random.between(-0.4, 0.1);
    Box::new(StickingWindow {
        joint,
        excess_nm: 3.0 * drive.torque_noise_nm,
        place_rad: [start, start + random.between(0.15, 0.35)],
    })
}

impl Effect for StickingWindow {
    fn identifier(&self) -> &'static str {
        KIND.identifier
    }

    fn joints(&self) -> Vec<usize> {
        vec![self.joint]
    }

    fn parameters(&self) -> Vec<(&'static str, Vec<f64>)> {
        vec![("excess_nm", vec![self.excess_nm])]
    }

    fn scale(&mut self, factor: Factor<'_>, robot: &Robot) {
        let most = 3.0 * robot.drives[self.joint].coulomb_nm.max(0.1);
        self.excess_nm = (self.excess_nm * factor.on(self.joint)).clamp(-most, most);
    }

    fn validate(&self, robot: &Robot) -> Result<(), SimulationError> {
        let mut complaints = Complaints::default();
        check_joints(&mut complaints, KIND.identifier, &[self.joint], robot);
        complaints.within("excess of friction in Nm", self.excess_nm, -1e-12, 1e4);
        complaints.positive("width of the place in rad", self.place_rad[1] - self.place_rad[0]);
        complaints.finish()
    }

    fn install(&self, setup: &mut Setup) -> Result<(), SimulationError> {
        setup.machine.joints[self.joint].dry_terms.push(Box::new(*self));
        Ok(())
    }

    fn fields(&self) -> Value {
        fields(self)
    }
}

/// Width of the edges, rad.
const EDGE_RAD: f64 = 0.03;

impl DryTerm for StickingWindow {
    fn level_nm(&self, joint: usize, at: &Instant<'_>, _direction: f64) -> f64 {
        let [start, end] = self.place_rad;
        let inside = (at.q_rad[joint] - start).min(end - at.q_rad[joint]);
        self.excess_nm * (0.5 + inside / EDGE_RAD).clamp(0.0, 1.0)
    }
}
