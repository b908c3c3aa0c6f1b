//! Names and units of the parameters of effects.

use aurt_traits::MeasurementUnit;

/// Unit of a parameter. A model calibrated on motor currents has A in the place of Nm, and A/Nm kg in the place of kg.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unit {
    /// A ratio, a count or the number of a thing.
    One,
    Measurement,
    /// Nm.
    Torque,
    /// 1/Nm.
    PerTorque,
    /// Nm s/rad.
    Damping,
    /// Nm/rad.
    Stiffness,
    /// kg m².
    Inertia,
    /// kg.
    Mass,
    /// kg m.
    FirstMoment,
    /// m.
    Length,
    /// rad.
    Angle,
    /// rad/s.
    Velocity,
    /// s.
    Time,
    /// Hz.
    Frequency,
    /// N.
    Force,
}

impl Unit {
    /// What names of parameters of the unit end with, and its symbol, in a model of torques.
    const fn of_torques(self) -> [&'static str; 2] {
        match self {
            Self::One => ["", ""],
            Self::Measurement => ["", "Nm"],
            Self::Torque => ["_nm", "Nm"],
            Self::PerTorque => ["_per_nm", "1/Nm"],
            Self::Damping => ["_nm_s", "Nm s/rad"],
            Self::Stiffness => ["_nm_rad", "Nm/rad"],
            Self::Inertia => ["_kg_m2", "kg m²"],
            Self::Mass => ["_kg", "kg"],
            Self::FirstMoment => ["_kg_m", "kg m"],
            Self::Length => ["_m", "m"],
            Self::Angle => ["_rad", "rad"],
            Self::Velocity => ["_rad_s", "rad/s"],
            Self::Time => ["_s", "s"],
            Self::Frequency => ["_hz", "Hz"],
            Self::Force => ["_n", "N"],
        }
    }

    /// The same in a model of currents.
    const fn of_currents(self) -> [&'static str; 2] {
        match self {
            Self::Measurement => ["", "A"],
            Self::Torque => ["_a", "A"],
            Self::PerTorque => ["_per_a", "1/A"],
            Self::Damping => ["_a_s", "A s/rad"],
            Self::Stiffness => ["_a_rad", "A/rad"],
            Self::Inertia => ["_a_per_nm_kg_m2", "A/Nm kg m²"],
            Self::Mass => ["_a_per_nm_kg", "A/Nm kg"],
            Self::FirstMoment => ["_a_per_nm_kg_m", "A/Nm kg m"],
            other => other.of_torques(),
        }
    }

    const fn of(self, measured: MeasurementUnit) -> [&'static str; 2] {
        match measured {
            MeasurementUnit::NewtonMetre => self.of_torques(),
            MeasurementUnit::Ampere => self.of_currents(),
        }
    }

    /// Its symbol, in a model of what is measured in a unit.
    pub const fn symbol(self, measured: MeasurementUnit) -> &'static str {
        self.of(measured)[1]
    }

    /// Whether a value in it is off by as much as the drives' gains are.
    pub(crate) const fn follows_gains(self) -> bool {
        matches!(
            self,
            Self::Torque
                | Self::PerTorque
                | Self::Damping
                | Self::Stiffness
                | Self::Inertia
                | Self::Mass
                | Self::FirstMoment
        )
    }
}

/// A parameter of an effect.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Parameter {
    /// Its canonical name, with its unit in a model of torques.
    pub name: &'static str,
    pub unit: Unit,
    /// Whether a negative value would drive the arm with energy from nowhere.
    pub never_negative: bool,
    /// Names of its components, if it is a vector or a tensor.
    pub components: &'static [&'static str],
}

impl Parameter {
    /// A number, or one for each joint, that may be negative.
    pub(crate) const fn new(name: &'static str, unit: Unit) -> Self {
        Self { name, unit, never_negative: false, components: &[] }
    }

    /// One of friction or inertia, which takes energy from the arm, or stores it.
    pub(crate) const fn never_negative(self) -> Self {
        Self { never_negative: true, ..self }
    }

    /// A vector or a tensor.
    pub(crate) const fn of(self, components: &'static [&'static str]) -> Self {
        Self { components, ..self }
    }

    /// Its name in a model of what is measured in a unit: `coulomb_nm` is `coulomb_a` in a model of currents.
    pub fn name_in(&self, measured: MeasurementUnit) -> String {
        let stem = self.name.strip_suffix(self.unit.of_torques()[0]).unwrap_or(self.name);
        format!("{stem}{}", self.unit.of(measured)[0])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_say_the_unit() {
        let named = |name, unit| Parameter::new(name, unit).name_in(MeasurementUnit::Ampere);
        assert_eq!(named("amplitude_nm", Unit::Torque), "amplitude_a");
        assert_eq!(named("inertia_kg_m2", Unit::Inertia), "inertia_a_per_nm_kg_m2");
        assert_eq!(named("order", Unit::One), "order");
        assert_eq!(
            Unit::Mass.symbol(MeasurementUnit::Ampere),
            "A/Nm kg",
            "a mass in amperes is no mass in kg"
        );
    }
}
