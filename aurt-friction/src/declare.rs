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
