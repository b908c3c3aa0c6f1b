//! Presliding thresholds of the elements of `maxwell_slip` and `gms`: a list, or a logarithmic grid.

use aurt_traits::{ModelError, ShapeParameter};

use crate::shape::{Shape, out_of_bounds};

const SMALLEST: Shape = Shape::logarithmic("smallest_rad", "rad", 1e-5, 5e-3);
const LARGEST: Shape = Shape::logarithmic("largest_rad", "rad", 1e-2, 1.0);

/// Elements of a grid for which no number is given.
const DEFAULT_ELEMENTS: usize = 5;
/// More elements than this are a slip of the pen: neighbours could not be told apart.
const MOST_ELEMENTS: usize = 100;
const DEFAULT_SMALLEST_RAD: f64 = 0.0005;
const DEFAULT_LARGEST_RAD: f64 = 0.12;

/// The configuration keys that describe thresholds.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Thresholds<'a> {
    pub(crate) list_rad: Option<&'a [f64]>,
    pub(crate) elements: Option<usize>,
    pub(crate) smallest_rad: Option<f64>,
    pub(crate) largest_rad: Option<f64>,
}

impl Thresholds<'_> {
    /// Number of elements.
    pub(crate) fn len(self) -> usize {
        self.list_rad.map_or_else(|| self.elements.unwrap_or(DEFAULT_ELEMENTS), <[f64]>::len)
    }

    /// First and last threshold of the grid.
    fn ends(self) -> (f64, f64) {
        (self.smallest_rad.unwrap_or(DEFAULT_SMALLEST_RAD), self.largest_rad.unwrap_or(DEFAULT_LARGEST_RAD))
    }

    /// The threshold of every element in rad.
    pub(crate) fn values(self) -> Vec<f64> {
        if let Some(list) = self.list_rad {
            return list.to_vec();
        }
        let (smallest, largest) = self.ends();
        let last = self.len().saturating_sub(1).max(1) as f64;
        (0..self.len()).map(|i| smallest * libm::pow(largest / smallest, i as f64 / last)).collect()
    }

    /// The ends of the grid as shape parameters.
    pub(crate) fn shape_parameters(self) -> Vec<ShapeParameter> {
        let (smallest, largest) = self.ends();
        vec![SMALLEST.at(smallest), LARGEST.at(largest)]
    }

    /// Every complaint about the thresholds, in the name of `model`; `fitted` thresholds must be a grid within
    /// the bounds of the search.
    pub(crate) fn complaints(self, model: &str, fitted: bool) -> Vec<ModelError> {
        let mut complaints = Vec::new();
        let mut complain = |parameter: &str, reason: String| {
            complaints.push(ModelError::parameter(model, parameter, reason));
        };
        if let Some(list) = self.list_rad {
            for (key, given) in [
                ("elements", self.elements.is_some()),
                ("smallest_rad", self.smallest_rad.is_some()),
                ("largest_rad", self.largest_rad.is_some()),
                ("fit_thresholds", fitted),
            ] {
                if given {
                    complain(
                        key,
                        "describes a grid; leave it out, or leave out the list `thresholds_rad`".into(),
                    );
                }
            }
            if list.is_empty() {
                complain("thresholds_rad", "must not be empty".into());
            }
            if let Some(bad) = list.iter().find(|t| !(t.is_finite() && **t > 0.0)) {
                complain("thresholds_rad", format!("must be positive, contain {bad}"));
            }
            if let Some(pair) = list.windows(2).find(|pair| pair[0] >= pair[1]) {
                complain(
                    "thresholds_rad",
                    format!("must ascend, but {} is followed by {}", pair[0], pair[1]),
                );
            }
            if list.len() > MOST_ELEMENTS {
                complain(
                    "thresholds_rad",
                    format!("must not be more than {MOST_ELEMENTS}, are {}", list.len()),
                );
            }
            return complaints;
        }
        if !(2..=MOST_ELEMENTS).contains(&self.len()) {
            complain(
                "elements",
                format!(
                    "must lie between 2 and {MOST_ELEMENTS}, is {}; give one as `thresholds_rad`",
                    self.len()
                ),
            );
        }
        let (smallest, largest) = self.ends();
        for (key, value) in [("smallest_rad", smallest), ("largest_rad", largest)] {
            if !(value.is_finite() && value > 0.0) {
                complain(key, format!("must be positive, is {value}"));
            }
        }
        if smallest >= largest {
            complain("largest_rad", format!("must exceed `smallest_rad` = {smallest}, is {largest}"));
        }
        if fitted {
            complaints.extend(out_of_bounds(model, &self.shape_parameters()));
        }
        complaints
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GRID: Thresholds<'_> =
        Thresholds { list_rad: None, elements: None, smallest_rad: None, largest_rad: None };

    #[test]
    fn the_default_grid_has_constant_ratios() {
        let grid = GRID.values();
        assert_eq!(grid.len(), 5);
        assert!((grid[0] - 0.0005).abs() < 1e-18 && (grid[4] - 0.12).abs() < 1e-15);
        let ratio = 240f64.powf(0.25);
        assert!(grid.windows(2).all(|w| (w[1] / w[0] - ratio).abs() < 1e-12), "{grid:?}");
    }

    #[test]
    fn all_complaints_come_at_once() {
        let list = [0.1, 0.01, -1.0];
        let wrong = Thresholds { list_rad: Some(&list), elements: Some(3), ..GRID };
        assert_eq!(wrong.complaints("m", true).len(), 4);
        let wrong = Thresholds { elements: Some(1), smallest_rad: Some(0.2), ..GRID };
        assert_eq!(wrong.complaints("m", false).len(), 2);
        assert!(GRID.complaints("m", true).is_empty());
    }
}
