use super::{Path, Trajectory, check_options, smooth_step};
use crate::error::{Complaints, SimulationError};
use crate::random::Random;
use crate::robots::Robot;

/// No pose lies farther from home than this, rad.
const LARGEST_SWING_RAD: f64 = 1.4;

/// Moves between poses, all joints starting and stopping together.
#[derive(Debug, Clone)]
struct PointToPoint {
    duration_s: f64,
    /// Start time, travel time, start pose and end pose of each move.
    moves: Vec<Move>,
}

#[derive(Debug, Clone)]
struct Move {
    start_s: f64,
    travel_s: f64,
    from_rad: Vec<f64>,
    to_rad: Vec<f64>,
}

/// Random poses around home, each reached as fast as the share of the limits allows.
pub(super) fn draw(
    robot: &Robot,
    duration_s: f64,
    share: f64,
    rest_s: f64,
    random: &mut Random,
) -> Result<Trajectory, SimulationError> {
    check_options(duration_s, share)?;
    let mut complaints = Complaints::default();
    complaints.within("rest at each pose in s", rest_s, 0.0, duration_s);
    complaints.finish()?;
    let mut pose: Vec<f64> = robot.drives.iter().map(|d| d.home_rad).collect();
    let mut moves = Vec::new();
    let mut start_s = rest_s.max(0.4);
    loop {
        let target: Vec<f64> = robot
            .drives
            .iter()
            .map(|drive| {
                let [low, high] = drive.position_limit_rad;
                let reach = |away: f64| (drive.home_rad + away).clamp(low, high);
                random.between(reach(-LARGEST_SWING_RAD), reach(LARGEST_SWING_RAD))
            })
            .collect();
        let travel_s = robot.travel_s(share, &pose, &target, 0.1);
        if start_s + travel_s + rest_s > duration_s {
            break;
        }
        moves.push(Move { start_s, travel_s, from_rad: pose, to_rad: target.clone() });
        pose = target;
        start_s += travel_s + rest_s;
    }
    if moves.is_empty() {
        let reason = "no move fits into it at this share of the limits";
        return Err(SimulationError::value("duration of the trajectory in s", duration_s, reason));
    }
    Ok(Trajectory::new(PointToPoint { duration_s, moves }))
}

impl Path for PointToPoint {
    fn joints(&self) -> usize {
        self.moves[0].from_rad.len()
    }

    fn duration_s(&self) -> f64 {
        self.duration_s
    }

    fn at(&self, time_s: f64, q_rad: &mut [f64], qd_rad_s: &mut [f64], qdd_rad_s2: &mut [f64]) {
        let current = self.moves.partition_point(|m| m.start_s <= time_s).saturating_sub(1);
        let Move { start_s, travel_s, from_rad, to_rad } = &self.moves[current];
        let [s, sd, sdd] = smooth_step((time_s - start_s) / travel_s);
        for (j, (from, to)) in from_rad.iter().zip(to_rad).enumerate() {
            let distance = to - from;
            q_rad[j] = from + distance * s;
            qd_rad_s[j] = distance * sd / travel_s;
            qdd_rad_s2[j] = distance * sdd / (travel_s * travel_s);
        }
    }
}
