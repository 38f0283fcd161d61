//! Storage of a recording's bytes. A flush arrives as a whole or not at all.
//!
//! A disk that fills up in the middle of a chunk would leave an incomplete chunk. The file is then cut back to the end
//! of the last flush, and nothing more is written.

use std::fs::File;
use std::io::{self, Write};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{SyncSender, sync_channel};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// Destination of a recording's bytes. A trait, so that tests can simulate a full disk.
pub(crate) trait Storage: Send {
    /// Writes all bytes at the end of the file.
    fn append(&mut self, bytes: &[u8]) -> io::Result<()>;
    /// Cuts the file back to `length` bytes.
    fn truncate(&mut self, length: u64) -> io::Result<()>;
    /// Requests that the disk gets the written bytes, without waiting. Reports the failure of an earlier request.
    fn request_sync(&mut self) -> io::Result<()>;
    /// Waits until the disk has all bytes. Reports the failure of an earlier request, too.
    fn sync(&mut self) -> io::Result<()>;
}

/// File with a thread of its own that syncs it. A sync may take longer than the tenth of a second between two flushes,
/// and must not delay them.
pub(crate) struct FileStorage {
    file: File,
    requests: Option<SyncSender<()>>,
    failed: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl FileStorage {
    pub fn new(file: File) -> io::Result<Self> {
        Self::synced_by(file, File::sync_data)
    }

    /// File storage with the given function for a sync in the background.
    fn synced_by(
        file: File,
        sync: impl Fn(&File) -> io::Result<()> + Send + 'static,
    ) -> io::Result<Self> {
        let copy = file.try_clone()?;
        let failed = Arc::new(AtomicBool::new(false));
        let (requests, inbox) = sync_channel(1);
        let flag = Arc::clone(&failed);
        let thread = std::thread::Builder::new()
            .name("sulcus-sync".to_owned())
            .spawn(move || {
                while inbox.recv().is_ok() {
                    if sync(&copy).is_err() {
                        flag.store(true, Ordering::Relaxed);
                    }
                }
            })?;
        Ok(Self {
            file,
            requests: Some(requests),
            failed,
            thread: Some(thread),
        })
    }

    /// Waits until all requests are done and the thread has ended.
    fn end_thread(&mut self) {
        self.requests = None;
        if let Some(Err(_)) = self.thread.take().map(JoinHandle::join) {
            self.failed.store(true, Ordering::Relaxed);
        }
    }

    fn earlier(&self) -> io::Result<()> {
        if self.failed.load(Ordering::Relaxed) {
            return Err(io::Error::other("an earlier sync to disk failed"));
        }
        Ok(())
    }
}

impl Storage for FileStorage {
    fn append(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.file.write_all(bytes)
    }

    fn truncate(&mut self, length: u64) -> io::Result<()> {
        self.file.set_len(length)
    }

    fn request_sync(&mut self) -> io::Result<()> {
        self.earlier()?;
        if let Some(requests) = &self.requests {
            // A full queue has a waiting request, which will also cover these bytes.
            let _ = requests.try_send(());
        }
        Ok(())
    }

    fn sync(&mut self) -> io::Result<()> {
        // The system reports a failure once. If the thread gets the report, the sync here succeeds.
        self.end_thread();
        self.file.sync_all()?;
        self.earlier()
    }
}

impl Drop for FileStorage {
    fn drop(&mut self) {
        self.end_thread();
    }
}

/// Wall time between two requests to sync.
const SYNC_EVERY: Duration = Duration::from_secs(1);
/// Largest number of held bytes, for a caller that never flushes.
const HOLD: usize = 4 << 20;

/// Destination of the MCAP writer: holds the bytes of a flush until it is complete.
pub(crate) struct Sink {
    storage: Box<dyn Storage>,
    held: Vec<u8>,
    /// Bytes in the file, always the end of a whole flush.
    whole: u64,
    failed: bool,
    synced: Instant,
}

impl Sink {
    pub fn new(storage: Box<dyn Storage>) -> Self {
        Self {
            storage,
            held: Vec::new(),
            whole: 0,
            failed: false,
            synced: Instant::now(),
        }
    }

    fn commit(&mut self) -> io::Result<()> {
        if self.failed {
            return Err(io::Error::other("an earlier write failed"));
        }
        let mut written = self.storage.append(&self.held);
        if written.is_ok() {
            self.whole += self.held.len() as u64;
            if self.synced.elapsed() >= SYNC_EVERY {
                self.synced = Instant::now();
                written = self.storage.request_sync();
            }
        } else {
            // If the cut fails, too, readers still find the clean prefix.
            let _ = self.storage.truncate(self.whole);
        }
        self.failed = written.is_err();
        self.held.clear();
        written
    }

    /// Writes the held bytes and waits for the disk; length of the file.
    pub fn close(mut self) -> io::Result<u64> {
        self.commit()?;
        self.storage.sync()?;
        Ok(self.whole)
    }
}

impl Write for Sink {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if self.failed {
            return Err(io::Error::other("an earlier write failed"));
        }
        self.held.extend_from_slice(bytes);
        if self.held.len() > HOLD {
            self.commit()?;
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        self.commit()
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests;
