//! The friction of a joint, put together from one model for each factor of equation (6).

use aurt_friction::coulomb::absent::Absent;
use aurt_friction::coulomb::absolute::Absolute;
use aurt_friction::coulomb::constant::Constant;
use aurt_friction::coulomb::stribeck::Stribeck;
use aurt_friction::hysteresis::sign::Sign;
use aurt_friction::viscous::polynomial::Polynomial;
use aurt_traits::{CoulombModel, HysteresisModel, JointStack, ViscousBasis};

use crate::model::error::Error;

/// The friction of a joint, f_C(τ_J)·H(z, q̇) + f_v(q̇): a Coulomb level f_C, a hysteresis H, viscous friction f_v.
///
/// Every model of [`aurt_friction`] and every model of one's own that implements the trait of its factor can be named:
///
/// ```
/// use aurt_friction::{coulomb::stribeck::{LoadDependence, Stribeck}, hysteresis::dahl::Dahl};
/// use aurt_plugins::model::Friction;
///
/// let plain = Friction::coulomb().viscous(1);
/// let harmonic_drive = Friction::load_dependent().hysteresis(Dahl { presliding_rad: 0.02 }).viscous(2);
/// let slow = Friction::coulomb().level(Stribeck { load: LoadDependence::Absolute, ..Stribeck::default() }).viscous(1);
/// # let _ = (plain, harmonic_drive, slow);
/// ```
#[derive(Debug, Clone)]
pub struct Friction {
    coulomb: Box<dyn CoulombModel>,
    hysteresis: Box<dyn HysteresisModel>,
    viscous: Box<dyn ViscousBasis>,
}

impl Friction {
    /// Friction of three models, such as a [`Registry`](crate::Registry) builds by their names.
    pub fn new(
        coulomb: Box<dyn CoulombModel>,
        hysteresis: Box<dyn HysteresisModel>,
        viscous: Box<dyn ViscousBasis>,
    ) -> Self {
        Self { coulomb, hysteresis, viscous }
    }

    /// No friction, f = 0.
    pub fn absent() -> Self {
        Self::new(Box::new(Absent {}), Box::new(Sign::default()), Box::new(Polynomial { powers: Vec::new() }))
    }

    /// Dry friction that does not depend on the load, F_C0 sgn q̇.
    pub fn coulomb() -> Self {
        Self::absent().level(Constant {})
    }

    /// Dry friction that grows with the load, (F_C0 + F_C1 |τ_J|) sgn q̇.
    pub fn load_dependent() -> Self {
        Self::absent().level(Absolute {})
    }

    /// The same friction with a level that is higher near rest and does not depend on the load,
    /// (F_C0 + ΔF_S0 e^(−|q̇/v_S|^δ)); [`Self::level`] takes the load-dependent one.
    #[must_use]
    pub fn stribeck(self) -> Self {
        self.level(Stribeck::default())
    }

    /// The same friction with viscous terms of the powers 1 … `highest`, Σ F_v,i q̇ |q̇|^(i−1); none for 0.
    #[must_use]
    pub fn viscous(self, highest: u32) -> Self {
        self.velocity(Polynomial { powers: (1..=highest).collect() })
    }

    /// The same friction with another Coulomb level f_C(τ_J).
    #[must_use]
    pub fn level(self, model: impl CoulombModel + 'static) -> Self {
        Self { coulomb: Box::new(model), ..self }
    }

    /// The same friction with another hysteresis H(z, q̇): presliding, or a smooth sign.
    #[must_use]
    pub fn hysteresis(self, model: impl HysteresisModel + 'static) -> Self {
        Self { hysteresis: Box::new(model), ..self }
    }

    /// The same friction with another viscous friction f_v(q̇).
    #[must_use]
    pub fn velocity(self, model: impl ViscousBasis + 'static) -> Self {
        Self { viscous: Box::new(model), ..self }
    }

    /// The joint's stack of models.
    ///
    /// # Errors
    /// [`Error::Assembly`] for a model that lacks an invariant of its factor.
    pub fn stack(self) -> Result<JointStack, Error> {
        JointStack::new(self.coulomb, self.hysteresis, self.viscous).map_err(Error::Assembly)
    }
}

impl Default for Friction {
    /// F_C0 sgn q̇ + F_v1 q̇.
    fn default() -> Self {
        Self::coulomb().viscous(1)
    }
}
