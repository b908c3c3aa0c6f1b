use std::path::Path;

use aurt_traits::MeasurementUnit;

use crate::RecordingError;
use crate::csv::ReadOptions;
use crate::csv::families::{self, Families};
use crate::csv::header::Header;

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
    pub(super) time: usize,
    pub(super) position: Vec<usize>,
    pub(super) velocity: Option<Vec<usize>>,
    pub(super) measurement: Option<Vec<usize>>,
    pub(super) unit: MeasurementUnit,
    /// Choices that a person should know.
    pub(super) remarks: Vec<String>,
}

impl Selected {
    /// All columns: time, positions, velocities, measurements.
    pub(super) fn all(&self) -> Vec<usize> {
        let mut all = vec![self.time];
        all.extend(&self.position);
        all.extend(self.velocity.iter().flatten());
        all.extend(self.measurement.iter().flatten());
        all
    }
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
        let families = Families::of(&self.header.names);
        let mut remarks = Vec::new();
        if self.header.names.is_empty() && (selection.time.is_none() || selection.position.is_none()) {
            return Err(RecordingError::Headerless {
                path: self.path.to_owned(),
                line: self.header.line,
                columns: self.header.columns,
            });
        }
        let time = match &selection.time {
            Some(column) => self.column(column, "the time stamps")?,
            None => self.find_time()?,
        };
        let position = match &selection.position {
            Some(columns) => self.columns(columns, "joint positions", &families)?,
            None => match self.find(&families, "joint positions", &families::POSITION, &mut remarks)? {
                Some((_, columns)) => columns,
                None => return Err(self.missing("joint positions", None, &families::POSITION, "position")),
            },
        };
        let joints = self.options.joints.unwrap_or(position.len());
        let velocity = match &selection.velocity {
            Some(columns) => Some(self.columns(columns, "joint velocities", &families)?),
            None => self
                .find(&families, "joint velocities", &families::VELOCITY, &mut remarks)?
                .map(|(_, columns)| columns),
        };
        let (measurement, unit) = self.measurement(&families, &mut remarks)?;
        let selected = Selected { time, position, velocity, measurement, unit, remarks };
        let counts = [
            ("joint positions", Some(&selected.position)),
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

    /// The measurement's columns and unit.
    fn measurement(
        &self,
        families: &Families,
        remarks: &mut Vec<String>,
    ) -> Result<(Option<Vec<usize>>, MeasurementUnit), RecordingError> {
        let declared = self.options.unit;
        if let Some(columns) = &self.options.columns.measurement {
            let columns = self.columns(columns, "the measurement", families)?;
            let named = columns.first().and_then(|c| {
                self.header.names.get(*c).and_then(|name| families::unit_of(&families::split_number(name).0))
            });
            let Some(unit) = declared.or(named) else {
                return Err(RecordingError::Unit {
                    path: self.path.to_owned(),
                    reason: "the names of the measurement's columns do not tell its unit".into(),
                    remedy: "state it: unit = \"Nm\" (joint torque) or unit = \"A\" (motor current)".into(),
                });
            };
            return Ok((Some(columns), unit));
        }
        let currents = self.find_quietly(families, &families::CURRENT)?;
        let torques = self.find_quietly(families, &families::TORQUE)?;
        let (found, other, unit) = match (declared, currents, torques) {
            (None, Some(current), Some(torque)) => {
                let reason =
                    format!("the file has motor currents ({}) and joint torques ({})", current.0, torque.0);
                let remedy = "state which to use: unit = \"A\" or unit = \"Nm\"".to_owned();
                if self.options.needs_measurement {
                    return Err(RecordingError::Unit { path: self.path.to_owned(), reason, remedy });
                }
                remarks.push(format!("{reason}, and no unit was stated: neither was read"));
                return Ok((None, MeasurementUnit::default()));
            }
            (Some(MeasurementUnit::Ampere), Some(current), other) => {
                (Some(current), other, MeasurementUnit::Ampere)
            }
            (Some(MeasurementUnit::NewtonMetre), other, Some(torque)) => {
                (Some(torque), other, MeasurementUnit::NewtonMetre)
            }
            (None, Some(current), None) => (Some(current), None, MeasurementUnit::Ampere),
            (None, None, Some(torque)) => (Some(torque), None, MeasurementUnit::NewtonMetre),
            (Some(unit), current, torque) => {
                let found = current.or(torque);
                if let Some((prefix, _)) = &found {
                    remarks.push(format!(
                        "the columns `{prefix}` are taken to be in {}, as was stated",
                        unit.symbol()
                    ));
                }
                (found, None, unit)
            }
            (None, None, None) => (None, None, MeasurementUnit::default()),
        };
        if let (Some((prefix, _)), Some((unused, _))) = (&found, &other) {
            remarks.push(format!(
                "the file has `{prefix}` and `{unused}`: `{prefix}` is read, as unit {} was stated",
                unit.symbol()
            ));
        }
        if let Some((_, columns)) = found {
            return Ok((Some(columns), unit));
        }
        if self.options.needs_measurement {
            let mut names = families::CURRENT.to_vec();
            names.extend(families::TORQUE);
            return Err(self.missing(
                "the measurement (motor currents or joint torques)",
                None,
                &names,
                "measurement",
            ));
        }
        Ok((None, unit))
    }

    fn find_time(&self) -> Result<usize, RecordingError> {
        for name in families::TIME {
            let mut named = self.header.named(name);
            if let Some(column) = named.next() {
                if named.next().is_some() {
                    return Err(self.wrong(
                        format!("there are two columns named `{name}`"),
                        "rename one, or select the time column by its number".into(),
                    ));
                }
                return Ok(column);
            }
        }
        Err(self.missing("the time stamps", None, &families::TIME, "time"))
    }

    /// The preferred family among `prefixes`; a remark says so if there were others.
    fn find(
        &self,
        families: &Families,
        what: &str,
        prefixes: &[&'static str],
        remarks: &mut Vec<String>,
    ) -> Result<Option<(&'static str, Vec<usize>)>, RecordingError> {
        let found = self.find_quietly(families, prefixes)?;
        if let Some((prefix, _)) = &found {
            let mut others: Vec<&str> =
                families.present(prefixes).into_iter().filter(|p| p != prefix).collect();
            let commanded = families.present(&families::COMMANDED);
            let like: Vec<&str> =
                commanded.into_iter().filter(|c| c.rsplit('_').next() == prefix.rsplit('_').next()).collect();
            others.extend(like);
            if !others.is_empty() {
                remarks.push(format!("{what}: `{prefix}` is read, not `{}`", others.join("`, `")));
            }
        }
        Ok(found)
    }

    fn find_quietly(
        &self,
        families: &Families,
        prefixes: &[&'static str],
    ) -> Result<Option<(&'static str, Vec<usize>)>, RecordingError> {
        let Some(prefix) = families.present(prefixes).first().copied() else { return Ok(None) };
        match families.columns(prefix) {
            Some(Ok(columns)) => Ok(Some((prefix, columns))),
            Some(Err(reason)) => {
                Err(self.wrong(reason, "rename the columns, or select them explicitly".into()))
            }
            None => Ok(None),
        }
    }

    /// The columns that a selection means.
    fn columns(
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
            ColumnsRef::Prefix(prefix) => match families.columns(prefix) {
                Some(Ok(columns)) => Ok(columns),
                Some(Err(reason)) => {
                    Err(self.wrong(reason, "rename the columns, or list them one by one".into()))
                }
                None => Err(self.missing(what, Some(prefix), &[prefix], "position")),
            },
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

    fn missing(&self, what: &'static str, wanted: Option<&str>, names: &[&str], key: &str) -> RecordingError {
        let likely = wanted
            .and_then(|w| self.header.most_similar(w))
            .map(|name| format!("did you mean `{name}`?"))
            .unwrap_or_else(|| {
                let usual = names.iter().take(4).map(|n| format!("`{n}`")).collect::<Vec<_>>().join(", ");
                match wanted {
                    Some(_) => "names are compared without regard to case".to_owned(),
                    None => format!(
                        "usual names are {usual} …; select other columns with columns = {{ {key} = … }}"
                    ),
                }
            });
        RecordingError::MissingColumn {
            path: self.path.to_owned(),
            line: self.header.line,
            what,
            wanted: wanted.map(str::to_owned),
            known: self.header.names.clone(),
            likely: Some(likely),
        }
    }

    fn wrong(&self, reason: String, remedy: String) -> RecordingError {
        RecordingError::Columns { path: self.path.to_owned(), line: self.header.line, reason, remedy }
    }

    fn names_of(&self, columns: Option<&Vec<usize>>) -> String {
        self.header.span(columns.map_or(&[], Vec::as_slice))
    }
}
