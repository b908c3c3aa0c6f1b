//! `current_offset`: a constant that the instrument adds to a joint's measurement.
//!
//! # Equation
//! τ_j = o_j
//!
//! # Parameters
//! | key | unit | meaning |
//! |---|---|---|
//! | `joints` | – | joints that have the term; all unless given |
//!
//! # Use when
//! A current sensor's zero drifts. While a joint moves, an offset and unequal Coulomb levels for the two
//! directions (`coulomb_asymmetric`) are the same thing; only rest tells them apart.
//!
//! # Source
//! Khalil and Dombre (2002), *Modeling, Identification and Control of Robots*.

use aurt_traits::{ArmSeries, ArmTerm, Columns};

joint_term! {
    /// A constant offset of the measurement.
    CurrentOffset,
    name: "current_offset",
    columns: ["offset" in "Nm"],
    invariants: [EvenInLoad, BoundedByOne, ContinuousInVelocity, RateIndependent, Memoryless],
    evaluate: |_, _, own| own.column_mut(0).fill(1.0),
    summary: "a constant in a joint's measurement",
    equation: "τ_j = offset_j",
    use_when: "the zero of a current sensor drifts; while moving it equals unequal Coulomb levels",
    source: "Khalil and Dombre (2002)",
    example: r#"{ model = "current_offset", joints = [0, 1] }"#,
}
