//! What the file of an effect declares, and all else that follows from it.

use std::fmt::Debug;
use std::ops::{Deref, DerefMut};

use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::Value;

use super::effect::{Effect, Factor, Hidden, Setup, check_joints, check_values};
use super::kind::{Draw, EffectKind, Family, Presence, Takes};
use crate::error::{Complaints, SimulationError};
use crate::random::Random;
use crate::robots::{Robot, Rotors};

/// The names of an effect, in which recordings it can be, and how many joints it takes.
#[derive(Debug, Clone, Copy)]
pub struct Declaration {
    /// Identifier, snake_case.
    pub identifier: &'static str,
    pub family: Family,
    pub presence: Presence,
    pub takes: Takes,
}

impl Declaration {
    pub const fn new(identifier: &'static str, family: Family, presence: Presence, takes: Takes) -> Self {
        Self { identifier, family, presence, takes }
    }
}

/// An effect as its file declares it: its names, what it is drawn from, and what it does to the machine. Whatever has
/// this is an [`Effect`] of the kind [`EffectKind::of`] it.
pub trait Physics: Debug + Send + Sync + Serialize + DeserializeOwned + 'static {
    const KIND: Declaration;
    /// Where the rotors' inertia has to be, if that matters.
    const ROTORS: Option<Rotors> = None;

    /// Its parameters, by the names of their fields.
    const PARAMETERS: &'static [&'static str] = &[];
    /// Fields with a value for each joint, and the bounds of these.
    const VALUES: &'static [(&'static str, [f64; 2])] = &[];
    /// Terms of the robot's own friction that it stands for, as [`Effect::hidden`].
    const HIDDEN: Hidden = Hidden::Nothing;
    /// Whether it can be on a joint.
    const SUITS: fn(&Robot, usize) -> bool = |_, _| true;

    /// An effect of medium strength, as far as that can be said beforehand.
    fn draw(context: &Draw<'_>, random: &mut Random) -> Self;

    /// As [`Effect::joints`]: those that the fields `joint` or `joints` name.
    fn joints(&self) -> Vec<usize> {
        let fields = serde_json::to_value(self).unwrap_or_default();
        let joints = fields["joints"].as_array().cloned().unwrap_or_else(|| vec![fields["joint"].clone()]);
        joints.iter().filter_map(Value::as_u64).map(|joint| joint as usize).collect()
    }

    /// As [`Effect::parameters`]: the fields that [`Self::PARAMETERS`] names.
    fn parameters(&self) -> Vec<(&'static str, Vec<f64>)> {
        Self::PARAMETERS.iter().map(|name| (*name, self.numbers(name))).collect()
    }

    /// The number of a field, or its numbers.
    fn numbers(&self, field: &str) -> Vec<f64> {
        let fields = serde_json::to_value(self).unwrap_or_default();
        let numbers = fields[field].as_array().map_or(std::slice::from_ref(&fields[field]), Vec::as_slice);
        numbers.iter().map(|number| number.as_f64().unwrap_or(f64::NAN)).collect()
    }

    /// As [`Effect::window_s`].
    fn window_s(&self) -> Option<[f64; 2]> {
        None
    }

    /// As [`Effect::scale`].
    fn scale(&mut self, factor: Factor<'_>, robot: &Robot);

    /// Complains about what cannot be on this robot. The joints of an effect that takes one or a few and
    /// [`Self::VALUES`] are checked before.
    fn check(&self, complaints: &mut Checks<'_>) {
        let _ = complaints;
    }

    /// As [`Effect::install`].
    ///
    /// # Errors
    /// [`SimulationError::Conflict`] with an effect that is there already.
    fn install(&self, setup: &mut Setup) -> Result<(), SimulationError>;
}

/// An effect of one value on each of some joints: its type, and what [`Physics`] asks of it. What else it declares comes last.
macro_rules! per_joint {
    (
        $(#[$about:meta])*
        $effect:ident {
            $(#[$of:meta])*
            $field:ident: $bounds:expr,
        }
        $identifier:literal, $family:ident, $presence:ident, $takes:ident;
        drawn: |$context:ident, $random:ident| $values:expr;
        scaled_within: |$robot:ident, $joint:ident| $within:expr;
        installed: |$setup:ident, $at:ident, $value:ident| $install:block
        $($more:tt)*
    ) => {
        $(#[$about])*
        #[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
        #[serde(deny_unknown_fields)]
        pub struct $effect {
            pub joints: Vec<usize>,
            $(#[$of])*
            pub $field: Vec<f64>,
        }

        impl Physics for $effect {
            const KIND: Declaration =
                Declaration::new($identifier, Family::$family, Presence::$presence, Takes::$takes);
            const PARAMETERS: &'static [&'static str] = &[stringify!($field)];
            const VALUES: &'static [(&'static str, [f64; 2])] = &[(stringify!($field), $bounds)];

            fn draw($context: &Draw<'_>, $random: &mut Random) -> Self {
                Self { joints: $context.joints.to_vec(), $field: $values }
            }

            fn scale(&mut self, factor: Factor<'_>, $robot: &Robot) {
                factor.scale(&self.joints, &mut self.$field, |$joint| $within);
            }

            fn install(&self, $setup: &mut Setup) -> Result<(), SimulationError> {
                for ($at, $value) in self.joints.iter().copied().zip(self.$field.iter().copied()) $install
                Ok(())
            }

            $($more)*
        }
    };
}

pub(crate) use per_joint;

impl<P: Physics> Effect for P {
    fn identifier(&self) -> &'static str {
        P::KIND.identifier
    }

    fn joints(&self) -> Vec<usize> {
        P::joints(self)
    }

    fn parameters(&self) -> Vec<(&'static str, Vec<f64>)> {
        P::parameters(self)
    }

    fn window_s(&self) -> Option<[f64; 2]> {
        P::window_s(self)
    }

    fn hidden(&self) -> Hidden {
        P::HIDDEN
    }

    fn scale(&mut self, factor: Factor<'_>, robot: &Robot) {
        P::scale(self, factor, robot);
    }

    fn validate(&self, robot: &Robot) -> Result<(), SimulationError> {
        let joints = P::joints(self);
        let mut checks = Checks { found: Complaints::default(), effect: P::KIND.identifier, joints, robot };
        if matches!(P::KIND.takes, Takes::One | Takes::Few) {
            check_joints(&mut checks.found, P::KIND.identifier, &checks.joints, robot);
        }
        for (name, [low, high]) in P::VALUES {
            let bounds = (*low, *high);
            check_values(
                &mut checks.found,
                P::KIND.identifier,
                name,
                &checks.joints,
                &self.numbers(name),
                bounds,
            );
        }
        self.check(&mut checks);
        checks.found.finish()
    }

    fn install(&self, setup: &mut Setup) -> Result<(), SimulationError> {
        P::install(self, setup)
    }

    fn fields(&self) -> Value {
        serde_json::to_value(self).unwrap_or(Value::Null)
    }
}

impl EffectKind {
    pub const fn of<P: Physics>() -> Self {
        Self {
            identifier: P::KIND.identifier,
            family: P::KIND.family,
            presence: P::KIND.presence,
            rotors: P::ROTORS,
            takes: P::KIND.takes,
            suits: P::SUITS,
            draw: |context, random| Box::new(P::draw(context, random)),
            read: |fields| Ok(Box::new(serde_json::from_value::<P>(fields)?)),
        }
    }
}

/// The complaints about an effect on a robot.
#[derive(Debug)]
pub struct Checks<'a> {
    found: Complaints,
    effect: &'static str,
    joints: Vec<usize>,
    pub robot: &'a Robot,
}

impl Checks<'_> {
    /// Complains about a link that the robot does not have.
    pub fn link(&mut self, link: usize) {
        let Robot { name, links, .. } = self.robot;
        self.found.part(format!("`{}`", self.effect), "link", link, (name, links.len()));
    }

    /// Complains about joints that the robot does not have, none at all, or one named twice.
    pub fn joints(&mut self, joints: &[usize]) {
        check_joints(&mut self.found, self.effect, joints, self.robot);
    }
}

impl Deref for Checks<'_> {
    type Target = Complaints;

    fn deref(&self) -> &Complaints {
        &self.found
    }
}

impl DerefMut for Checks<'_> {
    fn deref_mut(&mut self) -> &mut Complaints {
        &mut self.found
    }
}
