use super::declaring::*;
use aurt_rbd::LinkBody;

/// A box-shaped body fixed to a link, mostly the last.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Payload {
    pub link: usize,
    pub mass_kg: f64,
    /// Centre of mass in the link's frame, m.
    pub com_m: [f64; 3],
    /// Edges of the box, along the link frame's axes, m.
    pub edges_m: [f64; 3],
}

impl Payload {
    pub fn body(&self) -> LinkBody {
        let [a, b, c] = self.edges_m.map(|edge| edge * edge / 12.0);
        let m = self.mass_kg;
        LinkBody {
            mass_kg: m,
            com_m: self.com_m,
            inertia_at_com_kg_m2: [m * (b + c), 0.0, 0.0, m * (a + c), 0.0, m * (a + b)],
        }
    }
}

impl Physics for Payload {
    const KIND: Declaration = Declaration::new("payload", Family::I, Presence::Later, Takes::All);
    const PARAMETERS: &'static [&'static str] = &["mass_kg", "link"];

    fn draw(context: &Draw<'_>, random: &mut Random) -> Self {
        let last = context.robot.joints() - 1;
        let link = if random.chance(0.8) { last } else { last.saturating_sub(1 + random.index(3)) };
        let side = |random: &mut Random| random.between(-0.06, 0.06);
        Self {
            link,
            mass_kg: random.between(0.5, 1.5),
            com_m: [side(random), side(random), random.between(0.02, 0.14)],
            edges_m: [random.between(0.04, 0.15), random.between(0.04, 0.15), random.between(0.04, 0.15)],
        }
    }

    fn joints(&self) -> Vec<usize> {
        (0..=self.link).collect()
    }

    fn scale(&mut self, factor: Factor<'_>, _robot: &Robot) {
        self.mass_kg = (self.mass_kg * factor.on(self.link)).clamp(0.01, 12.0);
    }

    fn check(&self, complaints: &mut Checks<'_>) {
        complaints.link(self.link);
        complaints.positive("mass of the payload in kg", self.mass_kg);
        for x in self.com_m {
            complaints.within("centre of mass of the payload in m", x, -2.0, 2.0);
        }
        for x in self.edges_m {
            complaints.positive("edge of the payload in m", x);
        }
    }

    fn install(&self, setup: &mut Setup) -> Result<(), SimulationError> {
        let carrier = &mut setup.machine.robot.links[self.link];
        let mut sum = carrier.standard_parameters();
        for (s, p) in sum.iter_mut().zip(self.body().standard_parameters()) {
            *s += p;
        }
        let Some(both) = LinkBody::from_standard_parameters(&sum) else {
            return Err(SimulationError::value(
                "mass of the payload in kg",
                self.mass_kg,
                "it must be positive",
            ));
        };
        *carrier = both;
        Ok(())
    }
}
