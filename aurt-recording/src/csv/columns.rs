use std::path::Path;

use aurt_traits::MeasurementUnit;

use crate::csv::clock::Clock;
use crate::csv::families::{self, Families};
use crate::csv::header::Header;
use crate::csv::search::Search;
use crate::error::RecordingError;
use crate::recorded_as::{AngleUnit, CurrentUnit, Factor, Quantity, RecordedAs, TimeUnit};
use crate::recording::{ReadReport, RecordedJoints, Recording};

#[derive(Debug)]
pub(super) struct Selected {
    /// None where the stamps follow from the rate.
    pub(super) time: Option<usize>,
    pub(super) position: Vec<usize>,
    pub(super) velocity: Option<Vec<usize>>,
    pub(super) measurement: Option<Vec<usize>>,
    pub(super) unit: MeasurementUnit,
    /// What each number of a row is scaled with: time, positions, velocities, measurements.
    pub(super) factors: Vec<Factor>,
    pub(super) rate_hz: Option<f64>,
    /// The nanoseconds of the stamps, where `time` has their seconds alone; last in a row.
    pub(super) nanoseconds: Option<usize>,
    /// Columns of positions of joints beside the chain, after all others in a row.
    pub(super) branches: Vec<(String, usize)>,
    pub(super) branch_factors: Vec<Factor>,
    /// Whether each joint slides: its positions are no angles.
    pub(super) sliding: Vec<bool>,
    pub(super) joints: RecordedJoints,
    /// Choices that a person should know.
    pub(super) remarks: Vec<String>,
    /// What may be a measurement, and was not read.
    pub(super) unread: Option<String>,
}

impl Selected {
    /// All columns: time, positions, velocities, measurements, nanoseconds, positions beside the chain.
    pub(super) fn all(&self) -> Vec<usize> {
        let mut all: Vec<usize> = self.time.into_iter().collect();
        all.extend(&self.position);
        all.extend(self.velocity.iter().flatten());
        all.extend(self.measurement.iter().flatten());
        all.extend(self.nanoseconds);
        all.extend(self.branches.iter().map(|(_, column)| column));
        all
    }

    /// Where each quantity is taken from.
    pub(super) fn in_words(&self, header: &Header) -> Vec<String> {
        let time = match (self.time, self.rate_hz) {
            (Some(time), _) => header.name(time),
            (None, rate) => format!("{} rows per second, as was stated", rate.unwrap_or_default()),
        };
        let mut columns = vec![format!("time: {time}")];
        if !self.position.is_empty() {
            columns.push(format!("position: {}", header.span(&self.position)));
        }
        columns.extend(self.velocity.iter().map(|v| format!("velocity: {}", header.span(v))));
        let measured = self.measurement.iter();
        columns.extend(measured.map(|m| format!("{}: {}", self.unit.quantity(), header.span(m))));
        columns
    }

    /// The recording of some series: time, positions, velocities, measurements, as far as they were selected.
    pub(super) fn recording(&self, path: &Path, series: Vec<Vec<f64>>, report: ReadReport) -> Recording {
        // A file that is joined to another may have no positions.
        let mut series = series.into_iter();
        let mut family = |columns: &[usize]| series.by_ref().take(columns.len()).collect::<Vec<_>>();
        let time_s = family(&[0]).pop().unwrap_or_default();
        Recording {
            file: path.to_owned(),
            time_s,
            position_rad: family(&self.position),
            velocity_rad_s: self.velocity.as_deref().map(&mut family),
            measurement: self.measurement.as_deref().map(&mut family),
            unit: self.unit,
            joints: self.joints.clone(),
            report,
        }
    }
}

/// What the numbers of a row are scaled with, column by column of what is read.
fn factors(selected: &Selected, recorded: &RecordedAs) -> Result<Vec<Factor>, RecordingError> {
    let time = if selected.time.is_some() { recorded.time_factor() } else { [1.0, 1.0] };
    let of_joints = recorded.position_factors(&selected.sliding)?;
    let measured =
        if selected.unit == MeasurementUnit::Ampere { recorded.current_factor() } else { [1.0, 1.0] };
    let families = [Some(&selected.position), selected.velocity.as_ref()];
    let motions = families.into_iter().flatten().flat_map(|columns| columns.iter().zip(&of_joints));
    let measurements = selected.measurement.iter().flatten().map(|_| measured);
    Ok(std::iter::once(time).chain(motions.map(|(_, factor)| *factor)).chain(measurements).collect())
}

impl Search<'_> {
    pub(super) fn run(&self) -> Result<Selected, RecordingError> {
        let selection = &self.options.columns;
        let recorded = &self.options.recorded;
        let families = Families::of(&self.header.names);
        let mut remarks = Vec::new();
        if self.header.names.is_empty()
            && (selection.time.is_none() && recorded.rate_hz.is_none()
                || selection.position.is_none()
                    && (self.options.needs_position || selection.measurement.is_none()))
        {
            return Err(RecordingError::Headerless {
                path: self.path.to_owned(),
                line: self.header.line,
                columns: self.header.columns,
            });
        }
        let time = match (&selection.time, recorded.rate_hz) {
            (_, Some(rate_hz)) => {
                if let Ok(clock) = self.find_time(&families) {
                    let name = self.header.name(clock.column);
                    remarks.push(format!("`{name}` is not read, since rate_hz = {rate_hz} was stated"));
                }
                None
            }
            (Some(column), None) => Some(Clock::of(self.column(column, "the time stamps")?)),
            (None, None) => Some(self.find_time(&families)?),
        };
        let position = self.position(&families, &mut remarks)?;
        let joints = self.options.joint_count().unwrap_or(position.len());
        let recorded = self.units(time.as_ref(), &position, &mut remarks)?;
        let velocity = match &selection.velocity {
            _ if !recorded.takes(Quantity::Velocity) => None,
            Some(columns) => Some(self.columns(columns, "joint velocities", &families)?),
            None => {
                let found = self.find(&families, "joint velocities", &families::VELOCITY, &mut remarks);
                let velocity = self.optional("joint velocities", joints, found, &mut remarks);
                self.in_unit_of_positions(&position, velocity, &mut remarks)
            }
        };
        let mut unread = None;
        let (measurement, unit) = if recorded.takes(Quantity::Measurement) {
            self.measurement(&families, joints, &mut remarks, &mut unread)?
        } else if self.options.needs_measurement {
            return Err(self.left_out("the measurement", "measurement"));
        } else {
            (None, self.options.unit.unwrap_or_default())
        };
        if position.is_empty() && velocity.is_none() && measurement.is_none() {
            let what = "joint positions, velocities or a measurement";
            return Err(self.missing(what, None, &families::CURRENT, "measurement"));
        }
        self.remark_on_drive(measurement.as_deref(), &mut remarks);
        let mut selected = Selected {
            time: time.as_ref().map(|clock| clock.column),
            position,
            velocity,
            measurement,
            unit,
            factors: Vec::new(),
            rate_hz: recorded.rate_hz,
            nanoseconds: time.and_then(|clock| clock.nanoseconds),
            branches: Vec::new(),
            branch_factors: Vec::new(),
            sliding: (0..joints).map(|joint| self.options.slides(joint)).collect(),
            joints: self.options.joints_read(&[]),
            remarks,
            unread,
        };
        let counts = [
            ("joint positions", Some(&selected.position).filter(|p| !p.is_empty())),
            ("joint velocities", selected.velocity.as_ref()),
            ("the measurement", selected.measurement.as_ref()),
        ];
        for (what, columns) in counts {
            if let Some(found) = columns.map(Vec::len).filter(|n| *n != joints) {
                return Err(self.wrong(
                    format!("{found} columns for {what} ({}), but {joints} joints", self.names_of(columns)),
                    "select the columns of all joints explicitly; if the file has none of some, such as fingers, end the chain before \
                     these (`--tip`, or `tip` of [robot])"
                        .into(),
                ));
            }
        }
        self.check_units(&selected, &recorded)?;
        selected.factors = factors(&selected, &recorded)?;
        let mut all = selected.all();
        all.sort_unstable();
        if let Some(twice) = all.windows(2).find(|w| w[0] == w[1]) {
            return Err(self.wrong(
                format!(
                    "column {} ({}) is selected for two quantities",
                    twice[0],
                    self.header.name(twice[0])
                ),
                "select another column for one of them".into(),
            ));
        }
        // Counts and gears of each joint of the chain say nothing of a joint beside it.
        let branches = self.branches(&all);
        let sliding: Vec<bool> =
            branches.iter().map(|(joint, _)| self.options.branch_slides(joint)).collect();
        let has_lists = [&recorded.counts_per_revolution, &recorded.gear_ratio]
            .iter()
            .any(|list| list.as_ref().is_some_and(|list| list.len() > 1));
        if !has_lists {
            selected.branch_factors = recorded.position_factors(&sliding)?;
            selected.branches = branches;
        }
        Ok(selected)
    }

    /// The columns of positions; none where a joined file has them.
    fn position(&self, families: &Families, remarks: &mut Vec<String>) -> Result<Vec<usize>, RecordingError> {
        let needed = self.options.needs_position;
        if !self.options.recorded.takes(Quantity::Position) {
            return if needed { Err(self.left_out("joint positions", "position")) } else { Ok(Vec::new()) };
        }
        if let Some(columns) = &self.options.columns.position {
            return self.columns(columns, "joint positions", families);
        }
        match self.find(families, "joint positions", &families::POSITION, remarks)? {
            Some(columns) => Ok(columns),
            None if !needed => Ok(Vec::new()),
            None => Err(self
                .partly_named()
                .unwrap_or_else(|| self.missing("joint positions", None, &families::POSITION, "position"))),
        }
    }

    fn left_out(&self, what: &str, quantity: &str) -> RecordingError {
        self.wrong(
            format!("`take` leaves out {what}, which no other file has"),
            format!("add \"{quantity}\" to `take`, or name the file that has it under `joined`"),
        )
    }

    /// Refuses columns whose names say that they are in another unit than they are read in.
    fn check_units(&self, selected: &Selected, recorded: &RecordedAs) -> Result<(), RecordingError> {
        let time: &[&str] = match recorded.time {
            None | Some(TimeUnit::Second) => &families::TIME_UNITS,
            Some(TimeUnit::Millisecond) => &["ms"],
            Some(TimeUnit::Microsecond) => &["us", "µs"],
            Some(TimeUnit::Nanosecond) => &["ns"],
        };
        let (position, velocity): (&[&str], &[&str]) = match (recorded.angle, &recorded.counts_per_revolution)
        {
            (_, Some(_)) => (&["counts", "inc"], &["counts/s", "inc/s"]),
            (Some(AngleUnit::Degree), None) => (&["deg", "°", "degrees"], &["deg/s", "°/s", "degrees/s"]),
            _ => (&families::POSITION_UNITS, &families::VELOCITY_UNITS),
        };
        let measurement: &[&str] = match selected.unit {
            MeasurementUnit::Ampere if recorded.current == Some(CurrentUnit::Milliampere) => &["ma"],
            MeasurementUnit::Ampere => &families::CURRENT_UNITS,
            MeasurementUnit::NewtonMetre => &families::TORQUE_UNITS,
        };
        let quantities: [(&str, &[usize], &[&str]); 4] = [
            ("time stamps", selected.time.as_slice(), time),
            ("positions", &selected.position, position),
            ("velocities", selected.velocity.as_deref().unwrap_or(&[]), velocity),
            ("measurements", selected.measurement.as_deref().unwrap_or(&[]), measurement),
        ];
        for (what, columns, units) in quantities {
            for (joint, name) in
                columns.iter().enumerate().filter_map(|(j, c)| Some((j, self.header.names.get(*c)?)))
            {
                // What slides is in lengths and forces.
                let slides = what != "time stamps" && selected.sliding.get(joint) == Some(&true);
                let units = if slides { &families::SLIDING_UNITS[..] } else { units };
                let unit = families::NameParts::of(name).unit;
                if let Some(unit) = unit.filter(|u| !units.contains(&u.as_str())) {
                    return Err(self.wrong(
                        format!("column `{name}` is in `{unit}`, but {what} are read in {}", units[0]),
                        "convert the column, state its unit (angle = \"deg\", time = \"ms\", current = \"mA\"), or rename it if its \
                         name is wrong"
                            .into(),
                    ));
                }
            }
        }
        Ok(())
    }
}

impl Search<'_> {
    /// The measurement's columns and unit.
    ///
    /// Selected columns have the stated unit, or the one that their names tell. Otherwise motor currents and joint
    /// torques are looked for; if there are both, the stated unit decides.
    pub(super) fn measurement(
        &self,
        families: &Families,
        joints: usize,
        remarks: &mut Vec<String>,
        unread: &mut Option<String>,
    ) -> Result<(Option<Vec<usize>>, MeasurementUnit), RecordingError> {
        let stated = self.options.unit;
        if let Some(selection) = &self.options.columns.measurement {
            let columns = self.columns(selection, "the measurement", families)?;
            let Some(unit) = stated.or_else(|| self.unit_of(&columns)) else {
                return Err(self.unit_unknown(
                    "the names of the measurement's columns do not tell its unit".into(),
                    "state it: unit = \"Nm\" (joint torque) or unit = \"A\" (motor current)",
                ));
            };
            return Ok((Some(columns), unit));
        }
        let candidates: Vec<(&str, MeasurementUnit)> = [
            (&families::CURRENT[..], MeasurementUnit::Ampere),
            (&families::TORQUE, MeasurementUnit::NewtonMetre),
        ]
        .into_iter()
        .filter_map(|(known, usual)| {
            let (prefix, columns) = match self.by_joint(known) {
                Some((quantity, columns)) => (quantity, Some(columns)),
                None => {
                    let prefix = *families.present(known).first()?;
                    (prefix, families.columns(prefix)?.ok())
                }
            };
            let unit = columns.and_then(|columns| self.unit_of(&columns)).unwrap_or(usual);
            Some((prefix, unit))
        })
        .collect();
        let fitting = candidates.iter().find(|(_, unit)| Some(*unit) == stated);
        let (prefix, unit) = match (fitting, stated, candidates.as_slice()) {
            (Some((prefix, unit)), ..) => {
                for (other, _) in candidates.iter().filter(|(other, _)| other != prefix) {
                    remarks.push(format!(
                        "the measurement: `{prefix}` is read, not `{other}`, since unit {} was stated",
                        unit.symbol()
                    ));
                }
                (*prefix, *unit)
            }
            (None, Some(unit), [(prefix, _), ..]) => {
                remarks.push(format!("`{prefix}` is taken to be in {}, as was stated", unit.symbol()));
                (*prefix, unit)
            }
            (None, None, [(prefix, unit)]) => (*prefix, *unit),
            (None, None, [(one, _), (two, _), ..]) => {
                let reason = format!("the file has motor currents (`{one}`) and joint torques (`{two}`)");
                if self.options.needs_measurement {
                    return Err(
                        self.unit_unknown(reason, "state which to read: unit = \"A\" or unit = \"Nm\"")
                    );
                }
                remarks.push(format!("{reason}, and no unit was stated: neither was read"));
                return Ok((None, MeasurementUnit::default()));
            }
            (None, _, []) if self.options.needs_measurement => {
                let mut names = families::CURRENT.to_vec();
                names.extend(families::TORQUE);
                let what = "the measurement (motor currents or joint torques)";
                return Err(self.missing(what, None, &names, "measurement"));
            }
            (None, _, []) => {
                if let Some((columns, selection)) = self.selection_of_measurement() {
                    *unread = Some(format!(
                        "nothing measured was recognised; if {} are motor currents or joint torques, say so: in an experiment with \
                         {selection}, on the command line with --unit and --columns",
                        self.header.span(&columns)
                    ));
                }
                return Ok((None, stated.unwrap_or_default()));
            }
        };
        let columns = match self.by_joint(&[prefix]) {
            Some((_, columns)) => Ok(Some(columns)),
            None => self.family(families, prefix, "the measurement").map(Some),
        };
        if self.options.needs_measurement {
            return Ok((columns?, unit));
        }
        Ok((self.optional("the measurement", joints, columns, remarks), unit))
    }

    /// The unit that the name of the first of some columns tells.
    fn unit_of(&self, columns: &[usize]) -> Option<MeasurementUnit> {
        families::unit_of(self.header.names.get(*columns.first()?)?)
    }

    fn unit_unknown(&self, reason: String, remedy: &str) -> RecordingError {
        RecordingError::Unit { path: self.path.to_owned(), reason, remedy: remedy.to_owned() }
    }
}
