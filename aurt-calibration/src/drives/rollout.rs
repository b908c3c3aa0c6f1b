use aurt_traits::{CommandSignal, Jet};

use crate::drives::plant::Plant;
use crate::drives::{DriveError, DrivenArm};

/// A recording of commands and positions: what a rollout starts from and is compared with.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct DriveRecording {
    /// Stamps in s, ascending.
    pub time_s: Vec<f64>,
    /// Commands by joint, in the unit of the drives' [`Command`](aurt_traits::Command).
    pub command: Vec<Vec<f64>>,
    /// Positions by joint, in rad.
    pub position_rad: Vec<Vec<f64>>,
    /// The sample at which a rollout starts; what is before it is history of the command.
    pub first: usize,
    /// Velocities at that sample, in rad/s; none at rest.
    pub first_velocity_rad_s: Vec<f64>,
}

/// Samples on either side from which the velocity at the start of a piece is taken.
const AROUND: usize = 10;
/// What a piece keeps of the command before its start, in s: the longest delay.
const HISTORY_S: f64 = 0.5;

impl DriveRecording {
    /// Whether the series can be those of `joints` joints.
    ///
    /// # Errors
    /// [`DriveError::Recording`], with `recording` as its place.
    pub fn check(&self, joints: usize, recording: usize) -> Result<(), DriveError> {
        let fail = |reason: String| Err(DriveError::Recording { recording, reason });
        if self.command.len() != joints || self.position_rad.len() != joints {
            let (commands, positions) = (self.command.len(), self.position_rad.len());
            return fail(format!(
                "commands of {commands} and positions of {positions} joints, the robot has {joints}"
            ));
        }
        if self.time_s.len() < self.first + 3 {
            return fail(format!("{} samples; at least 3 are needed", self.time_s.len()));
        }
        let series = || self.command.iter().chain(&self.position_rad);
        if series().any(|s| s.len() != self.time_s.len()) {
            return fail("the series differ in length".into());
        }
        if !series().chain([&self.time_s]).flatten().all(|v| v.is_finite()) {
            return fail("a value is not finite".into());
        }
        self.time_s.windows(2).position(|w| w[1] <= w[0]).map_or(Ok(()), |k| {
            fail(format!("the stamp {} s does not follow {} s", self.time_s[k + 1], self.time_s[k]))
        })
    }

    /// The recording in pieces of about `piece_s`, each starting where the robot was, with its velocity; whole without.
    ///
    /// # Errors
    /// [`DriveError::ShortPieces`] if a piece has fewer rows than the velocity at its start is taken from.
    pub fn pieces(&self, piece_s: Option<f64>) -> Result<Vec<Self>, DriveError> {
        let Some(piece_s) = piece_s else { return Ok(vec![self.clone()]) };
        let at = |t: f64| self.time_s.partition_point(|s| *s < t);
        let (begin, end) = (self.time_s[self.first], self.time_s[self.time_s.len() - 1]);
        let count = ((end - begin) / piece_s).round().max(1.0);
        let most = ((self.time_s.len() - self.first) / AROUND).max(1) as f64;
        // Not a number, too.
        if !(piece_s > 0.0 && count <= most) {
            return Err(DriveError::ShortPieces { piece_s, rows: AROUND, least_s: (end - begin) / most });
        }
        let edge = |k: f64| if k == 0.0 { self.first } else { at(begin + (end - begin) * k / count) };
        let part = |k: usize| self.part(edge(k as f64)..edge((k + 1) as f64) + 1);
        Ok((0..count as usize).map(part).collect())
    }

    /// Some of the samples. A part that begins on the way starts where the robot was, with its velocity, and keeps the commands
    /// before; samples of the range that are not there are left out.
    pub fn part(&self, samples: std::ops::Range<usize>) -> Self {
        let last = samples.end.min(self.time_s.len());
        let first = samples.start.min(last.saturating_sub(1));
        let from = self.time_s.partition_point(|s| *s < self.time_s[first] - HISTORY_S);
        let of = |series: &[Vec<f64>]| series.iter().map(|s| s[from..last].to_vec()).collect();
        let velocity = |s: &Vec<f64>| slope(&self.time_s, s, first);
        Self {
            time_s: self.time_s[from..last].to_vec(),
            command: of(&self.command),
            position_rad: of(&self.position_rad),
            first: first - from,
            first_velocity_rad_s: if first == self.first {
                self.first_velocity_rad_s.clone()
            } else {
                self.position_rad.iter().map(velocity).collect()
            },
        }
    }
}

/// The slope at sample `k` of the cubic through the samples about it, of the line where there are fewer than five.
fn slope(time_s: &[f64], series: &[f64], k: usize) -> f64 {
    let around = AROUND.min(k).min(series.len() - 1 - k);
    // Only odd powers have a slope in the middle of an even window: [Σt² Σt⁴; Σt⁴ Σt⁶] (a₁, a₃) = (Σt y, Σt³ y).
    let [mut t2, mut t4, mut t6, mut ty, mut t3y] = [0.0; 5];
    for i in k - around..=k + around {
        let (t, y) = (time_s[i] - time_s[k], series[i] - series[k]);
        let square = t * t;
        t2 += square;
        t4 += square * square;
        t6 += square * square * square;
        ty += t * y;
        t3y += t * square * y;
    }
    let determinant = t2 * t6 - t4 * t4;
    if around >= 2 && determinant > 0.0 {
        (t6 * ty - t4 * t3y) / determinant
    } else if t2 > 0.0 {
        ty / t2
    } else {
        0.0
    }
}

/// Longest step of the integrator, s, unless asked otherwise: 1/8 of 20 ms.
pub const LONGEST_STEP_S: f64 = 2.5e-3;

impl DrivenArm {
    /// The positions of a rollout: the arm starts at the recording's first position and velocity and is driven by its commands
    /// alone. One series a joint, with a value at each stamp from the recording's first on.
    ///
    /// # Errors
    /// [`DriveError::Recording`] and [`DriveError::Diverged`], with the recording as number 0.
    pub fn rollout(&self, recording: &DriveRecording) -> Result<Vec<Vec<f64>>, DriveError> {
        recording.check(self.joints.len(), 0)?;
        let numbers: Vec<Jet> = self.numbers().iter().map(|p| Jet::constant(p.value)).collect();
        let mut out = vec![Vec::with_capacity(recording.time_s.len()); self.joints.len()];
        let visit = |q: &[Jet]| out.iter_mut().zip(q).for_each(|(o, q)| o.push(q.value));
        self.simulate(&numbers, recording, LONGEST_STEP_S, visit)
            .map_err(|time_s| DriveError::Diverged { recording: 0, time_s })?;
        Ok(out)
    }

    /// Simulates over the stamps of a recording; `visit` receives the positions at each.
    ///
    /// # Errors
    /// The time at which a position is not finite, or beyond 1000 rad.
    pub(crate) fn simulate(
        &self,
        numbers: &[Jet],
        recording: &DriveRecording,
        longest_step_s: f64,
        mut visit: impl FnMut(&[Jet]),
    ) -> Result<(), f64> {
        let at_first =
            |series: &[Vec<f64>]| -> Vec<f64> { series.iter().map(|s| s[recording.first]).collect() };
        let q = at_first(&recording.position_rad).into_iter().map(Jet::constant).collect();
        let mut plant = Plant::new(self, numbers, q, &at_first(&recording.command));
        plant.qd.iter_mut().zip(&recording.first_velocity_rad_s).for_each(|(qd, v)| *qd = Jet::constant(*v));
        visit(&plant.q);
        let time_s = &recording.time_s;
        for k in recording.first + 1..time_s.len() {
            let span_s = time_s[k] - time_s[k - 1];
            let substeps = (span_s / longest_step_s * (1.0 - 1e-9)).ceil().max(1.0);
            let step_s = span_s / substeps;
            let command = |joint: usize, t: Jet, window_s: f64| {
                let sent = Sent { time_s, series: &recording.command[joint] };
                match self.command {
                    CommandSignal::Hold => sent.held(t, window_s, k),
                    CommandSignal::Linear => sent.interpolated(t, k),
                }
            };
            plant.sample(time_s[k - 1], step_s, substeps as usize, &command);
            visit(&plant.q);
            if !plant.q.iter().all(|q| q.value.abs() < 1e3) {
                return Err(time_s[k]);
            }
        }
        Ok(())
    }
}

/// A joint's commands as they were sent. `near` is a stamp at or after the time that is asked for, where a search starts.
struct Sent<'a> {
    time_s: &'a [f64],
    series: &'a [f64],
}

/// An edge of a step within this part of the step from a stamp stands on it.
const ON_STAMP: f64 = 1e-6;

impl Sent<'_> {
    /// Linear between stamps and constant outside.
    fn interpolated(&self, t: Jet, near: usize) -> Jet {
        let (time_s, series) = (self.time_s, self.series);
        let mut k = near.min(time_s.len() - 1);
        while k > 0 && time_s[k - 1] > t.value {
            k -= 1;
        }
        if k == 0 || t.value >= time_s[k] {
            return Jet::constant(series[k]);
        }
        let rate = (series[k] - series[k - 1]) / (time_s[k] - time_s[k - 1]);
        t.chain(series[k - 1] + rate * (t.value - time_s[k - 1]), rate)
    }

    /// The mean over a step about `t` of commands of which each holds until the next. The mean depends on a delay without
    /// jumps, (c(t + h/2) − c(t − h/2))/h: a staircase itself has no slope that tells a delay.
    fn held(&self, t: Jet, step_s: f64, near: usize) -> Jet {
        let (begin, end) = (t.value - 0.5 * step_s, t.value + 0.5 * step_s);
        let mut k = self.last_before(end, near);
        let (mut sum, mut until) = (0.0, end);
        while k > 0 && self.time_s[k] > begin {
            sum += self.series[k] * (until - self.time_s[k]);
            until = self.time_s[k];
            k -= 1;
        }
        sum += self.series[k] * (until - begin);
        t.chain(sum / step_s, (self.at_edge(end, step_s, near) - self.at_edge(begin, step_s, near)) / step_s)
    }

    /// The command that holds at the edge of a step; the mean of two at a stamp, so that the steps on either side share its jump.
    fn at_edge(&self, t: f64, step_s: f64, near: usize) -> f64 {
        let tolerance = ON_STAMP * step_s;
        let k = self.last_before(t + tolerance, near);
        if k > 0 && (t - self.time_s[k]).abs() <= tolerance {
            return 0.5 * (self.series[k - 1] + self.series[k]);
        }
        self.series[k]
    }

    /// The last stamp up to `near` that is not after `t`; the first if there is none.
    fn last_before(&self, t: f64, near: usize) -> usize {
        let mut k = near.min(self.time_s.len() - 1);
        while k > 0 && self.time_s[k] > t {
            k -= 1;
        }
        k
    }
}
