//! See `aurt_tests::any_input::scenario`.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| aurt_tests::any_input::scenario(data));
