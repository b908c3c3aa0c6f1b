use serde::{Deserialize, Serialize};

/// The shape of an effect; its size is that of [`Added`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "law", rename_all = "snake_case")]
pub enum Law {
    /// size · sgn q̇.
    Coulomb,
    /// size, while the joint moves: half the difference of the levels of the two directions.
    CoulombAsymmetry,
    /// size · exp(−|q̇/v|^δ) sgn q̇.
    Stribeck {
        /// v, rad/s.
        velocity_rad_s: f64,
        /// δ.
        exponent: f64,
    },
    /// size · q̇.
    Viscous,
    /// size · (v tanh(q̇/v) − q̇ v/(v + v_max)): a slope that falls with speed, less about its mean.
    ViscousNonlinear {
        /// v, where the slope falls, rad/s.
        knee_rad_s: f64,
    },
    /// size · |q̇|.
    ViscousAsymmetry,
    /// size · z, dz = (1 − |z| sgn(z q̇)) dq/d, the bristle of Dahl.
    PreslidingHysteresis {
        /// d, rad.
        distance_rad: f64,
    },
    /// size · |τ_J| sgn q̇.
    LoadDependentFriction,
    /// size · |τ_J| sgn q̇ where the drive delivers power, `driven` times that where it receives power.
    DriveEfficiency {
        /// Loss while driven over loss while driving.
        driven: f64,
    },
    /// −size · ln(1 + t/t₀) times the joint's own friction.
    TemperatureDependentFriction { origin_s: f64 },
    /// size times the joint's own Coulomb friction, and `viscous` times as much of its viscous friction.
    FrictionLevelChanged {
        /// Relative change of viscous over that of Coulomb friction.
        viscous: f64,
    },
    /// size · (sgn w + `viscous_s` w + `inertia_s2` ẇ) with w = q̇_j + ratio q̇_k, on joint j, and ratio times that on k.
    JointCouplingFriction {
        /// k.
        partner: usize,
        ratio: f64,
        /// Viscous over Coulomb coefficient, s/rad.
        viscous_s: f64,
        /// Inertia over Coulomb coefficient, s²/rad.
        inertia_s2: f64,
    },
    /// size · q̈.
    RotorInertia,
    /// A body of mass size on a link.
    Payload {
        link: usize,
        /// Centre of mass in the link's frame, m.
        com_m: [f64; 3],
        /// Radius of gyration about it, m.
        gyration_m: f64,
    },
    /// The base tilted by size.
    BaseTilt {
        /// atan2(pitch, roll).
        direction_rad: f64,
    },
    /// A recorded angle that is too large by size.
    EncoderOffset,
    /// size · (q − q₀).
    Spring {
        /// q₀, rad.
        rest_rad: f64,
    },
    /// size · sin(N q + φ).
    TorqueRipple {
        /// N.
        order: f64,
        /// φ, rad.
        phase_rad: f64,
    },
    /// M(q) e_j (R − 1) q̈_j with the resonator R of a joint of stiffness 1/size and the arm's mean inertia.
    JointElasticity { damping_ratio: f64 },
    /// The measurement times 1/(1 + size).
    TorqueConstant,
    /// size.
    CurrentOffset,
    /// The measurement later by size.
    TimeDelay,
    /// The measurement clipped at (1 − size) of its peak.
    Saturation {
        /// The peak, in the unit of the measurement.
        peak: f64,
    },
    /// Rows missing, and rows that repeat the one before, in bursts, size of them all.
    DroppedSamples { seed: u64 },
    /// Jᵀ F in a window, |F| = size.
    ExternalContact {
        /// The link that is touched, at its frame's origin.
        link: usize,
        /// Direction of F in the base frame.
        direction: [f64; 3],
        /// The window, s from the first stamp.
        window_s: [f64; 2],
    },
    /// size · sin(2π f t + φ).
    PeriodicDisturbance {
        frequency_hz: f64,
        /// φ, rad.
        phase_rad: f64,
    },
    /// size · (1 + sin(2 (q_k − q₀)))/2 · sgn q̇: dry friction that depends on another joint's angle.
    CrossAngleFriction {
        /// k.
        partner: usize,
        /// q₀, rad.
        middle_rad: f64,
    },
    /// size · sgn q̇ within a range of angles.
    StickingWindow {
        /// From and to, rad.
        place_rad: [f64; 2],
    },
    /// size · (1 + sin(2 (q − q₀))) q̇: a damper whose strength depends on the angle.
    PositionDamper {
        /// q₀, rad.
        middle_rad: f64,
    },
}

/// An effect that is added to recordings.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Added {
    pub law: Law,
    /// The joint that it is on; of effects of the whole arm, any.
    pub joint: usize,
    /// Its size, in the unit that `Self::unit` names; never negative.
    pub size: f64,
    /// 1 or −1: which way it acts, where it can act either way.
    pub sign: f64,
}

impl Added {
    /// The same effect of another size.
    pub fn of_size(&self, size: f64) -> Self {
        Self { size, ..self.clone() }
    }

    /// Whether what is added is in proportion to the size.
    pub const fn is_linear(&self) -> bool {
        !matches!(
            self.law,
            Law::TorqueConstant
                | Law::TimeDelay
                | Law::Saturation { .. }
                | Law::BaseTilt { .. }
                | Law::EncoderOffset
                | Law::JointElasticity { .. }
                | Law::DroppedSamples { .. }
        )
    }

    /// Whether it takes rows away and adds no torque.
    pub const fn is_loss_of_rows(&self) -> bool {
        matches!(self.law, Law::DroppedSamples { .. })
    }

    /// Whether it is confined to a window of one recording.
    pub const fn is_local(&self) -> bool {
        matches!(self.law, Law::ExternalContact { .. })
    }

    pub(super) fn signed(&self) -> f64 {
        self.sign * self.size
    }
}
