//! The program of the tests.

use std::path::Path;

pub fn aurt() -> &'static Path {
    Path::new(env!("CARGO_BIN_EXE_aurt"))
}
