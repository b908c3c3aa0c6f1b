use super::declaring::*;
use crate::plant::{Instant, ShaftTorque};

/// Ripple of gear or motor: amplitude · (sin(N q + φ) + ½ · overtone · sin(2 N q + 2.3 φ)) against the drive.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TorqueRipple {
    pub joint: usize,
    /// N, periods per revolution of the joint.
    pub order: f64,
    pub amplitude_nm: f64,
    /// φ, rad.
    pub phase_rad: f64,
    /// Size of the first overtone.
    pub overtone: f64,
}

impl Physics for TorqueRipple {
    const KIND: Declaration = Declaration::new("torque_ripple", Family::P, Presence::Structural, Takes::One);
    const PARAMETERS: &'static [&'static str] = &["order", "amplitude_nm"];

    fn draw(context: &Draw<'_>, random: &mut Random) -> Self {
        let (joint, drive) = context.drive();
        // The motor's revolution, the gear's two waves of it, and slower ones of bearings.
        if context.continuous() {
            // Teeth and poles make whole orders; belts, rollers and wave generators with slip make broken ones.
            let order = random.between_logs(3.0, 2.2 * drive.gear_ratio.clamp(10.0, 110.0));
            return Self {
                joint,
                order: if random.chance(0.5) { order.round() } else { order },
                amplitude_nm: 1.5 * drive.torque_noise_nm,
                phase_rad: random.between(0.0, std::f64::consts::TAU),
                overtone: random.between(0.0, 0.6),
            };
        }
        let orders = [12.0, 20.0, 36.0, drive.gear_ratio, 2.0 * drive.gear_ratio];
        Self {
            joint,
            order: orders[random.index(orders.len())],
            amplitude_nm: 1.5 * drive.torque_noise_nm,
            phase_rad: random.between(0.0, std::f64::consts::TAU),
            overtone: if random.chance(0.5) { random.between(0.0, 0.5) } else { 0.0 },
        }
    }

    fn scale(&mut self, factor: Factor<'_>, robot: &Robot) {
        let most = 0.2 * robot.drives[self.joint].torque_limit_nm;
        self.amplitude_nm = (self.amplitude_nm * factor.on(self.joint)).min(most);
    }

    fn check(&self, complaints: &mut Checks<'_>) {
        complaints.within("order of the ripple", self.order, 0.5, 2000.0);
        complaints.not_negative("amplitude of the ripple in Nm", self.amplitude_nm);
        complaints.within("overtone of the ripple", self.overtone, 0.0, 2.0);
    }

    fn install(&self, setup: &mut Setup) -> Result<(), SimulationError> {
        setup.machine.shaft_torques.push(Box::new(*self));
        Ok(())
    }
}

impl ShaftTorque for TorqueRipple {
    fn add(&self, at: &Instant<'_>, opposing_nm: &mut [f64]) {
        let angle = self.order * at.shaft_rad[self.joint] + self.phase_rad;
        let mut wave = libm::sin(angle);
        if self.overtone != 0.0 {
            wave += 0.5 * self.overtone * libm::sin(2.0 * angle + 0.3 * self.phase_rad);
        }
        opposing_nm[self.joint] += self.amplitude_nm * wave;
    }

    fn rate_per_s(&self, inertia_kg_m2: &dyn Fn(usize) -> f64) -> f64 {
        (self.amplitude_nm * self.order / inertia_kg_m2(self.joint)).sqrt()
    }
}
