//! Contents of a folder at a moment, for comparison.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Bytes of every file below a folder, by path. Sockets and locks are no content.
pub fn snapshot(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut all = BTreeMap::new();
    let mut open = vec![folder.to_owned()];
    while let Some(at) = open.pop() {
        for entry in std::fs::read_dir(at).into_iter().flatten().flatten() {
            let path = entry.path();
            let is_content = path
                .extension()
                .is_none_or(|kind| kind != "lock" && kind != "sock");
            if path.is_dir() {
                open.push(path);
            } else if is_content {
                let bytes = std::fs::read(&path).expect("a file");
                all.insert(path, bytes);
            }
        }
    }
    all
}

/// Lines of the audit log of a state folder.
pub fn audit(state: &Path) -> Vec<String> {
    let text = std::fs::read_to_string(state.join("audit.jsonl")).unwrap_or_default();
    text.lines().map(str::to_owned).collect()
}
