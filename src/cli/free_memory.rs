//! The memory that this process may still take, for the core, which knows no system.

use std::fs;
use std::path::{Path, PathBuf};

/// Bytes that can be taken without others being driven out and without crossing a limit of this process, if the system reports any of
/// it: available memory, the limit of the address space (`ulimit -v`), and those of control groups.
pub fn free_bytes() -> Option<u64> {
    let text = |path: &str| fs::read_to_string(path).ok();
    let available = text("/proc/meminfo").and_then(|report| available_of(&report));
    let limits = text("/proc/self/limits").zip(text("/proc/self/status"));
    let address_space = limits.and_then(|(limits, status)| address_space_of(&limits, &status));
    let groups = text("/proc/self/cgroup").and_then(|groups| in_groups(Path::new("/sys/fs/cgroup"), &groups));
    [available, address_space, groups].into_iter().flatten().min()
}

/// The available memory in what Linux reports: `MemAvailable:   12345 kB`.
fn available_of(meminfo: &str) -> Option<u64> {
    kilobytes(meminfo, "MemAvailable:")
}

/// The bytes in the line of a report that begins with `name`.
fn kilobytes(report: &str, name: &str) -> Option<u64> {
    let line = report.lines().find_map(|line| line.strip_prefix(name))?;
    let kilobytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    kilobytes.checked_mul(1024)
}

/// What is left of the address space, by its limit in bytes (`Max address space  6291456000  unlimited  bytes`) and its present size.
fn address_space_of(limits: &str, status: &str) -> Option<u64> {
    let line = limits.lines().find_map(|line| line.strip_prefix("Max address space"))?;
    let soft: u64 = line.split_whitespace().next()?.parse().ok()?;
    Some(soft.saturating_sub(kilobytes(status, "VmSize:")?))
}

/// The least that is left in the control groups of this process and in those above them, below `root`. Cached files count as free.
fn in_groups(root: &Path, groups: &str) -> Option<u64> {
    let left = |line: &str| {
        let mut parts = line.splitn(3, ':').skip(1);
        let (controllers, path) = (parts.next()?, parts.next()?);
        let (root, files) = match controllers {
            "" => (root.to_owned(), ["memory.max", "memory.current"]),
            all if all.split(',').any(|one| one == "memory") => {
                (root.join("memory"), ["memory.limit_in_bytes", "memory.usage_in_bytes"])
            }
            _ => return None,
        };
        let group = root.join(path.trim_start_matches('/'));
        group.ancestors().take_while(|group| group.starts_with(&root)).filter_map(|group| in_group(group, files)).min()
    };
    groups.lines().filter_map(left).min()
}

fn in_group(group: &Path, files: [&str; 2]) -> Option<u64> {
    let number = |file: PathBuf| fs::read_to_string(file).ok()?.trim().parse::<u64>().ok();
    let [limit, used] = files.map(|file| number(group.join(file)));
    let cached = fs::read_to_string(group.join("memory.stat")).ok().and_then(|report| {
        report.lines().find_map(|line| line.strip_prefix("inactive_file ")?.trim().parse::<u64>().ok())
    });
    // Without a limit there is a word instead of a number, or in the older version a number beyond any memory.
    Some(limit?.saturating_sub(used?.saturating_sub(cached.unwrap_or(0))))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_report_of_linux_is_read() {
        let meminfo = "MemTotal:       24000000 kB\nMemFree:  100 kB\nMemAvailable:   23000000 kB\n";
        assert_eq!(available_of(meminfo), Some(23_000_000 * 1024));
        for odd in ["", "MemAvailable: many kB", "MemAvailable: 5", "MemAvailable: 99999999999999999999 kB"] {
            assert_eq!(available_of(odd), None, "{odd}");
        }
    }

    #[test]
    fn the_limit_of_the_address_space_counts_from_its_present_size() {
        let limits = |soft: &str| {
            format!("Limit       Soft Limit    Hard Limit   Units\nMax address space    {soft}   unlimited   bytes\n")
        };
        let status = "VmPeak:    2000 kB\nVmSize:\t    1000 kB\n";
        assert_eq!(address_space_of(&limits("6291456"), status), Some(6_291_456 - 1_024_000));
        assert_eq!(address_space_of(&limits("1000"), status), Some(0));
        assert_eq!(address_space_of(&limits("unlimited"), status), None);
    }

    #[test]
    fn the_tightest_control_group_decides() {
        let root = tempfile::tempdir().unwrap();
        let put = |group: &str, file: &str, text: &str| {
            let group = root.path().join(group);
            fs::create_dir_all(&group).unwrap();
            fs::write(group.join(file), text).unwrap();
        };
        for (group, limit) in [("a", "5000\n"), ("a/b", "max\n"), ("memory/c", "9000\n"), ("memory", "8000\n")] {
            let [max, current] = if group.starts_with("memory") {
                ["memory.limit_in_bytes", "memory.usage_in_bytes"]
            } else {
                ["memory.max", "memory.current"]
            };
            put(group, max, limit);
            put(group, current, "3000\n");
        }
        put("a", "memory.stat", "anon 1000\ninactive_file 500\n");
        let left = |groups: &str| in_groups(root.path(), groups);
        assert_eq!(left("0::/a/b\n"), Some(5000 - (3000 - 500)));
        assert_eq!(left("4:cpu,memory:/c\n1:name=x:/\n"), Some(5000));
        assert_eq!((left("0::/a/b/c/d\n"), left("0::/none\n"), left("odd\n")), (Some(2500), None, None));
    }
}
