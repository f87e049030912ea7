//! Memory of the running process, and what the system has left.

/// Largest resident memory of this process so far \[bytes\].
///
/// Read from `VmHWM` of `/proc/self/status` on Linux; `None` elsewhere, or where it cannot be read.
pub fn peak_memory() -> Option<u64> {
    status("VmHWM")
}

/// Resident memory of this process now \[bytes\].
///
/// Read from `VmRSS` of `/proc/self/status` on Linux; `None` elsewhere, or where it cannot be read.
pub fn resident_memory() -> Option<u64> {
    status("VmRSS")
}

fn status(key: &str) -> Option<u64> {
    if cfg!(target_os = "linux") {
        parse_status(&std::fs::read_to_string("/proc/self/status").ok()?, key)
    } else {
        None
    }
}

fn parse_status(status: &str, key: &str) -> Option<u64> {
    let line = status.lines().find_map(|line| line.strip_prefix(key)?.strip_prefix(':'))?;
    let kib: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    kib.checked_mul(1024)
}

/// Memory that this process may still take \[bytes\]: what the system can give without moving anything else to disk, and its
/// free swap space; less where a control group allows less.
///
/// Read from `/proc/meminfo` and `/sys/fs/cgroup` on Linux; `None` elsewhere, or where they cannot be read.
pub fn available_memory() -> Option<u64> {
    if !cfg!(target_os = "linux") {
        return None;
    }
    let text = |path: &str| std::fs::read_to_string(path).ok();
    let system = parse_meminfo(&text("/proc/meminfo")?)?;
    let number = |path: &str| text(path)?.trim().parse::<u64>().ok();
    let group = number("/sys/fs/cgroup/memory.max").zip(number("/sys/fs/cgroup/memory.current"));
    Some(group.map_or(system, |(most, now)| system.min(most.saturating_sub(now))))
}

fn parse_meminfo(text: &str) -> Option<u64> {
    let kib = |key: &str| {
        let line = text.lines().find_map(|line| line.strip_prefix(key)?.strip_prefix(':'))?;
        line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok()
    };
    kib("MemAvailable")?.saturating_add(kib("SwapFree").unwrap_or(0)).checked_mul(1024)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn status_of_a_process() {
        assert_eq!(parse_status("Name:\tx\nVmHWM:\t    2048 kB\nVmRSS: 1 kB\n", "VmHWM"), Some(2048 * 1024));
        assert_eq!(parse_status("Name:\tx\n", "VmHWM"), None);
        assert_eq!(parse_status("VmHWM: many kB\n", "VmHWM"), None);
        assert_eq!(parse_status("VmHWM2: 1 kB\nVmRSS: 1 kB\n", "VmRSS"), Some(1024));
    }

    #[test]
    fn memory_of_a_system() {
        let text = "MemTotal: 9 kB\nMemAvailable:    5 kB\nSwapCached: 1 kB\nSwapFree: 2 kB\n";
        assert_eq!(parse_meminfo(text), Some(7 * 1024));
        assert_eq!(parse_meminfo("MemAvailable: 5 kB\n"), Some(5 * 1024));
        assert_eq!(parse_meminfo("MemTotal: 9 kB\n"), None);
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn this_system_has_memory() {
        assert!(available_memory().is_some_and(|bytes| bytes > 1_000_000));
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn this_process_uses_memory() {
        let now = resident_memory();
        assert!(now.is_some_and(|bytes| bytes > 100_000) && peak_memory() >= now);
    }
}
