//! What the machine has.

use std::fs;

/// Memory that this process may come to hold, bytes: of the machine with its swap, or less where a group of processes is limited.
/// `None` where the system does not say.
pub fn memory_bytes() -> Option<u64> {
    let text = fs::read_to_string("/proc/meminfo").ok()?;
    let kilobytes = |key: &str| {
        let line = text.lines().find_map(|line| line.strip_prefix(key)?.strip_prefix(':'))?;
        line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok()
    };
    let machine = kilobytes("MemTotal")?.saturating_add(kilobytes("SwapTotal").unwrap_or(0)).saturating_mul(1024);
    // Of the two versions of control groups; without a limit it is no number, or a huge one.
    let limits = ["/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory/memory.limit_in_bytes"];
    let limit = limits.iter().find_map(|path| fs::read_to_string(path).ok()?.trim().parse::<u64>().ok());
    Some(limit.map_or(machine, |limit| limit.min(machine)))
}

#[cfg(test)]
mod tests {
    #[test]
    #[cfg(target_os = "linux")]
    fn a_machine_that_runs_this_has_memory() {
        // From 64 MB to 1 PB.
        assert!((1 << 26..1 << 50).contains(&super::memory_bytes().unwrap()));
    }
}
