use aurt_traits::{BaseParameters, Parameter, RigidBodyRegressor};
use serde_json::{Map, Value, json};

use super::json::At;
use crate::model::error::Error;

/// A base parameter as people read it.
#[derive(Debug, Clone, PartialEq)]
pub struct BaseParameterReading {
    /// The standard parameter that was kept, e.g. `ZZ_1`.
    pub name: String,
    /// Its unit.
    pub unit: String,
    /// What it collects: `ZZ_1 + YY_2 + 0.375 m_3`.
    pub stands_for: String,
}

/// What each base parameter of a robot stands for.
pub fn read_base_parameters(
    body: &dyn RigidBodyRegressor,
    base: &BaseParameters,
) -> Vec<BaseParameterReading> {
    let standard = body.standard_parameters();
    base.columns
        .iter()
        .zip(&base.combinations)
        .map(|(column, combination)| BaseParameterReading {
            name: standard[*column].name.clone(),
            unit: standard[*column].unit.clone(),
            stands_for: in_words(&standard, combination),
        })
        .collect()
}

fn in_words(standard: &[Parameter], combination: &[(usize, f64)]) -> String {
    let mut words = String::new();
    for (i, (index, factor)) in combination.iter().enumerate() {
        let sign = match (i, *factor < 0.0) {
            (0, false) => "",
            (0, true) => "-",
            (_, false) => " + ",
            (_, true) => " - ",
        };
        words.push_str(sign);
        let magnitude = factor.abs();
        if magnitude != 1.0 {
            words.push_str(&six_digits(magnitude));
            words.push(' ');
        }
        words.push_str(&standard[*index].name);
    }
    words
}

/// A number with six significant digits and no trailing zeros; readers want the size, the exact value stands beside.
fn six_digits(x: f64) -> String {
    let decimals = (5 - x.log10().floor() as i32).clamp(0, 17) as usize;
    let text = format!("{x:.decimals$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

pub(super) fn to_json(body: &dyn RigidBodyRegressor, base: &BaseParameters) -> Value {
    let standard = body.standard_parameters();
    let parameters: Vec<Value> = read_base_parameters(body, base)
        .into_iter()
        .zip(&base.combinations)
        .map(|(reading, combination)| {
            let terms: Map<String, Value> =
                combination.iter().map(|(i, factor)| (standard[*i].name.clone(), json!(factor))).collect();
            json!({
                "name": reading.name,
                "unit": reading.unit,
                "stands_for": reading.stands_for,
                "terms": terms,
            })
        })
        .collect();
    json!({ "seed": base.seed, "observations": base.observations, "parameters": parameters })
}

pub(super) fn from_json(body: &dyn RigidBodyRegressor, value: &At<'_>) -> Result<BaseParameters, Error> {
    let standard = body.standard_parameters();
    let index = |at: &At<'_>, name: &str| {
        standard.iter().position(|p| p.name == name).ok_or_else(|| {
            at.error(format!("names `{name}`, which is no standard parameter of these rigid bodies"), None)
        })
    };
    let mut columns = Vec::new();
    let mut combinations = Vec::new();
    for parameter in value.get("parameters")?.items()? {
        let name = parameter.get("name")?;
        let column = index(&name, name.text()?)?;
        if columns.last().is_some_and(|last| *last >= column) {
            return Err(
                name.error("stands out of order: base parameters ascend as the standard ones do", None)
            );
        }
        let mut combination = Vec::new();
        for (name, factor) in parameter.get("terms")?.entries()? {
            combination.push((index(&factor, name)?, factor.number()?));
        }
        if combination.first() != Some(&(column, 1.0)) {
            let reason = format!("must begin with the parameter itself, \"{}\": 1.0", name.text()?);
            return Err(parameter.get("terms")?.error(reason, None));
        }
        columns.push(column);
        combinations.push(combination);
    }
    let observations = value.get("observations")?.count()? as usize;
    Ok(BaseParameters { columns, combinations, seed: value.get("seed")?.count()?, observations })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn combinations_read_like_sums() {
        let standard: Vec<Parameter> =
            ["ZZ_1", "YY_2", "m_3", "mX_3"].map(|name| Parameter::new(name, "kg m^2")).into();
        let words = in_words(&standard, &[(0, 1.0), (1, 1.0), (2, 0.375), (3, -1.0), (2, -1.0 / 3.0)]);
        assert_eq!(words, "ZZ_1 + YY_2 + 0.375 m_3 - mX_3 - 0.333333 m_3");
    }

    #[test]
    fn six_digits_are_significant_ones() {
        assert_eq!(six_digits(0.0012345678), "0.00123457");
        assert_eq!(six_digits(1234567.8), "1234568");
        assert_eq!(six_digits(2.5), "2.5");
        assert_eq!(six_digits(100.0), "100");
    }
}
