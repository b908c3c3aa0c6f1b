use std::collections::HashMap;
use std::path::Path;

use aurt_traits::MeasurementUnit;

use crate::csv::ReadOptions;
use crate::csv::clock::Clock;
use crate::csv::families::{self, Families};
use crate::csv::header::Header;
use crate::recorded_as::Factor;
use crate::{AngleUnit, CurrentUnit, Quantity, RecordedAs, RecordedJoints, RecordingError, TimeUnit};

/// A column of a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum ColumnRef {
    /// By its place, counting from 0.
    Index(usize),
    /// By its name in the header (case does not matter).
    Name(String),
}

/// The columns of a quantity, one for each joint in the order of the joints.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum ColumnsRef {
    /// From `first` to `last`, both included, counting from 0.
    Range {
        /// The column of joint 0.
        first: usize,
        /// The column of the last joint.
        last: usize,
    },
    /// One by one.
    List(Vec<ColumnRef>),
    /// All columns whose names are this and a joint number, e.g. `target_q` for `target_q_0`, `target_q_1`, ….
    Prefix(String),
}

/// Which columns hold what. Whatever is `None` is looked for by its usual names.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct ColumnSelection {
    /// Time stamps in s.
    pub time: Option<ColumnRef>,
    /// Joint angles in rad.
    pub position: Option<ColumnsRef>,
    /// Joint velocities in rad/s.
    pub velocity: Option<ColumnsRef>,
    /// Joint torques or motor currents.
    pub measurement: Option<ColumnsRef>,
}

/// The columns that are read.
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
    /// Which joints the columns belong to.
    pub(super) joints: RecordedJoints,
    /// Choices that a person should know.
    pub(super) remarks: Vec<String>,
}

impl Selected {
    /// All columns: time, positions, velocities, measurements, nanoseconds.
    pub(super) fn all(&self) -> Vec<usize> {
        let mut all: Vec<usize> = self.time.into_iter().collect();
        all.extend(&self.position);
        all.extend(self.velocity.iter().flatten());
        all.extend(self.measurement.iter().flatten());
        all.extend(self.nanoseconds);
        all
    }
}

/// What the numbers of a row are scaled with.
fn factors(selected: &Selected, recorded: &RecordedAs, joints: usize) -> Result<Vec<Factor>, RecordingError> {
    let time = if selected.time.is_some() { recorded.time_factor() } else { [1.0, 1.0] };
    let angles = recorded.angle_factors(joints)?;
    let measured =
        if selected.unit == MeasurementUnit::Ampere { recorded.current_factor() } else { [1.0, 1.0] };
    let mut factors = vec![time];
    factors.extend(&angles);
    factors.extend(selected.velocity.iter().flat_map(|_| &angles));
    factors.extend(selected.measurement.iter().flatten().map(|_| measured));
    Ok(factors)
}

/// The search for columns in one file.
pub(super) struct Search<'a> {
    pub(super) path: &'a Path,
    pub(super) header: &'a Header,
    pub(super) options: &'a ReadOptions,
}

impl Search<'_> {
    /// Finds the columns of all quantities.
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
        let (measurement, unit) = if recorded.takes(Quantity::Measurement) {
            self.measurement(&families, joints, &mut remarks)?
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
            joints: self.options.joints_read(&[]),
            remarks,
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
                    "select the columns of all joints explicitly".into(),
                ));
            }
        }
        self.check_units(&selected, &recorded)?;
        selected.factors = factors(&selected, &recorded, joints)?;
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
            None => Err(self.missing("joint positions", None, &families::POSITION, "position")),
        }
    }

    fn left_out(&self, what: &str, quantity: &str) -> RecordingError {
        self.wrong(
            format!("`take` leaves out {what}, which no other file has"),
            format!("add \"{quantity}\" to `take`, or name the file that has it under `joined`"),
        )
    }

    /// Columns that nobody asked for: if they are unusable, a remark says so.
    pub(super) fn optional(
        &self,
        what: &str,
        joints: usize,
        found: Result<Option<Vec<usize>>, RecordingError>,
        remarks: &mut Vec<String>,
    ) -> Option<Vec<usize>> {
        let problem = match found {
            Ok(Some(columns)) if columns.len() == joints => return Some(columns),
            Ok(None) => return None,
            Ok(Some(columns)) => {
                format!("{} columns ({}) for {joints} joints", columns.len(), self.header.span(&columns))
            }
            Err(RecordingError::Columns { reason, .. } | RecordingError::Unit { reason, .. }) => reason,
            Err(error) => error.to_string(),
        };
        remarks.push(format!("{what} were not read: {problem}"));
        None
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
            for name in columns.iter().filter_map(|c| self.header.names.get(*c)) {
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

    /// The preferred family among `prefixes`; a remark says so if there were others.
    fn find(
        &self,
        families: &Families,
        what: &'static str,
        prefixes: &[&'static str],
        remarks: &mut Vec<String>,
    ) -> Result<Option<Vec<usize>>, RecordingError> {
        if let Some((_, columns)) = self.by_joint(prefixes) {
            return Ok(Some(columns));
        }
        let Some(prefix) = families.present(prefixes).first().copied() else { return Ok(None) };
        let columns = self.family(families, prefix, what)?;
        let last_word = |name: &str| name.rsplit('_').next().map(str::to_owned);
        let others: Vec<&str> = families
            .present(prefixes)
            .into_iter()
            .filter(|p| *p != prefix)
            .chain(
                families
                    .present(&families::COMMANDED)
                    .into_iter()
                    .filter(|c| last_word(c) == last_word(prefix)),
            )
            .collect();
        if !others.is_empty() {
            remarks.push(format!("{what}: `{prefix}` is read, not `{}`", others.join("`, `")));
        }
        Ok(Some(columns))
    }

    /// The first of some quantities that has a column for each of the robot's joints by its name, as `elbow.position` and
    /// `position/elbow`.
    pub(super) fn by_joint<'p>(&self, quantities: &[&'p str]) -> Option<(&'p str, Vec<usize>)> {
        let joints = self.options.joint_names();
        let mut places = HashMap::new();
        for (k, quantity) in quantities.iter().enumerate() {
            for (j, joint) in joints.iter().map(|joint| joint.to_lowercase()).enumerate() {
                for between in ['.', '/', '_', ' '] {
                    places.insert(format!("{joint}{between}{quantity}"), (k, j));
                    places.insert(format!("{quantity}{between}{joint}"), (k, j));
                }
            }
        }
        let mut found = vec![vec![Vec::new(); joints.len()]; quantities.len()];
        for (column, name) in self.header.names.iter().enumerate().filter(|_| !joints.is_empty()) {
            let name = families::without_unit(name);
            // The topic may stand before it.
            let mut ends = std::iter::once(0).chain(name.match_indices(['/', '.']).map(|(at, _)| at + 1));
            if let Some((k, j)) = ends.find_map(|at| places.get(&name[at..])) {
                found[*k][*j].push(column);
            }
        }
        let only = |columns: &Vec<usize>| columns.first().copied().filter(|_| columns.len() == 1);
        let all = |columns: &Vec<Vec<usize>>| columns.iter().map(only).collect::<Option<Vec<usize>>>();
        let mut families = quantities.iter().zip(&found).filter(|_| !joints.is_empty());
        families.find_map(|(quantity, columns)| Some((*quantity, all(columns)?)))
    }

    /// The columns of a prefix.
    pub(super) fn family(
        &self,
        families: &Families,
        prefix: &str,
        what: &'static str,
    ) -> Result<Vec<usize>, RecordingError> {
        match families.columns(prefix) {
            Some(Ok(columns)) => Ok(columns),
            Some(Err(reason)) => {
                Err(self.wrong(reason, "rename the columns, or select them one by one".into()))
            }
            None => Err(self.missing(what, Some(prefix), &[prefix], "position")),
        }
    }

    /// The columns that a selection means.
    pub(super) fn columns(
        &self,
        columns: &ColumnsRef,
        what: &'static str,
        families: &Families,
    ) -> Result<Vec<usize>, RecordingError> {
        match columns {
            ColumnsRef::Range { first, last } => {
                if first > last {
                    return Err(self.wrong(
                        format!("the range of columns for {what} ends ({last}) before it starts ({first})"),
                        "give the first and the last column, both included, counting from 0".into(),
                    ));
                }
                self.column(&ColumnRef::Index(*last), what)?;
                Ok((*first..=*last).collect())
            }
            ColumnsRef::List(list) if list.is_empty() => {
                Err(self
                    .wrong(format!("no columns were listed for {what}"), "list one for each joint".into()))
            }
            ColumnsRef::List(list) => list.iter().map(|c| self.column(c, what)).collect(),
            ColumnsRef::Prefix(prefix) => self.family(families, prefix, what),
        }
    }

    /// The column that a reference means.
    fn column(&self, column: &ColumnRef, what: &'static str) -> Result<usize, RecordingError> {
        match column {
            ColumnRef::Index(index) if *index < self.header.columns => Ok(*index),
            ColumnRef::Index(index) => Err(RecordingError::ColumnIndex {
                path: self.path.to_owned(),
                what,
                index: *index,
                columns: self.header.columns,
            }),
            ColumnRef::Name(name) => {
                let mut named = self.header.named(name);
                match (named.next(), named.next()) {
                    (Some(column), None) => Ok(column),
                    (Some(_), Some(_)) => Err(self.wrong(
                        format!("there are two columns named `{name}`"),
                        "select the column by its number".into(),
                    )),
                    (None, _) => Err(self.missing(what, Some(name), &[name], "time")),
                }
            }
        }
    }

    pub(super) fn missing(
        &self,
        what: &'static str,
        wanted: Option<&str>,
        names: &[&str],
        key: &str,
    ) -> RecordingError {
        let commanded = Families::of(&self.header.names).present(&families::COMMANDED);
        let likely = match wanted {
            Some(wanted) => match self.header.most_similar(wanted) {
                Some(name) => format!("did you mean `{name}`?"),
                None => "names are compared without regard to case".to_owned(),
            },
            None if !commanded.is_empty() && key != "time" => format!(
                "`{}` is what was commanded, not what was measured; to use it all the same, select it with \
                 columns = {{ {key} = … }}",
                commanded[0]
            ),
            None => {
                // Asked for nothing else: the search for a selection reports missing columns of its own.
                let unknown = if key == "measurement" { self.selection_of_measurement() } else { None };
                if let Some((columns, selection)) = unknown {
                    return self.not_there(what, None, format!(
                        "if {} are what was measured, say so: in an experiment with {selection}, on the command line with --unit \
                         and --columns",
                        self.header.span(&columns)
                    ));
                }
                let usual: Vec<String> = names.iter().take(4).map(|n| format!("`{n}`")).collect();
                let usual = usual.join(", ");
                format!("usual names are {usual} …; select other columns with columns = {{ {key} = … }}")
            }
        };
        self.not_there(what, wanted, likely)
    }

    fn not_there(&self, what: &'static str, wanted: Option<&str>, likely: String) -> RecordingError {
        RecordingError::MissingColumn {
            path: self.path.to_owned(),
            line: self.header.line,
            what,
            wanted: wanted.map(str::to_owned),
            known: self.header.names.clone(),
            likely: Some(likely),
        }
    }

    /// Columns of all joints that nothing is known of, and how an experiment would select them as the measurement.
    pub(super) fn selection_of_measurement(&self) -> Option<(Vec<usize>, String)> {
        let families = Families::of(&self.header.names);
        let time = self.find_time(&families).ok()?.column;
        let position =
            self.find(&families, "joint positions", &families::POSITION, &mut Vec::new()).ok()??;
        let columns = families.unknown(self.options.joint_count().unwrap_or(position.len()))?;
        let listed = |columns: &[usize]| -> String {
            columns.iter().map(|c| format!("\"{}\"", self.header.name(*c))).collect::<Vec<_>>().join(", ")
        };
        let file = self.path.file_name().unwrap_or_default().to_string_lossy();
        let selection = format!(
            "{{ file = \"{file}\", unit = \"A\", columns = {{ time = {}, position = [{}], measurement = [{}] }} }} (or unit = \
             \"Nm\")",
            listed(&[time]),
            listed(&position),
            listed(&columns)
        );
        Some((columns, selection))
    }

    pub(super) fn wrong(&self, reason: String, remedy: String) -> RecordingError {
        RecordingError::Columns { path: self.path.to_owned(), line: self.header.line, reason, remedy }
    }

    fn names_of(&self, columns: Option<&Vec<usize>>) -> String {
        self.header.span(columns.map_or(&[], Vec::as_slice))
    }
}
