//! How many setups were answered how.

use serde::Serialize;

use super::{Answer, Kind, Outcome};

#[derive(Debug, Clone, Serialize)]
pub struct Board {
    pub seed: u64,
    pub right: Vec<Answer>,
    pub wrong: Vec<Answer>,
}

impl Board {
    pub fn markdown(&self) -> String {
        let mut text = String::new();
        let row = |what: &str, of: &[&Answer]| {
            let count = |outcome| of.iter().filter(|a| a.outcome == outcome).count().to_string();
            let cells: Vec<String> = Outcome::ALL.map(count).into();
            format!("| {what} ({}) | {} |\n", of.len(), cells.join(" | "))
        };
        let names: Vec<&str> = Outcome::ALL.iter().map(|o| o.name()).collect();
        let head =
            format!("| setups (number) | {} |\n|---|{}\n", names.join(" | "), "---|".repeat(names.len()));
        text.push_str(&head);
        text.push_str(&row("right", &self.right.iter().collect::<Vec<_>>()));
        text.push_str(&row("wrong", &self.wrong.iter().collect::<Vec<_>>()));
        for name in Kind::names() {
            let of: Vec<&Answer> =
                self.wrong.iter().filter(|a| a.mistake.as_ref().is_some_and(|m| m[0] == name)).collect();
            if !of.is_empty() {
                text.push_str(&row(name, &of));
            }
        }
        let accused = self.right.iter().filter(|a| a.outcome == Outcome::Accused).count();
        if let Some(most) = upper_bound(accused, self.right.len()) {
            text.push_str(&format!(
                "\n{accused} of {} right setups accused: with 95 % confidence at most {:.2} % are\n",
                self.right.len(),
                100.0 * most
            ));
        }
        text
    }
}

/// The share that gives `count` or fewer of `of` with a probability of 5 % (Clopper and Pearson 1934).
fn upper_bound(count: usize, of: usize) -> Option<f64> {
    if of == 0 || count >= of {
        return None;
    }
    let at_most = |share: f64| -> f64 {
        let mut term = (of as f64 * (-share).ln_1p()).exp();
        let mut sum = term;
        for k in 0..count {
            term *= (of - k) as f64 / (k + 1) as f64 * share / (1.0 - share);
            sum += term;
        }
        sum
    };
    let (mut low, mut high) = (count as f64 / of as f64, 1.0 - f64::EPSILON);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if at_most(middle) > 0.05 { low = middle } else { high = middle }
    }
    Some(high)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Upper limits of scipy 1.17: binomtest(k, n, alternative="less").proportion_ci(0.95).high.
    #[test]
    fn bounds_are_those_of_tables() {
        for (count, of, expected) in [(0, 600, 1.0 - 0.05_f64.powf(1.0 / 600.0)), (0, 10, 0.258_865_6)] {
            assert!((upper_bound(count, of).unwrap() - expected).abs() < 1e-6);
        }
        assert_eq!(upper_bound(3, 3), None);
    }
}
