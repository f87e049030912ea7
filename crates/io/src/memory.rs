//! Memory of the running process.

/// Largest resident memory of this process so far \[bytes\].
///
/// Read from `VmHWM` of `/proc/self/status` on Linux; `None` elsewhere, or where it cannot be read.
pub fn peak_memory() -> Option<u64> {
    if cfg!(target_os = "linux") { parse_status(&std::fs::read_to_string("/proc/self/status").ok()?) } else { None }
}

fn parse_status(status: &str) -> Option<u64> {
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kib: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    kib.checked_mul(1024)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn status_of_a_process() {
        assert_eq!(parse_status("Name:\tx\nVmHWM:\t    2048 kB\nVmRSS: 1 kB\n"), Some(2048 * 1024));
        assert_eq!(parse_status("Name:\tx\n"), None);
        assert_eq!(parse_status("VmHWM: many kB\n"), None);
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn this_process_uses_memory() {
        assert!(peak_memory().is_some_and(|bytes| bytes > 100_000));
    }
}
