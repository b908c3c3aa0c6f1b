//! Values of options that clap has no parser for.

use std::fmt;

use aurt_rbd::gravity_complaint;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};

/// A word of an option, what help says of it, and the value that it stands for.
pub type Choice<T> = (&'static str, &'static str, T);

/// Takes one of a few words.
pub fn choice<T: Clone + Send + Sync>(choices: &'static [Choice<T>]) -> impl TypedValueParser<Value = T> {
    let shown = |(word, help, _): &Choice<T>| PossibleValue::new(*word).help(*help);
    PossibleValuesParser::new(choices.iter().map(shown)).try_map(|word| {
        let meant = choices.iter().find(|(known, ..)| *known == word);
        meant.map(|(.., value)| value.clone()).ok_or("no such word")
    })
}

/// Takes one of a few words that explain themselves.
pub fn word<T: Clone + Send + Sync>(words: &'static [(&str, T)]) -> impl TypedValueParser<Value = T> {
    PossibleValuesParser::new(words.iter().map(|(word, _)| word)).try_map(|word| {
        let meant = words.iter().find(|(known, _)| *known == word);
        meant.map(|(_, value)| value.clone()).ok_or("no such word")
    })
}

/// Numbers separated by spaces, commas or both, in brackets or not.
pub fn parse_numbers(text: &str) -> Result<Vec<f64>, String> {
    let inner = text.trim().trim_start_matches('[').trim_end_matches(']');
    let numbers = inner
        .split(|c: char| c == ',' || c.is_whitespace())
        .filter(|word| !word.is_empty())
        .map(|word| match word.parse::<f64>() {
            Ok(x) if x.is_finite() => Ok(x),
            Ok(_) => Err(format!("`{word}` is not finite")),
            Err(_) => Err(format!("`{word}` is not a number")),
        })
        .collect::<Result<Vec<f64>, String>>()?;
    if numbers.is_empty() { Err("expected numbers".into()) } else { Ok(numbers) }
}

/// Gravitational acceleration in the base frame, m/s².
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gravity(pub [f64; 3]);

impl fmt::Display for Gravity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [x, y, z] = self.0;
        write!(f, "{x} {y} {z} m/s²")
    }
}

pub fn parse_gravity(text: &str) -> Result<Gravity, String> {
    let numbers = parse_numbers(text)?;
    let gravity = <[f64; 3]>::try_from(numbers).map_err(|n| {
        format!(
            "expected three numbers, x y z in m/s² in the base frame, found {}; for example 0 0 -9.81",
            n.len()
        )
    })?;
    gravity_complaint(gravity).map_or(Ok(Gravity(gravity)), |reason| Err(format!("gravity {reason}")))
}

pub fn parse_torque_constants(text: &str) -> Result<Constants, String> {
    let numbers = parse_numbers(text)?;
    if numbers.contains(&0.0) {
        return Err("a torque constant must not be zero".into());
    }
    Ok(Constants(numbers))
}

/// Torque constants in Nm/A, joint after joint. A type of its own, because clap takes a bare `Vec` for a
/// repeated option.
#[derive(Debug, Clone, PartialEq)]
pub struct Constants(pub Vec<f64>);

pub fn parse_positive(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(x) if x.is_finite() && x > 0.0 => Ok(x),
        Ok(x) => Err(format!("must be above zero, is {x}")),
        Err(_) => Err("expected a number".into()),
    }
}

pub fn parse_not_negative(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(x) if x.is_finite() && x >= 0.0 => Ok(x),
        Ok(x) => Err(format!("must not be below zero, is {x}")),
        Err(_) => Err("expected a number".into()),
    }
}

/// A place, m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Position(pub [f64; 3]);

pub fn parse_position(text: &str) -> Result<Position, String> {
    let wrong = |n: Vec<f64>| format!("expected three numbers, x y z in m, found {}", n.len());
    parse_numbers(text)?.try_into().map(Position).map_err(wrong)
}

/// A share strictly between none and all.
pub fn parse_share(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(x) if x > 0.0 && x < 1.0 => Ok(x),
        _ => Err("expected a number between 0 and 1, such as 0.7".into()),
    }
}
