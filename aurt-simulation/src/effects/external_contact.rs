use super::declaring::*;
use crate::plant::{Instant, LinkTorque};
use aurt_rbd::{LinkFrame, SerialChain};

/// A force on a point of a link, constant in the base frame but for its rise and fall: Jᵀ F on the joints.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ExternalContact {
    pub link: usize,
    /// The point, in the link's frame, m.
    pub point_m: [f64; 3],
    /// The force in the base frame, N.
    pub force_n: [f64; 3],
    /// From when to when, s.
    pub window_s: [f64; 2],
}

/// Duration of rise and fall, s.
const EDGE_S: f64 = 0.08;
const LARGEST_N: f64 = 400.0;

impl Physics for ExternalContact {
    const KIND: Declaration = Declaration::new("external_contact", Family::X, Presence::Later, Takes::All);
    const PARAMETERS: &'static [&'static str] = &["link"];

    fn draw(context: &Draw<'_>, random: &mut Random) -> Self {
        let last = context.robot.joints() - 1;
        let link = last - random.index(2.min(last));
        let length_s = random.between(0.06, 0.15) * context.duration_s;
        let start_s = random.between(0.15, 0.75) * context.duration_s;
        let direction = [random.normal(), random.normal(), random.normal()];
        let size = direction.iter().map(|d| d * d).sum::<f64>().sqrt().max(1e-6);
        Self {
            link,
            point_m: [random.between(-0.05, 0.05), random.between(-0.05, 0.05), random.between(0.0, 0.1)],
            force_n: direction.map(|d| 20.0 * d / size),
            window_s: [start_s, start_s + length_s],
        }
    }

    fn joints(&self) -> Vec<usize> {
        (0..=self.link).collect()
    }

    fn window_s(&self) -> Option<[f64; 2]> {
        Some(self.window_s)
    }

    fn scale(&mut self, factor: Factor<'_>, _robot: &Robot) {
        let size = self.force_n.iter().map(|f| f * f).sum::<f64>().sqrt();
        let factor = factor.on(self.link).min(LARGEST_N / size.max(1e-12));
        self.force_n = self.force_n.map(|f| f * factor);
    }

    fn check(&self, complaints: &mut Checks<'_>) {
        complaints.link(self.link);
        for force in self.force_n {
            complaints.within("force of the contact in N", force, -1e5, 1e5);
        }
        let [start, end] = self.window_s;
        complaints.not_negative("start of the contact in s", start);
        complaints.positive("duration of the contact in s", end - start);
    }

    fn install(&self, setup: &mut Setup) -> Result<(), SimulationError> {
        let chain = setup.machine.robot.chain()?;
        let joints = chain.joints().len();
        setup.machine.link_torques.push(Box::new(Push {
            contact: *self,
            chain,
            frames: Vec::with_capacity(joints),
            jacobian: vec![0.0; 6 * joints],
        }));
        Ok(())
    }
}

#[derive(Debug)]
struct Push {
    contact: ExternalContact,
    chain: SerialChain,
    frames: Vec<LinkFrame>,
    jacobian: Vec<f64>,
}

impl LinkTorque for Push {
    fn add(&mut self, at: &Instant<'_>, acting_nm: &mut [f64]) {
        let [start, end] = self.contact.window_s;
        let inside = (at.time_s - start).min(end - at.time_s);
        if inside <= 0.0 {
            return;
        }
        let x = (inside / EDGE_S).min(1.0);
        let size = x * x * (3.0 - 2.0 * x);
        self.chain.link_frames(at.q_rad, &mut self.frames);
        self.chain.jacobian(&self.frames, self.contact.link, self.contact.point_m, &mut self.jacobian);
        let joints = acting_nm.len();
        for (j, torque) in acting_nm.iter_mut().enumerate() {
            for (row, force) in self.contact.force_n.iter().enumerate() {
                *torque += size * force * self.jacobian[row * joints + j];
            }
        }
    }
}
