//! What models declare of themselves: methods of `JointModel` and `ArmTerm` from lists of names.

/// Methods that declare a model of one joint, in an `impl JointModel`: its `name` and, for each list that is given,
/// `columns`, `invariants`, `reads_load` (false), from `shape` the shape parameters, which are fields of the model, and
/// `validate`, which holds them to their bounds.
macro_rules! declares {
    (@columns [$($column:literal in $unit:literal),*]) => {
        fn columns(&self) -> Vec<aurt_traits::Parameter> {
            vec![$(aurt_traits::Parameter::new($column, $unit)),*]
        }
    };
    (@invariants [$($invariant:ident),*]) => {
        fn invariants(&self) -> aurt_traits::Invariants {
            aurt_traits::Invariants::of(&[$(aurt_traits::Invariant::$invariant),*])
        }
    };
    (@reads_load false) => {
        fn reads_load(&self) -> bool {
            false
        }
    };
    (@shape [$($field:ident in $shape:ident),+]) => {
        fn shape_parameters(&self) -> Vec<aurt_traits::ShapeParameter> {
            vec![$($shape.at(self.$field)),+]
        }

        fn set_shape(&mut self, values: &[f64]) -> aurt_traits::Result {
            if let [$($field),+] = crate::shape::accepted(Self::NAME, &self.shape_parameters(), values)?[..] {
                $(self.$field = $field;)+
            }
            Ok(())
        }
    };
    (@validate within_bounds) => {
        fn validate(&self) -> aurt_traits::Result<(), Vec<aurt_traits::ModelError>> {
            crate::shape::verdict(crate::shape::out_of_bounds(Self::NAME, &self.shape_parameters()))
        }
    };
    ($($part:ident: $list:tt),+ $(,)?) => {
        fn name(&self) -> &str {
            Self::NAME
        }

        $(declares! { @$part $list })+
    };
}

/// Methods that declare an arm term, in an `impl ArmTerm`: its `name`, and for terms with columns of their own for each
/// selected joint `joints`, `columns` and `acts_on`.
macro_rules! declares_term {
    ($name:literal $(, invariants: $invariants:tt)?) => {
        fn name(&self) -> &str {
            $name
        }

        fn boxed_clone(&self) -> Box<dyn ArmTerm> {
            Box::new(self.clone())
        }

        $(declares! { @invariants $invariants })?
    };
    ($name:literal, per joint: [$($column:literal in $unit:literal),+] $(, invariants: $invariants:tt)?) => {
        declares_term! { $name $(, invariants: $invariants)? }

        fn joints(&self, robot_joints: usize) -> Vec<usize> {
            self.joints.resolve(robot_joints)
        }

        fn columns(&self, robot_joints: usize) -> Vec<aurt_traits::Parameter> {
            self.joints.columns(robot_joints, &[$(($column, $unit)),+])
        }

        fn acts_on(&self, column: usize, joint: usize, robot_joints: usize) -> bool {
            self.joints.owns(robot_joints, [$($column),+].len(), column, joint)
        }
    };
}

/// An arm term with columns of its own for each selected joint, and no key but `joints`, in full; `evaluate` fills the columns of a
/// joint.
macro_rules! joint_term {
    ($(#[$doc:meta])* $model:ident, name: $name:literal, columns: [$($column:literal in $unit:literal),+],
     invariants: $invariants:tt, evaluate: $evaluate:expr, $($entry:tt)+) => {
        $(#[$doc])*
        #[derive(Debug, Clone, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
        #[serde(deny_unknown_fields)]
        pub struct $model {
            /// Joints that have the term.
            #[serde(default, skip_serializing_if = "crate::arm_terms::joint_selection::JointSelection::is_all")]
            pub joints: crate::arm_terms::joint_selection::JointSelection,
        }

        aurt_traits::register_model! { slot: ArmTerm, name: $name, $($entry)+ }

        #[typetag::serde(name = $name)]
        impl ArmTerm for $model {
            declares_term! { $name, per joint: [$($column in $unit),+], invariants: $invariants }

            fn validate(&self, robot_joints: usize) -> aurt_traits::Result<(), Vec<aurt_traits::ModelError>> {
                crate::shape::verdict(self.joints.complaints($name, robot_joints))
            }

            fn evaluate(
                &self,
                series: &ArmSeries<'_>,
                _state: &mut [f64],
                out: &mut Columns<'_>,
            ) -> aurt_traits::Result {
                let evaluate: fn(&ArmSeries<'_>, usize, &mut Columns<'_>) = $evaluate;
                let columns = [$($column),+].len();
                self.joints.write_own_rows(series.motion.joints(), columns, out, |_, joint, own| {
                    evaluate(series, joint, own);
                });
                Ok(())
            }
        }
    };
}

/// Methods of a term around the inertial values of a fit (`crate::known_bodies`), in an `impl ArmTerm`; the state is the number of the rigid
/// body's standard parameters, which is asked for once per series. With `around`, a column for each selected joint, whose values on all
/// joints `slope` gives, exact around those of the field.
macro_rules! declares_known_bodies {
    () => {
        fn joints(&self, robot_joints: usize) -> Vec<usize> {
            (0..robot_joints).collect()
        }

        fn is_load(&self) -> bool {
            true
        }

        fn state_len(&self, _robot_joints: usize) -> usize {
            1
        }

        fn initial_state(&self, first: &ArmSeries<'_>) -> Vec<f64> {
            vec![first.rigid_body.standard_parameters().len() as f64]
        }
    };
    ($name:literal in $unit:literal, around: $around:ident) => {
        declares_known_bodies! {}

        fn columns(&self, robot_joints: usize) -> Vec<Parameter> {
            let name = |j: usize| Parameter::new(format!("{}_{j}", $name), $unit);
            self.joints.resolve(robot_joints).into_iter().map(name).collect()
        }

        fn validate(&self, robot_joints: usize) -> Result<(), Vec<ModelError>> {
            let mut complaints = self.joints.complaints($name, robot_joints);
            let bodies = known_bodies!(self, $name);
            complaints.extend(bodies.complaints());
            let joints = self.joints.resolve(robot_joints).len();
            complaints.extend(bodies.around_complaints(stringify!($around), &self.$around, joints));
            crate::shape::verdict(complaints)
        }

        fn evaluate(&self, series: &ArmSeries<'_>, state: &mut [f64], out: &mut Columns<'_>) -> Result {
            let (joints, samples) = (series.motion.joints(), series.motion.samples());
            let standard = known_bodies!(self, $name).standard(state[0] as usize)?;
            let own = self.joints.resolve(joints);
            let is_known = samples > 0 && standard.iter().any(|value| *value != 0.0);
            for (k, joint) in own.iter().enumerate() {
                let around = self.$around.get(k).copied().unwrap_or(0.0);
                let none = || Ok(vec![0.0; joints * samples]);
                let slope = if is_known { slope(series, &standard, *joint, around) } else { none() }?;
                for row in 0..joints {
                    out.column_mut(row * own.len() + k)
                        .copy_from_slice(&slope[row * samples..(row + 1) * samples]);
                }
            }
            Ok(())
        }
    };
}

/// The bodies of a term's configuration.
macro_rules! known_bodies {
    ($term:expr, $name:literal) => {
        crate::known_bodies::KnownBodies {
            model: $name,
            columns: &$term.inertial_columns,
            values: &$term.inertial_values,
        }
    };
}
