//! The clock of a file, and the units that its names imply.

use crate::csv::families::{self, Families, NameParts};
use crate::csv::search::Search;
use crate::error::RecordingError;
use crate::recorded_as::{AngleUnit, RecordedAs, TimeUnit};

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Clock {
    pub(super) column: usize,
    /// The column of their nanoseconds, if they are in two.
    pub(super) nanoseconds: Option<usize>,
    unit: Option<TimeUnit>,
}

impl Clock {
    pub(super) const fn of(column: usize) -> Self {
        Self { column, nanoseconds: None, unit: None }
    }
}

impl Search<'_> {
    pub(super) fn find_time(&self, families: &Families) -> Result<Clock, RecordingError> {
        let one = |name: &str| match families.unnumbered(name).as_slice() {
            [] => Ok(None),
            [column] => Ok(Some(*column)),
            _ => Err(self.wrong(
                format!("there are two columns named `{name}`"),
                "rename one, or select the time column by its number".into(),
            )),
        };
        for name in families::TIME {
            if let Some(column) = one(name)? {
                return Ok(Clock::of(column));
            }
        }
        for (name, unit) in families::TIME_IN {
            if let Some(column) = one(name)? {
                return Ok(Clock { unit: Some(unit), ..Clock::of(column) });
            }
        }
        for [seconds, nanoseconds] in families::TIME_PAIRS {
            if let (Some(column), Some(fraction)) = (one(seconds)?, one(nanoseconds)?) {
                return Ok(Clock { nanoseconds: Some(fraction), ..Clock::of(column) });
            }
        }
        Err(self.missing("the time stamps", None, &families::TIME, "time"))
    }

    /// What was stated about the file and, where nothing was, what the names of its columns are documented to mean.
    pub(super) fn units(
        &self,
        time: Option<&Clock>,
        position: &[usize],
        remarks: &mut Vec<String>,
    ) -> Result<RecordedAs, RecordingError> {
        let mut recorded = self.options.recorded.clone();
        let family = self.family_of(position);
        let clock = time.map(|clock| (clock, self.header.name(clock.column)));
        if let (Some((clock, name)), None) = (&clock, recorded.time) {
            let of_libfranka = family == families::LIBFRANKA && name.trim().eq_ignore_ascii_case("time");
            recorded.time = clock.unit.or(of_libfranka.then_some(TimeUnit::Millisecond));
            if let Some(unit) = recorded.time {
                remarks.push(format!("`{name}` is in {}", unit.symbol()));
            }
        }
        if clock.is_some_and(|(clock, _)| clock.nanoseconds.is_some()) && recorded.time.is_some() {
            return Err(self.wrong(
                "the stamps are in seconds and nanoseconds, by the names of their columns".into(),
                "remove the key `time`".into(),
            ));
        }
        if recorded.angle.is_none() && recorded.counts_per_revolution.is_none() {
            let name = || self.header.span(position);
            if families::DEGREES.contains(&family.as_str()) {
                remarks.push(format!(
                    "{} are in degrees, as their name is documented to be; angle = \"rad\" says otherwise",
                    name()
                ));
                recorded.angle = Some(AngleUnit::Degree);
            } else if families::COUNTS.contains(&family.as_str()) {
                return Err(self.wrong(
                    format!("{} are encoder counts", name()),
                    "state how many make a turn, e.g. counts_per_revolution = 4096 (see the servo's control table), or \
                     angle = \"rad\" if they were converted"
                        .into(),
                ));
            }
        }
        Ok(recorded)
    }

    /// Velocities, unless positions are in degrees by their name and velocities by theirs are not.
    pub(super) fn in_unit_of_positions(
        &self,
        position: &[usize],
        velocity: Option<Vec<usize>>,
        remarks: &mut Vec<String>,
    ) -> Option<Vec<usize>> {
        let velocity = velocity?;
        let degrees = |columns: &[usize]| families::DEGREES.contains(&self.family_of(columns).as_str());
        if self.options.recorded.angle.is_none() && degrees(position) != degrees(&velocity) {
            let (q, v) = (self.header.span(position), self.header.span(&velocity));
            remarks.push(format!("joint velocities were not read: {v} need not be in the unit of {q}"));
            return None;
        }
        Some(velocity)
    }

    pub(super) fn remark_on_drive(&self, measurement: Option<&[usize]>, remarks: &mut Vec<String>) {
        let Some(columns) = measurement else { return };
        if families::DRIVE_UNITS.contains(&self.family_of(columns).as_str()) {
            remarks.push(format!(
                "{} are in the drive's own unit, not in A: torque per unit is what is calibrated, or state it by [instrument] gains",
                self.header.span(columns)
            ));
        }
    }

    fn family_of(&self, columns: &[usize]) -> String {
        let name = columns.first().and_then(|column| self.header.names.get(*column));
        name.map(|name| NameParts::of(name).prefix).unwrap_or_default()
    }
}
