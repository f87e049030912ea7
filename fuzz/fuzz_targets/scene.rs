#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| subrope_fuzz::scene(data));
