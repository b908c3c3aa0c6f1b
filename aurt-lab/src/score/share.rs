use std::fmt;

use serde::{Deserialize, Serialize};

#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Share {
    /// Those that are right (or whatever is counted).
    pub count: usize,
    pub of: usize,
}

impl Share {
    /// The share of what is so.
    pub fn counted<T>(all: impl IntoIterator<Item = T>, is: impl Fn(&T) -> bool) -> Self {
        all.into_iter().fold(Self::default(), |share, one| Self {
            count: share.count + usize::from(is(&one)),
            of: share.of + 1,
        })
    }

    pub const fn count(&mut self, is: bool) {
        self.count += is as usize;
        self.of += 1;
    }

    /// The share, none of nothing.
    pub fn ratio(&self) -> Option<f64> {
        (self.of > 0).then(|| self.count as f64 / self.of as f64)
    }
}

impl fmt::Display for Share {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.ratio() {
            Some(ratio) => write!(f, "{}/{} ({:.0} %)", self.count, self.of, 100.0 * ratio),
            None => write!(f, "–"),
        }
    }
}

pub(super) fn mean(values: impl Iterator<Item = f64>) -> Option<f64> {
    let (sum, count) = values.fold((0.0, 0), |(sum, count), v| (sum + v, count + 1));
    (count > 0).then(|| sum / f64::from(count))
}

pub(super) fn median(mut values: Vec<f64>) -> Option<f64> {
    values.retain(|v| v.is_finite());
    values.sort_by(f64::total_cmp);
    let middle = values.len() / 2;
    let odd = values.len() % 2 == 1;
    (!values.is_empty())
        .then(|| if odd { values[middle] } else { 0.5 * (values[middle - 1] + values[middle]) })
}
