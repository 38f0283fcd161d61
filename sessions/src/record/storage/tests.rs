//! Tests of a recording on a full disk.

use super::*;
use crate::record::statement::SessionEnd;
use crate::{RecordError, Recorder, Recording, Row, SessionHeader, StationKey};
use std::sync::Mutex;
use sulcus_core::TickInput;

/// Disk with limited space, which accepts the first part of a write that is too long.
struct Disk {
    content: Arc<Mutex<Vec<u8>>>,
    room: usize,
}

impl Storage for Disk {
    fn append(&mut self, bytes: &[u8]) -> io::Result<()> {
        let mut content = self.content.lock().unwrap();
        let fits = bytes.len().min(self.room - content.len());
        content.extend_from_slice(&bytes[..fits]);
        if fits < bytes.len() {
            return Err(io::ErrorKind::StorageFull.into());
        }
        Ok(())
    }
    fn truncate(&mut self, length: u64) -> io::Result<()> {
        self.content.lock().unwrap().truncate(length as usize);
        Ok(())
    }
    fn request_sync(&mut self) -> io::Result<()> {
        Ok(())
    }
    fn sync(&mut self) -> io::Result<()> {
        Ok(())
    }
}

fn row(tick: u64) -> Row {
    Row {
        tick,
        time_unix_ns: tick * 1_000_000,
        input: TickInput::IDLE,
        hash: tick.wrapping_mul(0x9e37_79b9_7f4a_7c15),
        wrench: [[tick as f32; 6]; 2],
        status: [0; 2],
        device: [None; 2],
    }
}

#[test]
fn a_full_disk_is_reported_once_and_leaves_a_clean_prefix() {
    for room in [0, 10, 1000, 4000, 7000, 12_345, 20_000] {
        let content = Arc::new(Mutex::new(Vec::new()));
        let disk = Disk {
            content: Arc::clone(&content),
            room,
        };
        let header = SessionHeader::new(vec![1, 2, 3]);
        let mut errors = 0;
        let key = StationKey::from_seed([1; 32]);
        match Recorder::on(Box::new(disk), &header, key) {
            Err(error) => {
                assert!(matches!(error, RecordError::Stopped { rows: 0, .. }));
                assert!(content.lock().unwrap().is_empty());
                continue;
            }
            Ok(mut recorder) => {
                errors += usize::from(recorder.snapshot(0, 0, &[0; 16]).is_err());
                for tick in 1..=5000 {
                    errors += usize::from(recorder.push(&row(tick)).is_err());
                }
                let error = recorder.finish(SessionEnd::default()).unwrap_err();
                let error = error.to_string();
                let lost =
                    error.contains("rows came after") && !error.contains(": 0 rows came after");
                assert!(lost, "{error}");
            }
        }
        assert_eq!(errors, 1, "room {room}");
        let bytes = content.lock().unwrap().clone();
        match Recording::from_bytes(bytes.clone()) {
            Ok(recording) => {
                let at_byte = bytes.len() as u64;
                let why = "there is no end record".to_owned();
                assert_eq!(*recording.ending(), crate::Ending::CutOff { at_byte, why });
                assert!(recording.messages().all(|message| message.is_ok()));
            }
            Err(error) => assert!(error.to_string().contains("no rows"), "{error}"),
        }
    }
}

#[test]
fn order_is_kept_and_nothing_is_overwritten() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("a.mcap");
    let header = SessionHeader::new(vec![]);
    let create = || Recorder::create(&path, &header, StationKey::from_seed([1; 32]));
    let mut recorder = create().unwrap();
    assert!(matches!(create(), Err(RecordError::Exists(_))));
    assert!(matches!(
        recorder.push(&row(1)),
        Err(RecordError::NoSnapshot)
    ));
    recorder.snapshot(0, 0, &[]).unwrap();
    recorder.push(&row(5)).unwrap();
    for tick in [0, 4, 5] {
        let error = recorder.push(&row(tick)).unwrap_err();
        assert!(matches!(error, RecordError::Order { last: 5, .. }));
    }
    assert!(recorder.snapshot(0, 4, &[]).is_err());
    recorder.snapshot(0, 5, &[]).unwrap();
    let done = recorder.finish(SessionEnd::default()).unwrap();
    assert_eq!(done.bytes, std::fs::metadata(&path).unwrap().len());
    assert_eq!(done.rows, 1);
    let missing = dir.path().join("no/such/directory.mcap");
    let error = Recorder::create(&missing, &header, StationKey::from_seed([1; 32]));
    assert!(matches!(error, Err(RecordError::Create { .. })));
}

#[test]
fn a_failure_that_only_the_background_sync_heard_of_is_told_at_the_close() {
    for panics in [false, true] {
        let file = tempfile::tempfile().unwrap();
        let storage = FileStorage::synced_by(file, move |_| {
            assert!(!panics, "the disk is gone");
            Err(io::ErrorKind::StorageFull.into())
        });
        let mut storage = storage.unwrap();
        storage.append(b"row").unwrap();
        storage.request_sync().unwrap();
        let mut sink = Sink::new(Box::new(storage));
        sink.write_all(b"end").unwrap();
        let error = sink.close().unwrap_err();
        assert!(error.to_string().contains("earlier sync"), "{error}");
    }
    let file = FileStorage::new(tempfile::tempfile().unwrap()).unwrap();
    let mut sink = Sink::new(Box::new(file));
    sink.write_all(b"row").unwrap();
    assert_eq!(sink.close().unwrap(), 3);
}
