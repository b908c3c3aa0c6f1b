//! The `aurt` command as a person or a script meets it.

mod real_recordings;
mod support;
