//! Queue of ticks to the recorder, and before each tick the shapes that its events and viewers need.

use rtrb::{Consumer, Producer, PushError};
use sulcus_core::{Params, State, Vec3, Workspace};
use sulcus_sessions::exercise::events::Look;
use sulcus_sessions::record::recorder::SNAPSHOT_EVERY_S;
use sulcus_sessions::{Sampler, Shapes};

use crate::outlets::recording::{Entry, Ticked};
use crate::session::metrics::Metrics;

/// Ends of the rings between the thread of the ticks and the recorder.
pub(crate) struct Rings {
    /// Queue to the recorder.
    pub entries: Producer<Entry>,
    /// Free buffers for snapshots, returned by the recorder.
    pub buffers: Consumer<Vec<u8>>,
    /// Reader of the shapes for the events of the exercise.
    pub look: Look,
    /// Free buffers for looks, returned by the recorder.
    pub looks: Consumer<Vec<Vec3>>,
    /// Reader of the shapes for viewers.
    pub sampler: Sampler,
    /// Free buffers for shapes, returned by the recorder.
    pub shapes: Consumer<Box<Shapes>>,
}

/// Queue to the recorder. No call allocates, frees or waits. A full queue drops the entry; rows and snapshots that are
/// dropped are counted.
pub(crate) struct Queue {
    pub rings: Rings,
    /// Number of ticks between two snapshots.
    snapshot_every: u64,
    pub next_snapshot: u64,
}

impl Queue {
    pub fn new(rings: Rings, params: &Params) -> Self {
        let snapshot_every = params.ticks_in(SNAPSHOT_EVERY_S);
        Self {
            rings,
            snapshot_every,
            next_snapshot: snapshot_every,
        }
    }

    /// Number of entries that fit into the queue now.
    pub fn room(&self) -> usize {
        self.rings.entries.slots()
    }

    /// Queues a tick, with a snapshot of the state after it if one is due.
    pub fn tick(
        &mut self,
        ticked: Ticked,
        state: &State,
        workspace: &Workspace,
        metrics: &mut Metrics,
    ) {
        let (tick, unix_ns) = (ticked.row.tick, ticked.row.time_unix_ns);
        self.shapes_of(tick, workspace);
        if self.rings.entries.push(Entry::Tick(ticked)).is_err() {
            metrics.rows_dropped += 1;
        }
        if tick >= self.next_snapshot {
            self.next_snapshot = tick + self.snapshot_every;
            self.snapshot(unix_ns, state, metrics);
        }
    }

    fn shapes_of(&mut self, tick: u64, workspace: &Workspace) {
        let rings = &mut self.rings;
        if rings.look.is_due(tick)
            && let Ok(mut centres) = rings.looks.pop()
        {
            rings.look.read(workspace, &mut centres);
            if let Err(PushError::Full(entry)) = rings.entries.push(Entry::Look(tick, centres)) {
                // A free could lock, like an allocation. The buffer is leaked instead.
                std::mem::forget(entry);
            }
        }
        if rings.sampler.is_due(tick)
            && let Ok(mut shapes) = rings.shapes.pop()
        {
            rings.sampler.read(tick, workspace, &mut shapes);
            if let Err(PushError::Full(entry)) = rings.entries.push(Entry::Shapes(shapes)) {
                std::mem::forget(entry);
            }
        }
    }

    fn snapshot(&mut self, unix_ns: u64, state: &State, metrics: &mut Metrics) {
        let Ok(mut bytes) = self.rings.buffers.pop() else {
            metrics.snapshots_dropped += 1;
            return;
        };
        bytes.clear();
        state.write_bytes(&mut bytes);
        let entry = Entry::Snapshot {
            unix_ns,
            tick: state.tick,
            bytes,
        };
        if let Err(PushError::Full(entry)) = self.rings.entries.push(entry) {
            metrics.snapshots_dropped += 1;
            std::mem::forget(entry);
        }
    }
}
