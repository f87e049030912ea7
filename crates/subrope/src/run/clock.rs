//! Time of the solution, by the wall and by the processor.

use std::time::{Duration, Instant};

use subrope_io::cpu_time;

/// A clock that runs.
#[derive(Clone, Copy, Debug)]
pub struct Clock {
    wall: Instant,
    cpu: Option<Duration>,
}

/// What a clock shows \[s\].
#[derive(Clone, Copy, Debug)]
pub struct Reading {
    /// Time that passed.
    pub wall: f64,
    /// Time that the process had a processor, where the system tells it.
    pub cpu: Option<f64>,
}

impl Clock {
    /// A clock that starts now.
    pub fn start() -> Self {
        Self { wall: Instant::now(), cpu: cpu_time() }
    }

    /// What it shows now.
    pub fn read(self) -> Reading {
        let cpu = cpu_time().zip(self.cpu).map(|(now, before)| now.saturating_sub(before).as_secs_f64());
        Reading { wall: self.wall.elapsed().as_secs_f64(), cpu }
    }
}
