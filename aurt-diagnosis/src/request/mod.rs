//! What a diagnosis is asked.

mod common_scale;
pub(crate) mod length;
mod paths;
mod question;
mod settings;
pub(crate) mod simulated;

pub use common_scale::CommonScale;
pub use paths::{from_folder, with_file_names};
pub use question::{Question, QuestionedRecording, Spoilt};
pub use settings::SelectionOptions;
