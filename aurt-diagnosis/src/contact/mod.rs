//! External contact: a force on a link for a while.
//!
//! Looked for in the residuals of a fit, by time and link, after all other effects. For each link the torque of a
//! force on it is known up to the force, r = C(q) F ([`force_columns`]). For a stretch of time, the share of the
//! whitened residual that one constant F explains is
//! T = gᵀ A⁻¹ g with A = Σ Cᵀ C/σ² and g = Σ Cᵀ r/σ²,
//! a χ² variable of three degrees of freedom if there is only white noise. Residuals of real robots are not white,
//! so T is divided by the inflation V of its own median over all stretches of the same length. A contact is a
//! stretch whose T/V is large, which several joints show, and which nothing else matches: no other time in any
//! recording, since what repeats with the motion is no contact.

mod columns;
mod scan;
mod search;
mod standing;
#[cfg(test)]
mod tests;

pub use columns::{ForceColumns, force_columns};
pub use standing::{StandingRows, find_standing_contacts};

use search::LinkSearch;

use crate::recordings::rows::RecordingRows;

/// A contact that was found.
#[derive(Debug, Clone, PartialEq)]
pub struct Contact {
    /// Index of the recording.
    pub recording: usize,
    /// When, s from the recording's first stamp.
    pub window_s: [f64; 2],
    /// The touched link, as far as the joints tell: a force near the origin of a link's frame is felt alike by this
    /// link and by the one before it.
    pub link: usize,
    /// Joints on which the force is felt, of those the ones that show it.
    pub joints: Vec<usize>,
    /// Evidence in nats, as Σ ½ n_eff log(MSE before / after): ½ T/V.
    pub score: f64,
    /// Its T/V over the largest of any other stretch of that length, in all recordings.
    pub distinction: f64,
    /// Mean force in the base frame while it lasts, N (if the measurement is in Nm).
    pub force_n: [f64; 3],
    /// Its deviation, N, by what noise and model errors explain elsewhere or by how the force changes while it lasts, the larger; none
    /// where the arm stands, since stiction hides some of a force.
    pub force_std_n: Option<[f64; 3]>,
}

impl Contact {
    /// Whether two contacts are one: the same recording, and windows that meet.
    pub(crate) fn meets(&self, other: &Self) -> bool {
        let [from, to] = self.window_s;
        self.recording == other.recording && from < other.window_s[1] && other.window_s[0] < to
    }
}

/// What a contact must show.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactOptions {
    /// Least score.
    pub score: f64,
    /// Least distinction.
    pub distinction: f64,
    /// Rows this near to a reversal are left out, s: filters smear what happens there.
    pub margin_s: f64,
    /// Largest number of contacts.
    pub most: usize,
}

impl ContactOptions {
    /// The defaults for dynamics up to `f_dyn_hz`.
    pub fn new(f_dyn_hz: f64) -> Self {
        Self { score: 50.0, distinction: 2.7, margin_s: 0.5 / f_dyn_hz, most: 4 }
    }
}

/// What the search needs of one recording.
#[derive(Debug, Clone, Copy)]
pub struct ContactRows<'a> {
    pub rows: &'a RecordingRows,
    /// Stamp of the recording's first sample, s: windows count from it.
    pub origin_s: f64,
    /// Residual of a fit, `[joint][row]`, best of one that leaves out the recording.
    pub residual: &'a [Vec<f64>],
    /// Columns of each link's force, from [`force_columns`].
    pub forces: &'a [ForceColumns],
    /// Rows to be left out, `[joint][row]`, for instance those that a fault has touched; may be empty.
    pub left_out: &'a [Vec<bool>],
}

/// Contacts nearer than this to each other are one, s, and as far from its window a force still ebbs away: the constant force that explains
/// most of half a sine (tan a = 1/(π − 2a)) leaves out 13 % at either end, which of pushes up to 4 s is less than this.
pub(crate) const ALONE_S: f64 = 0.5;

/// Finds contacts in recordings, the clearest first.
///
/// The background is that of all recordings together, and so is the noise level of each joint, unless a recording has more: a
/// contact does not last throughout a recording. The recordings should belong to one robot and one fit. Windows are exact to about
/// a row (2 rows where the filters are slow).
pub fn find_contacts(recordings: &[ContactRows<'_>], options: &ContactOptions) -> Vec<Contact> {
    let mut usable: Vec<Vec<Vec<bool>>> = recordings.iter().map(|r| usable_rows(r, options)).collect();
    let sigma = noise_levels(recordings, &usable);
    let mut found: Vec<Contact> = Vec::new();
    while found.len() < options.most {
        let links = recordings.first().map_or(0, |r| r.forces.len());
        let passes = |contact: &Contact| {
            // What a single joint shows, its own drive can do: ringing after a start, a tooth that sticks.
            contact.score >= options.score
                && contact.distinction >= options.distinction
                && contact.joints.len() > 1
        };
        // Of the links whose force would do, it is the one that explains most.
        let clearest = (0..links)
            .filter_map(|link| LinkSearch::new(link, recordings, &usable, &sigma).best())
            .filter(|candidate| passes(&candidate.contact))
            .max_by(|a, b| a.explained.total_cmp(&b.explained));
        let Some(contact) = clearest.map(|c| c.contact) else { break };
        let rows = recordings[contact.recording].rows;
        let origin = recordings[contact.recording].origin_s;
        let [from, to] = contact.window_s.map(|t| t + origin);
        for (usable, t) in usable[contact.recording].iter_mut().flat_map(|u| u.iter_mut().zip(&rows.time_s)) {
            *usable &= *t < from - ALONE_S || *t > to + ALONE_S;
        }
        found.push(contact);
    }
    found.sort_by(|a, b| b.score.total_cmp(&a.score));
    found
}

/// Where a joint's residual is meaningful: it moves and has not just reversed.
fn usable_rows(recording: &ContactRows<'_>, options: &ContactOptions) -> Vec<Vec<bool>> {
    let rows = recording.rows;
    let margin = (options.margin_s * rows.rate_hz).ceil() as usize;
    rows.joints
        .iter()
        .enumerate()
        .map(|(j, joint)| {
            let n = rows.rows();
            let mut usable = vec![true; n];
            let mut spoil = |from: usize, to: usize| usable[from.min(n)..to.min(n)].fill(false);
            // At rest the sign of friction is unknown.
            let slow = |v: &f64| v.abs() <= joint.rest_velocity;
            for (k, v) in joint.velocity_rad_s.iter().enumerate() {
                let reversed = k > 0 && v * joint.velocity_rad_s[k - 1] < 0.0;
                if slow(v) || reversed {
                    spoil(k.saturating_sub(margin), k + margin + 1);
                }
            }
            for (k, out) in recording.left_out.get(j).into_iter().flatten().enumerate() {
                if *out {
                    spoil(k, k + 1);
                }
            }
            usable
        })
        .collect()
}

/// Robust standard deviation of each joint's usable residuals, `[recording][joint]`: that of the recording or that of all, the
/// larger; infinite where there are none.
fn noise_levels(recordings: &[ContactRows<'_>], usable: &[Vec<Vec<bool>>]) -> Vec<Vec<f64>> {
    let joints = recordings.iter().map(|r| r.residual.len()).max().unwrap_or(0);
    let magnitudes = |r: usize, j: usize| -> Vec<f64> {
        let rows = recordings[r].residual[j].iter().zip(&usable[r][j]);
        rows.filter(|(_, usable)| **usable).map(|(e, _)| e.abs()).collect()
    };
    let level = |mut magnitudes: Vec<f64>| -> Option<f64> {
        let middle = magnitudes.len() / 2;
        let (_, median, _) =
            (middle > 0).then(|| magnitudes.select_nth_unstable_by(middle, f64::total_cmp))?;
        // The median of |x| of a normal variable is 0.6745 of its standard deviation.
        (*median > 0.0).then_some(*median / 0.674_49)
    };
    let of_all = |j: usize| level((0..recordings.len()).flat_map(|r| magnitudes(r, j)).collect());
    let all: Vec<Option<f64>> = (0..joints).map(of_all).collect();
    let of_one = |r: usize, j: usize| {
        all[j].map_or(f64::INFINITY, |all| level(magnitudes(r, j)).map_or(all, |own| own.max(all)))
    };
    (0..recordings.len()).map(|r| (0..joints).map(|j| of_one(r, j)).collect()).collect()
}
