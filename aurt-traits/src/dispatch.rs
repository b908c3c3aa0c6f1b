use std::fmt;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicU8, Ordering};

use crate::ModelError;

/// The instruction set that kernels run on: the regressor's, the filter bank's, that of least squares.
///
/// Results agree between levels to rounding (1e-12 relative is tested); [`Self::Avx2`] and [`Self::Avx512`]
/// agree bit for bit, and [`Self::Baseline`] gives the same bits on every machine, because it uses neither
/// fused operations nor the platform's mathematical library. Plugins from dynamic libraries choose for themselves.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Dispatch {
    /// What every processor of the target has (SSE2 on x86-64, NEON on AArch64), two samples at a time.
    Baseline,
    /// AVX2 with fused multiply-add, four samples at a time.
    Avx2,
    /// AVX-512F, eight samples at a time.
    Avx512,
}

/// The level set by [`Dispatch::select`], plus one; 0 as long as nobody has.
static SELECTED: AtomicU8 = AtomicU8::new(0);

impl Dispatch {
    /// All levels, slowest first.
    pub const ALL: [Self; 3] = [Self::Baseline, Self::Avx2, Self::Avx512];

    /// The environment variable that overrides the choice: `AURT_SIMD=baseline|avx2|avx512`.
    pub const VARIABLE: &str = "AURT_SIMD";

    /// The level's name, as the environment variable spells it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Baseline => "baseline",
            Self::Avx2 => "avx2",
            Self::Avx512 => "avx512",
        }
    }

    /// Whether this processor has the level.
    pub fn is_available(self) -> bool {
        match self {
            Self::Baseline => true,
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma"),
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 => {
                Self::Avx2.is_available()
                    && is_x86_feature_detected!("avx512f")
                    && is_x86_feature_detected!("avx512dq")
                    && is_x86_feature_detected!("avx512vl")
            }
            #[cfg(not(target_arch = "x86_64"))]
            Self::Avx2 | Self::Avx512 => false,
        }
    }

    /// The levels that this processor has, slowest first.
    pub fn available() -> Vec<Self> {
        Self::ALL.into_iter().filter(|level| level.is_available()).collect()
    }

    /// The level of a name, if this processor has it.
    ///
    /// # Errors
    /// [`ModelError::InstructionSet`] for an unknown name or a level that is not available.
    pub fn from_name(name: &str) -> Result<Self, ModelError> {
        let refuse = |reason| {
            let available: Vec<_> = Self::available().into_iter().map(Self::name).collect();
            Err(ModelError::InstructionSet { asked: name.into(), reason, available: available.join(", ") })
        };
        match Self::ALL.into_iter().find(|level| level.name() == name.trim().to_ascii_lowercase()) {
            None => refuse("is not known"),
            Some(level) if !level.is_available() => refuse("is not available on this processor"),
            Some(level) => Ok(level),
        }
    }

    /// What the environment variable asks for; `None` if it is unset or empty.
    ///
    /// # Errors
    /// As [`Self::from_name`].
    pub fn from_environment() -> Result<Option<Self>, ModelError> {
        match std::env::var(Self::VARIABLE) {
            Ok(name) if !name.trim().is_empty() => Self::from_name(&name).map(Some),
            _ => Ok(None),
        }
    }

    /// Sets the level for the whole process from now on, over environment and detection;
    /// `Dispatch::Baseline.select()` makes runs bit-reproducible across machines.
    ///
    /// # Errors
    /// [`ModelError::InstructionSet`] if the level is not available.
    pub fn select(self) -> Result<(), ModelError> {
        Self::from_name(self.name())?;
        SELECTED.store(self as u8 + 1, Ordering::Relaxed);
        Ok(())
    }

    /// The level in force: the selected one, else the environment's, else the best available. An
    /// environment variable that cannot be followed is passed over here; a program that wants to refuse
    /// it calls [`Self::from_environment`] at its start.
    pub fn active() -> Self {
        static DETECTED: OnceLock<Dispatch> = OnceLock::new();
        match SELECTED.load(Ordering::Relaxed) {
            0 => *DETECTED.get_or_init(|| {
                let best = Self::ALL.into_iter().rev().find(|level| level.is_available());
                Self::from_environment().ok().flatten().or(best).unwrap_or(Self::Baseline)
            }),
            level => Self::ALL[usize::from(level) - 1],
        }
    }
}

impl fmt::Display for Dispatch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
