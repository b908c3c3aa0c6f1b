//! Gradient-boosted regression trees for squared errors (Friedman 2001), on features in classes of equal count.

/// How trees are grown.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Growth {
    /// Most trees.
    pub trees: usize,
    /// Splits between root and leaf.
    pub depth: usize,
    /// Share of a tree's prediction that is added.
    pub rate: f64,
    /// Fewest rows in a leaf.
    pub leaf_rows: usize,
}

impl Default for Growth {
    fn default() -> Self {
        Self { trees: 100, depth: 3, rate: 0.1, leaf_rows: 30 }
    }
}

/// Classes in which a feature is divided.
const CLASSES: usize = 32;

/// The edges of each feature's classes: quantiles of the rows that they were made from.
#[derive(Debug, Clone)]
pub struct Edges(Vec<Vec<f64>>);

impl Edges {
    /// Of features `[feature][row]`.
    pub fn of(features: &[Vec<f64>]) -> Self {
        let edges = |values: &Vec<f64>| {
            let mut sorted = values.clone();
            sorted.sort_by(f64::total_cmp);
            let mut edges: Vec<f64> =
                (1..CLASSES).filter_map(|k| sorted.get(k * sorted.len() / CLASSES).copied()).collect();
            edges.dedup();
            edges
        };
        Self(features.iter().map(edges).collect())
    }

    /// The class of each value, `[feature][row]`.
    pub fn classes(&self, features: &[Vec<f64>]) -> Vec<Vec<u8>> {
        let of = |(values, edges): (&Vec<f64>, &Vec<f64>)| {
            values.iter().map(|v| edges.partition_point(|e| e < v) as u8).collect()
        };
        features.iter().zip(&self.0).map(of).collect()
    }
}

/// A node: values of a class up to `class` go left.
#[derive(Debug, Clone, Copy)]
struct Split {
    feature: usize,
    class: u8,
}

/// A tree of complete depth: split k has the children 2k + 1 and 2k + 2; a node that is not divided sends all rows left.
#[derive(Debug, Clone)]
struct Tree {
    splits: Vec<Option<Split>>,
    leaves: Vec<f64>,
}

impl Tree {
    fn predict(&self, classes: &[Vec<u8>], row: usize) -> f64 {
        let mut node = 0;
        while node < self.splits.len() {
            let right = self.splits[node].is_some_and(|s| classes[s.feature][row] > s.class);
            node = 2 * node + 1 + usize::from(right);
        }
        self.leaves[node - self.splits.len()]
    }
}

/// Boosted trees.
#[derive(Debug, Clone)]
pub struct Boosted {
    trees: Vec<Tree>,
    /// By how much each feature's splits lower the squared error of the rows that were fitted.
    pub gains: Vec<f64>,
}

impl Boosted {
    /// Fits `values` over `rows` of the classes. With `judged`, no more trees are kept than lower the squared error of those
    /// rows; they may be none.
    pub fn fit(
        classes: &[Vec<u8>],
        values: &[f64],
        rows: &[usize],
        judged: Option<&[usize]>,
        growth: Growth,
    ) -> Self {
        let mut left = values.to_vec();
        let mut boosted = Self { trees: Vec::new(), gains: vec![0.0; classes.len()] };
        let error = |left: &[f64]| judged.map(|rows| rows.iter().map(|r| left[*r] * left[*r]).sum::<f64>());
        let mut best = (error(&left), 0);
        for _ in 0..growth.trees {
            let tree = grow(classes, &left, rows, growth, &mut boosted.gains);
            for row in rows.iter().chain(judged.into_iter().flatten()) {
                left[*row] -= tree.predict(classes, *row);
            }
            boosted.trees.push(tree);
            let now = error(&left);
            if now.zip(best.0).is_none_or(|(now, best)| now < best) {
                best = (now, boosted.trees.len());
            }
        }
        boosted.trees.truncate(best.1);
        boosted
    }

    /// Number of trees.
    pub const fn trees(&self) -> usize {
        self.trees.len()
    }

    pub fn predict(&self, classes: &[Vec<u8>], row: usize) -> f64 {
        self.trees.iter().map(|tree| tree.predict(classes, row)).sum()
    }
}

/// A tree that fits `left` over `rows`, shrunk; what each split gains is added to `gains`.
fn grow(classes: &[Vec<u8>], left: &[f64], rows: &[usize], growth: Growth, gains: &mut [f64]) -> Tree {
    let inner = (1 << growth.depth) - 1;
    let mut tree = Tree { splits: vec![None; inner], leaves: vec![0.0; inner + 1] };
    let mut parts: Vec<Vec<usize>> = vec![rows.to_vec()];
    for level in 0..growth.depth {
        let mut next = Vec::with_capacity(2 * parts.len());
        for (k, part) in parts.into_iter().enumerate() {
            let found = best_split(classes, left, &part, growth.leaf_rows);
            let (low, high) = match found {
                Some((split, gain)) => {
                    gains[split.feature] += gain;
                    part.into_iter().partition(|row| classes[split.feature][*row] <= split.class)
                }
                None => (part, Vec::new()),
            };
            tree.splits[(1 << level) - 1 + k] = found.map(|f| f.0);
            next.extend([low, high]);
        }
        parts = next;
    }
    for (leaf, part) in tree.leaves.iter_mut().zip(&parts).filter(|(_, part)| !part.is_empty()) {
        *leaf = growth.rate * part.iter().map(|row| left[*row]).sum::<f64>() / part.len() as f64;
    }
    tree
}

/// The split that lowers the squared error of `rows` most, and by how much.
fn best_split(classes: &[Vec<u8>], left: &[f64], rows: &[usize], leaf_rows: usize) -> Option<(Split, f64)> {
    if rows.len() < 2 * leaf_rows {
        return None;
    }
    let total: f64 = rows.iter().map(|row| left[*row]).sum();
    let whole = total * total / rows.len() as f64;
    let mut best: Option<(Split, f64)> = None;
    for (feature, of_feature) in classes.iter().enumerate() {
        let mut sums = [(0.0, 0_usize); CLASSES];
        for row in rows {
            let sum = &mut sums[usize::from(of_feature[*row])];
            sum.0 += left[*row];
            sum.1 += 1;
        }
        let (mut low, mut count) = (0.0, 0);
        for (class, (sum, n)) in sums.iter().enumerate() {
            low += sum;
            count += n;
            let above = rows.len() - count;
            if *n == 0 || count < leaf_rows || above < leaf_rows {
                continue;
            }
            let gain = low * low / count as f64 + (total - low).powi(2) / above as f64 - whole;
            if gain > best.map_or(0.0, |b| b.1) {
                best = Some((Split { feature, class: class as u8 }, gain));
            }
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::{Boosted, Edges, Growth};
    use crate::dice::Dice;

    /// Rows with a law in two features, a third that has no part in it, and noise of deviation one half.
    fn drawn(law: impl Fn(f64, f64) -> f64) -> (Vec<Vec<f64>>, Vec<f64>) {
        let mut dice = Dice(7);
        let mut uniform = || 2.0 * dice.uniform() - 1.0;
        let rows = 4000;
        let features: Vec<Vec<f64>> = (0..3).map(|_| (0..rows).map(|_| uniform()).collect()).collect();
        let values = (0..rows).map(|k| law(features[0][k], features[1][k]) + 0.866 * uniform()).collect();
        (features, values)
    }

    fn share(law: impl Fn(f64, f64) -> f64) -> (f64, Vec<f64>) {
        let (features, values) = drawn(law);
        let (fitted, judged): (Vec<usize>, Vec<usize>) = (0..values.len()).partition(|k| (k / 100) % 2 == 0);
        let classes = Edges::of(&features).classes(&features);
        let boosted = Boosted::fit(&classes, &values, &fitted, None, Growth::default());
        let squares = |of: &dyn Fn(usize) -> f64| judged.iter().map(|k| of(*k).powi(2)).sum::<f64>();
        let after = squares(&|k| values[k] - boosted.predict(&classes, k));
        (1.0 - after / squares(&|k| values[k]), boosted.gains)
    }

    #[test]
    fn a_law_of_two_features_is_predicted_and_its_features_are_told() {
        // Variance of the law 0.5 · 1 = 0.5, of the noise 0.25: two thirds can be predicted.
        let (share, gains) = share(|a, b| (6.0 * a).sin() * b.signum());
        assert!(share > 0.5 && share < 0.68, "{share}");
        assert!(gains[2] < 0.1 * (gains[0] + gains[1]), "{gains:?}");
    }

    #[test]
    fn noise_is_not_predicted_and_judged_rows_stop_the_growth() {
        let (noise, _) = share(|_, _| 0.0);
        assert!(noise < 0.01, "{noise}");
        let (features, values) = drawn(|_, _| 0.0);
        let (fitted, judged): (Vec<usize>, Vec<usize>) = (0..values.len()).partition(|k| (k / 100) % 2 == 0);
        let classes = Edges::of(&features).classes(&features);
        let stopped = Boosted::fit(&classes, &values, &fitted, Some(&judged), Growth::default());
        assert!(stopped.trees() < 15, "{}", stopped.trees());
    }
}
