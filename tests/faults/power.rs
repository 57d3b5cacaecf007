//! What a disk holds after the power fails: of what was not synced, anything.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use crate::disk::Noted;

/// What becomes of names and bytes that were not synced.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Unsynced {
    /// Neither is there.
    Dropped,
    /// The names are there, the bytes are not.
    NamesOnly,
    /// Both are there, the bytes garbled.
    Garbled,
    /// Both are there.
    Kept,
    /// Each name as luck has it, and the bytes garbled; with the seed of the luck.
    ByLuck(u64),
}

#[derive(Clone, Default)]
struct Content {
    now: Vec<u8>,
    synced: Vec<u8>,
}

/// Names: of folders (`None`) and of files, by content.
type Names = BTreeMap<PathBuf, Option<usize>>;

/// The files of a disk as the program sees them, and as they are on it for certain.
#[derive(Default)]
pub struct Model {
    contents: Vec<Content>,
    now: Names,
    certain: Names,
}

impl Model {
    /// The disk after these calls.
    pub fn after(calls: &[Noted]) -> Self {
        let mut model = Self::default();
        calls.iter().filter(|call| call.done).for_each(|call| model.take(call));
        model
    }

    fn take(&mut self, call: &Noted) {
        let path = call.path.clone();
        let content = |model: &Self| model.now.get(&path).copied().flatten();
        match call.kind.as_str() {
            "make" => drop(self.now.insert(path, None)),
            "clear" => self.now.retain(|name, _| !name.starts_with(&path)),
            "create" => self.new_file(path),
            "lock" if content(self).is_none() => self.new_file(path),
            "sign" => {
                let content = content(self).unwrap();
                self.contents[content].now = call.bytes.clone();
            }
            "write" => {
                let content = content(self).unwrap();
                self.contents[content].now.extend(&call.bytes);
            }
            "sync" => {
                let content = content(self).unwrap();
                self.contents[content].synced = self.contents[content].now.clone();
            }
            "rename" => {
                let content = self.now.remove(&path).unwrap();
                let to = std::str::from_utf8(&call.bytes).unwrap();
                self.now.insert(to.into(), content);
            }
            "names" => {
                let inside =
                    |name: &PathBuf| name.parent() == Some(&path) || (path == Path::new(".") && is_top(name));
                self.certain.retain(|name, _| !inside(name));
                let here = self.now.iter().filter(|(name, _)| inside(name));
                self.certain.extend(here.map(|(name, content)| (name.clone(), *content)));
            }
            "remove" => drop(self.now.remove(&path)),
            "list" | "lock" | "map" | "read" => {}
            other => panic!("a call of a kind that the model does not know: {other}"),
        }
    }

    fn new_file(&mut self, path: PathBuf) {
        self.now.insert(path, Some(self.contents.len()));
        self.contents.push(Content::default());
    }

    /// Writes what is found after a power cut into a folder.
    pub fn write(&self, root: &Path, unsynced: Unsynced) {
        let mut luck = match unsynced {
            Unsynced::ByLuck(seed) => seed | 1,
            _ => 1,
        };
        let mut next = move || {
            luck = luck.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            luck >> 33
        };
        let names = match unsynced {
            Unsynced::Dropped => self.certain.clone(),
            Unsynced::ByLuck(_) => {
                let mut names = Names::new();
                for name in self.certain.keys().chain(self.now.keys()) {
                    let from = if next() % 2 == 0 { &self.now } else { &self.certain };
                    if let (Some(content), false) = (from.get(name), names.contains_key(name)) {
                        names.insert(name.clone(), *content);
                    }
                }
                names
            }
            _ => self.now.clone(),
        };
        // In order, so that a folder comes before what is in it; what lies in a folder that is not there is not there.
        for (name, content) in names {
            let path = root.join(&name);
            match content {
                _ if !path.parent().unwrap().is_dir() => {}
                None => fs::create_dir(path).unwrap(),
                Some(content) => {
                    let Content { now, synced } = &self.contents[content];
                    let bytes = match unsynced {
                        _ if now == synced => now.clone(),
                        Unsynced::Dropped | Unsynced::NamesOnly => synced.clone(),
                        Unsynced::Kept => now.clone(),
                        Unsynced::Garbled | Unsynced::ByLuck(_) => now.iter().map(|_| next() as u8).collect(),
                    };
                    fs::write(path, bytes).unwrap();
                }
            }
        }
    }
}

fn is_top(name: &Path) -> bool {
    name.components().count() == 1
}
