//! Processor time of the running process.

use std::time::Duration;

/// Time that all threads of this process, ended ones included, have had a processor so far.
///
/// From the clock `CLOCK_PROCESS_CPUTIME_ID` of POSIX; `None` on other systems.
#[cfg(unix)]
pub fn cpu_time() -> Option<Duration> {
    let now = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
    Some(Duration::new(u64::try_from(now.tv_sec).ok()?, u32::try_from(now.tv_nsec).ok()?))
}

/// Time that all threads of this process, ended ones included, have had a processor so far.
///
/// From the clock `CLOCK_PROCESS_CPUTIME_ID` of POSIX; `None` on other systems.
#[cfg(not(unix))]
pub fn cpu_time() -> Option<Duration> {
    None
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    #[test]
    fn working_takes_time_also_on_threads_that_have_ended() {
        let work = || {
            let start = std::time::Instant::now();
            let mut x = 0_u64;
            while start.elapsed() < Duration::from_millis(50) {
                x = std::hint::black_box(x + 1);
            }
        };
        let before = cpu_time().unwrap();
        std::thread::spawn(work).join().unwrap();
        assert!(cpu_time().unwrap() - before > Duration::from_millis(1));
    }
}
