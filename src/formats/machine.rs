//! What the machine has.

use std::fs;
use std::path::Path;

use super::staging;

/// Memory that this process may come to hold, bytes: of the machine with its swap, or less where a group of processes is limited.
/// `None` where the system does not say.
pub fn memory_bytes() -> Option<u64> {
    let told = fs::read_to_string("/proc/meminfo").ok()?;
    let machine = of_meminfo(&told, "MemTotal")?.saturating_add(of_meminfo(&told, "SwapTotal").unwrap_or(0));
    Some(of_group(["memory.max", "memory/memory.limit_in_bytes"]).map_or(machine, |limit| limit.min(machine)))
}

/// Memory that is free now, or would be freed at once, bytes. `None` where the system does not say.
pub fn free_memory_bytes() -> Option<u64> {
    let free = of_meminfo(&fs::read_to_string("/proc/meminfo").ok()?, "MemAvailable")?;
    let limit = of_group(["memory.max", "memory/memory.limit_in_bytes"]);
    let held = of_group(["memory.current", "memory/memory.usage_in_bytes"]);
    Some(limit.zip(held).map_or(free, |(limit, held)| limit.saturating_sub(held).min(free)))
}

/// Room that is left on the disk of a folder, bytes. `None` where the system does not say.
pub fn free_disk_bytes(folder: &Path) -> Option<u64> {
    staging::free_bytes(folder)
}

/// A value of `/proc/meminfo`, bytes.
fn of_meminfo(text: &str, key: &str) -> Option<u64> {
    let line = text.lines().find_map(|line| line.strip_prefix(key)?.strip_prefix(':'))?;
    line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok()?.checked_mul(1024)
}

/// A value of the group of processes, bytes, by its names in the two versions of control groups. Without a limit it is not a number, or a
/// huge one.
fn of_group(names: [&str; 2]) -> Option<u64> {
    names.iter().find_map(|name| fs::read_to_string(Path::new("/sys/fs/cgroup").join(name)).ok()?.trim().parse().ok())
}

/// A size for people, as `1.500 GB` with 3 decimals.
pub fn size(bytes: u64, decimals: usize) -> String {
    let (unit, name) = [(1e9, "GB"), (1e6, "MB"), (1e3, "kB")]
        .into_iter()
        .find(|(unit, _)| bytes as f64 >= *unit)
        .unwrap_or((1.0, "bytes"));
    format!("{:.decimals$} {name}", bytes as f64 / unit)
}

#[cfg(test)]
mod tests {
    #[test]
    #[cfg(target_os = "linux")]
    fn a_machine_that_runs_this_has_memory() {
        // From 64 MB to 1 PB.
        let memory_bytes = super::memory_bytes().unwrap();
        assert!((1 << 26..1 << 50).contains(&memory_bytes));
        assert!((1..=memory_bytes).contains(&super::free_memory_bytes().unwrap()));
        assert!(super::free_disk_bytes(&std::env::temp_dir()).unwrap() > 0);
    }
}
