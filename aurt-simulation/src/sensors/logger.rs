use aurt_traits::MeasurementUnit;
use serde::{Deserialize, Serialize};

use super::csv::push_decimal;
use super::current::Wander;
use super::faults::{ClockFaults, Fate};
use super::instrument::Instrument;
use crate::error::{Complaints, SimulationError};
use crate::plant::{TRACE_STEP_S, Traces};
use crate::random::Random;

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ColumnNames {
    /// `timestamp, actual_q_0, …, actual_current_0, …` (torques: `torque_0`).
    #[default]
    Actual,
    /// `time, q_0, …, current_0, …` (torques: `tau_0`).
    Short,
}

/// The rate, clock, resolution and columns of a recording.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Logger {
    /// Rows per second, at most `FASTEST_HZ`.
    pub rate_hz: f64,
    /// Standard deviation of the instants of sampling around the regular ones, s. Stamps tell the real ones.
    pub clock_jitter_s: f64,
    pub time_decimals: usize,
    /// Decimals of angles in rad and velocities in rad/s.
    pub position_decimals: usize,
    /// Decimals of currents or torques.
    pub measurement_decimals: usize,
    /// Whether velocities are written too, as the controller sees them (with noise of 1e-3 rad/s).
    pub velocity: bool,
    pub names: ColumnNames,
    /// What goes wrong with rows.
    pub faults: ClockFaults,
}

impl Default for Logger {
    fn default() -> Self {
        Self {
            rate_hz: 500.0,
            clock_jitter_s: 0.0,
            time_decimals: 4,
            position_decimals: 7,
            measurement_decimals: 5,
            velocity: false,
            names: ColumnNames::Actual,
            faults: ClockFaults::default(),
        }
    }
}

/// Highest rate of a logger, Hz: two rows for every sample of the traces, which cubics between them resolve.
const FASTEST_HZ: f64 = 2.0 / TRACE_STEP_S;
const VELOCITY_NOISE_RAD_S: f64 = 1e-3;

/// A recording as a logger wrote it: row after row.
#[derive(Debug, Clone, PartialEq)]
pub struct SimulatedRecording {
    pub joints: usize,
    pub unit: MeasurementUnit,
    pub time_s: Vec<f64>,
    /// Angles, N a row, rad.
    pub position_rad: Vec<f64>,
    /// Velocities, N a row, rad/s; empty if they are not logged.
    pub velocity_rad_s: Vec<f64>,
    /// Currents in A or torques in Nm, N a row.
    pub measurement: Vec<f64>,
    /// How it was logged.
    pub logger: Logger,
}

impl Logger {
    pub fn validate(&self) -> Result<(), SimulationError> {
        let mut complaints = Complaints::default();
        complaints.within("rate of the logger in Hz", self.rate_hz, 1.0, FASTEST_HZ);
        complaints.within("clock jitter in s", self.clock_jitter_s, 0.0, 0.2 / self.rate_hz.max(1e-9));
        for decimals in [self.time_decimals, self.position_decimals, self.measurement_decimals] {
            complaints.within("number of decimals", decimals as f64, 0.0, 12.0);
        }
        self.faults.validate(&mut complaints);
        complaints.finish()
    }

    /// Whether rows fall between the samples of the traces, where a straight line would take 7 % off a ringing at 60 Hz,
    /// (ω · 2 ms)²/8, and a cubic takes less than 1 %.
    fn samples_between(&self) -> bool {
        let samples = 1.0 / (self.rate_hz * TRACE_STEP_S);
        self.clock_jitter_s > 0.0 || (samples - samples.round()).abs() > 1e-9
    }

    pub fn record(
        &self,
        traces: &Traces,
        instrument: &Instrument,
        unit: MeasurementUnit,
        seed: u64,
    ) -> Result<SimulatedRecording, SimulationError> {
        self.validate()?;
        instrument.validate()?;
        let n = traces.joints;
        if instrument.channels.len() != n {
            let what = "sensor channels".into();
            return Err(SimulationError::Count { what, expected: n, found: instrument.channels.len() });
        }
        let end_s = (traces.samples - 1) as f64 * TRACE_STEP_S;
        let rows = (end_s * self.rate_hz + 1e-9) as usize + 1;
        let mut clock = Random::labelled(seed, "clock");
        let mut encoders = Random::labelled(seed, "encoders");
        let mut currents = Random::labelled(seed, "currents");
        let channels = instrument.channels.iter().enumerate();
        let mut wanders: Vec<Wander> = channels.map(|(j, c)| Wander::new(c.memory, seed, j)).collect();
        let between = self.samples_between();
        let fates = self.faults.fates(rows, 2 * n, &mut Random::labelled(seed, "faults"));
        let mut recording = SimulatedRecording {
            joints: n,
            unit,
            time_s: Vec::with_capacity(rows),
            position_rad: Vec::with_capacity(rows * n),
            velocity_rad_s: Vec::new(),
            measurement: Vec::with_capacity(rows * n),
            logger: *self,
        };
        let mut row = Row { position: vec![0.0; n], velocity: vec![0.0; n], measurement: vec![0.0; n] };
        for (k, fate) in fates.iter().enumerate() {
            let shake = self.clock_jitter_s * clock.normal().clamp(-3.0, 3.0);
            let time_s = (k as f64 / self.rate_hz + shake).clamp(0.0, end_s);
            let before = row.clone();
            for (j, channel) in instrument.channels.iter().enumerate() {
                let noise = channel.encoder_noise_rad * encoders.normal();
                let angle = position_at(traces, time_s, j) + channel.encoder_offset_rad + noise;
                let step = channel.encoder_resolution_rad;
                row.position[j] = if step > 0.0 { (angle / step).round() * step } else { angle };
                let velocity_noise = if channel.encoder_noise_rad > 0.0 {
                    VELOCITY_NOISE_RAD_S * encoders.normal()
                } else {
                    0.0
                };
                row.velocity[j] = linear_at(&traces.velocity_rad_s, traces, time_s, j) + velocity_noise;
                let then_s = time_s - instrument.torque_delay_s;
                let torque = if between {
                    cubic_at(&traces.torque_nm, traces, then_s, j)
                } else {
                    linear_at(&traces.torque_nm, traces, then_s, j)
                };
                let noise = channel.torque_noise_nm * currents.normal()
                    + wanders[j].at(time_s)
                    + channel.ripple.at(position_at(traces, then_s, j));
                let measured = instrument.noise_free_nm(j, torque + noise);
                row.measurement[j] = match unit {
                    MeasurementUnit::NewtonMetre => measured,
                    MeasurementUnit::Ampere => measured / channel.torque_constant_nm_per_a,
                };
                let logged = [row.position[j], row.velocity[j], row.measurement[j]];
                if let Some(value) = logged.into_iter().find(|value| !value.is_finite()) {
                    let what = format!("what the logger reads of joint {j} at {time_s:.3} s");
                    return Err(SimulationError::value(
                        what,
                        value,
                        "noise, resolution and torque constant must be such that it is finite",
                    ));
                }
            }
            if self.faults.is_none() {
                recording.push(time_s, &row);
                continue;
            }
            match *fate {
                Fate::Written => recording.push(time_s, &row),
                Fate::Missing => {}
                Fate::Repeated => {
                    recording.push(time_s, &row);
                    recording.push(time_s, &row);
                }
                Fate::Held => {
                    row = before;
                    recording.push(time_s, &row);
                }
                Fate::Corrupt(channel) => {
                    let mut wrong = row.clone();
                    if channel < n {
                        wrong.position[channel] += 40.0;
                    } else {
                        wrong.measurement[channel - n] = 3.2e4;
                    }
                    recording.push(time_s, &wrong);
                }
            }
        }
        Ok(recording)
    }
}

#[derive(Debug, Clone)]
struct Row {
    position: Vec<f64>,
    velocity: Vec<f64>,
    measurement: Vec<f64>,
}

/// Sample before `time_s` and the share of the way to the next.
fn place(traces: &Traces, time_s: f64) -> (usize, f64) {
    let position = (time_s / TRACE_STEP_S).max(0.0);
    // Instants that fall on a sample up to rounding are on it.
    let nearest = position.round();
    let position = if (position - nearest).abs() < 1e-6 { nearest } else { position };
    let sample = (position as usize).min(traces.samples - 2);
    (sample, (position - sample as f64).clamp(0.0, 1.0))
}

/// A joint's angle between samples, from angles and velocities at both sides.
fn position_at(traces: &Traces, time_s: f64, joint: usize) -> f64 {
    let (sample, x) = place(traces, time_s);
    let (here, next) = (sample * traces.joints + joint, (sample + 1) * traces.joints + joint);
    let (q0, q1) = (traces.position_rad[here], traces.position_rad[next]);
    let (v0, v1) = (traces.velocity_rad_s[here], traces.velocity_rad_s[next]);
    let y = 1.0 - x;
    q0 + (q1 - q0) * x * x * (3.0 - 2.0 * x) + TRACE_STEP_S * (v0 * x * y * y - v1 * x * x * y)
}

/// A series between samples: the cubic of Catmull and Rom through four of them.
fn cubic_at(series: &[f64], traces: &Traces, time_s: f64, joint: usize) -> f64 {
    let (sample, x) = place(traces, time_s);
    let at = |sample: usize| series[sample.min(traces.samples - 1) * traces.joints + joint];
    let (before, here, next, after) =
        (at(sample.saturating_sub(1)), at(sample), at(sample + 1), at(sample + 2));
    let (rise, bend) = (next - before, 2.0 * before - 5.0 * here + 4.0 * next - after);
    let third = 3.0 * (here - next) + after - before;
    here + 0.5 * x * (rise + x * (bend + x * third))
}

/// A series of traces at a time, joined linearly; its ends beyond them.
pub fn linear_at(series: &[f64], traces: &Traces, time_s: f64, joint: usize) -> f64 {
    let (sample, x) = place(traces, time_s);
    let (here, next) = (sample * traces.joints + joint, (sample + 1) * traces.joints + joint);
    series[here] + x * (series[next] - series[here])
}

impl SimulatedRecording {
    fn push(&mut self, time_s: f64, row: &Row) {
        self.time_s.push(time_s);
        self.position_rad.extend_from_slice(&row.position);
        if self.logger.velocity {
            self.velocity_rad_s.extend_from_slice(&row.velocity);
        }
        self.measurement.extend_from_slice(&row.measurement);
    }

    pub fn rows(&self) -> usize {
        self.time_s.len()
    }

    /// The names of the columns, in order.
    pub fn header(&self) -> Vec<String> {
        let (time, position, velocity, measurement) = match (self.logger.names, self.unit) {
            (ColumnNames::Actual, MeasurementUnit::Ampere) => {
                ("timestamp", "actual_q", "actual_qd", "actual_current")
            }
            (ColumnNames::Actual, MeasurementUnit::NewtonMetre) => {
                ("timestamp", "actual_q", "actual_qd", "torque")
            }
            (ColumnNames::Short, MeasurementUnit::Ampere) => ("time", "q", "qd", "current"),
            (ColumnNames::Short, MeasurementUnit::NewtonMetre) => ("time", "q", "qd", "tau"),
        };
        let mut names = vec![time.to_owned()];
        for family in [Some(position), self.logger.velocity.then_some(velocity), Some(measurement)] {
            names.extend(family.into_iter().flat_map(|f| (0..self.joints).map(move |j| format!("{f}_{j}"))));
        }
        names
    }

    /// The recording as the text of a CSV file.
    pub fn csv(&self) -> Vec<u8> {
        let mut text = Vec::with_capacity(self.rows() * (3 * self.joints + 1) * 11);
        text.extend_from_slice(self.header().join(",").as_bytes());
        text.push(b'\n');
        let n = self.joints;
        for (k, time_s) in self.time_s.iter().enumerate() {
            push_decimal(&mut text, *time_s, self.logger.time_decimals);
            let mut block = |series: &[f64], decimals: usize| {
                for value in series.get(k * n..(k + 1) * n).unwrap_or_default() {
                    text.push(b',');
                    push_decimal(&mut text, *value, decimals);
                }
            };
            block(&self.position_rad, self.logger.position_decimals);
            block(&self.velocity_rad_s, self.logger.position_decimals);
            block(&self.measurement, self.logger.measurement_decimals);
            text.push(b'\n');
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robots;
    use crate::scenario::{Scenario, simulate_with_traces};
    use crate::trajectory::Motion;

    /// Every row holds the position and the torque of its stamp, whatever the clock does.
    #[test]
    fn stamps_are_honest() {
        let robot = robots::ur5e();
        let motion = Motion::MultiSine { duration_s: 6.0, harmonics: 5, top_hz: 1.5, share: 0.6 };
        let mut scenario = Scenario::new(robot.clone(), motion.plan(&robot, 2).unwrap(), 2);
        scenario.instrument = Some(Instrument::ideal(&robot));
        for rate_hz in [130.0, 977.0] {
            scenario.logger = Logger {
                rate_hz,
                clock_jitter_s: 0.06 / rate_hz,
                time_decimals: 6,
                position_decimals: 10,
                ..Logger::default()
            };
            scenario.logger.faults.missing_share = 0.05;
            let (recording, traces) = simulate_with_traces(&scenario).unwrap();
            let periods: Vec<f64> = recording.time_s.windows(2).map(|w| (w[1] - w[0]) * rate_hz).collect();
            assert!(periods.iter().any(|p| (0.5..0.97).contains(p)), "no jitter at {rate_hz} Hz");
            assert!(periods.iter().any(|p| *p > 1.9), "no row is lost at {rate_hz} Hz");
            for (k, time_s) in recording.time_s.iter().enumerate() {
                for j in 0..robot.joints() {
                    let place = k * robot.joints() + j;
                    // Velocities reach 2 rad/s: a stamp that were off by 5 µs would show.
                    let off = recording.position_rad[place] - position_at(&traces, *time_s, j);
                    assert!(off.abs() < 1e-9, "row {k}, joint {j}: {off}");
                }
            }
            // What is written keeps the stamps to half a microsecond.
            let text = String::from_utf8(recording.csv()).unwrap();
            for (line, time_s) in text.lines().skip(1).zip(&recording.time_s) {
                let stamp: f64 = line.split(',').next().unwrap().parse().unwrap();
                assert!((stamp - time_s).abs() < 0.51e-6);
            }
        }
    }

    /// A tone of 60 Hz between samples of the traces.
    #[test]
    fn cubics_keep_what_lies_between_samples() {
        let tone = |time_s: f64| (std::f64::consts::TAU * 60.0 * time_s).sin();
        let samples = 200;
        let series: Vec<f64> = (0..samples).map(|k| tone(k as f64 * TRACE_STEP_S)).collect();
        let traces = Traces {
            joints: 1,
            samples,
            position_rad: series.clone(),
            velocity_rad_s: vec![0.0; samples],
            acceleration_rad_s2: vec![0.0; samples],
            torque_nm: series.clone(),
            evaluations: 0,
            events: 0,
            step_s: TRACE_STEP_S,
        };
        let worst = |at: fn(&[f64], &Traces, f64, usize) -> f64| {
            (10..900)
                .map(|k| 0.01 + f64::from(k) * 4e-4)
                .map(|t| (at(&series, &traces, t, 0) - tone(t)).abs())
                .fold(0.0, f64::max)
        };
        assert!(
            worst(cubic_at) < 0.012 && worst(linear_at) > 0.05,
            "{} {}",
            worst(cubic_at),
            worst(linear_at)
        );
    }
}
