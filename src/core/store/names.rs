//! Names of files and folders that every system accepts, and that no system takes for one another.

use crate::text::is_plain;

/// Tells if Windows takes a name for a device's, whatever its ending.
pub fn is_device(name: &str) -> bool {
    let stem = name.split('.').next().unwrap_or_default().trim_end().to_lowercase();
    let numbered =
        |device| stem.strip_prefix(device).is_some_and(|n| "0123456789¹²³".split("").any(|d| d == n));
    let is_numbered = stem.len() > 3 && (numbered("com") || numbered("lpt"));
    is_numbered || ["con", "prn", "aux", "nul", "conin$", "conout$"].contains(&stem.as_str())
}

/// Turns a name into a folder's: if it is not plain, is a device's or ends with a dot, its hash is added at
/// the end.
pub fn folder_name(name: &str) -> String {
    let safe = |c: char| if is_plain(c) { c } else { '_' };
    let plain: String = name.chars().take(120).map(safe).collect();
    if plain == name && !is_device(name) && !name.ends_with('.') {
        return plain;
    }
    let plain = if is_device(&plain) { plain.replace('.', "_") } else { plain };
    format!("{plain}-{:016x}", xxhash_rust::xxh3::xxh3_64(name.as_bytes()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_devices_are_known() {
        for device in ["con", "CON", "aux.txt", "nul.a.b", "Com1", "lpt9.csv", "com¹", "con .x", "conin$"] {
            assert!(is_device(device), "{device}");
        }
        for other in ["", "com", "com10", "comx", "lpt", "console", "a.con", "con-1", "auxiliary"] {
            assert!(!is_device(other), "{other}");
        }
    }

    #[test]
    fn every_system_takes_the_name_of_a_folder() {
        for plain in ["fine", "cu_b=1.5,filter=a", "0.5"] {
            assert_eq!(folder_name(plain), plain);
        }
        for name in ["con", "con.x", "LPT1", "a.", "a ", "nul", "wide base", "é"] {
            let folder = folder_name(name);
            assert!(folder.len() > 17 && !is_device(&folder) && folder.chars().all(is_plain), "{folder}");
            assert!(!folder.ends_with(['.', ' ']));
        }
        assert_eq!(folder_name("wide base").split_once('-').map(|(plain, _)| plain), Some("wide_base"));
    }
}
