use super::{
    MultiSineOptions, Path, STEP_PEAK_ACCELERATION, STEP_PEAK_VELOCITY, Trajectory, check_options,
    multi_sine, point_to_point, smooth_step,
};
use crate::error::Complaints;
use crate::error::SimulationError;
use crate::random::Random;
use crate::robots::Robot;

/// Share of the duration that the sines take.
const SINES: f64 = 0.5;

/// Two motions and the way between them, each at rest where they meet.
#[derive(Debug, Clone)]
struct Mixed {
    first: Trajectory,
    way_s: f64,
    from_rad: Vec<f64>,
    to_rad: Vec<f64>,
    second: Trajectory,
}

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
    let n = robot.joints();
    let (mut from_rad, mut still) = (vec![0.0; n], [vec![0.0; n], vec![0.0; n]]);
    let [velocity, acceleration] = &mut still;
    first.at(sines.duration_s, &mut from_rad, velocity, acceleration);
    // Moves between poses begin at home.
    let to_rad: Vec<f64> = robot.drives.iter().map(|d| d.home_rad).collect();
    let way_s =
        robot.drives.iter().zip(from_rad.iter().zip(&to_rad)).fold(0.2_f64, |slowest, (d, (a, b))| {
            let distance = (b - a).abs();
            let by_velocity = STEP_PEAK_VELOCITY * distance / (options.share * d.velocity_limit_rad_s);
            let by_acceleration =
                (STEP_PEAK_ACCELERATION * distance / (options.share * d.acceleration_limit_rad_s2)).sqrt();
            slowest.max(by_velocity).max(by_acceleration)
        });
    let left_s = options.duration_s - sines.duration_s - way_s;
    let second = point_to_point::draw(robot, left_s, options.share, rest_s, random)?;
    Ok(Trajectory::new(Mixed { first, way_s, from_rad, to_rad, second }))
}

impl Path for Mixed {
    fn joints(&self) -> usize {
        self.from_rad.len()
    }

    fn duration_s(&self) -> f64 {
        self.first.duration_s() + self.way_s + self.second.duration_s()
    }

    fn at(&self, time_s: f64, q_rad: &mut [f64], qd_rad_s: &mut [f64], qdd_rad_s2: &mut [f64]) {
        let after_s = time_s - self.first.duration_s();
        if after_s <= 0.0 {
            return self.first.at(time_s, q_rad, qd_rad_s, qdd_rad_s2);
        }
        if after_s >= self.way_s {
            return self.second.at(after_s - self.way_s, q_rad, qd_rad_s, qdd_rad_s2);
        }
        let [s, sd, sdd] = smooth_step(after_s / self.way_s);
        for (j, (from, to)) in self.from_rad.iter().zip(&self.to_rad).enumerate() {
            let distance = to - from;
            q_rad[j] = from + distance * s;
            qd_rad_s[j] = distance * sd / self.way_s;
            qdd_rad_s2[j] = distance * sdd / (self.way_s * self.way_s);
        }
    }
}
