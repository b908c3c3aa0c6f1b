//! See `aurt_tests::any_input::robot`.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| aurt_tests::any_input::robot(data));
