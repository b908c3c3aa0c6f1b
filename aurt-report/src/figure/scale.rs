//! Axes: ranges, round values on them, and how these are written.

/// The smallest and largest finite value; `None` if there is none.
pub fn range<'a>(values: impl IntoIterator<Item = &'a f64>) -> Option<[f64; 2]> {
    values.into_iter().filter(|v| v.is_finite()).fold(None, |range, v| {
        let [low, high] = range.unwrap_or([*v, *v]);
        Some([low.min(*v), high.max(*v)])
    })
}

/// The least extent of a range, relative to its values: below it numbers on an axis would have too many digits.
const LEAST_EXTENT: f64 = 1e-4;

/// A range with room to both sides; a range without extent gets some. Values so small that they have not all digits are
/// zero.
pub fn padded(range: Option<[f64; 2]>, share: f64) -> [f64; 2] {
    let [low, high] = range.unwrap_or([0.0, 1.0]).map(|v| if v.is_normal() { v } else { 0.0 });
    let (extent, size) = (high - low, low.abs().max(high.abs()));
    if extent > LEAST_EXTENT * size {
        [low - share * extent, high + share * extent]
    } else if extent > 1e-12 * size {
        let (middle, half) = (0.5 * (low + high), 0.5 * LEAST_EXTENT * size);
        [middle - half, middle + half]
    } else {
        let room = if low == 0.0 { 1.0 } else { 0.5 * low.abs() };
        [low - room, high + room]
    }
}

/// The step between round values (1, 2 or 5 times a power of ten) that leaves at most `count` of them.
fn step(extent: f64, count: usize) -> f64 {
    let rough = extent / count.max(1) as f64;
    let power = 10.0_f64.powf(rough.log10().floor());
    let factor = rough / power;
    power
        * if factor <= 1.0 {
            1.0
        } else if factor <= 2.0 {
            2.0
        } else if factor <= 5.0 {
            5.0
        } else {
            10.0
        }
}

/// Round values within a range, at most about `count`, each with its text.
pub fn ticks([low, high]: [f64; 2], count: usize) -> Vec<(f64, String)> {
    let extent = high - low;
    // Of numbers without all their digits there is no step.
    if !extent.is_normal() || extent < 0.0 {
        return Vec::new();
    }
    let step = step(extent, count);
    let decimals = (-(step.log10() + 1e-9).floor()).clamp(0.0, 12.0) as usize;
    let first = (low / step).ceil() as i64;
    let last = (high / step).floor() as i64;
    (first..=last)
        .map(|k| {
            let value = k as f64 * step;
            (value, label(value, decimals))
        })
        .collect()
}

/// A number with that many decimals and a true minus sign; zero has none.
fn label(value: f64, decimals: usize) -> String {
    let text = if decimals > 5 && value != 0.0 {
        format!("{value:.1e}").replace("e-", "e−")
    } else {
        format!("{value:.*}", decimals.min(5))
    };
    match text.strip_prefix('-') {
        Some(rest) if rest.chars().all(|c| c == '0' || c == '.') => rest.to_owned(),
        Some(rest) => format!("−{rest}"),
        None => text,
    }
}

/// A coordinate in a drawing: two decimals at most.
pub fn coordinate(value: f64) -> String {
    let text = format!("{value:.2}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".into() } else { text.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_within() {
        let texts = |range, count| ticks(range, count).into_iter().map(|t| t.1).collect::<Vec<_>>();
        assert_eq!(texts([-1.1, 1.0], 5), ["−1.0", "−0.5", "0.0", "0.5", "1.0"]);
        assert_eq!(texts([0.0, 61.0], 7), ["0", "10", "20", "30", "40", "50", "60"]);
        assert_eq!(texts([0.012, 0.019], 4), ["0.012", "0.014", "0.016", "0.018"]);
        assert_eq!(texts([2.0, 2.0], 4), Vec::<String>::new());
    }

    #[test]
    fn ticks_are_few_whatever_the_range() {
        let sizes = [0.0, 5e-324, 1e-310, 2.3e-308, 1e-300, 1e-15, 1.0, 1e15, 1e300, f64::MAX];
        for low in sizes.iter().flat_map(|v| [-v, *v]) {
            for high in sizes.iter().flat_map(|v| [-v, *v]) {
                for range in [[low, high], padded(range(&[low, high]), 0.06)] {
                    assert!(ticks(range, 5).len() <= 7, "{range:?}");
                }
            }
        }
    }

    #[test]
    fn ranges_have_extent() {
        assert_eq!(padded(range(&[1.0, f64::NAN, 3.0]), 0.1), [0.8, 3.2]);
        assert_eq!(padded(range(&[2.0, 2.0]), 0.1), [1.0, 3.0]);
        assert_eq!(padded(None, 0.1), [-0.1, 1.1]);
        let [low, high] = padded(Some([2.0, 2.000_001]), 0.1);
        assert!((high - low - 2e-4).abs() < 1e-9, "{low} {high}");
    }

    #[test]
    fn labels_are_short_however_small_the_range() {
        for range in [[-3e-7, 2e-7], [0.0, 1e-12], [-1.870_85, -1.870_7], [1e-3, 2e-3], [-4e5, 3e5]] {
            for (_, label) in ticks(padded(Some(range), 0.06), 5) {
                assert!(label.chars().count() <= 8, "{label}");
            }
        }
    }

    #[test]
    fn coordinates_are_short() {
        assert_eq!(coordinate(12.0), "12");
        assert_eq!(coordinate(-0.001), "0");
        assert_eq!(coordinate(4.567_8), "4.57");
    }
}
