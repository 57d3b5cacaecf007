//! Sheets that were dropped or pasted, each in its own folder under a harmless name.

use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use serde::Serialize;

use voidwalk_core::store::{is_device, make_folder, write_whole};
use voidwalk_core::text::{all_visible, is_hidden, plain};
use voidwalk_sheets::{SoilSummary, soils_in_file};

const FOLDER: &str = "sheets";

/// Maximum number of sheets on a server, and of their bytes in all.
const MOST: (usize, u64) = (200, 256 << 20);

/// Maximum number of soils of a sheet that are kept and can be chosen.
const MOST_SOILS: usize = 1000;

const LAST: usize = 100_000;

/// Maximum lengths of a file's name and ending (letters, bytes); file systems allow 255 bytes.
const NAME: [(usize, usize); 2] = [(60, 180), (8, 32)];

#[derive(Debug, Serialize)]
pub(crate) struct Sheet {
    pub(crate) id: usize,
    pub(crate) name: String,
    /// Soils that can be chosen, the first ones of the file, as `voidwalk soil` reads them.
    pub(crate) soils: Vec<SoilSummary>,
    in_all: usize,
}

impl Sheet {
    fn open(id: usize, path: &Path) -> Result<Arc<Self>, String> {
        let mut soils = soils_in_file(path, None).map_err(|error| error.to_string())?;
        let in_all = soils.len();
        soils.truncate(MOST_SOILS);
        soils.shrink_to_fit();
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        Ok(Arc::new(Self { id, name, soils, in_all }))
    }
}

pub(crate) struct Sheets {
    folder: PathBuf,
    kept: Mutex<Kept>,
}

#[derive(Default)]
struct Kept {
    sheets: Vec<Arc<Sheet>>,
    read: usize,
    bytes: u64,
}

impl Sheets {
    pub(crate) fn new(root: &Path) -> Self {
        let folder = root.join(FOLDER);
        let mut kept = Kept::default();
        // A folder of sheets that is a link or unreadable counts as empty.
        let is_own = folder.symlink_metadata().is_ok_and(|meta| meta.is_dir());
        let entries = std::fs::read_dir(&folder).into_iter().flatten().flatten().filter(|_| is_own);
        let ids = entries.filter_map(|entry| entry.file_name().to_str()?.parse().ok());
        let mut ids: Vec<usize> = ids.filter(|id| *id < LAST).collect();
        ids.sort_unstable();
        ids.dedup();
        for (sheet, bytes) in ids.into_iter().filter_map(|id| earlier(&folder, id)).take(MOST.0) {
            kept.sheets.push(sheet);
            kept.bytes += bytes;
        }
        Self { folder, kept: Mutex::new(kept) }
    }

    pub(crate) fn add(&self, name: &str, bytes: &[u8]) -> Result<Arc<Sheet>, String> {
        let size = bytes.len() as u64;
        {
            let mut kept = self.locked();
            if kept.sheets.len() + kept.read >= MOST.0 || kept.bytes + size > MOST.1 {
                return Err(format!("no room: at most {} sheets and {} MB", MOST.0, MOST.1 >> 20));
            }
            kept.read += 1;
            kept.bytes += size;
        }
        // Reading a large sheet takes a while, and must not make others wait.
        let added = self.read(name, bytes);
        let mut kept = self.locked();
        kept.read -= 1;
        match &added {
            Ok(sheet) => kept.sheets.push(sheet.clone()),
            Err(_) => kept.bytes -= size,
        }
        added
    }

    fn read(&self, name: &str, bytes: &[u8]) -> Result<Arc<Sheet>, String> {
        make_folder(&self.folder).map_err(|error| error.to_string())?;
        let (id, folder) = self.new_folder()?;
        let path = folder.join(harmless(name));
        let written = write_whole(&path, bytes).map_err(|error| error.to_string());
        written.and_then(|()| Sheet::open(id, &path)).map_err(|problem| {
            // Removes a file that is not a sheet; if that fails, the file stays and does no harm.
            let _ = std::fs::remove_file(&path).and_then(|()| std::fs::remove_dir(&folder));
            self.as_named(&problem)
        })
    }

    fn locked(&self) -> MutexGuard<'_, Kept> {
        self.kept.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// New folder and its number; an earlier server may have left folders.
    fn new_folder(&self) -> Result<(usize, PathBuf), String> {
        for id in 1..LAST {
            let folder = self.folder.join(id.to_string());
            match std::fs::create_dir(&folder) {
                Ok(()) => return Ok((id, folder)),
                Err(error) if error.kind() == std::io::ErrorKind::AlreadyExists => {}
                Err(error) => return Err(format!("{}: {error}", folder.display())),
            }
        }
        Err("no room: too many sheets in this folder".into())
    }

    pub(crate) fn all(&self) -> Vec<Arc<Sheet>> {
        self.locked().sheets.clone()
    }

    /// Path of a sheet that a page names by its number, with the soil after a `#`: `3#Filter A`.
    pub(crate) fn path(&self, named: &str) -> Result<PathBuf, String> {
        let (id, soil) = named.split_once('#').map_or((named, None), |(id, soil)| (id, Some(soil)));
        let sheets = self.all();
        let sheet = id.parse().ok().and_then(|id: usize| sheets.into_iter().find(|sheet| sheet.id == id));
        let sheet = sheet.ok_or_else(|| "there is no such sheet; add it again".to_owned())?;
        let path = self.folder.join(sheet.id.to_string()).join(&sheet.name);
        let Some(soil) = soil.filter(|soil| !soil.is_empty()) else { return Ok(path) };
        if sheet.soils.iter().any(|one| plain(&one.name) == plain(soil)) {
            return Ok(format!("{}#{soil}", path.display()).into());
        }
        let among = match sheet.in_all > sheet.soils.len() {
            true => format!(" among the first {MOST_SOILS} of its {} soils", sheet.in_all),
            false => String::new(),
        };
        Err(format!("{} holds no soil of this name{among}", sheet.name))
    }

    /// Message as the command line would give it, but with the sheet's name and no folder.
    pub(crate) fn as_named(&self, message: &str) -> String {
        let mut text = message.to_owned();
        let folder = format!("{}/", self.folder.display());
        while let Some(at) = text.find(&folder) {
            let rest = &text[at + folder.len()..];
            let digits = rest.bytes().take_while(u8::is_ascii_digit).count();
            let end = at + folder.len() + digits + usize::from(rest[digits..].starts_with('/'));
            text.replace_range(at..end, "");
        }
        all_visible(&text)
    }
}

/// Sheet that an earlier server kept, with its size in bytes; `None` if no file of this number is the
/// program's own and still holds soils.
fn earlier(folder: &Path, id: usize) -> Option<(Arc<Sheet>, u64)> {
    let folder = folder.join(id.to_string());
    folder.symlink_metadata().ok().filter(|meta| meta.is_dir())?;
    let mut files = std::fs::read_dir(&folder).ok()?.flatten().filter_map(|entry| {
        let name = entry.file_name().into_string().ok()?;
        let is_harmless = !name.starts_with('.') && name.chars().all(is_plain);
        // A link is not followed.
        let meta = entry.metadata().ok().filter(|meta| meta.is_file() && is_harmless)?;
        Some((name, meta.len()))
    });
    let (name, bytes) = files.next().filter(|(_, bytes)| *bytes <= MOST.1)?;
    Some((Sheet::open(id, &folder.join(name)).ok()?, bytes))
}

/// True if a letter has no special meaning to terminals, pages and file systems.
fn is_plain(letter: char) -> bool {
    !is_hidden(letter) && (letter.is_alphanumeric() || "._- ()+,".contains(letter))
}

/// File name without folders and without letters of special meaning to terminals, pages or file systems.
fn harmless(name: &str) -> String {
    let last = name.rsplit(['/', '\\']).next().unwrap_or_default();
    let kept: String = last.chars().filter(|c| is_plain(*c)).collect();
    let kept = kept.trim().trim_start_matches('.');
    let (stem, ending) = kept.rsplit_once('.').unwrap_or((kept, "csv"));
    let (stem, ending) = (cut(stem, NAME[0]), cut(ending, NAME[1]));
    let ending = if ending.is_empty() { "csv" } else { ending };
    match stem.trim() {
        "" => format!("sheet.{ending}"),
        device if is_device(device) => format!("sheet {device}.{ending}"),
        stem => format!("{stem}.{ending}"),
    }
}

fn cut(text: &str, (letters, bytes): (usize, usize)) -> &str {
    let ends = text.char_indices().map(|(at, letter)| at + letter.len_utf8()).take(letters);
    &text[..ends.take_while(|end| *end <= bytes).last().unwrap_or(0)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_name_does_harm() {
        for (name, expected) in [
            ("base.csv", "base.csv"),
            ("../../x", "x.csv"),
            ("C:\\soils\\site 1.xlsx", "site 1.xlsx"),
            ("<script>alert(1)</script>", "script.csv"),
            ("a\u{202e}vsc.exe", "avsc.exe"),
            ("..", "sheet.csv"),
            (".hidden", "hidden.csv"),
            ("", "sheet.csv"),
            ("a#b.csv", "ab.csv"),
            ("a.", "a.csv"),
            ("Con.csv", "sheet Con.csv"),
            ("nul.x.csv", "sheet nul.x.csv"),
            ("Größe.ods", "Größe.ods"),
        ] {
            assert_eq!(harmless(name), expected, "{name}");
        }
        assert!(harmless(&"a".repeat(500)).len() < 80);
        let wide = harmless(&format!("{}.{}", "\u{20000}".repeat(500), "\u{20000}".repeat(500)));
        assert_eq!(wide.len(), 180 + 1 + 32);
    }

    #[test]
    fn a_sheet_is_kept_if_it_holds_a_soil() {
        let root = tempfile::tempdir().unwrap();
        let sheets = Sheets::new(root.path());
        let error = sheets.add("../bad.csv", b"size_mm,percent\n1,50\n2,x\n").unwrap_err();
        assert!(error.starts_with("bad.csv") && !error.contains("sheets"), "{error}");
        assert!(sheets.all().is_empty());
        let sheet = sheets.add("../../good.csv", b"size_mm,percent\n1,0\n2,100\n").unwrap();
        assert_eq!(sheet.name, "good.csv");
        assert!(sheets.path(&format!("{}#good", sheet.id)).unwrap().starts_with(root.path()));
        for wrong in ["7", "1#../x", "x", "1#"] {
            let path = sheets.path(wrong);
            assert_eq!(path.is_ok(), wrong == "1#", "{wrong}: {path:?}");
        }
        let hidden = "size_mm,a\u{1b}\u{202e}b,c\n1,0,0\n2,100,100\n";
        sheets.add("hidden.csv", hidden.as_bytes()).unwrap();
        // Name shown on the page.
        let path = sheets.path("2#a\u{fffd}\u{fffd}b").unwrap();
        assert_eq!(voidwalk_sheets::curves_in_file(&path, None).unwrap().len(), 1);
    }

    #[test]
    fn of_a_sheet_of_very_many_soils_the_first_are_kept() {
        let root = tempfile::tempdir().unwrap();
        let soils = MOST_SOILS + 5;
        let names: Vec<String> = (0..soils).map(|i| format!("s{i}")).collect();
        let row = |size: &str, percent: &str| format!("{size}{}\n", format!(",{percent}").repeat(soils));
        let table = format!("size_mm,{}\n{}{}", names.join(","), row("1", "0"), row("2", "100"));
        let sheets = Sheets::new(root.path());
        let sheet = sheets.add("many.csv", table.as_bytes()).unwrap();
        assert_eq!((sheet.soils.len(), sheet.in_all), (MOST_SOILS, soils));
        assert!(Arc::ptr_eq(&sheet, &sheets.all()[0]), "no copy is made");
        assert!(sheets.path("1#s999").is_ok());
        assert!(sheets.path("1#s1000").unwrap_err().contains("among the first 1000 of its 1005 soils"));
        assert_eq!(Sheets::new(root.path()).all()[0].in_all, soils);
    }

    #[test]
    fn the_next_server_has_the_sheets_and_no_link() {
        let root = tempfile::tempdir().unwrap();
        let sheets = Sheets::new(root.path());
        let wide = format!("{}.csv", "\u{20000}".repeat(500));
        for name in ["a.csv", "b.csv", wide.as_str()] {
            sheets.add(name, b"size_mm,percent\n1,0\n2,100\n").unwrap();
        }
        let listed =
            |sheets: &Sheets| sheets.all().iter().map(|s| (s.id, s.name.clone())).collect::<Vec<_>>();
        let before = listed(&sheets);
        assert_eq!((listed(&Sheets::new(root.path())), before.len()), (before.clone(), 3));
        let folder = root.path().join(FOLDER);
        let outside = root.path().join("outside.csv");
        std::fs::rename(folder.join("1/a.csv"), &outside).unwrap();
        #[cfg(unix)]
        std::os::unix::fs::symlink(&outside, folder.join("1/a.csv")).unwrap();
        std::fs::write(folder.join("2/b.csv"), "no soil").unwrap();
        std::fs::create_dir(folder.join("18446744073709551615")).unwrap();
        assert_eq!(listed(&Sheets::new(root.path())), before[2..]);
        // Files that are not listed are not overwritten.
        let next = Sheets::new(root.path()).add("c.csv", b"size_mm,percent\n1,0\n2,100\n").unwrap();
        assert_eq!(next.id, 4);
    }
}
