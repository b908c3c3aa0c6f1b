//! `viscous_asymmetric`: viscous friction with a slope of its own for each direction.
//!
//! # Equation
//! τ_j = F_v+,j max(q̇_j, 0) + F_v−,j min(q̇_j, 0)
//!
//! Equation (6) asks for viscous friction that is odd; this is not, so it stands outside. Use it with
//! `viscous = { model = "polynomial", powers = [] }` (or powers above 1) on the same joints.
//!
//! # Parameters
//! | key | unit | meaning |
//! |---|---|---|
//! | `joints` | – | joints that have the term; all unless given |
//!
//! # Use when
//! Drives with seals, belts or preload whose friction rises faster in one direction than in the other.
//!
//! # Source
//! Armstrong-Hélouvry (1991), *Control of Machines with Friction*. A public recording of an axis whose two slopes
//! differ: Janot, Gautier, Brunot (2019), *Data set and reference models of EMPS*.

use aurt_traits::{ArmSeries, ArmTerm, Columns};

joint_term! {
    /// Viscous friction with a slope for each direction.
    ViscousAsymmetric,
    name: "viscous_asymmetric",
    columns: ["F_v_pos" in "Nm s/rad", "F_v_neg" in "Nm s/rad"],
    invariants: [EvenInLoad, ContinuousInVelocity, SignOfVelocity, Passive, Memoryless],
    evaluate: |series, joint, own| {
        for (n, v) in series.motion.velocity_rad_s(joint).iter().enumerate() {
            own.column_mut(0)[n] = v.max(0.0);
            own.column_mut(1)[n] = v.min(0.0);
        }
    },
    summary: "viscous friction with a slope of its own for each direction",
    equation: "τ_j = F_v_pos max(q̇_j, 0) + F_v_neg min(q̇_j, 0)",
    use_when: "friction rises faster in one direction; with viscous `polynomial` without power 1",
    source: "Armstrong-Hélouvry (1991); Janot, Gautier, Brunot (2019)",
    example: r#"{ model = "viscous_asymmetric", joints = [0, 1] }"#,
}
