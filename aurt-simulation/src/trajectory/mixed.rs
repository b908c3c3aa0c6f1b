use super::sequence::SHORTEST_WAY_S;
use super::{MultiSineOptions, Trajectory, check_options, multi_sine, point_to_point};
use crate::error::{Complaints, SimulationError};
use crate::random::Random;
use crate::robots::Robot;

/// Share of the duration that the sines take.
const SINES: f64 = 0.5;

/// Sines for half of the duration, then poses.
pub(super) fn draw(
    robot: &Robot,
    options: &MultiSineOptions,
    rest_s: f64,
    random: &mut Random,
) -> Result<Trajectory, SimulationError> {
    check_options(options.duration_s, options.share)?;
    let mut complaints = Complaints::default();
    complaints.within("duration of a mixed motion in s", options.duration_s, 15.0, 3600.0);
    complaints.finish()?;
    let sines = MultiSineOptions { duration_s: SINES * options.duration_s, ..*options };
    let first = multi_sine::draw(robot, &sines, random)?;
    // Moves between poses begin at home.
    let home: Vec<f64> = robot.drives.iter().map(|d| d.home_rad).collect();
    let way_s = robot.travel_s(options.share, &first.pose_rad(sines.duration_s), &home, SHORTEST_WAY_S);
    let left_s = options.duration_s - sines.duration_s - way_s;
    let second = point_to_point::draw(robot, left_s, options.share, rest_s, random)?;
    Ok(Trajectory::sequence(robot, options.share, vec![first, second]))
}
