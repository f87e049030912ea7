#![no_main]

use libfuzzer_sys::{fuzz_mutator, fuzz_target, fuzzer_mutate};

fuzz_target!(|data: &[u8]| subrope_fuzz::checkpoint(data));

// A wrong checksum ends the reading: most inputs get right ones, so that what stands behind them is read.
fuzz_mutator!(|data: &mut [u8], size: usize, max_size: usize, seed: u32| {
    let size = fuzzer_mutate(data, size, max_size);
    if seed % 8 != 0 {
        subrope_fuzz::checksums::put_right(&mut data[..size]);
    }
    size
});
