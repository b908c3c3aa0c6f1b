//! The effects of a verdict as types.

use std::collections::BTreeMap;
use std::fmt;

use aurt_calibration::with_deviation;
use aurt_diagnosis::{Finding, ParameterValue};
use serde_json::Value;

/// An estimate with its standard deviation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// The value.
    pub value: f64,
    /// Its standard deviation, where one was estimated.
    pub std: Option<f64>,
}

impl fmt::Display for Estimate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.std {
            Some(std) => f.write_str(&with_deviation(self.value, std)),
            None => write!(f, "{}", self.value),
        }
    }
}

/// In which recordings an effect was found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Presence {
    /// In all recordings.
    Everywhere,
    /// In the targets alone: it is new.
    Target,
    /// In the calibration recordings alone: it has gone.
    Calibration,
}

/// An effect that a verdict claims.
#[derive(Debug, Clone, PartialEq)]
pub struct Named<'v> {
    /// The effect with its parameters.
    pub effect: Effect,
    /// All that the verdict says of it: joints, recordings, alternatives, evidence, the effect in a sentence.
    pub finding: &'v Finding,
}

impl Named<'_> {
    /// In which recordings it was found.
    pub fn presence(&self) -> Presence {
        let only = |kind: &str| self.finding.present_in.iter().all(|k| k == kind);
        match (only("target"), only("calibration")) {
            (true, false) => Presence::Target,
            (false, true) => Presence::Calibration,
            _ => Presence::Everywhere,
        }
    }
}

/// How a field is read from a parameter of a finding on so many joints.
trait Field: Sized {
    fn read(parameter: Option<&ParameterValue>, joints: usize) -> Option<Self>;
}

fn estimate(value: &Value, std: &Value) -> Option<Estimate> {
    Some(Estimate { value: value.as_f64()?, std: std.as_f64() })
}

/// A list; NaN stands for a joint that has no value.
fn list(value: &Value, std: &Value) -> Option<Vec<Estimate>> {
    let none = Estimate { value: f64::NAN, std: None };
    let of = |(k, v): (usize, &Value)| if v.is_null() { Some(none) } else { estimate(v, &std[k]) };
    value.as_array()?.iter().enumerate().map(of).collect()
}

impl Field for Estimate {
    fn read(parameter: Option<&ParameterValue>, _: usize) -> Option<Self> {
        let ParameterValue { value, std } = parameter?;
        estimate(value, std)
    }
}

impl Field for usize {
    fn read(parameter: Option<&ParameterValue>, _: usize) -> Option<Self> {
        let value = parameter?.value.as_f64()?;
        (value >= 0.0 && value.fract() == 0.0).then_some(value as Self)
    }
}

impl<const N: usize> Field for [Estimate; N] {
    fn read(parameter: Option<&ParameterValue>, _: usize) -> Option<Self> {
        let ParameterValue { value, std } = parameter?;
        list(value, std)?.try_into().ok()
    }
}

/// One entry for each joint of the finding; a number holds for all of them.
impl Field for Vec<Estimate> {
    fn read(parameter: Option<&ParameterValue>, joints: usize) -> Option<Self> {
        let ParameterValue { value, std } = parameter?;
        estimate(value, std).map(|one| vec![one; joints]).or_else(|| list(value, std))
    }
}

/// One list for each joint of the finding.
impl Field for Vec<Vec<Estimate>> {
    fn read(parameter: Option<&ParameterValue>, joints: usize) -> Option<Self> {
        let ParameterValue { value, std } = parameter?;
        if joints == 1 {
            return list(value, std).map(|only| vec![only]);
        }
        let of = |(k, v): (usize, &Value)| if v.is_null() { Some(Vec::new()) } else { list(v, &std[k]) };
        value.as_array()?.iter().enumerate().map(of).collect()
    }
}

impl<F: Field> Field for Option<F> {
    fn read(parameter: Option<&ParameterValue>, joints: usize) -> Option<Self> {
        Some(F::read(parameter, joints))
    }
}

macro_rules! effects {
    ($($(#[$doc:meta])* $kind:ident = $id:literal { $($(#[$of_field:meta])* $field:ident: $type:ty,)* })+) => {
        /// The effects that diagnoses know, by their kinds.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
        #[non_exhaustive]
        pub enum EffectKind {
            $($(#[$doc])* $kind,)+
        }

        impl EffectKind {
            /// All of them.
            pub const ALL: &'static [Self] = &[$(Self::$kind),+];

            /// The identifier in experiments, verdicts and `aurt explain`.
            pub const fn id(self) -> &'static str {
                match self { $(Self::$kind => $id),+ }
            }
        }

        $(
            $(#[$doc])*
            ///
            /// Lists have an entry for each joint of the [finding](Named::finding), NaN where a joint has no value. A model in A
            /// has A in the place of Nm.
            #[derive(Debug, Clone, PartialEq)]
            #[non_exhaustive]
            pub struct $kind { $($(#[$of_field])* pub $field: $type,)* }
        )+

        /// An effect with its parameters.
        #[derive(Debug, Clone, PartialEq)]
        #[non_exhaustive]
        pub enum Effect {
            $($(#[$doc])* $kind($kind),)+
            /// An effect that is none of these: a registered model, or what a newer version wrote.
            Other {
                /// Its identifier.
                id: String,
                /// Its parameters, as the verdict has them.
                parameters: BTreeMap<String, ParameterValue>,
            },
        }

        impl Effect {
            /// The effect of a finding.
            pub fn of(finding: &Finding) -> Self {
                let joints = finding.joints.len();
                let known = match finding.effect.as_str() {
                    $($id => (|| Some(Self::$kind($kind {
                        $($field: Field::read(finding.parameters.get(stringify!($field)), joints)?,)*
                    })))(),)+
                    _ => None,
                };
                let other = || Self::Other {
                    id: finding.effect.clone(),
                    parameters: finding.parameters.clone(),
                };
                known.unwrap_or_else(other)
            }

            /// Its kind; none of [`Self::Other`].
            pub const fn kind(&self) -> Option<EffectKind> {
                match self {
                    $(Self::$kind(_) => Some(EffectKind::$kind),)+
                    Self::Other { .. } => None,
                }
            }
        }
    };
}

effects! {
    /// Play in a gear.
    Backlash = "backlash" {
        /// Half the play, rad.
        gap_rad: Estimate,
        /// Stiffness of the flanks, Nm/rad.
        stiffness_nm_rad: Option<Estimate>,
        /// Damping of the flanks, Nm s/rad.
        damping_nm_s: Option<Estimate>,
    }
    /// A base that does not stand level.
    BaseTilt = "base_tilt" {
        /// About the first axis of the base, rad.
        roll_rad: Estimate,
        /// About the second axis of the base, rad.
        pitch_rad: Option<Estimate>,
    }
    /// Dry friction.
    Coulomb = "coulomb" {
        /// F_C, Nm.
        coulomb_nm: Vec<Estimate>,
    }
    /// Dry friction that differs between the directions.
    CoulombAsymmetry = "coulomb_asymmetry" {
        /// F_C for q̇ > 0, Nm.
        coulomb_pos_nm: Vec<Estimate>,
        /// F_C for q̇ < 0, Nm.
        coulomb_neg_nm: Vec<Estimate>,
    }
    /// A constant in the measurement.
    CurrentOffset = "current_offset" {
        /// In the unit of the measurement.
        offset: Vec<Estimate>,
    }
    /// Losses of the drive that depend on the direction of power.
    DriveEfficiency = "drive_efficiency" {
        /// While the motor drives the load, Nm/Nm.
        driving: Vec<Estimate>,
        /// While the load drives the motor, Nm/Nm.
        driven: Vec<Estimate>,
    }
    /// Rows of a recording that are missing, repeated, held or corrupt.
    DroppedSamples = "dropped_samples" {
        /// Share of the rows.
        share: Estimate,
    }
    /// An encoder with another zero.
    EncoderOffset = "encoder_offset" {
        /// The angle that the encoder shows too much, rad.
        offset_rad: Vec<Estimate>,
    }
    /// A force from outside during a window of time; the [finding](Named::finding) has the window.
    ExternalContact = "external_contact" {
        /// The link that is touched, as far as the joints can tell.
        link: usize,
        /// Mean force along the axes of the base frame, N.
        force_n: Option<[Estimate; 3]>,
    }
    /// Friction of another level than in the calibration recordings.
    FrictionLevelChanged = "friction_level_changed" {
        /// Change of dry friction, Nm, where the model's own is not known.
        coulomb_change_nm: Option<Vec<Estimate>>,
        /// Change of viscous friction, Nm s/rad, where the model's own is not known.
        viscous_change_nm_s: Option<Vec<Estimate>>,
        /// Dry friction in the calibration recordings, Nm.
        old_coulomb_nm: Option<Vec<Estimate>>,
        /// Dry friction in the targets, Nm.
        new_coulomb_nm: Option<Vec<Estimate>>,
        /// Viscous friction in the calibration recordings, Nm s/rad.
        old_viscous_nm_s: Option<Vec<Estimate>>,
        /// Viscous friction in the targets, Nm s/rad.
        new_viscous_nm_s: Option<Vec<Estimate>>,
    }
    /// Friction between two joints whose drives are coupled.
    JointCouplingFriction = "joint_coupling_friction" {
        /// The second joint.
        partner: usize,
        /// Turns of the partner in the coupling's velocity q̇ + ratio · q̇_partner.
        ratio: Estimate,
        /// Inertia, kg m².
        inertia_kg_m2: Option<Estimate>,
        /// Viscous friction, Nm s/rad.
        viscous_nm_s: Option<Estimate>,
        /// Dry friction, Nm.
        coulomb_nm: Option<Estimate>,
    }
    /// A link on an elastic gear.
    JointElasticity = "joint_elasticity" {
        /// Stiffness, Nm/rad, joint by joint, as all of these.
        stiffness_nm_rad: Vec<Estimate>,
        /// Damping, Nm s/rad.
        damping_nm_s: Option<Vec<Estimate>>,
        /// Frequency of the oscillation, Hz.
        frequency_hz: Option<Vec<Estimate>>,
    }
    /// Dry friction that grows with the load.
    LoadDependentFriction = "load_dependent_friction" {
        /// Friction per load, Nm/Nm.
        load_coefficient: Option<Vec<Estimate>>,
        /// Friction per square of the load, 1/Nm.
        load_coefficient_per_nm: Option<Vec<Estimate>>,
        /// Power of the load: 1 or 2.
        power: Vec<Estimate>,
    }
    /// A load attached to a link, or with a negative mass one that was taken off.
    Payload = "payload" {
        /// The link that carries it.
        link: usize,
        /// Mass, kg; none where the motion does not show it.
        mass_kg: Option<Estimate>,
        /// Centre of mass in the link's frame, m; none where the mass is not determined.
        com_m: Option<[Estimate; 3]>,
        /// Mass times centre of mass, kg m, where the mass is not determined.
        first_moment_kg_m: Option<[Estimate; 3]>,
        /// Inertia about the origin of the link's frame, XX XY XZ YY YZ ZZ, kg m².
        inertia_kg_m2: Option<[Estimate; 6]>,
    }
    /// Friction that builds up over a presliding distance.
    PreslidingHysteresis = "presliding_hysteresis" {
        /// Distances at which the elements slip, rad, of each joint.
        thresholds_rad: Vec<Vec<Estimate>>,
        /// Levels of the elements, Nm, of each joint.
        weights_nm: Vec<Vec<Estimate>>,
    }
    /// Inertia of a motor.
    RotorInertia = "rotor_inertia" {
        /// At the joint, kg m².
        inertia_kg_m2: Vec<Estimate>,
    }
    /// A measurement that stops at a limit.
    Saturation = "saturation" {
        /// The limit, in the unit of the measurement.
        limit: Vec<Estimate>,
        /// Share of the rows at the limit.
        share: Vec<Estimate>,
    }
    /// A spring between two links.
    Spring = "spring" {
        /// Stiffness, Nm/rad.
        stiffness_nm_rad: Vec<Estimate>,
        /// The angle at which it is relaxed, rad.
        rest_rad: Option<Vec<Estimate>>,
    }
    /// Friction that is higher near rest.
    Stribeck = "stribeck" {
        /// Level near rest, Nm.
        static_nm: Vec<Estimate>,
        /// Level at speed, Nm.
        coulomb_nm: Option<Vec<Estimate>>,
        /// Velocity of the transition, rad/s.
        stribeck_velocity_rad_s: Option<Vec<Estimate>>,
        /// Exponent of the transition.
        stribeck_exponent: Option<Vec<Estimate>>,
        /// Speed at which half of the difference of both levels is gone, rad/s.
        half_speed_rad_s: Option<Vec<Estimate>>,
    }
    /// Friction that changes while the robot warms up.
    TemperatureDependentFriction = "temperature_dependent_friction" {
        /// Relative change each time the uptime grows by the factor e.
        rate_per_efold: Option<Vec<Estimate>>,
        /// The same change at the end of the longest recording.
        change_at_end: Option<Vec<Estimate>>,
        /// Change of dry friction each time the uptime grows by the factor e, Nm.
        coulomb_per_efold_nm: Option<Vec<Estimate>>,
        /// Change of viscous friction each time the uptime grows by the factor e, Nm s/rad.
        viscous_per_efold_nm_s: Option<Vec<Estimate>>,
    }
    /// A measurement that is recorded later than the motion.
    TimeDelay = "time_delay" {
        /// Delay, s.
        delay_s: Vec<Estimate>,
    }
    /// A drive with another torque per current than assumed.
    TorqueConstant = "torque_constant" {
        /// Relative error of the gain.
        gain_error: Vec<Estimate>,
    }
    /// Torque that repeats with the angle of the joint.
    TorqueRipple = "torque_ripple" {
        /// Cycles per turn of the joint.
        order: Vec<Estimate>,
        /// Amplitude, Nm.
        amplitude_nm: Vec<Estimate>,
    }
    /// Viscous friction.
    Viscous = "viscous" {
        /// F_v, Nm s/rad.
        viscous_nm_s: Vec<Estimate>,
    }
    /// Viscous friction that differs between the directions.
    ViscousAsymmetry = "viscous_asymmetry" {
        /// F_v for q̇ > 0, Nm s/rad.
        viscous_pos_nm_s: Vec<Estimate>,
        /// F_v for q̇ < 0, Nm s/rad.
        viscous_neg_nm_s: Vec<Estimate>,
    }
    /// Viscous friction that is not proportional to velocity.
    ViscousNonlinear = "viscous_nonlinear" {
        /// Change of friction at 1 rad/s by the power of velocity, Nm.
        power_law_nm: Option<Vec<Estimate>>,
        /// Its exponent.
        velocity_exponent: Option<Vec<Estimate>>,
        /// Level at which friction saturates, Nm.
        saturation_nm: Option<Vec<Estimate>>,
        /// Velocity at which it saturates, rad/s.
        saturation_velocity_rad_s: Option<Vec<Estimate>>,
    }
}

impl AsRef<str> for EffectKind {
    fn as_ref(&self) -> &str {
        self.id()
    }
}
