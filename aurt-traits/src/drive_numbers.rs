//! Structures of numbers that are keys of an experiment and parameters of an estimate at once.

/// A limit that is not there: JSON has no infinity.
pub const UNLIMITED: f64 = 1e9;

/// A structure of numbers with, for each, a unit, a default, the deviation of what is known of it, and bounds.
///
/// The author's crate depends on `serde` with its feature `derive`.
#[macro_export]
macro_rules! drive_numbers {
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
            pub fn numbers(&self) -> Vec<$crate::DriveParameter> {
                vec![$($crate::DriveParameter {
                    parameter: $crate::Parameter::new(stringify!($key), $unit),
                    value: self.$key,
                    deviation: $deviation,
                    bounds: [$lower, $upper],
                },)+]
            }

            /// The meaning of every number, in the order of [`Self::numbers`].
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
