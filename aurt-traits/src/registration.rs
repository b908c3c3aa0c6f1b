use serde::{Deserialize, Serialize};

/// The trait that a registered model implements, and so the place where an experiment may name it. The plugin ABI carries its number.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Slot {
    /// [`CoulombModel`](crate::CoulombModel), `coulomb = { model = … }`.
    Coulomb,
    /// [`HysteresisModel`](crate::HysteresisModel), `hysteresis = { model = … }`.
    Hysteresis,
    /// [`ViscousBasis`](crate::ViscousBasis), `viscous = { model = … }`.
    Viscous,
    /// [`ArmTerm`](crate::ArmTerm), `[[arm_terms]] model = …`.
    ArmTerm,
}

impl Slot {
    /// The slot's name as experiments spell it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Coulomb => "coulomb",
            Self::Hysteresis => "hysteresis",
            Self::Viscous => "viscous",
            Self::ArmTerm => "arm_terms",
        }
    }
}

/// The listing of a statically linked model: `typetag` finds a model by its name but cannot list the names,
/// so each model submits this beside its `#[typetag::serde(name = "…")]`.
///
/// Use [`register_model!`](crate::register_model).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ModelEntry {
    /// Where the model may be named.
    pub slot: Slot,
    /// Name in experiments, equal to the `typetag` name.
    pub name: &'static str,
    /// One line for listings.
    pub summary: &'static str,
    /// The equation, in plain text.
    pub equation: &'static str,
    /// When to use the model, and when another.
    pub use_when: &'static str,
    /// Where the equation is from.
    pub source: &'static str,
    /// A working configuration, as a TOML inline table.
    pub example: &'static str,
    /// The crate that registered it.
    pub origin: &'static str,
}

inventory::collect!(ModelEntry);

/// Registers a statically linked model, so that experiments and saved models find it by its name; see [`ModelEntry`] for
/// the fields.
///
/// With `model`, the type, it also implements the trait of the slot and gives the type its name as `NAME`; the type
/// itself implements [`JointModel`](crate::JointModel) (or [`ArmTerm`](crate::ArmTerm), whose trait impl stays with the
/// author), `Clone`, `Serialize` and `Deserialize`. Without `model`, the listing alone is made.
///
/// ```
/// aurt_traits::register_model! {
///     slot: Viscous,
///     name: "my_viscous",
///     summary: "linear viscous friction",
///     equation: "f_v = F_v q̇",
///     use_when: "always as a first guess",
///     source: "textbook",
///     example: r#"{ model = "my_viscous" }"#,
/// }
/// ```
#[macro_export]
macro_rules! register_model {
    (slot: $slot:ident, model: $model:ty, name: $name:literal, $($rest:tt)+) => {
        $crate::register_model! { slot: $slot, name: $name, $($rest)+ }

        impl $model {
            /// The name in experiments and saved models.
            pub const NAME: &'static str = $name;
        }

        $crate::fill_slot! { $slot, $model, $name }
    };
    (slot: $slot:ident, name: $name:literal, summary: $summary:expr, equation: $equation:expr,
     use_when: $use_when:expr, source: $source:expr, example: $example:expr $(,)?) => {
        $crate::reexport::inventory::submit! {
            $crate::ModelEntry {
                slot: $crate::Slot::$slot,
                name: $name,
                summary: $summary,
                equation: $equation,
                use_when: $use_when,
                source: $source,
                example: $example,
                origin: env!("CARGO_PKG_NAME"),
            }
        }
    };
}

/// The trait of a slot for a type; a part of [`register_model!`](crate::register_model).
#[doc(hidden)]
#[macro_export]
macro_rules! fill_slot {
    (Coulomb, $model:ty, $name:literal) => {
        $crate::fill_slot! { @ CoulombModel, $model, $name }
    };
    (Hysteresis, $model:ty, $name:literal) => {
        $crate::fill_slot! { @ HysteresisModel, $model, $name }
    };
    (Viscous, $model:ty, $name:literal) => {
        $crate::fill_slot! { @ ViscousBasis, $model, $name }
    };
    (@ $slot:ident, $model:ty, $name:literal) => {
        const _: () = {
            use $crate::reexport::typetag;

            #[typetag::serde(name = $name)]
            impl $crate::$slot for $model {
                fn boxed_clone(&self) -> Box<dyn $crate::$slot> {
                    Box::new(Clone::clone(self))
                }
            }
        };
    };
}

/// A friction model without memory and without shape parameters, in full: the type, its columns and what it declares,
/// registered under its name.
///
/// The author's crate depends on `serde` with its feature `derive`. For a model with state or shape parameters, implement
/// [`JointModel`](crate::JointModel) and use [`register_model!`](crate::register_model).
///
/// ```
/// aurt_traits::friction_model! {
///     /// Viscous friction in proportion to the square of velocity, f_v = F_v q̇ |q̇|.
///     pub struct Drag {}
///
///     slot: Viscous,
///     name: "drag",
///     summary: "friction in proportion to the square of velocity",
///     equation: "f_v = F_v q̇ |q̇|",
///     use_when: "a link moves through a liquid",
///     source: "textbook",
///     example: r#"{ model = "drag" }"#,
///     columns: ["F_v" in "Nm s^2/rad^2"],
///     invariants: [OddInVelocity, ContinuousInVelocity, SignOfVelocity, Passive, Memoryless],
///     reads_load: false,
///     evaluate: |series, out| {
///         for (o, v) in out.column_mut(0).iter_mut().zip(series.velocity_rad_s) {
///             *o = v * v.abs();
///         }
///     },
/// }
/// # fn main() {
/// assert_eq!(Drag::NAME, "drag");
/// # }
/// ```
#[macro_export]
macro_rules! friction_model {
    (
        $(#[$documentation:meta])+
        pub struct $model:ident {}

        slot: $slot:ident,
        name: $name:literal,
        summary: $summary:expr,
        equation: $equation:expr,
        use_when: $use_when:expr,
        source: $source:expr,
        example: $example:expr,
        columns: [$($column:literal in $unit:literal),* $(,)?],
        invariants: [$($invariant:ident),* $(,)?],
        reads_load: $reads_load:literal,
        evaluate: |$series:ident, $out:ident| $evaluate:block $(,)?
    ) => {
        $(#[$documentation])+
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
        #[serde(deny_unknown_fields)]
        pub struct $model {}

        $crate::register_model! {
            slot: $slot,
            model: $model,
            name: $name,
            summary: $summary,
            equation: $equation,
            use_when: $use_when,
            source: $source,
            example: $example,
        }

        impl $crate::JointModel for $model {
            fn name(&self) -> &str {
                Self::NAME
            }

            fn columns(&self) -> Vec<$crate::Parameter> {
                vec![$($crate::Parameter::new($column, $unit)),*]
            }

            fn invariants(&self) -> $crate::Invariants {
                $crate::Invariants::of(&[$($crate::Invariant::$invariant),*])
            }

            fn reads_load(&self) -> bool {
                $reads_load
            }

            fn evaluate(
                &self,
                $series: &$crate::JointSeries<'_>,
                _state: &mut [f64],
                $out: &mut $crate::Columns<'_>,
            ) -> Result<(), $crate::ModelError> {
                $evaluate
                Ok(())
            }
        }
    };
}
