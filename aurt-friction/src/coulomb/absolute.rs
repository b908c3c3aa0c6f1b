//! `absolute`: a Coulomb level that grows in proportion to the load's magnitude.
//!
//! # Equation
//! f_C(τ_J) = F_C0 + F_C1 |τ_J|
//!
//! # Use when
//! The usual choice for geared joints that carry gravity: tooth friction is proportional to the tooth force.
//! F_C1 of harmonic drives lies at 0.06–0.15. If friction differs between driving and being driven, add the arm
//! term `drive_efficiency`.
//!
//! # Source
//! Madsen et al. (2022), figure 2 (c); Hamon, Gautier, Garrec (2010), *Dynamic identification of robots with a
//! dry friction model depending on load and velocity*.

use aurt_traits::friction_model;

friction_model! {
    /// A Coulomb level with proportional load dependence, f_C = F_C0 + F_C1 |τ_J|.
    pub struct Absolute {}

    slot: Coulomb,
    name: "absolute",
    summary: "Coulomb level with load dependence in proportion to |τ_J|",
    equation: "f_C = F_C0 + F_C1 |τ_J|",
    use_when: "geared joints that carry gravity; the usual choice",
    source: "Madsen et al. (2022), figure 2 (c); Hamon, Gautier, Garrec (2010)",
    example: r#"{ model = "absolute" }"#,
    columns: ["F_C0" in "Nm", "F_C1" in "1"],
    invariants: [EvenInLoad, Positive, ContinuousInVelocity, RateIndependent, Memoryless],
    reads_load: true,
    evaluate: |series, out| {
        out.column_mut(0).fill(1.0);
        for (o, load) in out.column_mut(1).iter_mut().zip(series.load_torque) {
            *o = load.abs();
        }
    },
}
