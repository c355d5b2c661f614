//! How much memory this computer has left, for the core, which knows no system.

use std::fs::read_to_string;
use std::path::Path;

/// Bytes that can be taken without others being driven out, if the system reports it: by the memory that is free, by the limit of the
/// process's address space, and by that of its control group.
pub fn free_bytes() -> Option<u64> {
    let read = |path: &str| read_to_string(path).ok();
    let free = read("/proc/meminfo").and_then(|meminfo| free_of(&meminfo));
    let space = read("/proc/self/limits").zip(read("/proc/self/status"));
    let space = space.and_then(|(limits, status)| left_of(&limits, &status));
    let group = read("/proc/self/cgroup").and_then(|groups| {
        let folder = Path::new("/sys/fs/cgroup").join(groups.trim().strip_prefix("0::/")?);
        let number = |name: &str| read_to_string(folder.join(name)).ok()?.trim().parse::<u64>().ok();
        Some(number("memory.max")?.saturating_sub(number("memory.current")?))
    });
    [free, space, group].into_iter().flatten().min()
}

/// What a limit of the address space (`ulimit -v`) leaves: `Max address space  6442450944  6442450944  bytes` without `VmSize:  12345 kB`.
fn left_of(limits: &str, status: &str) -> Option<u64> {
    let line = limits.lines().find_map(|line| line.strip_prefix("Max address space"))?;
    let most: u64 = line.split_whitespace().next()?.parse().ok()?;
    let taken = status.lines().find_map(|line| line.strip_prefix("VmSize:"))?;
    let kilobytes: u64 = taken.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(most.saturating_sub(kilobytes.checked_mul(1024)?))
}

/// The same from what Linux reports: `MemAvailable:   12345 kB`.
fn free_of(meminfo: &str) -> Option<u64> {
    let line = meminfo.lines().find_map(|line| line.strip_prefix("MemAvailable:"))?;
    let kilobytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    kilobytes.checked_mul(1024)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_limit_of_the_address_space_counts() {
        let limits = |most: &str| {
            format!(
                "Limit  Soft Limit  Hard Limit  Units\nMax address space         {most}           unlimited            bytes\n"
            )
        };
        let status = "Name:\tx\nVmPeak:\t  9 kB\nVmSize:\t    1000 kB\n";
        assert_eq!(left_of(&limits("6442450944"), status), Some(6_442_450_944 - 1000 * 1024));
        assert_eq!((left_of(&limits("unlimited"), status), left_of(&limits("5"), status)), (None, Some(0)));
    }

    #[test]
    fn the_report_of_linux_is_read() {
        let meminfo = "MemTotal:       24000000 kB\nMemFree:  100 kB\nMemAvailable:   23000000 kB\n";
        assert_eq!(free_of(meminfo), Some(23_000_000 * 1024));
        for odd in ["", "MemAvailable: many kB", "MemAvailable: 5", "MemAvailable: 99999999999999999999 kB"] {
            assert_eq!(free_of(odd), None, "{odd}");
        }
    }
}
