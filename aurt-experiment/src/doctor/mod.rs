//! The setup doctor: what recordings are good for, which of the usual mistakes of a setup they show, and a first experiment
//! without them.

pub mod checkup;
pub mod first_experiment;
pub mod inspection;
pub mod mistakes;
pub mod report;
