//! Isotonic regression of hits on evidence, by pooling adjacent violators (Barlow et al., *Statistical Inference under
//! Order Restrictions*, 1972; as calibration: Zadrozny and Elkan, KDD 2002).

#[derive(Debug, Clone, Copy)]
struct Block {
    from: f64,
    to: f64,
    count: f64,
    rate: f64,
}

/// The monotone curve that hits follow best, rising or falling: (evidence, rate), evidence ascending. The rates of
/// pooled findings are those of Laplace's rule of succession, so that few findings claim no certainty.
pub(super) fn isotonic(points: &[(f64, bool)]) -> Vec<[f64; 2]> {
    let mut sorted: Vec<(f64, f64)> = points.iter().map(|(x, hit)| (*x, f64::from(u8::from(*hit)))).collect();
    sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
    // Equal evidence has one rate.
    let mut blocks: Vec<Block> = Vec::new();
    for (x, hit) in sorted {
        match blocks.last_mut() {
            Some(last) if last.to == x => {
                last.rate = (last.rate * last.count + hit) / (last.count + 1.0);
                last.count += 1.0;
            }
            _ => blocks.push(Block { from: x, to: x, count: 1.0, rate: hit }),
        }
    }
    let rising = pooled(&blocks, 1.0);
    let falling = pooled(&blocks, -1.0);
    // What pooling in a direction costs: the squared distance that it adds.
    let explained = |of: &[Block]| of.iter().map(|b| b.count * b.rate * b.rate).sum::<f64>();
    let (mut best, direction) =
        if explained(&falling) > explained(&rising) { (falling, -1.0) } else { (rising, 1.0) };
    for block in &mut best {
        block.rate = (block.rate * block.count + 1.0) / (block.count + 2.0);
    }
    // Shrinking small blocks more than large ones can break the order.
    let mut curve: Vec<[f64; 2]> = Vec::new();
    for block in pooled(&best, direction) {
        curve.push([block.from, block.rate]);
        if block.to > block.from {
            curve.push([block.to, block.rate]);
        }
    }
    curve
}

/// Pools neighbours until rates rise (direction 1) or fall (−1).
fn pooled(blocks: &[Block], direction: f64) -> Vec<Block> {
    let mut stack: Vec<Block> = Vec::new();
    for block in blocks {
        let mut block = *block;
        while let Some(last) = stack.last().filter(|last| direction * last.rate >= direction * block.rate) {
            let count = last.count + block.count;
            let rate = (last.rate * last.count + block.rate * block.count) / count;
            block = Block { from: last.from, to: block.to, count, rate };
            stack.pop();
        }
        stack.push(block);
    }
    stack
}

#[cfg(test)]
mod tests {
    use aurt_diagnosis::interpolated;

    use super::*;

    #[test]
    fn violators_are_pooled() {
        // 0 1 | 1 0 1 | 1 1: the second 0 pools with the 1s before it.
        let hits = [false, true, true, false, true, true, true];
        let points: Vec<(f64, bool)> = hits.iter().enumerate().map(|(k, h)| (k as f64, *h)).collect();
        let blocks: Vec<Block> = points
            .iter()
            .map(|(x, h)| Block { from: *x, to: *x, count: 1.0, rate: f64::from(u8::from(*h)) })
            .collect();
        let rates: Vec<(f64, f64, f64)> =
            pooled(&blocks, 1.0).iter().map(|b| (b.from, b.to, b.rate)).collect();
        assert_eq!(rates, [(0.0, 0.0, 0.0), (1.0, 3.0, 2.0 / 3.0), (4.0, 6.0, 1.0)]);
        let curve = isotonic(&points);
        assert!(curve.windows(2).all(|w| w[0][1] <= w[1][1] && w[0][0] < w[1][0]));
        // One miss alone: (0 + 1)/(1 + 2); three hits: (3 + 1)/(3 + 2).
        assert!((interpolated(&curve, -1.0) - 1.0 / 3.0).abs() < 1e-12);
        assert!((interpolated(&curve, 9.0) - 0.8).abs() < 1e-12);
    }

    #[test]
    fn evidence_may_fall_and_may_be_missing() {
        let points: Vec<(f64, bool)> = (0..40).map(|k| (f64::from(k), k < 20)).collect();
        let curve = isotonic(&points);
        assert!(interpolated(&curve, 0.0) > 0.9 && interpolated(&curve, 39.0) < 0.1);
        assert_eq!(interpolated(&isotonic(&[]), 1.0), 0.5);
    }
}
