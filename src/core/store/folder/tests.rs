use super::*;

#[test]
fn a_new_or_empty_folder_is_taken_and_can_be_taken_again() {
    let root = tempfile::tempdir().unwrap();
    let path = root.path().join("a/b");
    for text in ["one", "two"] {
        let folder = Folder::open(&path).unwrap();
        folder.write("x.txt", text.as_bytes()).unwrap();
        assert_eq!(fs::read_to_string(path.join("x.txt")).unwrap(), text);
        assert!(folder.has("x.txt") && !folder.has("y.txt"));
    }
    assert_eq!(fs::read_dir(&path).unwrap().count(), 2);
}

#[test]
fn a_second_writer_is_told_who_holds_the_folder() {
    let root = tempfile::tempdir().unwrap();
    let _first = Folder::open(root.path()).unwrap();
    let error = Folder::open(root.path()).unwrap_err();
    assert!(error.is_refusal());
    assert!(error.to_string().contains(&format!("process {} on", std::process::id())));
}

#[test]
fn what_a_killed_process_left_is_cleared_up_by_the_sole_owner_only() {
    let root = tempfile::tempdir().unwrap();
    let path = root.path().join("run");
    drop(Folder::open(&path).unwrap());
    let part = |folder: &Path| {
        fs::create_dir_all(folder).unwrap();
        fs::write(folder.join(".voidwalk-part-4999999-1"), "half").unwrap();
        folder.join(".voidwalk-part-4999999-1")
    };
    let (left, inside) = (part(&path), part(&path.join("checkpoint")));
    let of_another = part(&path.join("cases/one"));
    fs::write(path.join("cases/one").join(LOCK_FILE), "process 7 on x").unwrap();
    fs::write(path.join("notes.txt"), "mine").unwrap();
    let held = Folder::open_shared(&path).unwrap();
    assert!(!left.exists() && !inside.exists() && of_another.exists());
    // A live holder may own it.
    part(&path);
    let _other = Folder::open_shared(&path).unwrap();
    assert!(left.exists());
    drop((held, _other));
    drop(Folder::open(&path).unwrap());
    assert!(!left.exists() && of_another.exists() && path.join("notes.txt").exists());
}

#[test]
fn what_is_not_ours_is_left_alone() {
    let root = tempfile::tempdir().unwrap();
    fs::write(root.path().join("thesis.txt"), "years of work").unwrap();
    assert!(matches!(Folder::open(root.path()), Err(StoreError::NotOurs { .. })));
    assert!(matches!(
        Folder::open(&root.path().join("thesis.txt")),
        Err(StoreError::NotAFolder { what: "a file", .. })
    ));
    let linked = root.path().join("linked");
    fs::create_dir(&linked).unwrap();
    fs::hard_link(root.path().join("thesis.txt"), linked.join(LOCK_FILE)).unwrap();
    for opened in [Folder::open(&linked), Folder::open_shared(&linked)] {
        assert!(matches!(opened, Err(StoreError::NotALock { .. })));
    }
    fs::remove_dir_all(&linked).unwrap();
    assert_eq!(fs::read_to_string(root.path().join("thesis.txt")).unwrap(), "years of work");
    assert_eq!(fs::read_dir(root.path()).unwrap().count(), 1);
}

#[test]
#[cfg(unix)]
fn a_link_is_not_followed() {
    let root = tempfile::tempdir().unwrap();
    let (link, elsewhere) = (root.path().join("link"), root.path().join("elsewhere"));
    fs::create_dir(&elsewhere).unwrap();
    std::os::unix::fs::symlink(&elsewhere, &link).unwrap();
    assert!(matches!(Folder::open(&link), Err(StoreError::NotAFolder { what: "a symbolic link", .. })));
    let with_slash = root.path().join("link/");
    assert!(matches!(Folder::open(&with_slash), Err(StoreError::NotAFolder { .. })));
    assert_eq!(fs::read_dir(&elsewhere).unwrap().count(), 0);
}

/// A process that is being started has a copy of every open file until it becomes another program.
#[test]
fn a_folder_that_is_let_go_is_free_though_its_lock_file_is_open_elsewhere() {
    let root = tempfile::tempdir().unwrap();
    let folder = Folder::open(root.path()).unwrap();
    let _copy = folder._lock.0.try_clone().unwrap();
    drop(folder);
    assert!(Folder::open(root.path()).is_ok());
}
