//! An elastic gear: bursts at a frequency of its own.
//!
//! In bands of constant relative width the mean energy D_j along M e_j ([`Along`]), in units of the noise, makes a
//! spectrum for each joint j. A spring shows as a peak in it that explains most of the arm's energy in its band
//! and comes in bursts: a steady tone has ⟨D²⟩/⟨D⟩² = 1.5 and steady noise 3.

use aurt_recording::ZeroPhase;

use super::{
    Piece, Shaking,
    pattern::{Along, Energy},
    windows,
};
use crate::error::DiagnosisError;

/// Lowest frequency of a peak, in units of f_dyn: below it, other physics is as large.
const LOWEST: f64 = 0.33;
/// The spectrum begins here, in the same units.
const BEGIN: f64 = 0.2;
/// Highest frequency, in units of the sampling rate.
const HIGHEST: f64 = 0.3;
/// Ratio of the centres of neighbouring bands, and of a band's edge and its centre.
const STEP: f64 = 1.12;
const EDGE: f64 = 1.07;
/// A peak is compared with the bands this many steps away.
const ASIDE: usize = 4;
/// Least energy over noise or over the bands aside, whichever is more.
const LEAST_CONTRAST: f64 = 2.2;
/// Where the bands aside are this far above the noise, something else shakes the arm, and its spectrum has peaks, too.
const QUIET: f64 = 100.0;
/// Least contrast there.
const LEAST_CONTRAST_IN_NOISE: f64 = 6.0;
/// Least share of the arm's energy in the band.
const LEAST_SHARE: f64 = 0.7;
/// Least ⟨D²⟩/⟨D⟩².
const LEAST_KURTOSIS: f64 = 2.5;
/// It rings where the energy, smoothed over this many periods, exceeds this many times the noise.
const PERIODS: f64 = 2.0;
const LOUD: f64 = 6.0;

/// The spectra of one piece: centre frequencies, and energies `[band][joint]`.
struct Spectra {
    frequency_hz: Vec<f64>,
    bands: Vec<Vec<Energy>>,
}

/// The clearest ringing of each kind of recordings, if any.
pub(super) fn find(pieces: &[Piece], f_dyn_hz: f64) -> Result<Vec<Shaking>, DiagnosisError> {
    let spectra: Vec<Spectra> = pieces.iter().map(|p| spectra(p, f_dyn_hz)).collect::<Result<_, _>>()?;
    let mut found: Vec<Shaking> = Vec::new();
    for target in [false, true] {
        let pieces: Vec<(&Piece, &Spectra)> =
            pieces.iter().zip(&spectra).filter(|(p, _)| p.target == target).collect();
        let Some(mut one) = clearest(&pieces, f_dyn_hz)? else { continue };
        one.present[usize::from(target)] = true;
        match found.iter_mut().find(|f| f.joint == one.joint) {
            Some(same) => {
                same.present[usize::from(target)] = true;
                same.score += one.score;
                same.contrast = same.contrast.max(one.contrast);
                same.windows_s.extend(one.windows_s);
            }
            None => found.push(one),
        }
    }
    Ok(found)
}

fn spectra(piece: &Piece, f_dyn_hz: f64) -> Result<Spectra, DiagnosisError> {
    let mut spectra = Spectra { frequency_hz: Vec::new(), bands: Vec::new() };
    let mut frequency_hz = BEGIN * f_dyn_hz;
    while frequency_hz < HIGHEST * piece.full.rate_hz {
        let (band, noise) = band_pass(piece, frequency_hz)?;
        let energy = |j: usize| Along::new(&piece.full, &band, &noise, j).energy();
        spectra.bands.push((0..piece.full.joints()).map(energy).collect());
        spectra.frequency_hz.push(frequency_hz);
        frequency_hz *= STEP;
    }
    Ok(spectra)
}

/// The residual in a band, joint by joint, and what the noise has in it.
fn band_pass(piece: &Piece, frequency_hz: f64) -> Result<(Vec<Vec<f64>>, Vec<f64>), DiagnosisError> {
    let full = &piece.full;
    let edge = |f: f64| -> Result<Vec<Vec<f64>>, DiagnosisError> {
        Ok(ZeroPhase::butterworth(4, f, full.rate_hz)?.filter_all(&full.residual)?)
    };
    let (below, above) = (edge(frequency_hz / EDGE)?, edge(frequency_hz * EDGE)?);
    let difference = |(a, b): (&Vec<f64>, &Vec<f64>)| a.iter().zip(b).map(|(a, b)| a - b).collect();
    let band = above.iter().zip(&below).map(difference).collect();
    let width = 2.0 * frequency_hz * (EDGE - 1.0 / EDGE) / full.rate_hz;
    Ok((band, full.noise.iter().map(|s| s * width.sqrt()).collect()))
}

/// The clearest peak among pieces of one kind; its joint is the one along whose inertia most of the energy lies.
fn clearest(pieces: &[(&Piece, &Spectra)], f_dyn_hz: f64) -> Result<Option<Shaking>, DiagnosisError> {
    let mut best: Option<(f64, usize, usize)> = None;
    for (index, (_, spectra)) in pieces.iter().enumerate() {
        for band in 0..spectra.bands.len() {
            if spectra.frequency_hz[band] < LOWEST * f_dyn_hz {
                continue;
            }
            let contrast =
                (0..spectra.bands[band].len()).filter_map(|j| peak(spectra, band, j)).fold(0.0, f64::max);
            if contrast > best.map_or(0.0, |b| b.0) {
                best = Some((contrast, index, band));
            }
        }
    }
    let Some((contrast, index, band)) = best else { return Ok(None) };
    let (piece, spectra) = pieces[index];
    let row = &spectra.bands[band];
    let Some(joint) = (0..row.len())
        .filter(|j| peak(spectra, band, *j).is_some())
        .max_by(|a, b| row[*a].share.total_cmp(&row[*b].share))
    else {
        return Ok(None);
    };
    let frequency_hz = spectra.frequency_hz[band];
    let omega = 2.0 * std::f64::consts::PI * frequency_hz;
    let mut windows_s = Vec::new();
    let mut inertia = 0.0;
    let mut independent = 0.0;
    for (k, (other, _)) in pieces.iter().enumerate() {
        let (passed, noise) = band_pass(other, frequency_hz)?;
        let along = Along::new(&other.full, &passed, &noise, joint);
        let half = (0.5 * PERIODS / frequency_hz * other.full.rate_hz).ceil() as usize;
        windows_s.extend(windows(other, along.loud(half, LOUD).into_iter(), PERIODS / frequency_hz));
        if k == index {
            inertia = along.mean_of(|at| piece.full.inertia.at(joint, joint, at));
            // Band-passed samples are independent about twice per period of the band's width.
            let width = 2.0 * frequency_hz * (EDGE - 1.0 / EDGE) / piece.full.rate_hz;
            independent = along.samples.len() as f64 * width;
        }
    }
    Ok(Some(Shaking {
        effect: "joint_elasticity",
        joint,
        present: [false; 2],
        score: 0.5 * independent * contrast.ln(),
        contrast,
        frequency_hz: Some(frequency_hz),
        stiffness_nm_rad: Some(inertia * omega * omega),
        crossings: None,
        windows_s,
    }))
}

/// Contrast of a band of a joint's spectrum if it is a peak that a spring could make.
fn peak(spectra: &Spectra, band: usize, joint: usize) -> Option<f64> {
    let energy = |b: usize| spectra.bands[b][joint].mean;
    let Energy { mean: own, kurtosis, share } = spectra.bands[band][joint];
    let below = energy(band.saturating_sub(ASIDE));
    let above = if band + ASIDE < spectra.bands.len() { energy(band + ASIDE) } else { 0.0 };
    let aside = below.max(above).max(1.0);
    let contrast = own / aside;
    let least = if aside > QUIET { LEAST_CONTRAST_IN_NOISE } else { LEAST_CONTRAST };
    (contrast >= least && share >= LEAST_SHARE && kurtosis >= LEAST_KURTOSIS).then_some(contrast)
}
