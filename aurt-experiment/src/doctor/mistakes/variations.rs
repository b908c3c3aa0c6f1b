//! Neighbours of mistakes: with other numbers, for fitting these, and with other orders of columns.

use super::mistake::{Mistake, Reading, exchanged, pairs};

/// Neighbours of a number that was tried coarsely; `step` is 1 at first and falls.
pub(super) fn variations(mistake: &Mistake, step: f64) -> Vec<Mistake> {
    match mistake {
        Mistake::Gravity { to_m_s2: g } if *g != [0.0; 3] => turned(*g, 0.35 * step),
        Mistake::Reading { what, file } => {
            let changed: Vec<Reading> = match what {
                Reading::Delay(d) => {
                    [1.0 - 0.4 * step, 1.0 + 0.4 * step].map(|f| Reading::Delay(d * f)).to_vec()
                }
                Reading::Gain { joint, factor } => [1.0 / (1.0 + 1.5 * step), 1.0 + 1.5 * step]
                    .map(|f| Reading::Gain { joint: *joint, factor: factor * f })
                    .to_vec(),
                Reading::Geared(ratio) => {
                    [1.0 / (1.0 + 0.2 * step), 1.0 + 0.2 * step].map(|f| Reading::Geared(ratio * f)).to_vec()
                }
                _ => Vec::new(),
            };
            changed.into_iter().map(|what| Mistake::Reading { what, file: *file }).collect()
        }
        _ => Vec::new(),
    }
}

impl Mistake {
    /// The same with two columns more exchanged, where it is about an order.
    pub(super) fn exchanges(&self) -> Vec<Self> {
        let Self::Reading { what: Reading::Order { of, order }, file } = self else { return Vec::new() };
        let others = pairs(order.len()).map(|pair| exchanged(order, pair));
        let others = others.filter(|order| !order.iter().copied().eq(0..order.len()));
        others.map(|order| Self::Reading { what: Reading::Order { of: *of, order }, file: *file }).collect()
    }
}

fn turned(g: [f64; 3], angle_rad: f64) -> Vec<Mistake> {
    let size = g.iter().map(|v| v * v).sum::<f64>().sqrt();
    let mut all = Vec::new();
    for axis in 0..3 {
        for sign in [-1.0, 1.0] {
            let mut to = g;
            to[axis] += sign * size * angle_rad.tan();
            let length = to.iter().map(|v| v * v).sum::<f64>().sqrt();
            all.push(Mistake::Gravity { to_m_s2: to.map(|v| v * size / length) });
        }
    }
    all
}
