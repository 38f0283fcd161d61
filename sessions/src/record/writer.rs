//! The writer of a session: the one order of messages, for live sessions and for sessions in virtual time.

use sulcus_core::{Scene, TickOutput};

use crate::record::channels::{Moved, Sampler, Shapes, Views};
use crate::record::message::Level;
use crate::record::occurrence::Occurrence;
use crate::record::recorder::{Finished, RecordError, Recorder};
use crate::record::row::Row;
use crate::record::sample::OnlyNew;
use crate::record::statement::SessionEnd;

/// A tick for the recording.
pub struct RecordedTick<'a> {
    /// Exact row. Its samples may repeat a pose that an earlier tick has used; a repeated one is not written.
    pub row: &'a Row,
    /// Output of the tick.
    pub output: &'a TickOutput,
    /// Thread CPU time of the tick, nanoseconds.
    pub cpu_ns: u32,
    /// Shapes of the tissues after this tick, where [`Sampler::read`] has copied them.
    pub shapes: Option<&'a Shapes>,
}

/// Writer of one session into a new recording. Order of a tick's messages: row, occurrences, channels for viewers.
pub struct SessionWriter {
    recorder: Recorder,
    views: Views,
    only_new: OnlyNew,
}

impl SessionWriter {
    /// Begins a session: snapshot of tick 0, `opening` as an event where there is one, channels for viewers.
    /// `state` is the initial state as bytes.
    ///
    /// # Errors
    /// The first write that failed.
    pub fn begin(
        mut recorder: Recorder,
        scene: &Scene,
        started_unix_ns: u64,
        state: &[u8],
        opening: Option<&str>,
    ) -> Result<Self, RecordError> {
        recorder.snapshot(started_unix_ns, 0, state)?;
        if let Some(text) = opening {
            recorder.event(started_unix_ns, Level::Info, text)?;
        }
        let views = Views::open(scene, &mut recorder, started_unix_ns)?;
        Ok(Self {
            recorder,
            views,
            only_new: OnlyNew::default(),
        })
    }

    /// Copier of tissue shapes, for the thread that ticks.
    pub fn sampler(&self) -> Sampler {
        self.views.sampler()
    }

    /// Computes the places of the spheres for a copy of the shapes, for other outlets. [`SessionWriter::tick`] of the
    /// same tick does not compute them again.
    pub fn follow(&mut self, shapes: &Shapes) -> &Moved {
        self.views.follow(shapes)
    }

    /// Places of the spheres after the last copy of the shapes.
    pub fn moved(&self) -> &Moved {
        self.views.moved()
    }

    /// Writes a tick with its occurrences.
    ///
    /// # Errors
    /// The first write that failed.
    pub fn tick(
        &mut self,
        scene: &Scene,
        tick: &RecordedTick<'_>,
        occurrences: impl IntoIterator<Item = Occurrence>,
    ) -> Result<(), RecordError> {
        let row = tick.row;
        self.recorder
            .push(&row.with_device(self.only_new.of(&row.device)))?;
        for occurrence in occurrences {
            let level = occurrence.level();
            self.event(row.time_unix_ns, level, &occurrence.to_string())?;
        }
        let (recorder, output) = (&mut self.recorder, tick.output);
        self.views
            .tick(recorder, scene, row, output, tick.cpu_ns, tick.shapes)
    }

    /// Writes an event that belongs to no tick.
    ///
    /// # Errors
    /// The write failed.
    pub fn event(&mut self, unix_ns: u64, level: Level, text: &str) -> Result<(), RecordError> {
        self.recorder.event(unix_ns, level, text)
    }

    /// Writes a snapshot of the state after `tick`.
    ///
    /// # Errors
    /// The write failed.
    pub fn snapshot(&mut self, unix_ns: u64, tick: u64, state: &[u8]) -> Result<(), RecordError> {
        self.recorder.snapshot(unix_ns, tick, state)
    }

    /// Number of rows given to the file.
    pub fn rows(&self) -> u64 {
        self.recorder.rows()
    }

    /// Hands all complete chunks to the system.
    ///
    /// # Errors
    /// The write failed.
    pub fn flush(&mut self) -> Result<(), RecordError> {
        self.recorder.flush()
    }

    /// Ends the session: signature, summary, end of the file.
    ///
    /// # Errors
    /// The first write that failed.
    pub fn finish(self, end: SessionEnd) -> Result<Finished, RecordError> {
        self.recorder.finish(end)
    }
}
