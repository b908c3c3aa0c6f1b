//! `absent`: no dry friction at all.
//!
//! # Equation
//! f_C = 0, as no column: equation (6) keeps its viscous part alone, whatever the hysteresis model is.
//!
//! # Use when
//! Dry friction is described outside equation (6), for instance by the arm terms `coulomb_asymmetric` or
//! `lugre_damped`, or is to be left out on purpose. A constant level is `constant`. The paper calls it "none", for
//! "no dependence on the load", not for "no friction".
//!
//! # Source
//! The trivial case.

use aurt_traits::friction_model;

friction_model! {
    /// No dry friction: zero columns.
    pub struct Absent {}

    slot: Coulomb,
    name: "absent",
    summary: "no dry friction at all (no column)",
    equation: "f_C = 0",
    use_when: "dry friction is described by an arm term instead, or is left out on purpose; for a level \
               that does not depend on the load use `constant`",
    source: "trivial",
    example: r#"{ model = "absent" }"#,
    columns: [],
    invariants: [
        EvenInLoad,
        Positive,
        BoundedByOne,
        OddInVelocity,
        ContinuousInVelocity,
        SignOfVelocity,
        Passive,
        RateIndependent,
        Memoryless,
    ],
    reads_load: false,
    evaluate: |_series, _out| {},
}
