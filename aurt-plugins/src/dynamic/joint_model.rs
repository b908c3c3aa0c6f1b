use aurt_traits::abi::Series;
use aurt_traits::{
    Columns, CoulombModel, HysteresisModel, Invariants, JointModel, JointSeries, ModelError, Parameter,
    Result, ShapeParameter, ViscousBasis,
};

use super::guarded;
use super::instance::Fault;
use super::model::LibraryTerm;

impl JointModel for LibraryTerm {
    fn name(&self) -> &str {
        self.instance.model.name
    }

    fn columns(&self) -> Vec<Parameter> {
        self.described.columns.clone()
    }

    fn invariants(&self) -> Invariants {
        self.described.invariants
    }

    fn shape_parameters(&self) -> Vec<ShapeParameter> {
        self.described.shapes.clone()
    }

    fn set_shape(&mut self, values: &[f64]) -> Result<(), ModelError> {
        self.reshape(values)
    }

    fn state_len(&self) -> usize {
        self.described.state_len
    }

    fn initial_state(&self, first: &JointSeries<'_>) -> Vec<f64> {
        self.first_state(&self.described, &Series::of_joint(first))
    }

    fn evaluate(&self, series: &JointSeries<'_>, state: &mut [f64], out: &mut Columns<'_>) -> Result {
        let columns = self.described.columns.len();
        let described = &*self.described;
        if !self.instance.is_new() {
            let of_joint = Series::of_joint(series);
            return self.checked(described, columns, &of_joint, state, out, false);
        }
        let before = state.to_vec();
        let of_joint = Series::of_joint(series);
        self.checked(described, columns, &of_joint, state, out, true)?;
        let mut again = |series: &JointSeries<'_>, out: &mut Columns<'_>| {
            self.instance.evaluate(&Series::of_joint(series), &mut before.clone(), out)
        };
        guarded::check_invariants(described.invariants, series, out, &mut again)
            .map_err(|Fault(reason)| self.instance.failed(reason))
    }
}

// `#[typetag::serde]` on an implementation registers one fixed name, but these models have the names that their
// libraries give them. The two hidden functions that the attribute adds are therefore written out; the registry, not
// `typetag`, reads such models back.
macro_rules! fills_slot {
    ($slot:ident) => {
        impl $slot for LibraryTerm {
            fn typetag_name(&self) -> &'static str {
                self.instance.model.name
            }

            fn typetag_deserialize(&self) {}

            fn boxed_clone(&self) -> Box<dyn $slot> {
                Box::new(self.clone())
            }
        }
    };
}

fills_slot!(CoulombModel);
fills_slot!(HysteresisModel);
fills_slot!(ViscousBasis);
