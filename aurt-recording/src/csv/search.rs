//! The search for columns by name, and what is said where there are none.

use std::collections::HashMap;
use std::path::Path;

use aurt_files::suggestion::likely;

use crate::csv::families::{self, Families};
use crate::csv::header::Header;
use crate::error::RecordingError;
use crate::read_options::ReadOptions;
use crate::recorded_as::{ColumnRef, ColumnsRef};

pub(super) struct Search<'a> {
    pub(super) path: &'a Path,
    pub(super) header: &'a Header,
    pub(super) options: &'a ReadOptions,
}

impl Search<'_> {
    /// Columns that were not requested: if they are unusable, a remark says so.
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

    /// The preferred family among `prefixes`; a remark says so if there were others.
    pub(super) fn find(
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
        self.by_names(self.options.joint_names(), quantities)
    }

    /// The positions of joints beside the robot's chain, in columns that nothing else is read from.
    pub(super) fn branches(&self, taken: &[usize]) -> Vec<(String, usize)> {
        let tracks = self.options.branch_tracks().into_iter().map(|track| track.joint);
        let column = |joint: String| {
            let (_, columns) = self.by_names(std::slice::from_ref(&joint), &families::POSITION)?;
            columns.first().filter(|column| !taken.contains(column)).map(|column| (joint, *column))
        };
        tracks.filter_map(column).collect()
    }

    /// The refusal of a file that has positions of some of the robot's joints by their names, and not of all.
    pub(super) fn partly_named(&self) -> Option<RecordingError> {
        let wanted = self.options.joint_names();
        let is_recorded = |columns: &Vec<Vec<usize>>| columns.iter().any(|columns| !columns.is_empty());
        let columns = self.named_columns(wanted, &families::POSITION).into_iter().find(is_recorded)?;
        let counted = |name: &String, columns: &Vec<usize>| vec![name.clone(); columns.len()];
        let recorded =
            wanted.iter().zip(&columns).flat_map(|(name, columns)| counted(name, columns)).collect();
        let lacking = wanted.iter().zip(&columns).filter(|(_, columns)| columns.len() != 1);
        Some(RecordingError::JointNames {
            path: self.path.to_owned(),
            recorded,
            wanted: wanted.to_vec(),
            lacking: lacking.map(|(name, _)| name.clone()).collect(),
        })
    }

    fn by_names<'p>(&self, joints: &[String], quantities: &[&'p str]) -> Option<(&'p str, Vec<usize>)> {
        let found = self.named_columns(joints, quantities);
        let only = |columns: &Vec<usize>| columns.first().copied().filter(|_| columns.len() == 1);
        let all = |columns: &Vec<Vec<usize>>| columns.iter().map(only).collect::<Option<Vec<usize>>>();
        let mut families = quantities.iter().zip(&found).filter(|_| !joints.is_empty());
        families.find_map(|(quantity, columns)| Some((*quantity, all(columns)?)))
    }

    fn named_columns(&self, joints: &[String], quantities: &[&str]) -> Vec<Vec<Vec<usize>>> {
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
        found
    }

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

    pub(super) fn column(&self, column: &ColumnRef, what: &'static str) -> Result<usize, RecordingError> {
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
            Some(wanted) => match likely(wanted, self.header.names.iter().map(String::as_str)) {
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

    pub(super) fn names_of(&self, columns: Option<&Vec<usize>>) -> String {
        self.header.span(columns.map_or(&[], Vec::as_slice))
    }
}
