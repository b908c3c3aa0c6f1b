//! Fewer points that look the same.

/// Indices of samples that stand for all: in each of `buckets` stretches the first, the last, and for every series
/// the smallest and the largest, so that no spike is lost. Everything, where that is not more.
pub fn decimated(series: &[&[f64]], buckets: usize) -> Vec<usize> {
    let samples = series.iter().map(|s| s.len()).min().unwrap_or(0);
    let kept_per_bucket = 2 + 2 * series.len();
    if samples <= buckets.max(1) * kept_per_bucket {
        return (0..samples).collect();
    }
    let mut kept = Vec::with_capacity(buckets * kept_per_bucket);
    for bucket in 0..buckets {
        let (start, end) = (samples * bucket / buckets, samples * (bucket + 1) / buckets);
        let mut here = vec![start, end - 1];
        for values in series {
            let finite = || (start..end).filter(|k| values[*k].is_finite());
            here.extend(finite().min_by(|a, b| values[*a].total_cmp(&values[*b])));
            here.extend(finite().max_by(|a, b| values[*a].total_cmp(&values[*b])));
            // A gap must stay a gap.
            here.extend((start..end).find(|k| !values[*k].is_finite()));
        }
        here.sort_unstable();
        here.dedup();
        kept.extend(here);
    }
    kept
}

/// At most `most` indices out of `samples`, evenly.
pub fn subsample(samples: usize, most: usize) -> Vec<usize> {
    if samples <= most { (0..samples).collect() } else { (0..most).map(|k| k * samples / most).collect() }
}

/// Means of `y` in classes of equal count along `x`: mean x and mean y of each class with at least four points.
pub fn quantile_means(x: &[f64], y: &[f64], classes: usize) -> (Vec<f64>, Vec<f64>) {
    let mut pairs: Vec<(f64, f64)> =
        x.iter().copied().zip(y.iter().copied()).filter(|(x, y)| x.is_finite() && y.is_finite()).collect();
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
    let n = pairs.len();
    (0..classes)
        .map(|c| &pairs[n * c / classes.max(1)..n * (c + 1) / classes.max(1)])
        .filter(|class| class.len() >= 4)
        .map(|class| {
            let count = class.len() as f64;
            let sum = class.iter().fold((0.0, 0.0), |(sx, sy), (x, y)| (sx + x, sy + y));
            (sum.0 / count, sum.1 / count)
        })
        .unzip()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spikes_and_gaps_survive() {
        let mut values: Vec<f64> = (0..100_000).map(|k| (f64::from(k) * 1e-3).sin()).collect();
        values[54_321] = 9.0;
        values[70_001] = -9.0;
        values[80_000] = f64::NAN;
        let kept = decimated(&[&values], 500);
        assert!(kept.len() <= 2_500, "{}", kept.len());
        for k in [0, 54_321, 70_001, 80_000, 99_999] {
            assert!(kept.contains(&k), "{k} was lost");
        }
        assert!(kept.windows(2).all(|w| w[0] < w[1]));
    }

    #[test]
    fn short_series_stay_whole() {
        assert_eq!(decimated(&[&[1.0, 2.0], &[3.0, 4.0]], 10), [0, 1]);
        assert_eq!(decimated(&[], 10), Vec::<usize>::new());
        assert_eq!(subsample(3, 10), [0, 1, 2]);
        assert_eq!(subsample(10, 5), [0, 2, 4, 6, 8]);
    }

    #[test]
    fn class_means_follow_a_line() {
        let x: Vec<f64> = (0..160).map(f64::from).collect();
        let y: Vec<f64> = x.iter().map(|x| 2.0 * x).collect();
        let (mx, my) = quantile_means(&x, &y, 16);
        assert_eq!(mx.len(), 16);
        assert!(mx.iter().zip(&my).all(|(x, y)| (y - 2.0 * x).abs() < 1e-12));
    }
}
