//! What a diagnosis is asked.

mod common_scale;
pub(crate) mod length;
mod paths;
mod question;
mod ratios;
mod settings;
pub(crate) mod simulated;

pub use paths::{from_folder, with_file_names};
pub use question::{Question, QuestionedRecording, Spoilt};
pub use ratios::CommonScale;
pub use settings::SelectionOptions;
