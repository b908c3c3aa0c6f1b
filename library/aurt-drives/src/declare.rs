//! Structures of numbers that are keys of an experiment and parameters of an estimate at once.

/// A limit that is not there: JSON has no infinity.
pub(crate) const UNLIMITED: f64 = 1e9;

/// A structure of numbers with, for each, a unit, a default, the deviation of what is known of it, and bounds.
macro_rules! numbers {
    ($(#[$documentation:meta])+ pub struct $name:ident {
        $($(#[doc = $meaning:literal])+ $(#[serde($former:meta)])? $key:ident: $unit:literal = $default:expr, $deviation:expr, [$lower:expr, $upper:expr];)+
    }) => {
        $(#[$documentation])+
        #[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
        #[serde(default, deny_unknown_fields)]
        pub struct $name { $($(#[doc = $meaning])+ $(#[serde($former)])? pub $key: f64,)+ }

        impl Default for $name {
            fn default() -> Self {
                Self { $($key: $default,)+ }
            }
        }

        impl $name {
            /// Every number with what is known of it.
            #[must_use]
            pub fn numbers(&self) -> Vec<aurt_traits::DriveParameter> {
                vec![$(aurt_traits::DriveParameter {
                    parameter: aurt_traits::Parameter::new(stringify!($key), $unit),
                    value: self.$key,
                    deviation: $deviation,
                    bounds: [$lower, $upper],
                },)+]
            }

            /// The meaning of every number, in the order of [`Self::numbers`].
            #[must_use]
            pub fn meanings() -> Vec<String> {
                vec![$([$($meaning.trim()),+].join(" "),)+]
            }

            /// Sets all numbers, in the order of [`Self::numbers`]; missing ones stay.
            pub fn set_numbers(&mut self, values: &[f64]) {
                let mut values = values.iter();
                $(if let Some(value) = values.next() { self.$key = *value; })+
            }
        }
    };
}

/// A drive that is a structure of [`numbers!`], under a name.
macro_rules! drive {
    ($drive:ty, $name:literal, $command:ident, $signal:ident, $initial:expr, $torque:expr) => {
        #[typetag::serde(name = $name)]
        impl aurt_traits::DriveModel for $drive {
            fn name(&self) -> &str {
                $name
            }
            fn command(&self) -> aurt_traits::Command {
                aurt_traits::Command::$command
            }
            fn usual_signal(&self) -> aurt_traits::CommandSignal {
                aurt_traits::CommandSignal::$signal
            }
            fn parameters(&self) -> Vec<aurt_traits::DriveParameter> {
                self.numbers()
            }
            fn set_parameters(&mut self, values: &[f64]) {
                self.set_numbers(values);
            }
            fn initial_state(&self, command: f64) -> Vec<aurt_traits::Jet> {
                ($initial)(command)
            }
            fn torque(
                &self,
                parameters: &[aurt_traits::Jet],
                input: &aurt_traits::DriveInput<'_>,
                state: &mut [aurt_traits::Jet],
            ) -> aurt_traits::DriveTorque {
                $torque(parameters, input, state)
            }
            fn boxed_clone(&self) -> Box<dyn aurt_traits::DriveModel> {
                Box::new(*self)
            }
        }
    };
}

pub(crate) use {drive, numbers};
