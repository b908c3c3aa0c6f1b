//! What a diagnosis is asked.

pub(crate) mod length;
mod paths;
mod question;
mod settings;
pub(crate) mod simulated;

pub use paths::{from_folder, with_file_names};
pub use question::{Question, QuestionedRecording, Spoilt};
pub use settings::SelectionOptions;
