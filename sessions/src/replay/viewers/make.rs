//! Pass over a recording that copies the exact messages and makes the messages for viewers between them.

use std::iter::Peekable;

use prost::Message as _;
use sulcus_core::{Scene, TickOutput};

use super::Made;
use super::error::ViewersError;
use crate::record::channels::v1::SessionMetrics;
use crate::record::channels::{Sampler, Shapes, Views};
use crate::record::format::Layout;
use crate::record::header::METADATA;
use crate::record::message::{Event, Message, Topic};
use crate::record::policy::is_kept;
use crate::record::program::Program;
use crate::record::raw::{Raw, RawMessage};
use crate::record::read::{ReadError, Recording};
use crate::record::recorder::{Extent, Head, Tape};
use crate::record::row::Row;
use crate::record::storage::Storage;
use crate::record::viewers::is_sum;
use crate::record::walk;
use crate::record::walk::Walk;
use crate::replay::run::{REPORT_EVERY, Run};

/// Copies the exact record to `storage` with the channels for viewers of this extent. Compares the replay with every
/// row and snapshot, and the channels with the signed hash.
pub(super) fn make(
    recording: &Recording,
    storage: Box<dyn Storage>,
    extent: Extent,
    progress: &mut dyn FnMut(u64),
) -> Result<Made, ViewersError> {
    let scene = recording.scene()?;
    let head = head(recording)?;
    let tape = Tape::begin(storage, &head, recording.header().viewers, extent)?;
    let mut making = Making {
        recording,
        scene: &scene,
        tape,
        run: Run::new(&scene, false, true),
        views: None,
        sampler: Sampler::new(&scene),
        shapes: Shapes::new(&scene),
        kept: Raw::new(recording, is_kept).peekable(),
        began_unix_ns: None,
        waiting: None,
    };
    for message in Raw::new(recording, |topic| Topic::from_name(topic).is_some()) {
        making.message(message?)?;
        if making.run.ticks.is_multiple_of(REPORT_EVERY) {
            progress(making.run.ticks);
        }
    }
    let made = making.finish()?;
    progress(made.ticks);
    Ok(made)
}

/// Header of the recording, with the metadata as the file has them: they are signed.
fn head(recording: &Recording) -> Result<Head<'_>, ReadError> {
    let walk = Walk::new(&recording.bytes).ok_or(ReadError::NotMcap)?;
    let records = recording
        .placed
        .iter()
        .filter_map(|at| walk.peek_at(*at).ok());
    let mut metadata = records.filter_map(|record| walk::metadata(record.body));
    let metadata = metadata.find(|(name, _)| *name == METADATA);
    let (_, metadata) = metadata.ok_or_else(|| ReadError::Changed {
        what: format!("there is no metadata `{METADATA}`"),
    })?;
    Ok(Head {
        header: recording.header(),
        metadata,
    })
}

/// Tick whose messages for viewers are not made yet. The events of the tick come before them.
struct Waiting {
    row: Row,
    output: TickOutput,
    /// Whether the shapes after the tick were due, and have been read.
    due: bool,
}

struct Making<'a> {
    recording: &'a Recording,
    scene: &'a Scene,
    tape: Tape,
    run: Run<'a>,
    /// Channels, once they are declared.
    views: Option<Views>,
    sampler: Sampler,
    shapes: Shapes,
    kept: Peekable<Raw<'a>>,
    /// Time of the first snapshot.
    began_unix_ns: Option<u64>,
    waiting: Option<Waiting>,
}

impl Making<'_> {
    /// Takes the next exact message.
    fn message(&mut self, raw: RawMessage) -> Result<(), ViewersError> {
        let changed = |what: &str| ReadError::Changed {
            what: what.to_owned(),
        };
        let topic = Topic::from_name(&raw.topic).ok_or_else(|| changed("a topic is unknown"))?;
        let message = Message::decode(topic, Layout::Protobuf, &raw.bytes)
            .ok_or_else(|| changed("an exact message cannot be decoded"))?;
        match &message {
            // The events of a tick have the time of its row. The messages for viewers of the tick follow them.
            Message::Event(event) if self.belongs(event) => {}
            Message::Signed(_) => {}
            _ => self.complete_tick()?,
        }
        self.tape.put(topic, raw.time_unix_ns, &raw.bytes)?;
        match message {
            Message::Row(row) => self.row(row),
            Message::Snapshot { tick, state } => {
                self.began_unix_ns.get_or_insert(raw.time_unix_ns);
                self.run.snapshot(tick, &state)?;
                self.is_identical()
            }
            Message::Event(event) if is_sum(&event.text) => Ok(()),
            Message::Event(event) => {
                let (time, level) = (event.time_unix_ns, event.level);
                self.tape.say(raw.time_unix_ns, time, level, &event.text)?;
                Ok(())
            }
            Message::Signed(_) => Ok(()),
        }
    }

    /// Whether an event is of the tick that waits, or of the opening, which precedes the shapes at rest.
    fn belongs(&self, event: &Event) -> bool {
        let at = match &self.waiting {
            Some(waiting) => Some(waiting.row.time_unix_ns),
            None if self.views.is_none() => self.began_unix_ns,
            None => None,
        };
        at == Some(event.time_unix_ns) && !is_sum(&event.text)
    }

    /// Runs a row.
    fn row(&mut self, row: Row) -> Result<(), ViewersError> {
        let Some(output) = self.run.row(&row) else {
            return Err(self.differs(row.tick, "there is no snapshot before the row"));
        };
        self.is_identical()?;
        let due = self.sampler.is_due(row.tick);
        if due {
            let workspace = self.run.workspace();
            self.sampler.read(row.tick, workspace, &mut self.shapes);
        }
        self.tape.on_time(row.time_unix_ns)?;
        self.waiting = Some(Waiting { row, output, due });
        Ok(())
    }

    /// Declares the channels if they are not declared, and makes the messages of the tick that waits.
    fn complete_tick(&mut self) -> Result<(), ViewersError> {
        let Some(began) = self.began_unix_ns else {
            return Ok(());
        };
        let views = match &mut self.views {
            Some(views) => views,
            none => none.insert(Views::open_on(self.scene, &mut self.tape, began)?),
        };
        let Some(Waiting { row, output, due }) = self.waiting.take() else {
            return Ok(());
        };
        let is_here = |kept: &Result<RawMessage, _>| match kept {
            Ok(kept) => kept.time_unix_ns == row.time_unix_ns,
            Err(_) => true,
        };
        let kept = self.kept.next_if(is_here).transpose()?;
        // Bytes that cannot be decoded differ from the made ones.
        let told = kept.as_ref().map(|kept| {
            let told = SessionMetrics::decode(&kept.bytes[..]);
            told.unwrap_or_default()
        });
        let told = told.unwrap_or_default();
        let shapes = (due && told.awake.is_some()).then_some(&self.shapes);
        let (tape, scene) = (&mut self.tape, self.scene);
        let tick_us = told.longest_tick_us;
        let made = views.tick_on(tape, scene, &row, &output, tick_us, shapes)?;
        let made = made.map(|metrics| metrics.encode_to_vec());
        if made == kept.map(|kept| kept.bytes) {
            return Ok(());
        }
        Err(self.differs(row.tick, "the metrics of the session differ"))
    }

    /// Checks that no row and no snapshot differs so far.
    fn is_identical(&self) -> Result<(), ViewersError> {
        match &self.run.first {
            None => Ok(()),
            Some((tick, divergence)) => {
                let what = format!(
                    "{:?}: recorded {}, replayed {}",
                    divergence.what, divergence.hash_recorded, divergence.hash_replayed
                );
                Err(self.differs(*tick, &what))
            }
        }
    }

    fn differs(&self, tick: u64, what: &str) -> ViewersError {
        ViewersError::Differs {
            tick,
            what: what.to_owned(),
            recorded_by: Box::new(Program::of(self.recording.header())),
            replayed_by: Box::new(Program::this()),
        }
    }

    /// Compares the channels with the signed hash, and closes the file.
    fn finish(mut self) -> Result<Made, ViewersError> {
        self.complete_tick()?;
        if let Some(kept) = self.kept.next().transpose()? {
            let tick = SessionMetrics::decode(&kept.bytes[..]).map_or(0, |kept| kept.tick);
            return Err(self.differs(tick, "the metrics of the session have no row"));
        }
        let found = self.tape.said();
        let said = self.recording.facts().viewers.as_ref();
        let said = said.ok_or(ViewersError::NotSigned)?;
        if said.all() != found.all() {
            return Err(ViewersError::Others {
                found: found.all().messages(),
                expected: said.all().messages(),
                recorded_by: Box::new(Program::of(self.recording.header())),
                replayed_by: Box::new(Program::this()),
            });
        }
        let bytes = self.tape.finish(0)?;
        Ok(Made {
            out: None,
            bytes: Some(bytes),
            ticks: self.run.ticks,
            messages: found.all().messages(),
        })
    }
}
