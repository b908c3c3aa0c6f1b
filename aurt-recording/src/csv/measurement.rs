use aurt_traits::MeasurementUnit;

use crate::csv::families::{self, Families};
use crate::csv::search::Search;
use crate::error::RecordingError;

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
