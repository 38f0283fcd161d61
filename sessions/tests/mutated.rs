//! Real recordings, torn and mutated: a clear error or an answer, never a panic. (`sessions/fuzz` does the same for longer.)
#![allow(clippy::unwrap_used)]

use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use proptest::prelude::*;
use proptest::sample::Index;
use sulcus_sessions::*;

/// The corpus, of former versions too: [`crate`]'s other tests say how it is made.
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

/// Asks everything of bytes that may be anything.
fn ask(bytes: &[u8]) -> Result<Ending, String> {
    let recording = Recording::from_bytes(bytes.to_vec()).map_err(|error| error.to_string())?;
    info(Path::new("x"), &recording).map_err(|error| error.to_string())?;
    let tick_s = recording
        .scene()
        .map_err(|error| error.to_string())?
        .tick_s();
    let (first, _) = recording.facts().ticks.unwrap();
    // The first ticks: what is wrong with a scene or a state shows in them.
    let span = Span {
        from_s: None,
        to_s: Some((first + 20) as f64 * tick_s),
    };
    let options = ReplayOptions {
        span,
        ..ReplayOptions::default()
    };
    let report = replay(&recording, &options, &mut |_| {}).map_err(|error| error.to_string())?;
    // CRCs, hashes and signatures between them let nothing through.
    assert!(report.identical, "{report:?}");
    if let Ok((whole, lost)) = recover_to(&recording, Vec::new(), &mut |_| {}) {
        assert!(!lost.to_string().is_empty());
        let again = Recording::from_bytes(whole).unwrap();
        assert_eq!(again.facts(), recording.facts());
        assert!(matches!(
            again.ending(),
            Ending::Recovered { .. } | Ending::Finished
        ));
    }
    Ok(recording.ending().clone())
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
