//! Contacts of an arm that stands.
//!
//! A standing joint answers a force with the torque that holds against it; its friction takes up to its level of it, in
//! either direction and unknown. So a row speaks where |r_j| exceeds what friction can hold,
//! b_j = [`STICTION`] F_C,j + [`MISFIT`] s_j with s_j what the model leaves of the joint while it moves, and by how much
//! it does: e_j = |r_j| − b_j. A contact is a stretch in which several joints of a standing arm speak.

use super::scan::Prefix;
use super::{Contact, ForceColumns};
use crate::recordings::rows::RecordingRows;

/// What the search needs of one recording; the rows count where the joint stands.
#[derive(Debug, Clone, Copy)]
pub struct StandingRows<'a> {
    pub rows: &'a RecordingRows,
    /// Stamp of the recording's first sample, s: windows count from it.
    pub origin_s: f64,
    /// What the torque of the standing arm (gravity, loads, springs) leaves, `[joint][row]`.
    pub residual: &'a [Vec<f64>],
    /// Columns of each link's force.
    pub forces: &'a [ForceColumns],
    /// Level of dry friction of each joint.
    pub friction_nm: &'a [f64],
    /// Root mean square of what the model leaves of each joint while it moves.
    pub left_rms: &'a [f64],
    /// Rows this near to the end of a rest are left out, s: filters smear what happens there.
    pub margin_s: f64,
}

/// Break-away friction is taken to be at most half above the level while sliding.
const STICTION: f64 = 1.5;

/// Standard deviations of the moving joint's residual that a pose may be off by.
const MISFIT: f64 = 3.0;

/// Stretches nearer than this to each other are one contact, s.
const JOINED_S: f64 = 1.0;

/// A touch shorter than this cannot be told from an outlier, s.
const SHORTEST_S: f64 = 0.2;

/// What lasts for more than this share of a rest is no passing contact: a brake that holds looks the same.
const LONGEST_SHARE: f64 = 0.65;

/// Rows within this time are one statement: a hand's force does not change faster, s.
const MEMORY_S: f64 = 0.5;

/// Least evidence in nats, as for a moving arm.
const SCORE: f64 = 50.0;

/// Finds contacts while the arm stands, in the order of time.
pub fn find_standing_contacts(view: &StandingRows<'_>) -> Vec<Contact> {
    let count = view.rows.rows();
    let bound: Vec<f64> =
        view.friction_nm.iter().zip(view.left_rms).map(|(f, s)| STICTION * f + MISFIT * s).collect();
    let margin = (view.margin_s * view.rows.rate_hz).ceil() as usize;
    let mut found = Vec::new();
    for rest in rests(view.rows, margin) {
        let speaks: Vec<bool> =
            rest.clone().map(|k| view.residual.iter().zip(&bound).any(|(r, b)| r[k].abs() > *b)).collect();
        let share = speaks.iter().filter(|s| **s).count() as f64 / speaks.len().max(1) as f64;
        if share > LONGEST_SHARE {
            continue;
        }
        let spans = stretches(&speaks, (JOINED_S * view.rows.rate_hz) as usize);
        if spans.is_empty() {
            continue;
        }
        let usable: Vec<Vec<bool>> =
            vec![(0..count).map(|k| rest.contains(&k)).collect(); view.residual.len()];
        for span in spans {
            let span = [span[0] + rest.start, span[1] + rest.start];
            found.extend(contact(view, &bound, &usable, span));
        }
    }
    found
}

/// Stretches of rows in which all joints stand, without their ends.
fn rests(rows: &RecordingRows, margin: usize) -> Vec<std::ops::Range<usize>> {
    let stands = |k: usize| rows.joints.iter().all(|j| j.counts[k]);
    let mut rests = Vec::new();
    let mut start = 0;
    while start < rows.rows() {
        let end = (start..rows.rows()).find(|k| !stands(*k)).unwrap_or(rows.rows());
        // Where the recording itself begins or ends in a rest, nothing is smeared.
        let from = if start == 0 { 0 } else { start + margin };
        let to = if end == rows.rows() { end } else { end.saturating_sub(margin) };
        if from < to {
            rests.push(from..to);
        }
        start = end + 1;
    }
    rests
}

/// Runs of marked rows, those less than `join` rows apart as one: [first, end).
fn stretches(marked: &[bool], join: usize) -> Vec<[usize; 2]> {
    let mut found: Vec<[usize; 2]> = Vec::new();
    for (k, _) in marked.iter().enumerate().filter(|(_, m)| **m) {
        match found.last_mut() {
            Some(last) if k - last[1] <= join => last[1] = k + 1,
            _ => found.push([k, k + 1]),
        }
    }
    found
}

fn contact(
    view: &StandingRows<'_>,
    bound: &[f64],
    usable: &[Vec<bool>],
    span: [usize; 2],
) -> Option<Contact> {
    let rows = view.rows;
    let length_s = (span[1] - span[0]) as f64 / rows.rate_hz;
    if length_s < SHORTEST_S {
        return None;
    }
    let excess = |j: usize| {
        let of_row = |r: &f64| (r.abs() - bound[j]).max(0.0) / view.left_rms[j].max(f64::MIN_POSITIVE);
        view.residual[j][span[0]..span[1]].iter().map(|r| of_row(r).powi(2)).sum::<f64>()
    };
    let by_joint: Vec<f64> = (0..bound.len()).map(excess).collect();
    let joints: Vec<usize> = (0..bound.len()).filter(|j| by_joint[*j] > 0.0).collect();
    let memory = (MEMORY_S * rows.rate_hz).max(1.0);
    let score = 0.5 * by_joint.iter().sum::<f64>() / memory;
    // What a single joint shows, its own drive can do.
    if joints.len() < 2 || score < SCORE {
        return None;
    }
    let explains = |link: &usize| {
        let prefix = Prefix::new(&view.forces[*link], view.residual, usable, bound);
        (prefix.statistic(span), prefix.force(span))
    };
    let (link, (_, force_n)) =
        (0..view.forces.len()).map(|link| (link, explains(&link))).max_by(|a, b| a.1.0.total_cmp(&b.1.0))?;
    let time = |row: usize| rows.time_s[row.min(rows.rows() - 1)] - view.origin_s;
    let half_row_s = 0.5 / rows.rate_hz;
    Some(Contact {
        recording: 0,
        window_s: [time(span[0]) - half_row_s, time(span[1] - 1) + half_row_s],
        link,
        joints,
        score,
        distinction: f64::INFINITY,
        force_n,
        force_std_n: None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recordings::rows::{JointRows, Role};

    /// Two joints that stand for 20 s at 10 rows a second; a force along x turns both by their levers.
    fn standing(torque: impl Fn(usize) -> [f64; 2]) -> Vec<Contact> {
        let count = 200;
        let joint = |_| JointRows { counts: vec![true; count], ..JointRows::default() };
        let rows = RecordingRows {
            name: "standing.csv".into(),
            role: Role::Target,
            rate_hz: 10.0,
            time_s: (0..count).map(|k| k as f64 / 10.0).collect(),
            segment_starts: vec![0, count],
            joints: (0..2).map(joint).collect(),
        };
        let residual: Vec<Vec<f64>> = (0..2).map(|j| (0..count).map(|k| torque(k)[j]).collect()).collect();
        let lever = |length: f64| vec![length; count];
        let axes = [[lever(0.5), lever(1.0)].to_vec(), vec![lever(0.0); 2], vec![lever(0.0); 2]];
        find_standing_contacts(&StandingRows {
            rows: &rows,
            origin_s: 0.0,
            residual: &residual,
            forces: &[ForceColumns { axes }],
            friction_nm: &[10.0, 10.0],
            left_rms: &[1.0, 1.0],
            margin_s: 0.2,
        })
    }

    #[test]
    fn a_push_is_found_where_friction_cannot_hold_it() {
        let found = standing(|k| if (50..80).contains(&k) { [40.0, 80.0] } else { [9.0, -12.0] });
        assert_eq!(found.len(), 1, "{found:?}");
        assert_eq!((found[0].joints.as_slice(), found[0].link), ([0, 1].as_slice(), 0));
        assert!((found[0].window_s[0] - 5.0).abs() < 0.1 && (found[0].window_s[1] - 8.0).abs() < 0.1);
        assert!((found[0].force_n[0] - 80.0).abs() < 2.0, "{found:?}");
    }

    #[test]
    fn what_friction_can_hold_is_no_contact_nor_is_a_brake_nor_a_single_joint() {
        assert!(standing(|k| if k > 100 { [17.0, -17.0] } else { [0.0, 0.0] }).is_empty());
        assert!(standing(|_| [40.0, 80.0]).is_empty());
        assert!(standing(|k| if (50..80).contains(&k) { [0.0, 80.0] } else { [0.0, 0.0] }).is_empty());
    }
}
