use num_complex::Complex64 as Complex;

use crate::preprocess::butterworth::Butterworth;

/// Columns in a pack, and weights per sample: two modes, real and imaginary part, forward and backward.
pub(super) const WIDTH: usize = 8;

/// A zero-phase low-pass taken apart into first-order modes, one for each pole p of the one-way filter H.
///
/// With H(z) = k + Σ ρ_p z⁻¹ / (1 − p z⁻¹), the forward–backward filter H(z)H(1/z) is
///
///   y(t) = β x(t) + Σ_p ρ_p G_p · (S_p(t−1) + X_p(t+1)),   G_p = H(1/p),   β = k² + ΣΣ ρ_p ρ_r / (1 − p r),
///
/// where S_p(t) = x(t) + p S_p(t−1) runs forward and X_p(t) = x(t) + p X_p(t+1) runs backward, both over the
/// input itself. So both directions of a block of samples are sums that do not depend on one another, and the
/// states need to be known only where an output is wanted. The modes of a Butterworth filter are well
/// conditioned at any cut-off: residues and 1 − p shrink together.
#[derive(Debug, Clone)]
pub(super) struct Modes {
    /// Poles with Im p ≥ 0; a conjugate pair is counted once.
    poles: Vec<Complex>,
    residues: Vec<Complex>,
    mirrored_gain: Vec<Complex>,
    direct: f64,
    /// β.
    centre: f64,
    /// Pairs of modes, for the kernel.
    pub(super) groups: Vec<ModeGroup>,
}

/// Two modes side by side: re, im, re, im.
#[derive(Debug, Clone)]
pub(super) struct ModeGroup {
    /// For each sample of a block: p^(F−1−i) for the forward state, then p^(i−1) (0 at i = 0) backward.
    pub(super) weights: Vec<[f64; WIDTH]>,
    pub(super) step: [f64; 4],
    /// p^(F−1).
    pub(super) bridge: [f64; 4],
    /// The output is Σ Re(coefficient · state).
    pub(super) output: [f64; 4],
    /// β in the first group, 0 in the others.
    pub(super) direct: f64,
}

pub(super) type State = [Complex; 2];

impl Modes {
    pub(super) fn new(design: &Butterworth, factor: usize) -> Self {
        let poles = design.poles.clone();
        let residues: Vec<Complex> = poles
            .iter()
            .enumerate()
            .map(|(k, p)| {
                let mut residue = Complex::from(design.gain);
                for _ in 0..design.order {
                    residue *= *p + Complex::from(1.0);
                }
                for (j, other) in poles.iter().enumerate() {
                    if j != k {
                        residue /= *p - *other;
                    }
                    if other.im != 0.0 {
                        residue /= *p - other.conj();
                    }
                }
                residue
            })
            .collect();
        let mut modes = Self {
            mirrored_gain: Vec::new(),
            direct: design.gain,
            centre: 0.0,
            groups: Vec::new(),
            poles,
            residues,
        };
        modes.mirrored_gain = modes
            .poles
            .iter()
            .map(|p| Complex::from(modes.direct) + *p * modes.against_all(*p, &modes.residues))
            .collect();
        modes.centre = modes.direct * modes.direct
            + modes.real_sum(|k| modes.residues[k] * modes.against_all(modes.poles[k], &modes.residues));
        let indices: Vec<usize> = (0..modes.poles.len()).collect();
        modes.groups = indices.chunks(2).map(|pair| modes.group(pair, factor)).collect();
        modes
    }

    fn group(&self, pair: &[usize], factor: usize) -> ModeGroup {
        let mut group = ModeGroup {
            weights: vec![[0.0; WIDTH]; factor],
            step: [0.0; 4],
            bridge: [0.0; 4],
            output: [0.0; 4],
            direct: if pair[0] == 0 { self.centre } else { 0.0 },
        };
        for (slot, k) in pair.iter().enumerate() {
            let pole = self.poles[*k];
            let at = 2 * slot;
            for (i, lanes) in group.weights.iter_mut().enumerate() {
                put(lanes, at, power(pole, factor - 1 - i));
                if i > 0 {
                    put(lanes, WIDTH / 2 + at, power(pole, i - 1));
                }
            }
            put(&mut group.step, at, power(pole, factor));
            put(&mut group.bridge, at, power(pole, factor - 1));
            put(&mut group.output, at, self.multiplicity(*k) * self.residues[*k] * self.mirrored_gain[*k]);
        }
        group
    }

    pub(super) fn powers(&self, group: usize, n: usize) -> State {
        let power = |k: usize| self.poles.get(k).map_or(Complex::default(), |p| power(*p, n));
        [power(2 * group), power(2 * group + 1)]
    }

    fn multiplicity(&self, k: usize) -> Complex {
        Complex::from(if self.poles[k].im == 0.0 { 1.0 } else { 2.0 })
    }

    /// Σ over all poles (conjugates included) of a quantity that is conjugate for conjugate poles.
    fn real_sum(&self, of: impl Fn(usize) -> Complex) -> f64 {
        (0..self.poles.len()).map(|k| (self.multiplicity(k) * of(k)).re).sum()
    }

    /// Σ over all poles r (conjugates included) of value_r / (1 − p r).
    fn against_all(&self, p: Complex, values: &[Complex]) -> Complex {
        let one = Complex::from(1.0);
        let mut sum = Complex::default();
        for (r, value) in self.poles.iter().zip(values) {
            sum += *value / (one - p * *r);
            if r.im != 0.0 {
                sum += value.conj() / (one - p * r.conj());
            }
        }
        sum
    }

    /// The forward states before sample 0 of a series that is continued oddly by `padding` samples and
    /// constantly before that; `head` holds its first `padding` + 1 samples.
    pub(super) fn before_first(&self, head: &[f64]) -> Vec<State> {
        let padding = head.len() - 1;
        let extended = |k: usize| 2.0 * head[0] - head[padding - k];
        let mut states: Vec<Complex> =
            self.poles.iter().map(|p| Complex::from(extended(0)) / (Complex::from(1.0) - *p)).collect();
        for k in 1..padding {
            self.advance(&mut states, extended(k));
        }
        pairs(&states)
    }

    /// The backward states just after the last sample, X(n), from the forward states at the last sample and the
    /// last `padding` + 1 samples of the series, which is continued oddly.
    pub(super) fn after_last(&self, forward: &[State], tail: &[f64]) -> Vec<State> {
        let padding = tail.len() - 1;
        let extended = |k: usize| 2.0 * tail[padding] - tail[padding - 1 - k];
        let mut states: Vec<Complex> = forward.iter().flatten().copied().take(self.poles.len()).collect();
        let mut before = states.clone();
        for k in 0..padding {
            before.clone_from(&states);
            self.advance(&mut states, extended(k));
        }
        // The backward pass starts in the steady state of the forward pass's last value, `level`.
        let level = self.direct * extended(padding - 1) + self.real_sum(|k| self.residues[k] * before[k]);
        let weighted: Vec<Complex> = self.residues.iter().zip(&states).map(|(r, s)| *r * *s).collect();
        let one = Complex::from(1.0);
        let mut out: Vec<Complex> = self
            .poles
            .iter()
            .zip(&self.mirrored_gain)
            .map(|(p, gain)| (Complex::from(level) / (one - *p) - self.against_all(*p, &weighted)) / *gain)
            .collect();
        for k in (0..padding).rev() {
            self.advance(&mut out, extended(k));
        }
        pairs(&out)
    }

    pub(super) fn run_on(&self, states: &mut [State], samples: &[f64]) {
        for (state, pole) in states.iter_mut().flatten().zip(&self.poles) {
            for x in samples {
                *state = *pole * *state + Complex::from(*x);
            }
        }
    }

    fn advance(&self, states: &mut [Complex], x: f64) {
        for (state, pole) in states.iter_mut().zip(&self.poles) {
            *state = *pole * *state + Complex::from(x);
        }
    }
}

/// z^n by way of polar coordinates, so that the relative error does not grow with n times that of a product.
fn power(z: Complex, n: usize) -> Complex {
    if n == 0 {
        return Complex::from(1.0);
    }
    let (modulus, argument) = (libm::hypot(z.re, z.im), libm::atan2(z.im, z.re));
    let (sine, cosine) = libm::sincos(argument * n as f64);
    let modulus = libm::pow(modulus, n as f64);
    Complex::new(modulus * cosine, modulus * sine)
}

fn put(lanes: &mut [f64], at: usize, value: Complex) {
    lanes[at] = value.re;
    lanes[at + 1] = value.im;
}

/// Modes two by two, the last one filled up with zero.
fn pairs(states: &[Complex]) -> Vec<State> {
    states.chunks(2).map(|c| [c[0], c.get(1).copied().unwrap_or_default()]).collect()
}
