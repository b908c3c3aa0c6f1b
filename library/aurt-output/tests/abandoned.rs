//! An interruption: a process of its own, since nothing can be written after it.

use std::{thread, time::Duration};

use aurt_output::{StagedFolder, abandon, write_file, write_folder};

/// Threads write into a staged folder, one after the other; those that come after the interruption do not make it again.
#[test]
#[expect(clippy::unwrap_used, reason = "a test that panics has failed")]
fn nothing_is_begun_after_it() {
    let parent = tempfile::tempdir().unwrap();
    let staged = StagedFolder::new(parent.path()).unwrap();
    for k in 0..20 {
        let inside = staged.path().join(format!("case_{k}"));
        thread::spawn(move || {
            thread::sleep(Duration::from_millis(20 * k));
            let _ = write_file(&inside.join("truth"), b"3");
            let _ = write_folder(&inside.join("files"), &[("a", "1"), ("below/b", "2")]);
        });
    }
    thread::sleep(Duration::from_millis(200));
    let is_written = staged.path().join("case_0/files/below/b").exists();
    // Its end waits for ever, as that of whoever still writes.
    std::mem::forget(staged);
    let kept = abandon();
    thread::sleep(Duration::from_millis(400));
    assert!(is_written && kept > 2, "{kept}");
    assert_eq!(std::fs::read_dir(parent.path()).unwrap().count(), 0);
}
