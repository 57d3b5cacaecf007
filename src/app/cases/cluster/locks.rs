//! Reliability of the locks of a folder's file system.
//!
//! Cases are claimed by locks. On most file systems that clusters share, a lock that one node holds keeps the
//! others out; on some, or mounted in some ways, every node sees its own locks only, without any sign of it.
//! Then several tasks may walk one case: the same results, at more cost. This module reads the mount of the
//! folder and warns if that may happen.

use std::path::{Path, PathBuf};

use voidwalk_core::store::platform;

/// Mount of a folder.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Mount {
    point: PathBuf,
    kind: String,
    options: Vec<String>,
}

/// Warning about the locks in this folder; `None` if they hold on every node.
pub fn warning(folder: &Path) -> Option<String> {
    let folder = folder.canonicalize().ok()?;
    mount_of(&folder, &platform::mounts()?)?.doubt()
}

/// The mount that holds a path: the longest mount point above it, the last of equal ones.
fn mount_of(path: &Path, mounts: &str) -> Option<Mount> {
    let all = mounts.lines().filter_map(Mount::read);
    all.filter(|mount| path.starts_with(&mount.point)).max_by_key(|mount| mount.point.components().count())
}

impl Mount {
    /// A line of `/proc/self/mountinfo`.
    fn read(line: &str) -> Option<Self> {
        let (left, right) = line.split_once(" - ")?;
        let left: Vec<&str> = left.split(' ').collect();
        let right: Vec<&str> = right.split(' ').collect();
        let options = [*left.get(5)?, right.get(2).copied().unwrap_or("")];
        Some(Self {
            point: PathBuf::from(unescaped(left.get(4)?)),
            kind: (*right.first()?).to_owned(),
            options: options.iter().flat_map(|list| list.split(',')).map(str::to_owned).collect(),
        })
    }

    fn has(&self, option: &str) -> bool {
        self.options.iter().any(|o| o == option)
    }

    fn doubt(&self) -> Option<String> {
        let one_node = "locks hold on one node only";
        let why = match self.kind.as_str() {
            "nfs" | "nfs4" if self.has("nolock") => format!("it is mounted with `nolock`: {one_node}"),
            "nfs" | "nfs4" if self.has("local_lock=all") || self.has("local_lock=flock") => {
                format!("it is mounted with `local_lock`: {one_node}")
            }
            "lustre" if self.has("localflock") => format!("it is mounted with `localflock`: {one_node}"),
            "lustre" if !self.has("flock") => "it is mounted without `flock`: there are no locks".to_owned(),
            "beegfs" => {
                format!(
                    "unless `tuneUseGlobalFileLocks = true` stands in its client's configuration, {one_node}"
                )
            }
            "cifs" | "smb3" if self.has("nobrl") => format!("it is mounted with `nobrl`: {one_node}"),
            "fuse.sshfs" | "9p" => one_node.to_owned(),
            "tmpfs" | "overlay" | "ramfs" => "it is this machine's own: other nodes do not see it".to_owned(),
            _ => return None,
        };
        Some(format!("this folder lies on {} ({}): {why}", self.kind, self.point.display()))
    }
}

/// Spaces and the like are written as three octal digits.
fn unescaped(field: &str) -> String {
    let mut parts = field.split('\\');
    let mut text = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        match part.get(..3).and_then(|digits| u8::from_str_radix(digits, 8).ok()) {
            Some(byte) => {
                text.push(char::from(byte));
                text.push_str(&part[3..]);
            }
            None => {
                text.push('\\');
                text.push_str(part);
            }
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    const MOUNTS: &str = "22 1 8:1 / / rw,relatime shared:1 - ext4 /dev/sda1 rw\n\
        40 22 0:40 / /home rw shared:2 - nfs4 server:/home rw,vers=4.2,local_lock=none,addr=10.0.0.1\n\
        41 22 0:41 / /old rw - nfs server:/old rw,vers=3,nolock,local_lock=all\n\
        42 22 0:42 / /scratch/a\\040b rw - lustre 10.0.0.2@tcp:/s rw,checksum,localflock\n\
        43 22 0:43 / /scratch/c rw - lustre 10.0.0.2@tcp:/s rw,flock,lazystatfs\n\
        44 22 0:44 / /scratch/d rw - lustre 10.0.0.2@tcp:/s rw\n\
        45 22 0:45 / /bee rw - beegfs beegfs_nodev rw\n\
        46 22 0:46 / /tmp rw - tmpfs tmpfs rw\n\
        47 22 0:47 / /gpfs rw - gpfs gpfs0 rw\n";

    #[test]
    fn mounts_whose_locks_reach_one_node_are_named() {
        let doubt = |path: &str| mount_of(Path::new(path), MOUNTS).unwrap().doubt();
        for path in ["/home/x/campaign", "/srv/x", "/scratch/c/x", "/gpfs/x", "/homely"] {
            assert_eq!(doubt(path), None, "{path}");
        }
        for (path, words) in [
            ("/old/x", "`nolock`"),
            ("/scratch/a b/x", "`localflock`"),
            ("/scratch/d", "without `flock`"),
            ("/bee/x", "tuneUseGlobalFileLocks"),
            ("/tmp/x", "other nodes do not see it"),
        ] {
            let warning = doubt(path).unwrap();
            assert!(warning.contains(words), "{path}: {warning}");
        }
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn this_machine_says_how_its_folders_are_mounted() {
        let mounts = platform::mounts().unwrap();
        assert!(mount_of(Path::new("/proc/self"), &mounts).is_some());
    }
}
