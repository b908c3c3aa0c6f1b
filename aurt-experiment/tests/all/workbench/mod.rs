//! Experiments with a `[drive]`.

mod drives;
mod second_opinion;
