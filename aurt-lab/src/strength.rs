//! How strong an effect is to be.

words! {
    /// How strong an effect is to be: its torque that the baseline cannot absorb, root mean square over the
    /// standard deviation of the measured torque's noise, on the joint where it is largest.
    Strength {
        /// 0.3.
        Weak = "weak",
        /// 1.
        Medium = "medium",
        /// 3.
        Strong = "strong",
    }
}

impl Strength {
    /// The ratio that is aimed at.
    pub const fn over_noise(self) -> f64 {
        match self {
            Self::Weak => 0.3,
            Self::Medium => 1.0,
            Self::Strong => 3.0,
        }
    }

    /// What the unaltered model leaves, times this, is the wanted root mean square of an effect added to recordings.
    pub const fn over_left(self) -> f64 {
        match self {
            Self::Weak => 0.7,
            Self::Medium => 1.5,
            Self::Strong => 4.0,
        }
    }
}
