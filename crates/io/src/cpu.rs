//! Processor time of the running process.

use std::time::Duration;

/// Time that the threads of this process have had a processor so far; threads that have ended do not count.
///
/// The sum of the first numbers of `/proc/self/task/*/schedstat` on Linux, in nanoseconds; `None` elsewhere, or where they
/// cannot be read.
pub fn cpu_time() -> Option<Duration> {
    if !cfg!(target_os = "linux") {
        return None;
    }
    let tasks = std::fs::read_dir("/proc/self/task").ok()?;
    // A thread that ends meanwhile has no file any more.
    let texts = tasks.filter_map(|task| std::fs::read_to_string(task.ok()?.path().join("schedstat")).ok());
    let nanoseconds: Vec<u64> = texts.map(|text| parse_schedstat(&text)).collect::<Option<_>>()?;
    (!nanoseconds.is_empty()).then(|| Duration::from_nanos(nanoseconds.iter().sum()))
}

fn parse_schedstat(text: &str) -> Option<u64> {
    text.split_whitespace().next()?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn first_number_of_a_thread() {
        assert_eq!(parse_schedstat("48729 83790 2\n"), Some(48729));
        assert_eq!(parse_schedstat(""), None);
        assert_eq!(parse_schedstat("many 1 2"), None);
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn working_takes_time() {
        // A kernel without these statistics tells nothing.
        let Some(before) = cpu_time() else { return };
        let mut x = 0_u64;
        let start = std::time::Instant::now();
        while start.elapsed() < Duration::from_millis(50) {
            x = std::hint::black_box(x + 1);
        }
        assert!(cpu_time().is_some_and(|after| after > before), "{x}");
    }
}
