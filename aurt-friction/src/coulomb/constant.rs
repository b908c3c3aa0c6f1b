//! `constant`: a Coulomb level that does not depend on the load.
//!
//! # Equation
//! f_C = F_C0
//!
//! # Use when
//! First guess, and for joints whose load hardly changes. The paper calls it "none": no dependence on the load.
//!
//! # Source
//! Madsen et al. (2022), figure 2 (a); Coulomb (1785).

use aurt_traits::friction_model;

friction_model! {
    /// A constant Coulomb level, f_C = F_C0.
    pub struct Constant {}

    slot: Coulomb,
    name: "constant",
    summary: "Coulomb level without load dependence",
    equation: "f_C = F_C0",
    use_when: "a first guess, and joints whose load hardly changes",
    source: "Madsen et al. (2022), figure 2 (a); Coulomb (1785)",
    example: r#"{ model = "constant" }"#,
    columns: ["F_C0" in "Nm"],
    invariants: [EvenInLoad, Positive, BoundedByOne, ContinuousInVelocity, RateIndependent, Memoryless],
    reads_load: false,
    evaluate: |_series, out| {
        out.column_mut(0).fill(1.0);
    },
}
