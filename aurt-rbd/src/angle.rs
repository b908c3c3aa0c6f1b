//! Numbers as people write them in a table of joint geometry: `0.333`, `-pi/2`, `2*pi/3`, `0.5*pi`.

use std::f64::consts::PI;

/// The value of a sum of products of decimal numbers and `pi`.
///
/// Grammar: `sum = term {("+"|"-") term}`, `term = factor {("*"|"/") factor}`,
/// `factor = {"+"|"-"} (decimal | "pi" | "π")`. The error is the rest of a sentence about the text.
pub(crate) fn parse(text: &str) -> Result<f64, String> {
    let mut reader = Reader { rest: text.trim() };
    if reader.rest.is_empty() {
        return Err("is empty; write 0 for a value that is zero".into());
    }
    let value = reader.sum()?;
    if !reader.rest.is_empty() {
        return Err(reader.complaint());
    }
    if !value.is_finite() {
        return Err(format!("is {value}; a finite number is needed"));
    }
    Ok(value)
}

struct Reader<'a> {
    rest: &'a str,
}

impl Reader<'_> {
    fn sum(&mut self) -> Result<f64, String> {
        let mut value = self.term()?;
        loop {
            if self.take("+") {
                value += self.term()?;
            } else if self.take("-") {
                value -= self.term()?;
            } else {
                return Ok(value);
            }
        }
    }

    fn term(&mut self) -> Result<f64, String> {
        let mut value = self.factor()?;
        loop {
            if self.take("*") {
                value *= self.factor()?;
            } else if self.take("/") {
                value /= self.factor()?;
            } else {
                return Ok(value);
            }
        }
    }

    fn factor(&mut self) -> Result<f64, String> {
        let mut sign = 1.0;
        loop {
            if self.take("-") || self.take("−") {
                sign = -sign;
            } else if !self.take("+") {
                break;
            }
        }
        if ["pi", "Pi", "PI", "π"].iter().any(|name| self.take(name)) {
            return Ok(sign * PI);
        }
        let length = decimal_length(self.rest);
        match self.rest[..length].parse::<f64>() {
            Ok(value) => {
                self.rest = self.rest[length..].trim_start();
                Ok(sign * value)
            }
            Err(_) => Err(self.complaint()),
        }
    }

    fn take(&mut self, token: &str) -> bool {
        if let Some(rest) = self.rest.strip_prefix(token) {
            self.rest = rest.trim_start();
            return true;
        }
        false
    }

    fn complaint(&self) -> String {
        const FORMS: &str = "write a number or an expression such as pi/2, -pi/4, 2*pi/3";
        let lower = self.rest.to_ascii_lowercase();
        if lower.starts_with(',') {
            "is no number; write the decimal point as `.`".into()
        } else if lower.starts_with("pi") || lower.starts_with('π') {
            "is no number; write the product as 2*pi".into()
        } else if lower.starts_with("nan") || lower.starts_with("inf") {
            "is not finite; a finite number is needed".into()
        } else if lower.starts_with("deg") || lower.starts_with('°') {
            "is in degrees; angles are in radians, 90 degrees is pi/2".into()
        } else if lower.is_empty() {
            format!("ends too early; {FORMS}")
        } else {
            format!("cannot be read from `{}` on; {FORMS}", aurt_files::clipped(self.rest))
        }
    }
}

/// Length in bytes of the decimal number (with optional exponent, without sign) that `text` starts with.
fn decimal_length(text: &str) -> usize {
    let bytes = text.as_bytes();
    let digits = |from: usize| from + bytes[from..].iter().take_while(|b| b.is_ascii_digit()).count();
    let mut end = digits(0);
    if bytes.get(end) == Some(&b'.') {
        end = digits(end + 1);
    }
    if matches!(bytes.get(end), Some(b'e' | b'E')) {
        let sign = usize::from(matches!(bytes.get(end + 1), Some(b'+' | b'-')));
        let exponent = digits(end + 1 + sign);
        if exponent > end + 1 + sign {
            end = exponent;
        }
    }
    end
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_and_expressions() {
        for (text, value) in [
            ("0", 0.0),
            ("-0.6127", -0.6127),
            ("+1.5e-3", 1.5e-3),
            (".5", 0.5),
            ("3.", 3.0),
            ("2E2", 200.0),
            ("pi", PI),
            ("-pi", -PI),
            ("pi/2", PI / 2.0),
            ("-pi/4", -PI / 4.0),
            ("2*pi/3", 2.0 * PI / 3.0),
            (" 0.5 * pi ", PI / 2.0),
            ("π/2", PI / 2.0),
            ("pi/2 + 0.001", PI / 2.0 + 0.001),
            ("pi/2-1e-3", PI / 2.0 - 1e-3),
            ("-pi/-2", PI / 2.0),
        ] {
            assert_eq!(parse(text), Ok(value), "{text}");
        }
    }

    #[test]
    fn what_is_no_number_is_refused_with_a_remedy() {
        for (text, part) in [
            ("", "write 0"),
            ("abc", "pi/2"),
            ("2pi", "2*pi"),
            ("pi/", "ends too early"),
            ("0,5", "decimal point"),
            ("nan", "finite"),
            ("inf", "finite"),
            ("1/0", "finite"),
            ("90deg", "degrees"),
            ("90°", "degrees"),
            ("1e999", "finite"),
            ("pi pi", "2*pi"),
            ("1.2.3", "cannot be read"),
        ] {
            let error = parse(text).unwrap_err();
            assert!(error.contains(part), "{text}: {error}");
        }
    }
}
