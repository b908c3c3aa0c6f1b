use aurt_simulation::effects::declaring::*;
use aurt_simulation::plant::{DryTerm, Instant};

/// A worn or dirty place: dry friction is higher by `excess_nm` between two angles, with soft edges.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StickingWindow {
    pub joint: usize,
    pub excess_nm: f64,
    pub place_rad: [f64; 2],
}

impl Physics for StickingWindow {
    const KIND: Declaration =
        Declaration::new("sticking_window", Family::P, Presence::Structural, Takes::One);
    const PARAMETERS: &'static [&'static str] = &["excess_nm"];

    fn draw(context: &Draw<'_>, random: &mut Random) -> Self {
        let (joint, drive) = context.drive();
        let start = drive.home_rad + random.between(-0.4, 0.1);
        Self {
            joint,
            excess_nm: 3.0 * drive.torque_noise_nm,
            place_rad: [start, start + random.between(0.15, 0.35)],
        }
    }

    fn scale(&mut self, factor: Factor<'_>, robot: &Robot) {
        let most = 3.0 * robot.drives[self.joint].coulomb_nm.max(0.1);
        self.excess_nm = (self.excess_nm * factor.on(self.joint)).clamp(-most, most);
    }

    fn check(&self, complaints: &mut Checks<'_>) {
        complaints.within("excess of friction in Nm", self.excess_nm, -1e-12, 1e4);
        complaints.positive("width of the place in rad", self.place_rad[1] - self.place_rad[0]);
    }

    fn install(&self, setup: &mut Setup) -> Result<(), SimulationError> {
        setup.machine.joints[self.joint].dry_terms.push(Box::new(*self));
        Ok(())
    }
}

const EDGE_RAD: f64 = 0.03;

impl DryTerm for StickingWindow {
    fn level_nm(&self, joint: usize, at: &Instant<'_>, _direction: f64) -> f64 {
        let [start, end] = self.place_rad;
        let inside = (at.q_rad[joint] - start).min(end - at.q_rad[joint]);
        self.excess_nm * (0.5 + inside / EDGE_RAD).clamp(0.0, 1.0)
    }
}
