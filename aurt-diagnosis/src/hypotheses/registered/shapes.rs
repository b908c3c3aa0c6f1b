//! In which values of its shape parameters a model is tried.

use aurt_traits::{Scale, ShapeParameter};

/// Factors on a parameter that is searched in logarithms: two decades around the example's value. Friction laws are so
/// wide in their shapes that steps of three suffice to recognise one; calibration of the improved model finds the value.
const FACTORS: [f64; 4] = [1.0 / 9.0, 1.0 / 3.0, 3.0, 9.0];

/// Places within the bounds of a parameter that is searched linearly.
const PLACES: [f64; 4] = [0.125, 0.375, 0.625, 0.875];

/// With more combinations than this, one parameter is varied at a time.
const MOST: usize = 25;

/// Sets of values, the present ones first.
pub(super) fn variants(parameters: &[ShapeParameter]) -> Vec<Vec<f64>> {
    let values: Vec<Vec<f64>> = parameters.iter().map(values).collect();
    let present: Vec<f64> = parameters.iter().map(|p| p.value).collect();
    let combinations = values.iter().map(Vec::len).try_fold(1_usize, usize::checked_mul);
    if combinations.is_some_and(|n| n <= MOST) {
        return values.iter().fold(vec![Vec::new()], |sets, values| {
            let extended = |set: Vec<f64>| values.iter().map(move |v| [set.as_slice(), &[*v]].concat());
            sets.into_iter().flat_map(extended).collect()
        });
    }
    let mut sets = vec![present.clone()];
    for (k, values) in values.iter().enumerate() {
        sets.extend(values.iter().skip(1).map(|value| {
            let mut set = present.clone();
            set[k] = *value;
            set
        }));
    }
    sets
}

/// A parameter's present value, and others within its bounds.
fn values(parameter: &ShapeParameter) -> Vec<f64> {
    let ShapeParameter { value, lower, upper, scale, .. } = parameter;
    let others = match scale {
        Scale::Logarithmic => FACTORS.map(|factor| value * factor),
        Scale::Linear => PLACES.map(|place| lower + place * (upper - lower)),
    };
    let within = |x: &f64| x.is_finite() && *x != *value && (*lower..=*upper).contains(x);
    std::iter::once(*value).chain(others.into_iter().filter(within)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parameter(value: f64, lower: f64, upper: f64, scale: Scale) -> ShapeParameter {
        ShapeParameter { name: "p".into(), unit: "1".into(), value, lower, upper, scale }
    }

    #[test]
    fn all_combinations_of_two_and_one_at_a_time_of_three() {
        let logarithmic = parameter(0.1, 1e-6, 1.0, Scale::Logarithmic);
        let linear = parameter(0.0, -4.0, 4.0, Scale::Linear);
        assert_eq!(variants(std::slice::from_ref(&logarithmic)).len(), 5);
        let two = variants(&[logarithmic.clone(), linear.clone()]);
        assert_eq!((two.len(), &two[0][..]), (25, &[0.1, 0.0][..]));
        assert!(two.contains(&vec![0.1 / 9.0, 3.0]));
        let three = variants(&[logarithmic.clone(), linear.clone(), linear]);
        assert_eq!((three.len(), &three[0][..]), (13, &[0.1, 0.0, 0.0][..]));
        assert!(three.iter().all(|set| set.iter().zip(&three[0]).filter(|(a, b)| a != b).count() <= 1));
        assert_eq!(variants(&[parameter(0.5, 0.2, 1.0, Scale::Logarithmic)]), [[0.5]]);
        assert_eq!(variants(&[parameter(0.5, f64::NEG_INFINITY, f64::INFINITY, Scale::Linear)]), [[0.5]]);
    }
}
