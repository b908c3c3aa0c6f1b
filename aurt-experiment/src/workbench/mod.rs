//! What the commands of AURT do with experiments, for every front end.
//!
//! | room | what it does |
//! |---|---|
//! | [`failure`] | why a command failed |
//! | [`output`], [`table_file`] | where results go, tables of numbers |
//! | [`experiments`], [`described_model`] | what an experiment asks of the library; descriptions as models |
//! | [`streaming`], [`gains`], [`tracking`] | recordings longer than memory, gains of drives, drift |
//! | [`diagnosing`], [`next`], [`sensitivity`] | what a model lacks, the motion that decides what is open, and how large an effect could stay hidden |
//! | [`driving`] | commands and positions instead of torques: drives |
//! | [`exporting`] | models as files of other programs |
//! | [`results`], [`reports`] | what these leave behind in files, and their pages |
//! | [`demo`] | the recordings of `aurt demo` |

pub mod demo;
pub mod described_model;
pub mod diagnosing;
pub mod driving;
pub mod experiments;
pub mod exporting;
pub mod failure;
pub mod gains;
pub mod injected;
pub mod next;
pub mod output;
pub mod planned_output;
pub mod read_back;
pub mod reports;
pub mod results;
pub mod sensitivity;
mod simulated;
pub mod streaming;
pub mod table_file;
pub mod tracking;
