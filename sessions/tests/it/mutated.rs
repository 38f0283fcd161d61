//! Real recordings, torn and mutated: a clear error or an answer, never a panic. (`sessions/fuzz` does the same for longer.)
#![allow(clippy::unwrap_used)]

use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use proptest::prelude::*;
use proptest::sample::Index;
use sulcus_sessions::*;

/// The corpus, of former versions too: `corpus.rs` says how it is made.
static CORPUS: LazyLock<Vec<Vec<u8>>> = LazyLock::new(|| {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/corpus");
    let mut paths = files(&folder);
    paths.sort();
    paths
        .iter()
        .map(|path| std::fs::read(path).unwrap())
        .collect()
});

/// All files in a folder and in those under it.
fn files(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).unwrap();
    let paths = entries.map(|entry| entry.unwrap().path());
    paths
        .flat_map(|path| {
            if path.is_dir() {
                files(&path)
            } else {
                vec![path]
            }
        })
        .collect()
}

/// Asks everything of them. CRCs, hashes and signatures between them let nothing through.
fn ask(bytes: &[u8]) -> Result<Ending, String> {
    let report = crate::common::ask::ask(bytes)?;
    assert!(report.identical, "{report:?}");
    Ok(report.ending)
}

#[test]
fn a_torn_file_with_a_damaged_chunk_of_viewers_is_recovered_without_that_chunk() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/corpus");
    let mut bytes = std::fs::read(folder.join("bimanual.mcap")).unwrap();
    let chunk = crate::common::view_chunks(&bytes)[0].clone();
    bytes[chunk.start + chunk.len() / 2] ^= 0x10;
    bytes.truncate(bytes.len() - 40);
    let recording = Recording::from_bytes(bytes.clone()).unwrap();
    assert_eq!(recording.facts().damaged_views, 1);
    let ending = ask(&bytes).unwrap();
    assert!(matches!(ending, Ending::CutOff { .. }), "{ending}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(96))]

    #[test]
    fn torn(file: Index, at: Index) {
        let bytes = &CORPUS[file.index(CORPUS.len())];
        match ask(&bytes[..at.index(bytes.len())]) {
            Ok(ending) => prop_assert!(matches!(ending, Ending::CutOff { .. }), "{ending}"),
            Err(said) => prop_assert!(!said.is_empty()),
        }
    }

    #[test]
    fn mutated(
        file: Index,
        edits in proptest::collection::vec((any::<Index>(), any::<u8>()), 1..6),
        moved in proptest::option::of((any::<Index>(), any::<Index>(), 1usize..4000)),
    ) {
        let mut bytes = CORPUS[file.index(CORPUS.len())].clone();
        for (at, value) in edits {
            let at = at.index(bytes.len());
            bytes[at] = value;
        }
        // A piece of it over another, as a broken disk might.
        if let Some((from, to, length)) = moved {
            let from = from.index(bytes.len());
            let end = (from + length).min(bytes.len());
            let to = to.index(bytes.len() - (end - from) + 1);
            bytes.copy_within(from..end, to);
        }
        if let Err(said) = ask(&bytes) {
            prop_assert!(!said.is_empty());
        }
    }

    #[test]
    fn a_piece_left_out_or_put_in(file: Index, at: Index, out in 0usize..3000, put in proptest::collection::vec(any::<u8>(), 0..200)) {
        let bytes = &CORPUS[file.index(CORPUS.len())];
        let at = at.index(bytes.len());
        let rest = &bytes[(at + out).min(bytes.len())..];
        if let Err(said) = ask(&[&bytes[..at], &put, rest].concat()) {
            prop_assert!(!said.is_empty());
        }
    }
}
