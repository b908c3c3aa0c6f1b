use std::{
    collections::BTreeMap,
    fs,
    path::{Path, PathBuf},
    time::{Duration, SystemTime},
};

use super::*;

/// Everything in a folder, by name, with its contents.
fn contents(folder: &Path) -> BTreeMap<String, String> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap());
    entries
        .map(|entry| {
            let text = fs::read_to_string(entry.path()).unwrap_or_else(|_| "a folder".into());
            (entry.file_name().to_string_lossy().into_owned(), text)
        })
        .collect()
}

fn listed<const N: usize>(entries: [(&str, &str); N]) -> BTreeMap<String, String> {
    entries.map(|(name, text)| (name.to_owned(), text.to_owned())).into()
}

#[test]
fn files_are_replaced_and_nothing_is_left_beside_them() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("a"), "old").unwrap();
    fs::write(folder.path().join("other"), "stays").unwrap();
    write_folder(folder.path(), &[("a", "1"), ("b", "2")]).unwrap();
    assert_eq!(contents(folder.path()), listed([("a", "1"), ("b", "2"), ("other", "stays")]));
}

#[test]
fn an_error_takes_back_what_was_renamed_before_it() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("a"), "old").unwrap();
    // A folder cannot be replaced by a file; that is noticed when the file before it is renamed already.
    fs::create_dir(folder.path().join("c")).unwrap();
    let error = write_folder(folder.path(), &[("a", "1"), ("b", "2"), ("c", "3")]).unwrap_err();
    assert!(error.path.ends_with("c"), "{error}");
    assert_eq!(contents(folder.path()), listed([("a", "old"), ("c", "a folder")]));
}

#[test]
fn a_new_folder_appears_whole_with_folders_below() {
    let parent = tempfile::tempdir().unwrap();
    let folder = parent.path().join("results");
    write_folder(&folder, &[("a", "1"), ("below/b", "2")]).unwrap();
    assert_eq!(fs::read_to_string(folder.join("below/b")).unwrap(), "2");
    assert_eq!(contents(parent.path()).len(), 1);
}

#[test]
fn a_folder_that_cannot_be_filled_does_not_appear() {
    let parent = tempfile::tempdir().unwrap();
    let folder = parent.path().join("results");
    assert!(write_folder(&folder, &[("a", "1"), ("a/b", "2")]).is_err());
    assert!(contents(parent.path()).is_empty());
}

#[test]
fn a_staged_folder_that_an_interruption_removed_is_not_made_again() {
    let parent = tempfile::tempdir().unwrap();
    let staged = parent.path().join("staged");
    fs::create_dir(&staged).unwrap();
    make_below(&staged, Path::new("a/b/file")).unwrap();
    make_below(&staged, Path::new("a/file")).unwrap();
    assert!(staged.join("a/b").is_dir());
    fs::remove_dir_all(&staged).unwrap();
    assert!(make_below(&staged, Path::new("a/file")).is_err());
    make_below(&staged, Path::new("file")).unwrap();
    assert!(contents(parent.path()).is_empty());
}

/// Makes a file look as if a process had left it a minute ago.
fn abandoned(path: &Path, text: impl AsRef<[u8]>) -> PathBuf {
    fs::write(path, text).unwrap();
    let file = fs::File::options().write(true).open(path).unwrap();
    file.set_modified(SystemTime::now() - Duration::from_secs(60)).unwrap();
    path.to_owned()
}

#[test]
fn what_a_killed_process_left_staged_is_removed_by_the_next_write() {
    let folder = tempfile::tempdir().unwrap();
    abandoned(&folder.path().join(".aurt-dead.part"), "half");
    let living = tempfile::Builder::new().prefix(STAGED).suffix(".part").tempfile_in(folder.path()).unwrap();
    living.as_file().set_modified(SystemTime::now() - Duration::from_secs(60)).unwrap();
    living.as_file().lock().unwrap();
    write_file(&folder.path().join("a"), b"1").unwrap();
    assert_eq!(take_cleared().remove(folder.path()), Some(1));
    let left = contents(folder.path());
    let living = living.path().file_name().unwrap().to_string_lossy().into_owned();
    assert_eq!(left, listed([("a", "1"), (&living, "")]));
}

#[test]
fn renames_of_a_killed_process_are_completed_by_the_next_write() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    // It had renamed `a` and was killed before `b`.
    fs::write(at("a"), "new a").unwrap();
    fs::write(at("b"), "old b").unwrap();
    abandoned(&at(".aurt-2.part"), "new b");
    abandoned(&at(".aurt-1.old"), "old a");
    abandoned(&at(".aurt-2.old"), "old b");
    let entries = [(".aurt-1.part", "a", ".aurt-1.old"), (".aurt-2.part", "b", ".aurt-2.old")];
    let mut journal = Vec::new();
    for (part, target, old) in entries {
        for name in [part, target, old] {
            journal.extend_from_slice(at(name).as_os_str().as_encoded_bytes());
            journal.push(0);
        }
    }
    let unfinished = journal.clone();
    journal.extend_from_slice(b"complete\n");
    abandoned(&at(".aurt-3.journal"), journal);
    write_file(&at("c"), b"1").unwrap();
    assert_eq!(contents(folder.path()), listed([("a", "new a"), ("b", "new b"), ("c", "1")]));

    // A journal that was not complete was never in force.
    abandoned(&at(".aurt-2.part"), "newer b");
    abandoned(&at(".aurt-3.journal"), unfinished);
    clear_unfinished(folder.path());
    assert_eq!(contents(folder.path()), listed([("a", "new a"), ("b", "new b"), ("c", "1")]));
}

#[cfg(unix)]
#[test]
fn new_files_and_folders_get_the_permissions_of_any_new_one() {
    use std::os::unix::fs::PermissionsExt;
    let parent = tempfile::tempdir().unwrap();
    let at = |name: &str| parent.path().join(name);
    fs::create_dir(at("plain")).unwrap();
    fs::write(at("plain/file"), "").unwrap();
    write_folder(&at("ours"), &[("file", "")]).unwrap();
    write_file(&at("ours/other"), b"").unwrap();
    let mode = |name: &str| fs::metadata(at(name)).unwrap().permissions().mode();
    assert_eq!(mode("ours"), mode("plain"));
    assert_eq!(mode("ours/file"), mode("plain/file"));
    assert_eq!(mode("ours/other"), mode("plain/file"));
}

#[cfg(unix)]
#[test]
fn a_pipe_without_a_reader_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let pipe = folder.path().join("pipe");
    assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    let error = write_files(&[(folder.path().join("a"), "1"), (pipe, "2")]).unwrap_err().to_string();
    assert!(error.contains("it is a pipe"), "{error}");
    assert!(!folder.path().join("a").exists());
}

#[cfg(unix)]
#[test]
fn a_link_to_nothing_keeps_its_place_and_gets_its_file() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    std::os::unix::fs::symlink("file", at("link")).unwrap();
    std::os::unix::fs::symlink("second", at("first")).unwrap();
    std::os::unix::fs::symlink("third", at("second")).unwrap();
    write_file(&at("link"), b"new").unwrap();
    assert!(fs::symlink_metadata(at("link")).unwrap().is_symlink());
    assert_eq!(fs::read_to_string(at("file")).unwrap(), "new");
    let error = write_file(&at("first"), b"new").unwrap_err().to_string();
    assert!(error.contains("a link to a link that leads nowhere"), "{error}");
    assert!(!at("third").exists());
}

#[cfg(unix)]
#[test]
fn a_link_keeps_its_place() {
    let folder = tempfile::tempdir().unwrap();
    let (file, link) = (folder.path().join("file"), folder.path().join("link"));
    fs::write(&file, "old").unwrap();
    std::os::unix::fs::symlink(&file, &link).unwrap();
    write_file(&link, b"new").unwrap();
    assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
    assert_eq!(fs::read_to_string(&file).unwrap(), "new");
}
