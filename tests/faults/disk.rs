//! A disk that fails its n-th call, dies at it, or takes notes of everything.

use std::fs::File;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};

use voidwalk::store::disk::{Call, Disk};

/// Name of the variable by which this test program, started again, becomes voidwalk on such a disk.
pub const VARIABLE: &str = "VOIDWALK_TEST_DISK";

/// What the disk does: `fail N ERRNO`, `late N ERRNO`, `kill N` or `note FILE`; `real` is no other disk.
pub fn from_words(words: &str) -> Option<Box<dyn Disk>> {
    let words: Vec<&str> = words.split(' ').collect();
    let number = |at: usize| words[at].parse::<u64>().unwrap();
    let way = match words[0] {
        "fail" => Way::Fail(number(2) as i32),
        "late" => Way::Late(number(2) as i32),
        "kill" => Way::Kill,
        "note" => return Some(Box::new(Notes(Mutex::new(File::create(words[1]).unwrap())))),
        "real" => return None,
        other => panic!("{other}"),
    };
    Some(Box::new(Faulty { way, at: number(1), calls: AtomicU64::new(0) }))
}

/// How the call goes wrong.
enum Way {
    /// It does nothing and gives this error.
    Fail(i32),
    /// It does what it should and gives this error.
    Late(i32),
    /// The process is killed.
    Kill,
}

struct Faulty {
    way: Way,
    at: u64,
    calls: AtomicU64,
}

impl Disk for Faulty {
    fn call(&self, _: Call<'_>, act: &mut dyn FnMut() -> io::Result<()>) -> io::Result<()> {
        if self.calls.fetch_add(1, Ordering::Relaxed) + 1 != self.at {
            return act();
        }
        match self.way {
            Way::Fail(errno) => Err(io::Error::from_raw_os_error(errno)),
            Way::Late(errno) => act().and(Err(io::Error::from_raw_os_error(errno))),
            Way::Kill => {
                signal_hook::low_level::raise(9)?;
                unreachable!("nobody survives this")
            }
        }
    }
}

struct Notes(Mutex<File>);

impl Disk for Notes {
    fn call(&self, call: Call<'_>, act: &mut dyn FnMut() -> io::Result<()>) -> io::Result<()> {
        let result = act();
        let (kind, path, bytes): (&str, &Path, &[u8]) = match call {
            Call::List(path) => ("list", path, &[]),
            Call::MakeFolder(path) => ("make", path, &[]),
            Call::RemoveFolder(path) => ("clear", path, &[]),
            Call::Lock(path) => ("lock", path, &[]),
            Call::Sign(path, bytes) => ("sign", path, bytes),
            Call::Create(path) => ("create", path, &[]),
            Call::Write(path, bytes) => ("write", path, bytes),
            Call::Sync(path) => ("sync", path, &[]),
            Call::Rename(from, to) => ("rename", from, to.as_os_str().as_encoded_bytes()),
            Call::SyncFolder(path) => ("names", path, &[]),
            Call::Map(path, _) => ("map", path, &[]),
            Call::Read(path) => ("read", path, &[]),
            Call::Remove(path) => ("remove", path, &[]),
        };
        let mut notes = self.0.lock().unwrap();
        for part in [kind.as_bytes(), &[u8::from(result.is_ok())], path.as_os_str().as_encoded_bytes(), bytes]
        {
            notes.write_all(&(part.len() as u64).to_le_bytes())?;
            notes.write_all(part)?;
        }
        result
    }
}

/// One call that was noted.
#[derive(Clone, Debug)]
pub struct Noted {
    /// A word for the call; `names` for syncing a folder, `clear` for removing one.
    pub kind: String,
    /// Whether it succeeded.
    pub done: bool,
    /// The file or folder.
    pub path: PathBuf,
    /// What was written, or the new name.
    pub bytes: Vec<u8>,
}

/// What a disk that takes notes has noted.
pub fn notes(file: &Path) -> Vec<Noted> {
    let bytes = std::fs::read(file).unwrap();
    let mut rest = &bytes[..];
    let mut part = || {
        let (length, after) = rest.split_first_chunk::<8>()?;
        let (part, after) = after.split_at(u64::from_le_bytes(*length) as usize);
        rest = after;
        Some(part.to_vec())
    };
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    let mut all = Vec::new();
    while let Some(kind) = part() {
        let [done, path, bytes] = [part().unwrap(), part().unwrap(), part().unwrap()];
        all.push(Noted { kind: text(kind), done: done == [1], path: text(path).into(), bytes });
    }
    all
}
