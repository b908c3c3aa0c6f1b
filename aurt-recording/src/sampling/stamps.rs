//! The unit of time stamps, as rates, speeds and measured velocities show it.

use std::fmt;

use crate::noise::median_step_s;
use crate::recorded_as::TimeUnit;
use crate::recording::Recording;

/// Rates of loggers that see a motion, Hz.
pub(crate) const LOGGED_HZ: [f64; 2] = [5.0, 20_000.0];
/// No joint of an arm moves this fast, in rad/s or m/s.
const IMPOSSIBLE_SPEED: f64 = 50.0;
const SPANS: usize = 256;
/// How far measured velocities may be off a power of ten.
const VELOCITY_TOLERANCE: f64 = 0.1;

/// Time stamps that are in another unit than they are read in.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StampUnit {
    /// The unit that they are read in.
    pub read_in: TimeUnit,
    /// The unit that they are in.
    pub unit: TimeUnit,
    /// Rows per second as they are read, Hz.
    pub rate_hz: f64,
    /// Speed of the fastest joint as they are read, rad/s or m/s.
    pub speed: f64,
    /// Measured velocities over those that positions and stamps give, where there are some.
    pub velocity_ratio: Option<f64>,
}

impl fmt::Display for StampUnit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let factor = self.unit.seconds() / self.read_in.seconds();
        let number = |value: f64| match value {
            v if (100.0..1e7).contains(&v) => format!("{v:.0}"),
            v if (0.01..100.0).contains(&v) => format!("{}", (v * 1e3).round() / 1e3),
            v => format!("{v:.1e}"),
        };
        write!(
            f,
            "the stamps seem to be in {}: read in {} they give {} rows per second and joints at up to {} rad/s, read in {0} {} rows \
             and {} rad/s",
            self.unit.symbol(),
            self.read_in.symbol(),
            number(self.rate_hz),
            number(self.speed),
            number(self.rate_hz / factor),
            number(self.speed / factor),
        )?;
        if let Some(ratio) = self.velocity_ratio {
            write!(
                f,
                ", and the logged velocities are {} times the derivatives of the positions",
                number(ratio)
            )?;
        }
        write!(f, "; write `time = \"{}\"` in `[recordings]`", self.unit.key())
    }
}

impl Recording {
    /// The unit that its stamps are in, if that is another than the one they are read in. Measured velocities decide; without
    /// them it shows where loggers are not that slow or fast, and in the other unit joints can move that fast.
    pub fn stamp_unit(&self, read_in: TimeUnit) -> Option<StampUnit> {
        let rate_hz = 1.0 / median_step_s(&self.time_s)?;
        let speed = self.speed();
        let velocity_ratio = self.velocity_ratio();
        let is_logged = |rate_hz: f64| (LOGGED_HZ[0]..LOGGED_HZ[1]).contains(&rate_hz);
        let agrees = velocity_ratio.is_some_and(|ratio| (0.5..2.0).contains(&ratio));
        let candidate = |unit: &TimeUnit| {
            let factor = unit.seconds() / read_in.seconds();
            let by_velocity =
                velocity_ratio.is_some_and(|ratio| (ratio * factor - 1.0).abs() < VELOCITY_TOLERANCE);
            let by_motion =
                !is_logged(rate_hz) && is_logged(rate_hz / factor) && speed / factor < IMPOSSIBLE_SPEED;
            *unit != read_in && !agrees && (by_velocity || by_motion)
        };
        let unit = TimeUnit::NAMES.map(|(_, unit)| unit).into_iter().find(candidate)?;
        Some(StampUnit { read_in, unit, rate_hz, speed, velocity_ratio })
    }

    /// First and last row of spans that are long against the noise of positions.
    fn spans(&self) -> impl Iterator<Item = [usize; 2]> + Clone + use<> {
        let (samples, length) = (self.samples(), (self.samples() / SPANS).max(1));
        (0..samples.saturating_sub(length)).step_by(length).map(move |k| [k, k + length])
    }

    /// Speed of the fastest joint as positions and stamps give it.
    fn speed(&self) -> f64 {
        let of = |q: &Vec<f64>, [from, to]: [usize; 2]| {
            let speed = (q[to] - q[from]).abs() / (self.time_s[to] - self.time_s[from]);
            if speed.is_finite() { speed } else { 0.0 }
        };
        let joints = self.position_rad.iter();
        joints.flat_map(|q| self.spans().map(move |span| of(q, span))).fold(0.0, f64::max)
    }

    /// Measured velocities over those that positions and stamps give, by least squares over spans; `None` if nothing moves.
    fn velocity_ratio(&self) -> Option<f64> {
        let velocity = self.velocity_rad_s.as_ref()?;
        let (mut cross, mut power) = (0.0, 0.0);
        for (q, v) in self.position_rad.iter().zip(velocity) {
            for [from, to] in self.spans() {
                let step = |k: usize| 0.5 * (v[k] + v[k + 1]) * (self.time_s[k + 1] - self.time_s[k]);
                let distance = q[to] - q[from];
                cross += distance * (from..to).map(step).sum::<f64>();
                power += distance * distance;
            }
        }
        (power > 0.0).then(|| cross / power)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A joint at up to 0.7 rad/s, 125 rows a second, with stamps in a unit.
    fn recording(seconds: f64, with_velocity: bool) -> Recording {
        let time: Vec<f64> = (0..2000).map(|k| f64::from(k) * 0.008).collect();
        let of = |f: &dyn Fn(f64) -> f64| vec![time.iter().map(|t| f(*t)).collect::<Vec<_>>()];
        let stamps = time.iter().map(|t| t / seconds).collect();
        let recording = Recording::from_arrays(stamps, of(&|t| t.sin() * 0.7)).unwrap();
        if with_velocity { recording.with_velocity(of(&|t| 0.7 * t.cos())).unwrap() } else { recording }
    }

    #[test]
    fn other_units_show_with_velocities_and_without() {
        for with_velocity in [false, true] {
            for (_, unit) in TimeUnit::NAMES {
                let found = recording(unit.seconds(), with_velocity).stamp_unit(TimeUnit::Second);
                let expected = (unit != TimeUnit::Second).then_some(unit);
                assert_eq!(found.map(|f| f.unit), expected, "{found:?}");
            }
            // The other way round.
            let found = recording(1e3, with_velocity).stamp_unit(TimeUnit::Millisecond).unwrap();
            assert_eq!(found.unit, TimeUnit::Second);
        }
        let text = recording(1e-3, true).stamp_unit(TimeUnit::Second).unwrap().to_string();
        for words in ["0.125 rows", "125 rows", "1000 times", "time = \"ms\""] {
            assert!(text.contains(words), "{text}");
        }
    }

    /// A row a second of a joint that turns as arms do: in ms it would turn impossibly fast.
    #[test]
    fn slow_loggers_are_believed() {
        let mut slow = recording(1.0, false);
        slow.time_s = (0..2000).map(f64::from).collect();
        slow.position_rad = vec![(0..2000).map(|k| (f64::from(k) * 0.5).sin()).collect()];
        assert_eq!(slow.stamp_unit(TimeUnit::Second), None);
    }
}
