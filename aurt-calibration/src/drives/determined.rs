//! What recordings leave open, in words.

use nalgebra::DMatrix;

use crate::drives::columns::Column;

/// Numbers of a direction below this part of its largest are not named.
const NAMED: f64 = 0.35;

/// A direction along which the recordings say less than was known beforehand.
#[derive(Debug, Clone, PartialEq)]
pub struct Undetermined {
    /// The numbers that change along it, the largest first.
    pub names: Vec<String>,
    /// Their changes, in standard deviations of what was known beforehand.
    pub changes: Vec<f64>,
    /// What the recordings know of it, relative to what was known beforehand: below 1.
    pub information: f64,
}

impl std::fmt::Display for Undetermined {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        if let [name] = &self.names[..] {
            return write!(f, "these recordings say less of {name} than was known before");
        }
        let together = |k: usize| if self.changes[k] * self.changes[0] > 0.0 { "up" } else { "down" };
        let list: Vec<String> =
            (0..self.names.len()).map(|k| format!("{} {}", self.names[k], together(k))).collect();
        write!(f, "cannot be told apart by these recordings: {}", list.join(", "))
    }
}

/// The directions of `information` (in units of the columns' deviations) that the recordings leave open.
pub(crate) fn undetermined(
    columns: &[Column],
    information: &DMatrix<f64>,
    fixed: &[bool],
) -> Vec<Undetermined> {
    let free: Vec<usize> = (0..columns.len()).filter(|k| !fixed[*k]).collect();
    if free.is_empty() {
        return Vec::new();
    }
    let reduced = DMatrix::from_fn(free.len(), free.len(), |r, c| information[(free[r], free[c])]);
    let eigen = reduced.symmetric_eigen();
    let mut found: Vec<Undetermined> = (0..free.len())
        .filter(|k| eigen.eigenvalues[*k] < 1.0)
        .map(|k| {
            let direction = eigen.eigenvectors.column(k);
            let largest = direction.amax();
            let mut named: Vec<(usize, f64)> =
                direction.iter().copied().enumerate().filter(|(_, x)| x.abs() >= NAMED * largest).collect();
            named.sort_by(|a, b| b.1.abs().total_cmp(&a.1.abs()));
            Undetermined {
                names: named.iter().map(|(i, _)| columns[free[*i]].name.clone()).collect(),
                changes: named.iter().map(|(_, x)| *x).collect(),
                information: eigen.eigenvalues[k].max(0.0),
            }
        })
        .collect();
    found.sort_by(|a, b| a.information.total_cmp(&b.information));
    found
}
