//! Bounds of every number of an experiment, by the unit at the end of its key.

use aurt_files::clipped;
use aurt_plugins::{Node, NodeKind};

use super::errors::Complaint;
use super::section::Reader;

/// Ends of keys with the least and the greatest magnitude of their numbers; zero is always possible. The last row is that of all
/// other keys: products of some such numbers and their inverses stay finite.
const MAGNITUDES: [(&str, f64, f64); 3] = [
    // A sample in a quarter of an hour to one in a microsecond.
    ("_hz", 1e-3, 1e6),
    // The finest stamps to 30 000 years: a window may end after its recording.
    ("_s", 1e-9, 1e12),
    ("", 1e-30, 1e30),
];

/// Complains about every number whose magnitude no quantity of a robot has.
pub(super) fn check(root: &Node, reader: &Reader) {
    for entry in root.entries() {
        check_value(&entry.key, &entry.value, reader);
    }
}

fn check_value(key: &str, value: &Node, reader: &Reader) {
    match &value.kind {
        NodeKind::Array(items) => items.iter().for_each(|item| check_value(key, item, reader)),
        NodeKind::Table(_) => check(value, reader),
        _ => {
            let Some(size) = value.as_number().map(f64::abs).filter(|x| *x > 0.0 && x.is_finite()) else {
                return;
            };
            let bounds = MAGNITUDES.iter().find(|(end, ..)| key.ends_with(end));
            let Some((end, least, greatest)) = bounds.filter(|(_, l, g)| !(*l..=*g).contains(&size)) else {
                return;
            };
            let unit = end.trim_start_matches('_').replace("hz", "Hz");
            let message = format!(
                "`{}` is {size:e} {unit} in magnitude; numbers between {least:e} and {greatest:e} are accepted, and 0",
                clipped(key)
            );
            reader.complain(
                Complaint::new(value.span.clone(), message.replace("  ", " "))
                    .help("look at the unit and at the exponent"),
            );
        }
    }
}
