use aurt_traits::Motion;

use aurt_simulation::inject::{Gram, Structure, StructureColumns};
use aurt_simulation::robots::Robot;
use aurt_simulation::{Random, SimulationError};

/// Random samples on which it is judged what the base parameters absorb.
const SAMPLES: usize = 80;
/// Share of a rotor's torque below which the base parameters have absorbed it.
const ABSORBED: f64 = 1e-6;

/// The same structure without the rotors whose torque the base parameters absorb exactly, as they do on
/// the first axes of most arms.
pub(crate) fn without_absorbed_rotors(
    mut structure: Structure,
    robot: &Robot,
) -> Result<Structure, SimulationError> {
    if !structure.joints.iter().any(|j| j.rotor) {
        return Ok(structure);
    }
    let n = robot.joints();
    let mut random = Random::labelled(1, "absorbed rotors");
    let mut series = |size: f64| (0..n * SAMPLES).map(|_| random.between(-size, size)).collect::<Vec<f64>>();
    let time_s = (0..SAMPLES).map(|k| k as f64).collect();
    let motion = Motion::new(n, time_s, series(3.0), series(2.0), series(8.0))?;
    let mut bare = structure.clone();
    for joint in &mut bare.joints {
        (joint.coulomb, joint.viscous, joint.rotor, joint.load) = (false, false, false, false);
    }
    let columns = StructureColumns::of_robot(robot, &bare)?;
    let rows = columns.evaluate(motion.view());
    let nothing = vec![0.0; SAMPLES];
    for joint in 0..n {
        let wanted = |j: usize| if j == joint { motion.view().acceleration_rad_s2(j) } else { &nothing };
        let mut gram = Gram::new(columns.coefficients());
        for (j, row) in rows.iter().enumerate() {
            gram.add(columns.row(j), row, wanted(j), 1.0);
        }
        let coefficients = gram.solve();
        let mut left = 0.0;
        for (j, row) in rows.iter().enumerate() {
            for sample in 0..SAMPLES {
                let fitted: f64 =
                    columns.row(j).iter().zip(row).map(|(k, column)| coefficients[*k] * column[sample]).sum();
                left += (wanted(j)[sample] - fitted).powi(2);
            }
        }
        let all: f64 = wanted(joint).iter().map(|a| a * a).sum();
        structure.joints[joint].rotor &= left > ABSORBED * all;
    }
    Ok(structure)
}

#[cfg(test)]
mod tests {
    use super::*;
    use aurt_simulation::robots;

    /// Rotors of joints 0 and 1 of upright six-axis arms are absorbed; the second one of a planar arm is not.
    #[test]
    fn absorbed_rotors_of_known_arms() {
        let kept = |robot: &Robot| -> Vec<usize> {
            let structure = without_absorbed_rotors(Structure::of(robot), robot).unwrap();
            (0..robot.joints()).filter(|j| structure.joints[*j].rotor).collect()
        };
        assert_eq!(kept(&robots::ur10e()), [2, 3, 4, 5]);
        assert_eq!(kept(&robots::tx40()), [2, 3, 4, 5]);
        assert_eq!(kept(&robots::two_link()), [1]);
        assert_eq!(kept(&robots::panda()), [2, 3, 4, 5, 6]);
    }
}
