//! The rough world: our simulator as laboratories are.

mod background;
mod habits;
mod noise;

pub(super) use background::background;

use super::laboratory::Laboratory;
use super::layout::Slot;
use aurt_simulation::effects::Shapes;
use aurt_simulation::robots::Robot;
use aurt_simulation::{Random, SimulationError};

/// Range of the factors on the friction of a robot's joints: drives of one kind differ by a half.
const FRICTION: (f64, f64) = (0.5, 1.5);
/// Below this a joint with bristles counts as resting, rad/s: a third of the speed from which the recordings' own joints
/// are said to move, so that the way after a reversal still counts.
const REST_RAD_S: f64 = 0.01;

/// Recordings are up to 60 s long and bristles take short steps: an effect is measured in one of them, and four draws
/// have to do.
const EFFORT: (usize, usize) = (1, 4);

/// The robot, its laboratory and the recordings of a case.
pub(super) fn prepare(
    mut robot: Robot,
    later: bool,
    seed: u64,
) -> Result<(Robot, Laboratory, Vec<Slot>), SimulationError> {
    let mut random = Random::labelled(seed, "friction");
    for drive in &mut robot.drives {
        drive.coulomb_nm *= random.between(FRICTION.0, FRICTION.1);
        drive.viscous_nm_s *= random.between(FRICTION.0, FRICTION.1);
    }
    let (slots, top_hz) = habits::slots(&robot, later, &mut Random::labelled(seed, "motions"))?;
    let mut random = Random::labelled(seed, "laboratory");
    let controller = habits::controller(&mut random);
    let logger = habits::logger(&mut random);
    let mut instrument = habits::instrument(&robot, &mut random);
    let f_dyn_hz = habits::f_dyn_hz(&robot, &instrument, logger.rate_hz, top_hz, &mut random)?;
    // From here on the noise that effects are measured in is what passes this laboratory's filter.
    let noise_nm = noise::equivalent_nm(&robot, &instrument, logger.rate_hz, f_dyn_hz)?;
    for (drive, noise_nm) in robot.drives.iter_mut().zip(noise_nm) {
        drive.torque_noise_nm = noise_nm;
    }
    habits::add_ripple(&mut instrument, &robot, &mut random);
    let mut laboratory = Laboratory {
        controller,
        instrument,
        logger,
        f_dyn_hz,
        shapes: Shapes::Continuum,
        undeclared: None,
        rest_rad_s: Some(REST_RAD_S),
        effort: EFFORT,
    };
    background::neglect(&mut laboratory, &robot, &slots, &mut Random::labelled(seed, "background"))?;
    Ok((robot, laboratory, slots))
}
