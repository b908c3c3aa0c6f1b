//! The conformance checks find models that are not what they declare: a check that cannot fail proves nothing.

use aurt_friction::conformance::Violation;
use aurt_friction::conformance::joint::check;
use aurt_friction::hysteresis::dahl::Dahl;
use aurt_friction::hysteresis::gms::Gms;
use aurt_friction::hysteresis::sign::Sign;
use aurt_friction::hysteresis::tanh::Tanh;
use aurt_traits::{Columns, Invariant, Invariants, JointModel, JointSeries, ModelError, Parameter};

/// What a [`Faulty`] model writes for (time, velocity, load).
type Law = fn(&JointSeries<'_>, usize) -> f64;

/// A memoryless law with declarations, some of which are false.
#[derive(Debug)]
struct Faulty {
    law: Law,
    declares: Vec<Invariant>,
    reads_load: bool,
}

impl JointModel for Faulty {
    fn name(&self) -> &str {
        "faulty"
    }

    fn columns(&self) -> Vec<Parameter> {
        vec![Parameter::new("c", "Nm")]
    }

    fn invariants(&self) -> Invariants {
        Invariants::of(&self.declares)
    }

    fn reads_load(&self) -> bool {
        self.reads_load
    }

    fn evaluate(
        &self,
        series: &JointSeries<'_>,
        _state: &mut [f64],
        out: &mut Columns<'_>,
    ) -> Result<(), ModelError> {
        for (n, o) in out.column_mut(0).iter_mut().enumerate() {
            *o = (self.law)(series, n);
        }
        Ok(())
    }
}

/// A sound model under declarations of another.
#[derive(Debug)]
struct Disguised<M>(M, Invariant);

impl<M: JointModel> JointModel for Disguised<M> {
    fn name(&self) -> &str {
        self.0.name()
    }

    fn columns(&self) -> Vec<Parameter> {
        self.0.columns()
    }

    fn invariants(&self) -> Invariants {
        Invariants::of(&[self.1])
    }

    fn state_len(&self) -> usize {
        self.0.state_len()
    }

    fn initial_state(&self, first: &JointSeries<'_>) -> Vec<f64> {
        self.0.initial_state(first)
    }

    fn evaluate(
        &self,
        series: &JointSeries<'_>,
        state: &mut [f64],
        out: &mut Columns<'_>,
    ) -> Result<(), ModelError> {
        self.0.evaluate(series, state, out)
    }
}

fn broken_invariant(model: &dyn JointModel) -> Option<Invariant> {
    match check(model, 17) {
        Err(Violation::Invariant { invariant, .. }) => Some(invariant),
        Err(other) => panic!("{other}"),
        Ok(()) => None,
    }
}

#[test]
fn every_false_declaration_is_found() {
    let cases: [(Invariant, Law); 9] = [
        (Invariant::EvenInLoad, |s, n| s.load_torque[n]),
        (Invariant::Positive, |s, n| s.velocity_rad_s[n].abs()),
        (Invariant::Positive, |s, n| 1.0 + 1e-3 * s.load_torque[n] * s.load_torque[n] * s.velocity_rad_s[n]),
        (Invariant::BoundedByOne, |s, n| 1.02 * (9.0 * s.velocity_rad_s[n]).tanh()),
        (Invariant::OddInVelocity, |s, n| s.velocity_rad_s[n] + 1e-6),
        (Invariant::ContinuousInVelocity, |s, n| s.velocity_rad_s[n] + 1e-3 * s.velocity_rad_s[n].signum()),
        (Invariant::SignOfVelocity, |s, n| s.velocity_rad_s[n] - 0.01),
        (Invariant::Passive, |s, n| -0.01 * s.velocity_rad_s[n]),
        (Invariant::RateIndependent, |s, n| s.velocity_rad_s[n]),
    ];
    for (invariant, law) in cases {
        let model = Faulty { law, declares: vec![invariant, Invariant::Memoryless], reads_load: true };
        assert_eq!(broken_invariant(&model), Some(invariant));
    }
}

#[test]
fn models_under_false_flags_are_found() {
    let found = [
        broken_invariant(&Disguised(Dahl::default(), Invariant::Memoryless)),
        broken_invariant(&Disguised(Dahl::default(), Invariant::SignOfVelocity)),
        broken_invariant(&Disguised(Sign::default(), Invariant::ContinuousInVelocity)),
        broken_invariant(&Disguised(Tanh::default(), Invariant::RateIndependent)),
        broken_invariant(&Disguised(Gms::default(), Invariant::RateIndependent)),
    ];
    assert_eq!(
        found.map(|f| f.map(Invariant::in_words)),
        [
            Invariant::Memoryless,
            Invariant::SignOfVelocity,
            Invariant::ContinuousInVelocity,
            Invariant::RateIndependent,
            Invariant::RateIndependent
        ]
        .map(|i| Some(i.in_words()))
    );
}

#[test]
fn contracts_are_checked_whatever_is_declared() {
    let found = |law: Law, reads_load| match check(&Faulty { law, declares: Vec::new(), reads_load }, 3) {
        Err(Violation::Contract { detail, .. }) => detail,
        other => panic!("{other:?}"),
    };
    let contract = |law| found(law, true);
    assert!(contract(|_, n| n as f64).contains("split"));
    assert!(contract(|s, n| 1.0 / (s.velocity_rad_s[n] - s.velocity_rad_s[n])).contains("inf"));
    // Even in the load, so that a reversed load alone would not show it.
    assert!(found(|s, n| s.load_torque[n].abs(), false).contains("does not read the load"));
}
