use super::declaring::*;
use crate::plant::{CoupledRotor, Gear};

/// A rotor that turns with q̇_joint + ratio · q̇_partner, with inertia and friction of its own.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct JointCouplingFriction {
    pub joint: usize,
    pub partner: usize,
    /// The ratio on the other joint.
    pub ratio: f64,
    /// Inertia of the rotor, kg m².
    pub inertia_kg_m2: f64,
    /// Viscous friction of the rotor, Nm s/rad.
    pub viscous_nm_s: f64,
    /// Coulomb friction of the rotor, Nm.
    pub coulomb_nm: f64,
}

impl Physics for JointCouplingFriction {
    const KIND: Declaration =
        Declaration::new("joint_coupling_friction", Family::C, Presence::Structural, Takes::Pair);
    const PARAMETERS: &'static [&'static str] =
        &["partner", "ratio", "inertia_kg_m2", "viscous_nm_s", "coulomb_nm"];

    fn draw(context: &Draw<'_>, random: &mut Random) -> Self {
        let joint = context.drive().0;
        // A neighbour is the usual partner.
        let last = context.robot.joints() - 1;
        let neighbour =
            if joint == last || (joint > 0 && random.chance(0.5)) { joint.max(1) - 1 } else { joint + 1 };
        let partner =
            if random.chance(0.75) { neighbour } else { context.joints.get(1).copied().unwrap_or(neighbour) };
        let noise =
            context.robot.drives[joint].torque_noise_nm.min(context.robot.drives[partner].torque_noise_nm);
        let ratio = if context.continuous() {
            random.sign() * random.between(0.2, 3.0)
        } else {
            let ratios = [1.0, 1.0, -1.0, 0.5, -0.5];
            ratios[random.index(ratios.len())]
        };
        Self {
            joint,
            partner,
            ratio,
            inertia_kg_m2: 0.03 * noise * random.between(0.3, 1.0),
            viscous_nm_s: 0.6 * noise * random.between(0.6, 1.2),
            coulomb_nm: 1.2 * noise * random.between(0.7, 1.2),
        }
    }

    fn joints(&self) -> Vec<usize> {
        let mut joints = vec![self.joint, self.partner];
        joints.sort_unstable();
        joints
    }

    fn scale(&mut self, factor: Factor<'_>, robot: &Robot) {
        let most = robot.drives.iter().map(|d| d.coulomb_nm).fold(0.1, f64::max);
        let factor = factor.on(self.joint).min(3.0 * most / self.coulomb_nm.max(1e-12));
        self.inertia_kg_m2 *= factor;
        self.viscous_nm_s *= factor;
        self.coulomb_nm *= factor;
    }

    fn check(&self, complaints: &mut Checks<'_>) {
        complaints.joints(&[self.joint, self.partner]);
        complaints.within("ratio of the coupling", self.ratio, -100.0, 100.0);
        complaints.not_negative("inertia of the coupled rotor", self.inertia_kg_m2);
        complaints.not_negative("viscous friction of the coupled rotor", self.viscous_nm_s);
        complaints.not_negative("Coulomb friction of the coupled rotor", self.coulomb_nm);
    }

    fn install(&self, setup: &mut Setup) -> Result<(), SimulationError> {
        for joint in self.joints() {
            if setup.machine.joints[joint].gear != Gear::Rigid {
                let reason = "a coupled rotor needs rigid gears";
                return Err(conflict(Self::KIND.identifier, "a compliant gear", joint, reason));
            }
        }
        setup.machine.couplings.push(CoupledRotor {
            ratios: vec![(self.joint, 1.0), (self.partner, self.ratio)],
            inertia_kg_m2: self.inertia_kg_m2,
            viscous_nm_s: self.viscous_nm_s,
            coulomb_nm: self.coulomb_nm,
        });
        Ok(())
    }
}
