//! The result of a search for mistakes.

use super::evidence::Evidence;
use super::mistake::Mistake;
use super::trial::Score;

#[derive(Debug, Clone, Default)]
pub struct Found {
    /// How well the setup as it is explains the data; nothing if it allows no fit.
    pub before: Option<Score>,
    /// What to undo, in the order of finding, each with the error after it.
    pub steps: Vec<Step>,
    /// How well the setup does without the mistakes.
    pub after: Option<Score>,
    pub trials: usize,
    pub compared: Vec<Compared>,
}

/// A setup that was compared with the one that is there, or with that without the mistakes found before.
#[derive(Debug, Clone)]
pub struct Compared {
    /// What is undone in it, the last.
    pub mistake: Mistake,
    /// How much likelier it makes what is held out.
    pub across: Evidence,
    /// How much likelier it makes stretches of recordings, predicted from the rest of their own; where it matters.
    pub within: Option<Evidence>,
    pub errors: [f64; 2],
}

/// A mistake that was found.
#[derive(Debug, Clone)]
pub struct Step {
    /// Of another robot that is likelier: the factor of the error with which recordings are predicted from each other.
    pub likelier: Option<f64>,
    /// Of a mistake inside a recording: the errors of that recording, before and after.
    pub own: Option<[f64; 2]>,
    pub mistake: Mistake,
    /// The error once it is undone too.
    pub after: Score,
    /// Others that explain the data alike.
    pub alike: Vec<Mistake>,
}

impl Step {
    pub fn new(mistake: Mistake, after: Score) -> Self {
        Self { likelier: None, own: None, mistake, after, alike: Vec::new() }
    }
}
