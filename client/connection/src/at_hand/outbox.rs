//! Rows on their way to the server: from the device's thread into batches, and again after a return until the server
//! has computed them.

use std::collections::VecDeque;
use std::sync::atomic::{AtomicBool, AtomicU32, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use quinn::{Connection, VarInt};
use rtrb::{Consumer, Producer, RingBuffer};
use sulcus_program::tell;
use sulcus_proto::at_hand::{BATCH_MS, HandRow, MOST_ROWS, Packer};
use sulcus_proto::control::{InputBatch, LastTick};
use sulcus_proto::{ClientMessage, frame};
use tokio::sync::Notify;

use super::pace::{self, Pace};

/// Rows that wait for their batch: two seconds at the highest rate, 8 kHz.
const ROWS: usize = 16_384;
/// Largest sum of batches that wait for the server, bytes: about half an hour at 1 kHz.
const MOST_BYTES: usize = 64 << 20;

/// Time by which the server is behind when the person is told, milliseconds.
const BEHIND_MS: u64 = 5000;

/// Time of such a lag on a live connection after which the person is told, milliseconds.
const THIN_MS: u64 = 5000;

/// Priority of the stream of inputs: below that of the control stream.
const AFTER_CONTROL: i32 = -1;
/// Longest wait for an answer before the path is looked at again.
const BREATH: Duration = Duration::from_millis(10);

/// Row of a tick, and facts about the tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Out {
    /// Number of the tick.
    pub tick: u64,
    /// State hash after the tick.
    pub hash: u64,
    /// Number of the station's commands that the tick obeyed, wrapping.
    pub commands: u32,
    /// Number of the run: [`crate::link::Link::restarts`] when the ticks began.
    pub run: u32,
    /// Row.
    pub row: HandRow,
}

/// The device's end of the rows.
pub(crate) struct Rows {
    ring: Producer<Out>,
    outbox: Arc<Outbox>,
}

impl Rows {
    /// Ring of rows for batches in `outbox`.
    pub fn new() -> (Self, Consumer<Out>, Arc<Outbox>) {
        let (ring, rows) = RingBuffer::new(ROWS);
        let outbox = Arc::new(Outbox::default());
        let this = Self {
            ring,
            outbox: outbox.clone(),
        };
        (this, rows, outbox)
    }

    /// Queues a row. Wait-free. `false`: the network's thread has taken no row for seconds, and the session cannot go
    /// on.
    pub fn push(&mut self, out: Out) -> bool {
        let pushed = self.ring.push(out).is_ok();
        if pushed && out.run == self.outbox.run.load(Ordering::Acquire) {
            self.outbox.hash.store(out.hash, Ordering::Relaxed);
            self.outbox.offered.store(out.tick, Ordering::Release);
        }
        pushed && !self.outbox.overflows()
    }

    /// Batches of the rows.
    pub fn outbox(&self) -> &Outbox {
        &self.outbox
    }
}

/// Batches that wait for the server.
#[derive(Debug, Default)]
pub(crate) struct Outbox {
    inner: Mutex<Backlog>,
    /// Newest tick that the device has given.
    offered: AtomicU64,
    /// State hash after this tick.
    hash: AtomicU64,
    /// Number of the present run. Rows of former runs are of no use.
    run: AtomicU32,
    /// Whether the motion has ended.
    ended: AtomicBool,
    /// Whether more waits than [`MOST_BYTES`].
    overflow: AtomicBool,
    /// New batches.
    changed: Notify,
    /// Ticks that the server has computed.
    acknowledged: Notify,
}

#[derive(Debug, Default)]
struct Backlog {
    /// Frames, oldest first, with the last tick of each.
    batches: VecDeque<(u64, Vec<u8>)>,
    /// Number of frames that were written on the present connection.
    written: usize,
    /// Sums of all frames, and of those that were written, bytes.
    bytes: usize,
    written_bytes: usize,
    /// Newest tick that the server has computed.
    computed: u64,
    /// Sums over the session: bytes of rows, and rows.
    sums: (u64, u64),
}

impl Outbox {
    fn backlog(&self) -> MutexGuard<'_, Backlog> {
        self.inner.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Begins a run from its first tick: the server has lost the session before.
    pub fn begin(&self, run: u32) {
        let mut backlog = self.backlog();
        *backlog = Backlog {
            sums: backlog.sums,
            ..Backlog::default()
        };
        self.run.store(run, Ordering::Release);
        self.offered.store(0, Ordering::Release);
    }

    fn push(&self, run: u32, batch: InputBatch, last_tick: u64, rows: usize) {
        let mut backlog = self.backlog();
        if run != self.run.load(Ordering::Acquire) {
            return;
        }
        backlog.sums.0 += batch.rows.len() as u64;
        backlog.sums.1 += rows as u64;
        let Ok(frame) = frame::encode(&ClientMessage::Inputs(batch)) else {
            // 64 rows are far below the largest frame.
            self.overflow.store(true, Ordering::Release);
            return;
        };
        backlog.bytes += frame.len();
        if backlog.bytes > MOST_BYTES {
            self.overflow.store(true, Ordering::Release);
        }
        backlog.batches.push_back((last_tick, frame));
        drop(backlog);
        self.changed.notify_one();
    }

    /// The server has computed all ticks up to `tick`.
    pub fn computed(&self, tick: u64) {
        let mut backlog = self.backlog();
        if tick <= backlog.computed {
            return;
        }
        backlog.computed = tick;
        while backlog
            .batches
            .front()
            .is_some_and(|(last, _)| *last <= tick)
        {
            if let Some((_, frame)) = backlog.batches.pop_front() {
                backlog.bytes -= frame.len();
                if backlog.written > 0 {
                    backlog.written -= 1;
                    backlog.written_bytes -= frame.len();
                }
            }
        }
        drop(backlog);
        self.acknowledged.notify_one();
    }

    /// All that the server has not computed goes again over a new connection.
    pub fn rewind(&self) {
        let mut backlog = self.backlog();
        (backlog.written, backlog.written_bytes) = (0, 0);
    }

    /// Next frame to write, a copy.
    fn next(&self) -> Option<Vec<u8>> {
        let mut backlog = self.backlog();
        let next = backlog.batches.get(backlog.written)?.1.clone();
        backlog.written += 1;
        backlog.written_bytes += next.len();
        Some(next)
    }

    /// The device gives no further tick. Returns the message about the last one; `None` if nothing waits.
    pub fn end(&self) -> Option<ClientMessage> {
        if self.is_empty() {
            return None;
        }
        self.ended.store(true, Ordering::Release);
        self.changed.notify_one();
        Some(self.last())
    }

    /// Message about the newest tick that the device has given.
    fn last(&self) -> ClientMessage {
        ClientMessage::LastTick(LastTick {
            tick: self.offered.load(Ordering::Acquire),
            hash: self.hash.load(Ordering::Relaxed),
        })
    }

    /// Bytes of the frames that were written on the present connection and are not computed yet.
    fn on_the_way(&self) -> usize {
        self.backlog().written_bytes
    }

    /// Whether the server has computed all ticks that the device has given.
    pub fn is_empty(&self) -> bool {
        self.backlog().computed >= self.offered.load(Ordering::Acquire)
    }

    /// Whether more waits than the session may be behind. Wait-free.
    pub fn overflows(&self) -> bool {
        self.overflow.load(Ordering::Acquire)
    }

    /// Number of ticks by which the server is behind the hand.
    pub fn behind(&self) -> u64 {
        let offered = self.offered.load(Ordering::Acquire);
        offered.saturating_sub(self.backlog().computed)
    }

    /// Mean length of a row, bytes.
    pub fn bytes_per_tick(&self) -> f64 {
        let (bytes, rows) = self.backlog().sums;
        bytes as f64 / rows.max(1) as f64
    }

    /// Waits until the server has computed all ticks.
    pub async fn emptied(&self) {
        while !self.is_empty() {
            let _ = tokio::time::timeout(Duration::from_millis(100), self.acknowledged.notified())
                .await;
        }
    }
}

/// Packs rows into batches, one every [`BATCH_MS`], until the device's end is dropped. The person is told of a network
/// that carries less than the hand makes.
pub(crate) async fn pack(
    mut rows: Consumer<Out>,
    outbox: Arc<Outbox>,
    tick_ns: u64,
    is_connected: impl Fn() -> bool,
) {
    let behind_ms = || outbox.behind().saturating_mul(tick_ns) / 1_000_000;
    let (mut packer, mut run) = (Packer::default(), 0);
    let mut interval = tokio::time::interval(Duration::from_millis(BATCH_MS));
    interval.set_missed_tick_behavior(tokio::time::MissedTickBehavior::Delay);
    let mut batch: Vec<Out> = Vec::with_capacity(MOST_ROWS);
    // Intervals in which the connection lived and the server was far behind; `None`: the person has been told.
    let mut thin = Some(0);
    loop {
        interval.tick().await;
        thin = thin.map(|count| match behind_ms() > BEHIND_MS && is_connected() {
            true => count + 1,
            false => 0,
        });
        if thin.is_some_and(|count| count * BATCH_MS >= THIN_MS) {
            thin = None;
            tell!(
                "the network carries fewer inputs than the hand makes: the server is {} s behind, and the rest is handed \
                 in after the session",
                behind_ms() / 1000
            );
        }
        let over = rows.is_abandoned();
        while let Ok(out) = rows.pop() {
            let other = batch
                .last()
                .is_some_and(|last| (last.commands, last.run) != (out.commands, out.run));
            if other || batch.len() == MOST_ROWS {
                flush(&mut packer, &mut batch, &outbox);
            }
            if out.run != run {
                run = out.run;
                packer = Packer::default();
            }
            batch.push(out);
        }
        flush(&mut packer, &mut batch, &outbox);
        if over {
            return;
        }
    }
}

fn flush(packer: &mut Packer, batch: &mut Vec<Out>, outbox: &Outbox) {
    let (Some(first), Some(last)) = (batch.first(), batch.last()) else {
        return;
    };
    let rows: Vec<HandRow> = batch.iter().map(|out| out.row).collect();
    let (first_tick, last_tick, run) = (first.tick, last.tick, last.run);
    let packed = InputBatch {
        first_tick,
        hash: last.hash,
        commands: last.commands,
        rows: packer.pack(&rows),
    };
    outbox.push(run, packed, last_tick, rows.len());
    batch.clear();
}

/// Writes the batches on a stream of `connection` until the connection or the server ends it. The live poses and the
/// control messages go first, and no queue of the path is filled.
pub(crate) async fn write(connection: Connection, outbox: Arc<Outbox>) {
    let Ok(mut stream) = connection.open_uni().await else {
        return;
    };
    let _ = stream.set_priority(AFTER_CONTROL);
    let mut pace = Pace::new(connection.rtt());
    let mut named = false;
    loop {
        let ended = outbox.ended.load(Ordering::Acquire);
        if ended && !named {
            // Also before the batches that follow: they have no lag behind a motion that has ended.
            named = true;
            let Ok(frame) = frame::encode(&outbox.last()) else {
                return;
            };
            if stream.write_all(&frame).await.is_err() {
                return;
            }
        }
        let on_the_way = outbox.on_the_way();
        // After the motion no live poses need the path.
        let window = pace.window().max(if ended { pace::BEGIN } else { 0 });
        let limited = on_the_way >= window;
        pace.take(Instant::now(), connection.rtt(), limited);
        if limited {
            let _ = tokio::time::timeout(BREATH, outbox.acknowledged.notified()).await;
            continue;
        }
        let Some(frame) = outbox.next() else {
            outbox.changed.notified().await;
            continue;
        };
        if stream.write_all(&frame).await.is_err() {
            let _ = stream.reset(VarInt::from_u32(0));
            return;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn out(tick: u64, commands: u32) -> Out {
        Out {
            tick,
            hash: tick * 7,
            commands,
            run: 0,
            row: HandRow::default(),
        }
    }

    fn runtime() -> tokio::runtime::Runtime {
        let mut builder = tokio::runtime::Builder::new_current_thread();
        builder.enable_time().build().expect("a runtime")
    }

    /// Batches in the outbox: first tick and hash of each.
    fn sent(outbox: &Outbox) -> Vec<(u64, u64)> {
        std::iter::from_fn(|| outbox.next())
            .map(|bytes| match frame::decode(&bytes[frame::LENGTH_BYTES..]) {
                Ok(ClientMessage::Inputs(batch)) => (batch.first_tick, batch.hash),
                other => panic!("{other:?}"),
            })
            .collect()
    }

    #[test]
    fn what_the_server_has_not_computed_goes_again_after_a_return() {
        let runtime = runtime();
        let (mut rows, ring, outbox) = Rows::new();
        // A command of the station begins a batch of its own.
        for (tick, commands) in [(1, 0), (2, 0), (3, 1), (4, 1), (5, 1)] {
            assert!(rows.push(out(tick, commands)));
        }
        drop(rows);
        runtime.block_on(pack(ring, outbox.clone(), 1_000_000, || true));
        assert_eq!(sent(&outbox), [(1, 14), (3, 35)]);
        assert_eq!((outbox.behind(), outbox.is_empty()), (5, false));
        outbox.computed(2);
        outbox.rewind();
        assert_eq!(sent(&outbox), [(3, 35)]);
        // A batch goes again as a whole.
        outbox.computed(4);
        outbox.rewind();
        assert_eq!(sent(&outbox), [(3, 35)]);
        outbox.computed(5);
        outbox.rewind();
        assert_eq!(sent(&outbox), []);
        assert!(outbox.is_empty() && !outbox.overflows());
        runtime.block_on(outbox.emptied());
    }

    #[test]
    fn a_new_run_begins_with_a_new_packer_and_forgets_the_former_one() {
        let runtime = runtime();
        let (mut rows, ring, outbox) = Rows::new();
        let of_run = |tick, run| Out {
            run,
            ..out(tick, 0)
        };
        for (tick, run) in [(700, 0), (701, 0), (1, 1), (2, 1)] {
            assert!(rows.push(of_run(tick, run)));
        }
        drop(rows);
        outbox.begin(1);
        runtime.block_on(pack(ring, outbox.clone(), 1_000_000, || true));
        assert_eq!(sent(&outbox), [(1, 14)]);
        outbox.rewind();
        let frame = outbox.next().expect("a batch");
        let Ok(ClientMessage::Inputs(batch)) = frame::decode(&frame[frame::LENGTH_BYTES..]) else {
            panic!("no batch")
        };
        let rows = sulcus_proto::at_hand::Unpacker::default().unpack(&batch.rows);
        assert_eq!(rows.expect("a first batch").len(), 2);
    }

    #[test]
    fn a_ring_that_nobody_empties_refuses_rows() {
        let (mut rows, _ring, _outbox) = Rows::new();
        assert!((0..ROWS as u64).all(|tick| rows.push(out(tick, 0))));
        assert!(!rows.push(out(ROWS as u64, 0)));
    }
}
