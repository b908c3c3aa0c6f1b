//! `square`: a Coulomb level that grows with the square of the load.
//!
//! # Equation
//! f_C(τ_J) = F_C0 + F_C1 τ_J²
//!
//! # Use when
//! The load changes over a wide range and the joint's friction rises faster than in proportion to it. Outside
//! the calibrated load range the square extrapolates badly; `absolute` is the safer choice there.
//!
//! # Source
//! Madsen et al. (2022), figure 2 (b) and equation (7).

use aurt_traits::friction_model;

friction_model! {
    /// A Coulomb level with square load dependence, f_C = F_C0 + F_C1 τ_J².
    pub struct Square {}

    slot: Coulomb,
    name: "square",
    summary: "Coulomb level with square load dependence",
    equation: "f_C = F_C0 + F_C1 τ_J²",
    use_when: "the load varies widely and friction rises faster than in proportion; `absolute` extrapolates \
               more safely",
    source: "Madsen et al. (2022), figure 2 (b) and equation (7)",
    example: r#"{ model = "square" }"#,
    columns: ["F_C0" in "Nm", "F_C1" in "1/Nm"],
    invariants: [EvenInLoad, Positive, ContinuousInVelocity, RateIndependent, Memoryless],
    reads_load: true,
    evaluate: |series, out| {
        out.column_mut(0).fill(1.0);
        for (o, load) in out.column_mut(1).iter_mut().zip(series.load_torque) {
            *o = load * load;
        }
    },
}
