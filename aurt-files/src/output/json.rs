//! JSON that people can read: what fits on a line stands on one.

use std::fmt::Write;

use serde_json::Value;

const WIDTH: usize = 100;
const INDENT: usize = 2;

/// `value` as text with a newline at its end.
pub fn pretty(value: &Value) -> String {
    let mut out = String::new();
    write(&mut out, value, 0, 0);
    out.push('\n');
    out
}

/// Writes `value` at a depth; `used` columns of its first line are taken.
fn write(out: &mut String, value: &Value, depth: usize, used: usize) {
    let line = value.to_string();
    let entries = match value {
        Value::Array(items) => items.len(),
        Value::Object(entries) => entries.len(),
        _ => 0,
    };
    if entries == 0 || used + line.chars().count() <= WIDTH {
        // Serde writes no spaces; a line of many values reads better with them.
        out.push_str(&spaced(value));
        return;
    }
    let pad = " ".repeat((depth + 1) * INDENT);
    match value {
        Value::Array(items) => {
            out.push('[');
            if items.iter().all(Value::is_number) {
                fill(out, items, &pad);
            } else {
                for (i, item) in items.iter().enumerate() {
                    out.push_str(if i == 0 { "\n" } else { ",\n" });
                    out.push_str(&pad);
                    write(out, item, depth + 1, pad.len());
                }
            }
            let _ = write!(out, "\n{}]", " ".repeat(depth * INDENT));
        }
        Value::Object(entries) => {
            out.push('{');
            for (i, (key, item)) in entries.iter().enumerate() {
                out.push_str(if i == 0 { "\n" } else { ",\n" });
                let key = format!("{pad}{}: ", Value::from(key.as_str()));
                out.push_str(&key);
                write(out, item, depth + 1, key.chars().count());
            }
            let _ = write!(out, "\n{}}}", " ".repeat(depth * INDENT));
        }
        scalar => out.push_str(&scalar.to_string()),
    }
}

fn fill(out: &mut String, numbers: &[Value], pad: &str) {
    let mut column = WIDTH;
    for (i, number) in numbers.iter().enumerate() {
        let text = number.to_string();
        if i > 0 {
            out.push(',');
        }
        if column + text.len() + 2 > WIDTH {
            out.push('\n');
            out.push_str(pad);
            column = pad.len();
        } else {
            out.push(' ');
            column += 2;
        }
        out.push_str(&text);
        column += text.len();
    }
}

fn spaced(value: &Value) -> String {
    match value {
        Value::Array(items) => {
            format!("[{}]", items.iter().map(spaced).collect::<Vec<_>>().join(", "))
        }
        Value::Object(entries) if entries.is_empty() => "{}".into(),
        Value::Object(entries) => {
            let entries = entries.iter().map(|(k, v)| format!("{}: {}", Value::from(k.as_str()), spaced(v)));
            format!("{{ {} }}", entries.collect::<Vec<_>>().join(", "))
        }
        scalar => scalar.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn short_things_stand_on_one_line_and_all_reads_back() {
        let numbers: Vec<f64> = (0..40).map(|i| f64::from(i) / 7.0).collect();
        let value = json!({
            "kind": "x", "empty": [], "pair": [[1, 0.5], [2, -1.0]], "numbers": numbers,
            "nested": { "a": { "model": "square" }, "b": "y".repeat(120), "c": null },
        });
        let text = pretty(&value);
        assert!(text.contains("\"pair\": [[1, 0.5], [2, -1.0]]"), "{text}");
        assert!(text.contains("\"a\": { \"model\": \"square\" }"), "{text}");
        assert!(text.lines().filter(|l| !l.contains('y')).all(|l| l.chars().count() <= WIDTH + 2), "{text}");
        assert_eq!(serde_json::from_str::<Value>(&text).unwrap(), value);
    }
}
