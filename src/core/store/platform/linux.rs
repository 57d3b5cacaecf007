//! Processors and memory on Linux.

use super::Memory;
use rustix::thread::{CpuSet, sched_getaffinity, sched_setaffinity};
use std::fs::read_to_string;
use std::path::{Component, Path, PathBuf};

/// Lists the processors that this thread may use, by number.
pub fn processors() -> Vec<usize> {
    let set = sched_getaffinity(None).unwrap_or_default();
    (0..CpuSet::MAX_CPU).filter(|&processor| set.is_set(processor)).collect()
}

/// Binds this thread to a processor. If refused, the system places the thread.
pub fn stay_on(processor: usize) {
    let mut one = CpuSet::new();
    one.set(processor);
    let _ = sched_setaffinity(None, &one);
}

/// Returns the memory of the machine and the part that the control groups of this process leave it.
pub fn memory() -> Memory {
    let text = read_to_string("/proc/meminfo").unwrap_or_default();
    let bytes = |key: &str| -> Option<u64> {
        let line = text.lines().find(|line| line.starts_with(key))?;
        Some(line.split_whitespace().nth(1)?.parse::<u64>().ok()? * 1024)
    };
    // A container gets only part of the machine.
    let available = bytes("MemAvailable:").into_iter().chain(memory_left()).min();
    Memory { total: bytes("MemTotal:"), available }
}

/// Name of the processor.
pub fn processor() -> Option<String> {
    let text = read_to_string("/proc/cpuinfo").ok()?;
    let (_, name) = text.lines().find_map(|line| line.strip_prefix("model name")?.split_once(": "))?;
    Some(name.to_owned())
}

/// Returns the table of mounts, in the form of `/proc/self/mountinfo`.
pub fn mounts() -> Option<String> {
    read_to_string("/proc/self/mountinfo").ok()
}

/// File names of a group's limit and use, and the name in `memory.stat` of reclaimable file pages.
struct Names {
    limit: &'static str,
    used: &'static str,
    idle: &'static str,
}

/// Version 1: a separate hierarchy for memory.
const V1: Names =
    Names { limit: "memory.limit_in_bytes", used: "memory.usage_in_bytes", idle: "total_inactive_file" };
/// Version 2: one hierarchy for everything.
const V2: Names = Names { limit: "memory.max", used: "memory.current", idle: "inactive_file" };

/// Bytes that the control groups of this process (a container, a service, a job) leave it; `None` if
/// there is no limit or nothing is known.
///
/// A process is in a group, that group is in another, and so on to the root. Each may have a limit, and
/// the use of a group counts in all groups above it, so the minimum of `limit - used` along the path is
/// left. File pages that were not used for a while are reclaimed when needed, and count as free.
fn memory_left() -> Option<u64> {
    let read = |path: &Path| std::fs::read_to_string(path).ok();
    let groups = read(Path::new("/proc/self/cgroup"))?;
    least_left(&groups, &read(Path::new("/proc/self/mountinfo"))?, read)
}

/// Finds the minimum memory left, from `/proc/self/cgroup`, `/proc/self/mountinfo`, and the files of the
/// groups.
fn least_left(groups: &str, mounts: &str, read: impl Fn(&Path) -> Option<String>) -> Option<u64> {
    let all = groups.lines().filter_map(|line| {
        // `5:memory:/docker/1f`, or `0::/user.slice` for version 2.
        let mut parts = line.splitn(3, ':').skip(1);
        let (controllers, path) = (parts.next()?, parts.next()?);
        let names = match controllers {
            "" => V2,
            some if some.split(',').any(|name| name == "memory") => V1,
            _ => return None,
        };
        let (top, folder) = folder_of(Path::new(path), mounts, &names)?;
        let around = folder.ancestors().take_while(|folder| folder.starts_with(&top));
        around.filter_map(|folder| left_in(folder, &names, &read)).min()
    });
    all.min()
}

/// Finds the top folder of the hierarchy, and the folder of the group in it.
fn folder_of(path: &Path, mounts: &str, names: &Names) -> Option<(PathBuf, PathBuf)> {
    let version_1 = names.limit == V1.limit;
    let mut mounted = mounts.lines().rev().filter_map(|line| {
        // `id parent device root mount-point options [more] - type source super-options`
        let (mount, kind) = line.split_once(" - ")?;
        let mut fields = mount.split(' ').skip(3);
        let (root, top) = (fields.next()?, fields.next()?);
        let mut kind = kind.split(' ');
        let (kind, options) = (kind.next()?, kind.nth(1)?);
        let has_memory = kind == "cgroup" && options.split(',').any(|name| name == "memory");
        let wanted = if version_1 { has_memory } else { kind == "cgroup2" };
        wanted.then(|| (unescaped(root), unescaped(top)))
    });
    mounted.next().map(|(root, top)| {
        // A container sees the mounted part of the hierarchy, but may know its place in the whole.
        let inside = path
            .strip_prefix(&root)
            .ok()
            .filter(|inside| inside.components().all(|part| matches!(part, Component::Normal(_))));
        let folder = inside.map_or_else(|| top.clone(), |inside| top.join(inside));
        (top, folder)
    })
}

/// Decodes a path of `mountinfo`, in which blanks and the like are octal numbers.
fn unescaped(field: &str) -> PathBuf {
    let codes = [("\\040", " "), ("\\011", "\t"), ("\\012", "\n"), ("\\134", "\\")];
    codes.iter().fold(field.to_owned(), |text, (code, plain)| text.replace(code, plain)).into()
}

/// Returns the memory that a group's limit leaves; `None` without a limit.
fn left_in(folder: &Path, names: &Names, read: impl Fn(&Path) -> Option<String>) -> Option<u64> {
    let number = |name: &str| read(&folder.join(name))?.trim().parse::<u64>().ok();
    // `max`, or a number beyond any memory, means no limit.
    let limit = number(names.limit).filter(|limit| *limit < 1 << 60)?;
    let stat = read(&folder.join("memory.stat")).unwrap_or_default();
    let idle = stat.lines().find_map(|line| line.strip_prefix(names.idle)?.trim().parse::<u64>().ok());
    let used = number(names.used).unwrap_or(0).saturating_sub(idle.unwrap_or(0));
    Some(limit.saturating_sub(used))
}

#[cfg(test)]
mod tests {
    use super::*;

    const MIB: u64 = 1 << 20;

    /// Returns the memory left, given these group files.
    fn left(groups: &str, mounts: &str, files: &[(&str, &str)]) -> Option<u64> {
        least_left(groups, mounts, |path| {
            let file = files.iter().find(|(name, _)| Path::new(name) == path);
            file.map(|(_, text)| (*text).to_owned())
        })
    }

    const MOUNTS_1: &str = "25 30 0:23 / /sys rw - sysfs sysfs rw\n\
        32 25 0:28 / /sys/fs/cgroup/cpu,cpuacct rw,nosuid shared:9 - cgroup cgroup rw,cpu,cpuacct\n\
        36 25 0:32 / /sys/fs/cgroup/memory rw,nosuid shared:13 - cgroup cgroup rw,memory\n";
    const MOUNTS_2: &str = "31 24 0:27 / /sys/fs/cgroup rw,nosuid shared:9 - cgroup2 cgroup2 rw,nsdelegate\n";

    #[test]
    fn a_limit_of_version_1_is_seen() {
        let groups = "12:cpu,cpuacct:/x\n5:memory:/voidwalk-test\n0::/\n";
        let files = [
            ("/sys/fs/cgroup/memory/voidwalk-test/memory.limit_in_bytes", "104857600\n"),
            ("/sys/fs/cgroup/memory/voidwalk-test/memory.usage_in_bytes", "20971520\n"),
            (
                "/sys/fs/cgroup/memory/voidwalk-test/memory.stat",
                "cache 1\ninactive_file 7\ntotal_inactive_file 10485760\n",
            ),
            ("/sys/fs/cgroup/memory/memory.limit_in_bytes", "9223372036854771712\n"),
        ];
        assert_eq!(left(groups, MOUNTS_1, &files), Some(90 * MIB));
        assert_eq!(left(groups, MOUNTS_1, &files[3..]), None);
    }

    #[test]
    fn the_smallest_limit_on_the_way_to_the_root_counts() {
        let groups = "0::/a.slice/b.service\n";
        let files = [
            ("/sys/fs/cgroup/a.slice/b.service/memory.max", "max\n"),
            ("/sys/fs/cgroup/a.slice/b.service/memory.current", "1048576\n"),
            ("/sys/fs/cgroup/a.slice/memory.max", "209715200\n"),
            ("/sys/fs/cgroup/a.slice/memory.current", "104857600\n"),
            ("/sys/fs/cgroup/a.slice/memory.stat", "anon 5\nfile 6\ninactive_file 4194304\n"),
            ("/sys/fs/cgroup/memory.max", "1073741824\n"),
        ];
        assert_eq!(left(groups, MOUNTS_2, &files), Some(104 * MIB));
        let lower = [("/sys/fs/cgroup/a.slice/b.service/memory.max", "5242880\n")];
        assert_eq!(left(groups, MOUNTS_2, &[&lower, &files[1..]].concat()), Some(4 * MIB));
    }

    /// A container may see only its own part of the hierarchy, mounted in place of the whole.
    #[test]
    fn a_container_that_sees_its_part_alone_finds_its_limit() {
        let mounts = "31 24 0:27 /docker/1f /sys/fs/cgroup/memory ro - cgroup cgroup rw,memory\n";
        let files = [("/sys/fs/cgroup/memory/memory.limit_in_bytes", "1048576")];
        assert_eq!(left("5:memory:/docker/1f\n", mounts, &files), Some(MIB));
        assert_eq!(left("5:memory:/\n", mounts, &files), Some(MIB));
        let files = [("/sys/fs/cgroup/memory.max", "2097152")];
        assert_eq!(left("0::/../../elsewhere\n", MOUNTS_2, &files), Some(2 * MIB));
        let blank = "31 24 0:27 / /my\\040groups rw - cgroup2 none rw\n";
        assert_eq!(left("0::/\n", blank, &[("/my groups/memory.max", "7")]), Some(7));
    }

    #[test]
    fn what_is_not_known_limits_nothing() {
        for (groups, mounts) in
            [("", ""), ("0::/\n", ""), ("rubbish\n::\n", "a - b\n - \n"), ("0::/x", MOUNTS_2)]
        {
            assert_eq!(left(groups, mounts, &[("/sys/fs/cgroup/x/memory.max", "max")]), None, "{groups}");
        }
        let full = [("/sys/fs/cgroup/memory.max", "5"), ("/sys/fs/cgroup/memory.current", "9")];
        assert_eq!(left("0::/\n", MOUNTS_2, &full), Some(0));
    }
}
