//! The machine a study runs on, and how fast it is at the moment.

use std::time::Instant;

use nalgebra::DMatrix;
use serde::Serialize;

/// Facts of the machine.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Machine {
    /// Processors that may be used.
    pub processors: usize,
    /// Name of the processor, where the system tells it.
    pub processor: Option<String>,
    /// System and architecture.
    pub system: String,
    /// Speed of a matrix product on one thread, before every round and at the end \[GFLOP/s\]; what varies here is the
    /// machine.
    pub calibration_gflops: Vec<f64>,
}

impl Machine {
    /// This machine, not yet calibrated.
    #[must_use]
    pub fn here() -> Self {
        Self {
            processors: std::thread::available_parallelism().map_or(1, std::num::NonZero::get),
            processor: processor(),
            system: format!("{} {}", std::env::consts::OS, std::env::consts::ARCH),
            calibration_gflops: Vec::new(),
        }
    }

    /// Measures the speed once more.
    pub fn calibrate(&mut self) {
        self.calibration_gflops.push(product_gflops());
    }
}

fn processor() -> Option<String> {
    let text = std::fs::read_to_string("/proc/cpuinfo").ok()?;
    let line = text.lines().find(|l| l.starts_with("model name"))?;
    line.split_once(':').map(|(_, name)| name.trim().to_owned())
}

/// Rows of the matrices of the calibration.
const SIZE: usize = 160;
/// Products; the median counts.
const PRODUCTS: usize = 15;

/// Speed of the product of two matrices \[GFLOP/s\].
fn product_gflops() -> f64 {
    let entry = |i: usize, j: usize| ((3 * i + 7 * j) % 11) as f64 * 0.1;
    let (a, b) = (DMatrix::from_fn(SIZE, SIZE, entry), DMatrix::from_fn(SIZE, SIZE, entry));
    let mut out = DMatrix::zeros(SIZE, SIZE);
    let mut seconds: Vec<f64> = (0..PRODUCTS)
        .map(|_| {
            let start = Instant::now();
            a.mul_to(&b, &mut out);
            std::hint::black_box(&out);
            start.elapsed().as_secs_f64()
        })
        .collect();
    seconds.sort_by(f64::total_cmp);
    let flops = 2.0 * (SIZE * SIZE * SIZE) as f64;
    flops / seconds[PRODUCTS / 2].max(1e-9) * 1e-9
}
