use std::f64::consts::FRAC_PI_2;
use std::path::{Path, PathBuf};

use aurt_files::clipped;
use aurt_files::suggestion::likely;
use serde::{Deserialize, Serialize};

use crate::error::{MdhError, MdhErrors};
use crate::plausible::{angle_complaint, length_complaint};
use crate::{Joint, JointKind, MOST_JOINTS, Parent, Placement, angle};

/// Which joint the `alpha` and `a` of a row lead to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum MdhRows {
    /// Row j holds the d, theta, sign of joint j and the alpha, a that lead on to joint j + 1. The first
    /// joint has alpha = a = 0; alpha and a of the last row are without effect.
    #[default]
    Next,
    /// Row j holds the alpha, a that lead from joint j − 1 to joint j, and the d, theta, sign of joint j: the
    /// convention of Craig (*Introduction to Robotics*, section 3.4, where they are written α_{j−1}, a_{j−1}, d_j,
    /// θ_j) and that of Khalil and Kleinfinger (ICRA 1986), whose α_j, d_j, r_j, θ_j are the columns alpha, a, d and
    /// theta, and whose σ_j = 1 is the type `prismatic`.
    Previous,
}

/// One row of a table of modified Denavit–Hartenberg parameters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MdhRow {
    /// What the joint does.
    pub kind: JointKind,
    /// Twist α in rad.
    pub alpha_rad: f64,
    /// Length a in m.
    pub a_m: f64,
    /// Offset d in m; of a prismatic joint that at coordinate zero.
    pub d_m: f64,
    /// What is added to a revolute joint's coordinate, in rad; the constant angle of a prismatic joint.
    pub theta_offset_rad: f64,
    /// Sense of the joint's coordinate, 1 or −1: the angle is sign · q + offset, the distance of a prismatic joint
    /// sign · q + d.
    pub sign: f64,
}

/// A table of modified Denavit–Hartenberg parameters, one row per joint.
#[derive(Debug, Clone, PartialEq)]
pub struct MdhTable {
    /// The rows, from base to tip.
    pub rows: Vec<MdhRow>,
    /// How the rows are to be read.
    pub reading: MdhRows,
}

const COLUMNS: [&str; 6] = ["alpha", "a", "d", "theta", "sign", "type"];
/// Mistakes of one table that are told at once.
const MOST_ERRORS: usize = 20;
/// How many of [`COLUMNS`], from the first, every table needs.
const NEEDED: usize = 3;

impl MdhTable {
    /// Reads a table from a file; see [`Self::parse`].
    ///
    /// # Errors
    /// If the file cannot be read, and as [`Self::parse`].
    pub fn from_path(path: impl AsRef<Path>, reading: MdhRows) -> Result<Self, MdhErrors> {
        let path = path.as_ref();
        let text = aurt_files::read_text(path, aurt_files::MOST_TEXT_BYTES)
            .map_err(|source| MdhErrors(vec![MdhError::Unreadable { path: path.into(), source }]))?;
        Self::parse(&text, path, reading)
    }

    /// Reads a table from text; `path` is what errors call it.
    ///
    /// The first line names the columns in any order: `alpha` (rad), `a` (m), `d` (m), optionally `theta`
    /// (offset, rad), `sign` (1 or −1) and `type` (`revolute` or `prismatic`; all joints are revolute without it). Cells are separated by comma, semicolon, tab or spaces and hold
    /// numbers or expressions (`pi/2`, `-pi/4`, `2*pi/3`). Blank lines, comments from `#` on, a byte order
    /// mark and Windows line ends are fine.
    ///
    /// # Errors
    /// Everything that is wrong with the table, each with its line and column.
    pub fn parse(text: &str, path: impl AsRef<Path>, reading: MdhRows) -> Result<Self, MdhErrors> {
        let path = path.as_ref().to_path_buf();
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let mut lines = text
            .lines()
            .enumerate()
            .map(|(i, line)| (i + 1, line.split('#').next().unwrap_or_default().trim()))
            .filter(|(_, line)| !line.is_empty());
        let Some((line, header)) = lines.next() else {
            return Err(MdhErrors(vec![MdhError::Empty { path, reason: "the table is empty" }]));
        };
        let mut errors = Vec::new();
        let separator = Separator::of(header);
        let columns = read_header(&path, line, header, separator, &mut errors);
        if !errors.is_empty() {
            return Err(MdhErrors(errors));
        }
        let mut rows: Vec<MdhRow> = Vec::new();
        for (line, row) in lines {
            if rows.len() >= MOST_JOINTS {
                errors.push(MdhError::TooManyRows { path: path.clone(), line, most: MOST_JOINTS });
            }
            if rows.len() >= MOST_JOINTS || errors.len() >= MOST_ERRORS {
                break;
            }
            rows.extend(read_row(&path, line, row, separator, &columns, &mut errors));
        }
        if !errors.is_empty() {
            return Err(MdhErrors(errors));
        }
        if rows.is_empty() {
            return Err(MdhErrors(vec![MdhError::Empty { path, reason: "there are no rows" }]));
        }
        Ok(Self { rows, reading })
    }

    /// The joints that the table describes: each with the constant transformation from the previous link
    /// frame, Rot_x(α) Trans_x(a) Trans_z(d), to which the joint adds its rotation about z or its shift along z.
    pub fn joints(&self) -> Vec<Joint> {
        self.rows
            .iter()
            .enumerate()
            .map(|(j, row)| {
                let (alpha_rad, a_m) = match (self.reading, j) {
                    (MdhRows::Previous, _) => (row.alpha_rad, row.a_m),
                    (MdhRows::Next, 0) => (0.0, 0.0),
                    (MdhRows::Next, _) => (self.rows[j - 1].alpha_rad, self.rows[j - 1].a_m),
                };
                Joint {
                    kind: row.kind,
                    parent: Parent::Previous,
                    placement: Placement::Mdh { alpha_rad, a_m, d_m: row.d_m },
                    theta_offset_rad: row.theta_offset_rad,
                    sign: row.sign,
                }
            })
            .collect()
    }

    /// What a reader of the table should know though it is no error: angles that look like a rounded
    /// multiple of π/4. Rounding makes axes that are parallel or perpendicular slightly not so, and that
    /// adds base parameters which no recording can determine.
    pub fn notes(&self) -> Vec<String> {
        let step = FRAC_PI_2 / 2.0;
        let mut notes = Vec::new();
        for (j, row) in self.rows.iter().enumerate() {
            for (column, angle) in [("alpha", row.alpha_rad), ("theta", row.theta_offset_rad)] {
                let quarters = (angle / step).round();
                let off = (angle - quarters * step).abs();
                if off > 1e-12 * angle.abs() && off < 5e-4 {
                    notes.push(format!(
                        "row {j}: {column} = {angle} is {off:.1e} rad off {quarters}*pi/4; \
                         write it as an expression if it is meant to be exact"
                    ));
                }
            }
        }
        notes
    }
}

#[derive(Debug, Clone, Copy)]
enum Separator {
    Character(char),
    Whitespace,
}

impl Separator {
    fn of(header: &str) -> Self {
        [';', ',', '\t'].into_iter().find(|c| header.contains(*c)).map_or(Self::Whitespace, Self::Character)
    }

    fn split(self, line: &str) -> Vec<&str> {
        match self {
            Self::Character(c) => line.split(c).map(|cell| cell.trim().trim_matches('"').trim()).collect(),
            Self::Whitespace => line.split_whitespace().map(|cell| cell.trim_matches('"')).collect(),
        }
    }
}

/// The place in [`COLUMNS`] of each column of the header.
fn read_header(
    path: &Path,
    line: usize,
    header: &str,
    separator: Separator,
    errors: &mut Vec<MdhError>,
) -> Vec<usize> {
    let path = || PathBuf::from(path);
    let cells = separator.split(header);
    if cells.iter().all(|cell| angle::parse(cell).is_ok()) {
        errors.push(MdhError::MissingHeader { path: path(), line, text: clipped(header) });
        return Vec::new();
    }
    let mut columns = Vec::new();
    for (i, cell) in cells.iter().enumerate() {
        let name = cell.to_lowercase();
        if errors.len() >= MOST_ERRORS {
            break;
        }
        match COLUMNS.iter().position(|c| *c == name) {
            Some(column) if columns.contains(&column) => errors.push(MdhError::DuplicateColumn {
                path: path(),
                line,
                column_number: i + 1,
                text: clipped(cell),
            }),
            Some(column) => columns.push(column),
            None => errors.push(MdhError::UnknownColumn {
                path: path(),
                line,
                column_number: i + 1,
                text: clipped(cell),
                meant: probably_meant(&name),
            }),
        }
    }
    for (column, name) in COLUMNS.iter().enumerate().take(NEEDED) {
        // A column that was probably meant by an unknown name is not reported as missing as well.
        let guessed =
            errors.iter().any(|e| matches!(e, MdhError::UnknownColumn { meant, .. } if *meant == Some(name)));
        if !columns.contains(&column) && !guessed {
            errors.push(MdhError::MissingColumn {
                path: path(),
                line,
                column: name,
                found: cells.iter().take(MOST_ERRORS).map(|c| format!("`{}`", clipped(c))).collect(),
            });
        }
    }
    columns
}

fn probably_meant(name: &str) -> Option<&'static str> {
    let stem = name.split(['_', ' ', '(', '[', '-']).next().unwrap_or_default();
    let synonym = match stem {
        "α" | "twist" => Some("alpha"),
        "r" | "length" => Some("a"),
        "offset" => Some("d"),
        "θ" | "q" => Some("theta"),
        "direction" | "sense" => Some("sign"),
        "joint" | "kind" | "σ" | "sigma" => Some("type"),
        _ => None,
    };
    synonym.or_else(|| likely(stem, COLUMNS))
}

fn read_row(
    path: &Path,
    line: usize,
    text: &str,
    separator: Separator,
    columns: &[usize],
    errors: &mut Vec<MdhError>,
) -> Option<MdhRow> {
    let cells = separator.split(text);
    if cells.len() != columns.len() {
        errors.push(MdhError::CellCount {
            path: path.into(),
            line,
            expected: columns.len(),
            found: cells.len(),
            text: clipped(text),
        });
        return None;
    }
    let mut values = [0.0, 0.0, 0.0, 0.0, 1.0];
    let mut kind = JointKind::default();
    let before = errors.len();
    for (i, (cell, column)) in cells.iter().zip(columns).enumerate() {
        let name = COLUMNS[*column];
        let read = match values.get_mut(*column) {
            None => joint_kind(cell).map(|read| kind = read),
            Some(value) => angle::parse(cell).and_then(|read| {
                let complaint = match name {
                    "sign" if read.abs() != 1.0 => Some("is no sense of rotation; write 1 or -1".into()),
                    "alpha" | "theta" => angle_complaint(read),
                    "a" | "d" => length_complaint(read),
                    _ => None,
                };
                *value = read;
                complaint.map_or(Ok(()), Err)
            }),
        };
        if let Err(reason) = read {
            errors.push(MdhError::Cell {
                path: path.into(),
                line,
                column_number: i + 1,
                column: name,
                text: clipped(cell),
                reason,
            });
        }
    }
    let [alpha_rad, a_m, d_m, theta_offset_rad, sign] = values;
    (errors.len() == before).then_some(MdhRow { kind, alpha_rad, a_m, d_m, theta_offset_rad, sign })
}

/// The kind of joint that a cell of the column `type` names; the error is the rest of a sentence about the cell.
fn joint_kind(cell: &str) -> Result<JointKind, String> {
    let name = cell.to_lowercase();
    JointKind::NAMES
        .into_iter()
        .find_map(|(known, kind)| (known == name).then_some(kind))
        .ok_or_else(|| "is no type of joint; write revolute or prismatic".into())
}
