use super::{Path, Trajectory, check_options};
use crate::error::{Complaints, SimulationError};
use crate::random::Random;
use crate::robots::{Drive, Robot};

/// Motions of constant velocities, with smooth changes between them, each joint with a schedule of its own.
#[derive(Debug, Clone)]
struct VelocityProfile {
    duration_s: f64,
    joints: Vec<Vec<Piece>>,
}

/// From `start_s` on the velocity goes from `from_rad_s` to `to_rad_s` within `change_s`, then stays.
#[derive(Debug, Clone, Copy)]
struct Piece {
    start_s: f64,
    change_s: f64,
    position_rad: f64,
    from_rad_s: f64,
    to_rad_s: f64,
}

impl Piece {
    /// Position, velocity and acceleration; the velocity follows 3x² − 2x³ while it changes.
    fn at(&self, time_s: f64) -> [f64; 3] {
        let dt = time_s - self.start_s;
        let change = self.to_rad_s - self.from_rad_s;
        if dt >= self.change_s {
            let travelled = 0.5 * (self.from_rad_s + self.to_rad_s) * self.change_s;
            let position = self.position_rad + travelled + self.to_rad_s * (dt - self.change_s);
            return [position, self.to_rad_s, 0.0];
        }
        let x = (dt / self.change_s).max(0.0);
        [
            self.position_rad + self.from_rad_s * dt + change * self.change_s * x * x * x * (1.0 - 0.5 * x),
            self.from_rad_s + change * x * x * (3.0 - 2.0 * x),
            change / self.change_s * 6.0 * x * (1.0 - x),
        ]
    }
}

/// One joint's schedule while it is laid out.
struct Schedule {
    pieces: Vec<Piece>,
    time_s: f64,
    end_s: f64,
    acceleration_rad_s2: f64,
}

impl Schedule {
    fn new(start_rad: f64, rest_s: f64, end_s: f64, acceleration_rad_s2: f64) -> Self {
        let rest =
            Piece { start_s: 0.0, change_s: 0.0, position_rad: start_rad, from_rad_s: 0.0, to_rad_s: 0.0 };
        Self { pieces: vec![rest], time_s: rest_s, end_s, acceleration_rad_s2 }
    }

    fn state(&self) -> (f64, f64) {
        let [position, velocity, _] = self.pieces[self.pieces.len() - 1].at(self.time_s);
        (position, velocity)
    }

    /// Time that a change of velocity takes: the largest acceleration is 1.5 times the mean one.
    fn change_s(&self, change_rad_s: f64) -> f64 {
        (1.5 * change_rad_s.abs() / self.acceleration_rad_s2).max(0.02)
    }

    /// Moves to `target` at the given speed and begins to brake there; false if there is no time left to
    /// do so and to stop afterwards.
    fn stroke(&mut self, target_rad: f64, speed_rad_s: f64) -> bool {
        let (position, velocity) = self.state();
        let speed = if target_rad < position { -speed_rad_s } else { speed_rad_s };
        let change_s = self.change_s(speed - velocity);
        let travelled = 0.5 * (speed + velocity) * change_s;
        let cruise_s = ((target_rad - position - travelled) / speed).max(0.0);
        if self.time_s + change_s + cruise_s + self.change_s(speed) > self.end_s {
            return false;
        }
        self.push(speed, change_s);
        self.time_s += change_s + cruise_s;
        true
    }

    fn stop(mut self) -> Vec<Piece> {
        let (_, velocity) = self.state();
        let change_s = self.change_s(velocity);
        self.push(0.0, change_s);
        self.pieces
    }

    fn push(&mut self, to_rad_s: f64, change_s: f64) {
        let (position_rad, from_rad_s) = self.state();
        self.pieces.push(Piece { start_s: self.time_s, change_s, position_rad, from_rad_s, to_rad_s });
    }
}

/// Triangles of nested amplitudes: turning points wander between the limits of the amplitude, large strokes
/// and small ones mixed, so that loops lie within loops.
pub(super) fn triangles(
    robot: &Robot,
    duration_s: f64,
    speed_rad_s: f64,
    amplitude_rad: f64,
    random: &mut Random,
) -> Result<Trajectory, SimulationError> {
    check_options(duration_s, 1.0)?;
    let mut complaints = Complaints::default();
    complaints.positive("speed of the triangles in rad/s", speed_rad_s);
    complaints.positive("amplitude of the triangles in rad", amplitude_rad);
    complaints.finish()?;
    Ok(strokes(robot, duration_s, random, |drive, random| {
        let [low, high] = drive.position_limit_rad;
        let amplitude = amplitude_rad.min(0.45 * (high - low));
        let centre = drive.home_rad.clamp(low + amplitude, high - amplitude);
        let speed = speed_rad_s * random.between(0.7, 1.3);
        let acceleration = (20.0 * speed).min(0.8 * drive.acceleration_limit_rad_s2);
        // Room for the braking beyond the turning point.
        let inner = (amplitude - speed * speed / acceleration).max(0.5 * amplitude);
        (centre, acceleration, move |position: f64, side: f64, random: &mut Random| {
            let stroke = inner * if random.chance(0.4) { 2.0 } else { random.between(0.05, 0.6) };
            [(position + side * stroke).clamp(centre - inner, centre + inner), speed]
        })
    }))
}

/// Strokes to either side in turn. Of each joint `joint` gives centre, acceleration and what draws a stroke's target and speed
/// from position and side.
fn strokes<S: Fn(f64, f64, &mut Random) -> [f64; 2]>(
    robot: &Robot,
    duration_s: f64,
    random: &mut Random,
    joint: impl Fn(&Drive, &mut Random) -> (f64, f64, S),
) -> Trajectory {
    let laid_out = |drive: &Drive| {
        let (centre, acceleration, stroke) = joint(drive, random);
        let mut schedule = Schedule::new(centre, random.between(0.4, 1.0), duration_s - 0.4, acceleration);
        let mut side = random.sign();
        loop {
            let (position, _) = schedule.state();
            let [target, speed] = stroke(position, side, random);
            if !schedule.stroke(target, speed) {
                return schedule.stop();
            }
            side = -side;
        }
    };
    let joints = robot.drives.iter().map(laid_out).collect();
    Trajectory::new(VelocityProfile { duration_s, joints })
}

/// Strokes back and forth, at velocities from a twentieth of the fastest up, in random order.
pub(super) fn sweeps(
    robot: &Robot,
    duration_s: f64,
    share: f64,
    random: &mut Random,
) -> Result<Trajectory, SimulationError> {
    check_options(duration_s, share)?;
    Ok(strokes(robot, duration_s, random, |drive, _| {
        let [low, high] = drive.position_limit_rad;
        let amplitude = (0.4 * (high - low)).min(1.0);
        let centre = drive.home_rad.clamp(low + amplitude, high - amplitude);
        let acceleration = 0.5 * drive.acceleration_limit_rad_s2;
        let fastest = (share * drive.velocity_limit_rad_s).min((0.6 * amplitude * acceleration).sqrt());
        (centre, acceleration, move |position: f64, side: f64, random: &mut Random| {
            let speed = fastest * random.between(0.05_f64.sqrt(), 1.0).powi(2);
            // The braking after the stroke and the next one's start stay within the amplitude.
            let inner = (amplitude - speed * speed / acceleration).max(0.3 * amplitude);
            if speed > 0.3 * fastest {
                return [centre + side * inner, speed];
            }
            let stroke = inner * random.between(0.15, 0.5);
            [(position + side * stroke).clamp(centre - inner, centre + inner), speed]
        })
    }))
}

impl Path for VelocityProfile {
    fn joints(&self) -> usize {
        self.joints.len()
    }

    fn duration_s(&self) -> f64 {
        self.duration_s
    }

    fn at(&self, time_s: f64, q_rad: &mut [f64], qd_rad_s: &mut [f64], qdd_rad_s2: &mut [f64]) {
        for (j, pieces) in self.joints.iter().enumerate() {
            let current = pieces.partition_point(|p| p.start_s <= time_s).saturating_sub(1);
            [q_rad[j], qd_rad_s[j], qdd_rad_s2[j]] = pieces[current].at(time_s);
        }
    }
}
