//! Friction that falls as a joint warms up.

/// A joint's lubricant as two heat stores: friction heats the first, which passes heat to the second and to
/// the surroundings; friction falls exponentially with the temperature of the first.
#[derive(Debug, Clone, PartialEq)]
pub struct Warmth {
    /// Heating of the lubricant per friction power, K/(W s).
    pub heating_k_per_j: f64,
    /// Time constants of lubricant and housing, s.
    pub time_constants_s: [f64; 2],
    /// Relative fall of dry and of viscous friction per kelvin.
    pub fall_per_k: [f64; 2],
    /// Temperatures of lubricant and housing above the surroundings at the start, K.
    pub start_k: [f64; 2],
}

impl Warmth {
    /// Factors on dry and viscous friction at the lubricant's temperature above the surroundings.
    pub(crate) fn factors(&self, lubricant_k: f64) -> [f64; 2] {
        self.fall_per_k.map(|fall| libm::exp(-fall * lubricant_k))
    }

    /// Temperatures after `dt_s` under the given friction power.
    pub(crate) fn advance(&self, temperatures_k: [f64; 2], power_w: f64, dt_s: f64) -> [f64; 2] {
        let [lubricant, housing] = temperatures_k;
        let [quick, slow] = self.time_constants_s;
        [
            lubricant + dt_s * (self.heating_k_per_j * power_w - (lubricant - housing) / quick),
            housing + dt_s * ((lubricant - housing) / slow - 0.5 * housing / slow),
        ]
    }
}
