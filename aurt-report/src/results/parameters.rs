//! `calibrated_parameters.csv`.

use std::fmt::Write;

use aurt_calibration::CalibratedParameter;

/// The parameters with what is known of their precision, one row each; cells without a value are empty.
pub fn to_csv(parameters: &[CalibratedParameter]) -> Vec<u8> {
    let mut csv = String::from("name,value,unit,std_dev,relative_std_dev_percent,lower_95,upper_95\n");
    let cell = |value: Option<f64>| value.filter(|v| v.is_finite()).map_or(String::new(), |v| v.to_string());
    for parameter in parameters {
        let _ = writeln!(
            csv,
            "{},{},{},{},{},{},{}",
            parameter.name,
            parameter.value,
            parameter.unit,
            cell(parameter.std_dev),
            cell(parameter.relative_std_dev_percent),
            cell(parameter.interval_95.map(|[lower, _]| lower)),
            cell(parameter.interval_95.map(|[_, upper]| upper)),
        );
    }
    csv.into_bytes()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_known_is_left_empty() {
        let known = CalibratedParameter {
            name: "F_C0_1".into(),
            unit: "Nm".into(),
            value: 2.5,
            std_dev: Some(0.5),
            relative_std_dev_percent: Some(20.0),
            interval_95: Some([1.5, 3.5]),
            excited: true,
        };
        let unknown = CalibratedParameter {
            name: "m_0".into(),
            unit: "kg".into(),
            value: 0.0,
            std_dev: None,
            relative_std_dev_percent: None,
            interval_95: None,
            excited: false,
        };
        let csv = String::from_utf8(to_csv(&[known, unknown])).unwrap();
        assert_eq!(
            csv,
            "name,value,unit,std_dev,relative_std_dev_percent,lower_95,upper_95\n\
             F_C0_1,2.5,Nm,0.5,20,1.5,3.5\nm_0,0,kg,,,,\n"
        );
    }
}
