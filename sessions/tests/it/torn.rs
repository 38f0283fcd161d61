//! Whatever happened to a file: no panic, and what is whole is read.
#![allow(clippy::unwrap_used)]

use crate::common::*;
use proptest::prelude::*;
use sulcus_sessions::*;

/// Reads everything there is to read.
fn exercise(bytes: &[u8]) -> Result<(ReplayReport, u64), ReadError> {
    let recording = Recording::from_bytes(bytes.to_vec())?;
    let report = match replay(&recording, &ReplayOptions::default(), &mut |_| {}) {
        Ok(report) => report,
        Err(ReplayError::Read(error)) => return Err(error),
        Err(error) => {
            return Err(ReadError::Header {
                what: error.to_string(),
            });
        }
    };
    let summary = info(std::path::Path::new("x.mcap"), &recording)?;
    assert_eq!(summary.ticks, report.ticks);
    assert!(!summary.to_string().is_empty());
    // What can be read can be recovered, if it is not whole, and then says the same.
    match recover_to(&recording, Vec::new(), &mut |_| {}) {
        Ok((whole, _)) => {
            let again = Recording::from_bytes(whole)?;
            ask::has_all_of(&again, &recording);
        }
        Err(RecoverError::Whole(_)) => assert!(!matches!(
            recording.ending(),
            Ending::CutOff { .. } | Ending::Damaged { .. }
        )),
        // A private record or a schema of somebody else's may be such that no tool writes it.
        Err(error) => assert!(matches!(error, RecoverError::Copy(_)), "{error}"),
    }
    Ok((report, recording.facts().rows))
}

#[test]
fn a_file_cut_off_anywhere_gives_its_clean_prefix() {
    let bytes = recorded(600);
    let mut most = 0;
    for at in (0..bytes.len()).filter(|at| at % 61 == 0 || at + 200 > bytes.len()) {
        match exercise(&bytes[..at]) {
            Ok((report, rows)) => {
                assert!(
                    report.identical && report.chain_ok && !report.gradable,
                    "{at}: {report:?}"
                );
                assert!(
                    matches!(report.ending, Ending::CutOff { .. }),
                    "{at}: {report:?}"
                );
                assert!(report.is_finding(), "a part is not gradable");
                assert!(rows >= most, "a longer prefix has no fewer rows");
                most = rows;
            }
            Err(error) => {
                assert_eq!(most, 0, "{at}: {error}");
                assert!(
                    matches!(
                        error,
                        ReadError::NotMcap | ReadError::HeaderCut { .. } | ReadError::NoRows { .. }
                    ),
                    "{at}: {error}"
                );
            }
        }
    }
    assert_eq!(most, 600);
}

#[test]
fn a_killed_session_replays_up_to_the_last_flush() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("session.mcap");
    let mut session = Session::begin(&path, key());
    for ticks in [50, 60, 130, 777, 10_000] {
        session.run(ticks);
        // What another process would find if this one were killed now.
        let found = std::fs::read(&path).unwrap();
        let ran = session.recorder.rows();
        match exercise(&found) {
            Ok((report, rows)) => {
                assert!(
                    report.identical && rows <= ran && rows + 101 >= ran,
                    "{rows} of {ran}"
                );
                let Signature::Unsigned {
                    last_valid_tick, ..
                } = report.signature
                else {
                    panic!("{report:?}")
                };
                assert_eq!(last_valid_tick, (rows > 10_001).then_some(10_001));
                assert_eq!(
                    report.ending,
                    Ending::CutOff {
                        at_byte: found.len() as u64,
                        why: "there is no end record".into()
                    }
                );
            }
            Err(error) => assert!(
                ran < 101 && matches!(error, ReadError::NoRows { .. }),
                "{error}"
            ),
        }
    }
    // Dropped without finish, as when a panic unwinds: the last rows are there, the end is not.
    let ran = session.recorder.rows();
    drop(session);
    let (report, rows) = exercise(&std::fs::read(&path).unwrap()).unwrap();
    assert_eq!(rows, ran);
    assert!(matches!(report.ending, Ending::CutOff { .. }) && !report.gradable);
}

#[test]
fn zeros_after_a_power_loss_are_a_cut() {
    let bytes = recorded(600);
    let keep = bytes.len() * 2 / 3;
    let Ending::CutOff { at_byte, .. } = exercise(&bytes[..keep]).unwrap().0.ending else {
        panic!("cut")
    };
    let mut zeros = bytes[..at_byte as usize].to_vec();
    zeros.resize(bytes.len(), 0);
    let (report, _) = exercise(&zeros).unwrap();
    assert!(matches!(report.ending, Ending::CutOff { .. }), "{report:?}");
}

#[test]
fn a_flipped_bit_in_a_chunk_is_damage_and_what_is_before_is_read() {
    let bytes = recorded(2000);
    let mut bad = bytes.clone();
    let at = bytes.len() / 2;
    bad[at] ^= 16;
    let (report, rows) = exercise(&bad).unwrap();
    assert!(
        matches!(report.ending, Ending::Damaged { .. }),
        "{report:?}"
    );
    assert!(rows > 200 && rows < 2000 && report.identical && report.is_finding());
    // Something behind the end.
    let mut longer = bytes;
    longer.push(0);
    let (report, rows) = exercise(&longer).unwrap();
    assert!(matches!(report.ending, Ending::Damaged { .. }) && rows == 2000);
}

#[test]
fn what_is_no_recording_is_told_in_one_sentence() {
    let told = |bytes: &[u8]| exercise(bytes).unwrap_err().to_string();
    assert!(told(b"").starts_with("not an MCAP file"));
    assert!(told(b"solid cube\n").starts_with("not an MCAP file"));
    let mut foreign = Vec::new();
    mcap::Writer::new(std::io::Cursor::new(&mut foreign))
        .unwrap()
        .finish()
        .unwrap();
    assert!(
        told(&foreign).starts_with("not a Sulcus recording"),
        "{}",
        told(&foreign)
    );
    assert!(told(mcap::MAGIC).starts_with("recording ends inside its header"));
    let bytes = recorded(150);
    let with = |key: &'static str, value: &'static str| {
        rewritten(
            &bytes,
            &mut Edit {
                message: &mut |_, _| true,
                metadata: &mut |pairs| {
                    pairs.insert(key.to_owned(), value.to_owned());
                },
                attachment: &mut |_, _| {},
            },
        )
    };
    let text = told(&with("format_version", "1"));
    assert!(
        text.contains("format version `1`")
            && text.contains("reads `7`, `4`, `5`, `6` and, migrated, `3`:")
            && text.contains("older"),
        "{text}"
    );
    assert!(told(&with("format_version", "77")).contains("that version is newer"));
    assert!(told(&with("format_version", "\u{1b}[2J")).contains("the header is damaged"));
    assert!(told(&with("seed", "x")).contains("field `seed`"));
    assert!(told(&with("signer_public_key", "x")).contains("field `signer_public_key`"));
    assert!(told(&with("blake3 scene.bin", "x")).contains("attachment `scene.bin`"));
    let empty = with_messages(&bytes, |topic, _| topic == "/exact/chain");
    assert!(
        told(&empty).starts_with("recording has no rows"),
        "{}",
        told(&empty)
    );
    let missing = Recording::open(std::path::Path::new("no such file.mcap")).unwrap_err();
    assert!(
        missing
            .to_string()
            .starts_with("cannot read `no such file.mcap`")
    );
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]

    #[test]
    fn any_bytes_are_read_or_refused(tail in proptest::collection::vec(any::<u8>(), 0..2000), magic: bool) {
        let bytes = if magic { [mcap::MAGIC, &tail].concat() } else { tail };
        let _ = exercise(&bytes);
    }

    #[test]
    fn mutated_files_are_read_or_refused(
        edits in proptest::collection::vec((any::<proptest::sample::Index>(), any::<u8>()), 1..8),
        cut in proptest::option::of(any::<proptest::sample::Index>()),
    ) {
        static BYTES: std::sync::LazyLock<Vec<u8>> = std::sync::LazyLock::new(|| recorded(250));
        let mut bytes = BYTES.clone();
        for (at, value) in edits {
            let at = at.index(bytes.len());
            bytes[at] = value;
        }
        if let Some(cut) = cut {
            bytes.truncate(cut.index(bytes.len()));
        }
        if let Ok((report, _)) = exercise(&bytes) {
            // The CRCs, hashes and signatures between them let nothing through. (What a summary
            // or index says is for viewers; it may change without anybody noticing here.)
            prop_assert!(report.identical);
        }
    }

    /// With correct CRCs, so that the decoders behind them are reached.
    #[test]
    fn mutated_messages_are_read_or_refused(
        edits in proptest::collection::vec((0usize..160, any::<proptest::sample::Index>(), any::<u8>()), 1..6),
        longer in proptest::option::of((0usize..160, 0usize..300)),
    ) {
        static BYTES: std::sync::LazyLock<Vec<u8>> = std::sync::LazyLock::new(|| recorded(150));
        let mut k = 0;
        let bytes = with_messages(&BYTES, |_, data| {
            for (message, at, value) in &edits {
                if *message == k && !data.is_empty() {
                    let at = at.index(data.len());
                    data[at] = *value;
                }
            }
            if let Some((message, length)) = longer && message == k {
                data.resize(length, 255);
            }
            k += 1;
            true
        });
        let _ = exercise(&bytes);
    }
}
