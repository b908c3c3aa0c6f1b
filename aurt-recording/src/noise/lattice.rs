//! The lattice on which an encoder puts its values.

use crate::noise::median;

/// Fewest changes of value from which a lattice is detected.
const FEWEST: usize = 20;
/// A change is on the lattice if it is a multiple to this share of the step: files round angles once more.
const OFF: f64 = 0.1;
/// Share of changes that must be on the lattice; of arbitrary values 2·OFF = 0.2 would be.
const ON: f64 = 0.9;
/// Multiples beyond which a step that is known to a per mille says nothing.
const FURTHEST: f64 = 200.0;
/// Decimals beyond which a file's rounding is that of binary numbers.
const MOST_DECIMALS: i32 = 10;

/// The step of the lattice on which all values of a series lie: an encoder's, or else the last decimal that was
/// written. `None` where there is neither.
///
/// The smallest tenth of the changes between neighbours supplies candidates for one step; the step is then refined by
/// least squares over multiples of growing size.
pub fn lattice_step(series: &[f64]) -> Option<f64> {
    let scale = series.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    let rounding = 16.0 * f64::EPSILON * scale;
    let mut changes: Vec<f64> =
        series.windows(2).map(|w| (w[1] - w[0]).abs()).filter(|d| *d > rounding).collect();
    if changes.len() < FEWEST {
        return None;
    }
    changes.sort_unstable_by(f64::total_cmp);
    let smallest = &mut changes[..].to_vec()[..(series.len() / 1000).clamp(1, FEWEST)];
    encoder(&changes, median(smallest)).or_else(|| decimals(series))
}

/// Refines a step from a first guess; `None` if the changes are no multiples of it.
fn encoder(changes: &[f64], guess: f64) -> Option<f64> {
    let mut step = guess;
    let mut reach = 1.5;
    while reach < FURTHEST {
        reach *= 2.0;
        let (mut cross, mut power) = (0.0, 0.0);
        for change in changes.iter().take_while(|c| **c < reach * step) {
            let multiple = (change / step).round();
            if (change / step - multiple).abs() < OFF {
                cross += multiple * change;
                power += multiple * multiple;
            }
        }
        if power == 0.0 {
            return None;
        }
        step = cross / power;
    }
    let judged = changes.iter().take_while(|c| **c < FURTHEST * step);
    let (on, all) = judged.fold((0, 0), |(on, all), c| {
        let multiple = c / step;
        (on + usize::from((multiple - multiple.round()).abs() < OFF && multiple > 0.5), all + 1)
    });
    (all >= FEWEST && on as f64 > ON * all as f64).then_some(step)
}

/// The last decimal in which the values are written.
fn decimals(series: &[f64]) -> Option<f64> {
    (0..=MOST_DECIMALS).find_map(|digits| {
        let unit = libm::pow(10.0, f64::from(digits));
        let written = series.iter().all(|x| (x * unit - (x * unit).round()).abs() < 1e-4);
        written.then(|| 1.0 / unit)
    })
}

#[cfg(test)]
mod tests {
    use super::lattice_step;
    use crate::noise::Normal;

    fn quantised(step: f64, noise: f64, decimals: i32) -> Vec<f64> {
        let mut normal = Normal::new(5);
        let unit = 10.0_f64.powi(decimals);
        (0..5000)
            .map(|k| 0.002 * f64::from(k))
            .map(|t| 0.8 * (2.0 * t).sin() + 0.3 * (5.1 * t).cos() + noise * normal.next())
            .map(|q| ((q / step).round() * step * unit).round() / unit)
            .collect()
    }

    #[test]
    fn the_step_of_an_encoder_is_found() {
        for bits in [12, 14, 16, 18] {
            let step = std::f64::consts::TAU / f64::from(1 << bits);
            for noise in [0.0, 0.3 * step] {
                let found = lattice_step(&quantised(step, noise, 9)).unwrap();
                assert!((found / step - 1.0).abs() < 2e-3, "{bits} bits, noise {noise}: {found} of {step}");
            }
        }
    }

    #[test]
    fn values_written_with_few_decimals_lie_on_these() {
        let found = lattice_step(&quantised(1e-12, 1e-3, 4)).unwrap();
        assert!((found / 1e-4 - 1.0).abs() < 1e-6, "{found}");
    }

    #[test]
    fn values_of_any_size_have_no_lattice() {
        assert_eq!(lattice_step(&quantised(1e-15, 1e-5, 15)), None);
        assert_eq!(lattice_step(&[0.5; 100]), None);
    }
}
