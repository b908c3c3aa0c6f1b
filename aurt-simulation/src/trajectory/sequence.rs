use super::{Path, STEP_PEAK_ACCELERATION, STEP_PEAK_VELOCITY, Trajectory, smooth_step};
use crate::robots::Robot;

/// Motions one after the other, and the ways between them, each at rest where they meet.
#[derive(Debug, Clone)]
struct Sequence {
    parts: Vec<Trajectory>,
    ways: Vec<Way>,
}

/// A move from the end of a motion to the beginning of the next.
#[derive(Debug, Clone)]
struct Way {
    from_rad: Vec<f64>,
    to_rad: Vec<f64>,
    duration_s: f64,
}

impl Robot {
    /// Shortest time of a move between two poses, all joints starting and stopping together, that uses a share of the limits of
    /// velocity and acceleration, s; at least `least_s`.
    pub fn travel_s(&self, share: f64, from_rad: &[f64], to_rad: &[f64], least_s: f64) -> f64 {
        self.drives.iter().zip(from_rad.iter().zip(to_rad)).fold(least_s, |slowest, (d, (a, b))| {
            let distance = (b - a).abs();
            let by_velocity = STEP_PEAK_VELOCITY * distance / (share * d.velocity_limit_rad_s);
            let by_acceleration =
                (STEP_PEAK_ACCELERATION * distance / (share * d.acceleration_limit_rad_s2)).sqrt();
            slowest.max(by_velocity).max(by_acceleration)
        })
    }
}

pub(super) const SHORTEST_WAY_S: f64 = 0.2;

impl Trajectory {
    pub fn pose_rad(&self, time_s: f64) -> Vec<f64> {
        let mut pose = vec![0.0; self.joints()];
        let mut still = [vec![0.0; pose.len()], vec![0.0; pose.len()]];
        let [velocity, acceleration] = &mut still;
        self.at(time_s, &mut pose, velocity, acceleration);
        pose
    }

    /// Motions of a robot one after the other; the ways between them use a share of its limits of velocity and acceleration.
    pub fn sequence(robot: &Robot, share: f64, parts: Vec<Self>) -> Self {
        let way = |pair: &[Self]| {
            let (from_rad, to_rad) = (pair[0].pose_rad(pair[0].duration_s()), pair[1].pose_rad(0.0));
            let duration_s = robot.travel_s(share, &from_rad, &to_rad, SHORTEST_WAY_S);
            Way { from_rad, to_rad, duration_s }
        };
        let ways = parts.windows(2).map(way).collect();
        Self::new(Sequence { parts, ways })
    }
}

impl Path for Sequence {
    fn joints(&self) -> usize {
        self.parts.first().map_or(0, Trajectory::joints)
    }

    fn duration_s(&self) -> f64 {
        let parts: f64 = self.parts.iter().map(Trajectory::duration_s).sum();
        parts + self.ways.iter().map(|way| way.duration_s).sum::<f64>()
    }

    fn at(&self, time_s: f64, q_rad: &mut [f64], qd_rad_s: &mut [f64], qdd_rad_s2: &mut [f64]) {
        let mut since_s = time_s;
        for (k, part) in self.parts.iter().enumerate() {
            let Some(way) = self.ways.get(k).filter(|_| since_s > part.duration_s()) else {
                return part.at(since_s, q_rad, qd_rad_s, qdd_rad_s2);
            };
            since_s -= part.duration_s();
            if since_s < way.duration_s {
                let [s, sd, sdd] = smooth_step(since_s / way.duration_s);
                for (j, (from, to)) in way.from_rad.iter().zip(&way.to_rad).enumerate() {
                    let distance = to - from;
                    q_rad[j] = from + distance * s;
                    qd_rad_s[j] = distance * sd / way.duration_s;
                    qdd_rad_s2[j] = distance * sdd / (way.duration_s * way.duration_s);
                }
                return;
            }
            since_s -= way.duration_s;
        }
    }
}
