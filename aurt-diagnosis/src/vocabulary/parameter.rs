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
    /// Ending of the names of its parameters in a model of what is measured. Joints that slide have forces and lengths where
    /// others have torques and angles.
    const fn ending(self, measured: MeasurementUnit, slides: bool) -> &'static str {
        match (self, measured, slides) {
            (Self::One | Self::Measurement, ..) => "",
            (Self::Torque, MeasurementUnit::NewtonMetre, false) => "_nm",
            (Self::Torque, MeasurementUnit::NewtonMetre, true) => "_n",
            (Self::Torque, MeasurementUnit::Ampere, _) => "_a",
            (Self::PerTorque, MeasurementUnit::NewtonMetre, false) => "_per_nm",
            (Self::PerTorque, MeasurementUnit::NewtonMetre, true) => "_per_n",
            (Self::PerTorque, MeasurementUnit::Ampere, _) => "_per_a",
            (Self::Damping, MeasurementUnit::NewtonMetre, false) => "_nm_s",
            (Self::Damping, MeasurementUnit::NewtonMetre, true) => "_n_s_per_m",
            (Self::Damping, MeasurementUnit::Ampere, false) => "_a_s",
            (Self::Damping, MeasurementUnit::Ampere, true) => "_a_s_per_m",
            (Self::Stiffness, MeasurementUnit::NewtonMetre, false) => "_nm_rad",
            (Self::Stiffness, MeasurementUnit::NewtonMetre, true) => "_n_per_m",
            (Self::Stiffness, MeasurementUnit::Ampere, false) => "_a_rad",
            (Self::Stiffness, MeasurementUnit::Ampere, true) => "_a_per_m",
            (Self::Inertia, MeasurementUnit::NewtonMetre, false) => "_kg_m2",
            (Self::Inertia, MeasurementUnit::Ampere, false) => "_a_per_nm_kg_m2",
            (Self::Inertia, MeasurementUnit::Ampere, true) => "_a_per_n_kg",
            (Self::Mass, MeasurementUnit::NewtonMetre, _) | (Self::Inertia, _, true) => "_kg",
            (Self::Mass, MeasurementUnit::Ampere, _) => "_a_per_nm_kg",
            (Self::FirstMoment, MeasurementUnit::NewtonMetre, _) => "_kg_m",
            (Self::FirstMoment, MeasurementUnit::Ampere, _) => "_a_per_nm_kg_m",
            (Self::Length, ..) | (Self::Angle, _, true) => "_m",
            (Self::Angle, _, false) => "_rad",
            (Self::Velocity, _, false) => "_rad_s",
            (Self::Velocity, _, true) => "_m_s",
            (Self::Time, ..) => "_s",
            (Self::Frequency, ..) => "_hz",
            (Self::Force, ..) => "_n",
        }
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

    /// Its name in a model of what is measured in a unit: `coulomb_nm` is `coulomb_a` in a model of currents, and `coulomb_n` of
    /// joints that slide.
    pub fn name_in(&self, measured: MeasurementUnit, slides: bool) -> String {
        let in_torques = self.unit.ending(MeasurementUnit::NewtonMetre, false);
        let stem = self.name.strip_suffix(in_torques).unwrap_or(self.name);
        format!("{stem}{}", self.unit.ending(measured, slides))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_say_the_unit() {
        let named = |name, unit| Parameter::new(name, unit).name_in(MeasurementUnit::Ampere, false);
        assert_eq!(named("amplitude_nm", Unit::Torque), "amplitude_a");
        assert_eq!(named("inertia_kg_m2", Unit::Inertia), "inertia_a_per_nm_kg_m2");
        assert_eq!(named("order", Unit::One), "order");
        let inertia = Parameter::new("inertia_kg_m2", Unit::Inertia);
        assert_eq!(inertia.name_in(MeasurementUnit::NewtonMetre, true), "inertia_kg");
    }
}
