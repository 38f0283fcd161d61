//! A small session, recorded, and ways to tamper with it.
#![allow(dead_code, clippy::unwrap_used)]

pub mod ask;
pub mod program;

use std::collections::BTreeMap;
use std::path::Path;

use mcap::records::{MessageHeader, Record};
use mcap::{Attachment, Compression, WriteOptions};
use prost::Message as _;
use sulcus_core::tissue::TissueModel;
use sulcus_core::{
    DisplayMesh, NoProbe, Object, Params, Pose, Quat, Scene, Sphere, SphereTree, State, TickInput,
    Tool, ToolInput, Vec3, Workspace, tick,
};
use sulcus_sessions::record::channels::v1::ExactRow;
use sulcus_sessions::{Level, Recorder, Row, SessionEnd, SessionHeader, Shapes, StationKey, Views};

/// Session clock at the first tick, nanoseconds since the Unix epoch.
pub const BEGAN: u64 = 1_790_000_000_000_000_000;

pub fn key() -> StationKey {
    StationKey::from_seed([42; 32])
}

/// A rod over three rigid balls.
pub fn scene() -> Scene {
    let rod: Vec<Sphere> = (0..40)
        .map(|k| Sphere {
            centre: Vec3::new(0.0, 0.0, -0.09 + 0.00025 * f64::from(k)),
            radius: 2.5e-4,
        })
        .collect();
    let balls: Vec<Sphere> = (-1..=1)
        .map(|k| Sphere {
            centre: Vec3::new(0.006 * f64::from(k), 0.0, -0.005),
            radius: 0.005,
        })
        .collect();
    Scene {
        name: "three balls".into(),
        source_hash: "none".into(),
        params: Params::default(),
        tools: vec![Tool {
            name: "rod".into(),
            tree: SphereTree::over_leaves(&rod).unwrap(),
            level: 3,
            working_point: Vec3::new(0.0, 0.0, -0.088),
            tip: Vec3::new(0.0, 0.0, -0.09025),
            tip_axis: -Vec3::z(),
            stiffness_n_per_m: 500.0,
            stiffness_nm_per_rad: 0.5,
            park: Pose::new(Vec3::new(0.0, 0.0, 0.12), Quat::identity()),
            bands: vec![],
            mesh: DisplayMesh::default(),
        }],
        objects: vec![Object {
            name: "balls".into(),
            fdi: 36,
            tree: SphereTree::over_leaves(&balls).unwrap(),
            level: 3,
            tissue: TissueModel::Rigid,
            mesh: DisplayMesh::default(),
            carriers: Vec::new(),
        }],
    }
}

/// A hand that sweeps over the balls, pressing 1 to 2 mm, with a tremor.
pub fn input(k: u64) -> TickInput {
    let t = k as f64 * 1e-3;
    let tremor = ((k.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 40) as f64 / 16_777_216.0 - 0.5) * 4e-5;
    let position = Vec3::new(
        0.007 * libm::sin(0.7 * t) + tremor,
        0.001 * libm::cos(1.9 * t) - tremor,
        0.09025 - 0.0005 - 0.0015 * libm::sin(0.3 * t).abs() + tremor,
    );
    let mut input = TickInput::IDLE;
    input.tools[0] = ToolInput {
        pose: (&Pose::new(position, Quat::identity())).into(),
        present: true,
        ..ToolInput::ABSENT
    };
    input
}

pub fn header(scene: &Scene) -> SessionHeader {
    SessionHeader {
        exercise_name: "touch".into(),
        exercise: "title = \"touch three balls\"\n".into(),
        patient: "condition = \"healthy\"\n".into(),
        rubric: "{}".into(),
        seed: 7,
        station: "bench 3".into(),
        learner_id: "a7f3".into(),
        started_unix_ns: BEGAN,
        ..SessionHeader::new(scene.to_bytes().unwrap())
    }
}

/// A session being run and recorded.
pub struct Session {
    pub scene: Scene,
    pub state: State,
    workspace: Workspace,
    pub recorder: Recorder,
    pub snapshot_every: u64,
}

impl Session {
    pub fn begin(path: &Path, key: StationKey) -> Self {
        Self::begin_by(path, key, &header(&scene()).program_version)
    }

    /// As if a program of that version did.
    pub fn begin_by(path: &Path, key: StationKey, version: &str) -> Self {
        let scene = scene();
        let header = SessionHeader {
            program_version: version.to_owned(),
            ..header(&scene)
        };
        let mut recorder = Recorder::create(path, &header, key).unwrap();
        let state = State::new(&scene);
        recorder.snapshot(BEGAN, 0, &state.to_bytes()).unwrap();
        recorder
            .event(BEGAN, Level::Info, "session begins")
            .unwrap();
        let workspace = Workspace::new(&scene);
        Self {
            scene,
            state,
            workspace,
            recorder,
            snapshot_every: 10_000,
        }
    }

    /// Runs a tick and gives its row without recording it.
    pub fn tick(&mut self, input: &TickInput) -> Row {
        let output = tick(
            &self.scene,
            &mut self.state,
            &mut self.workspace,
            input,
            &mut NoProbe,
        );
        Row::new(BEGAN + output.tick * 1_000_000, input, &output)
    }

    pub fn run(&mut self, ticks: u64) {
        for _ in 0..ticks {
            let row = self.tick(&input(self.state.tick));
            self.recorder.push(&row).unwrap();
            if row.tick.is_multiple_of(self.snapshot_every) {
                self.recorder
                    .snapshot(row.time_unix_ns, row.tick, &self.state.to_bytes())
                    .unwrap();
            }
        }
    }

    pub fn end(&self) -> SessionEnd {
        SessionEnd {
            ticks: self.recorder.rows(),
            ..SessionEnd::default()
        }
    }

    pub fn finish(self) {
        let end = self.end();
        self.recorder.finish(end).unwrap();
    }
}

/// Records `ticks` ticks and finishes.
pub fn record(path: &Path, ticks: u64) {
    let mut session = Session::begin(path, key());
    session.run(ticks);
    session.finish();
}

/// A finished session of `ticks` ticks as bytes.
pub fn recorded(ticks: u64) -> Vec<u8> {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("session.mcap");
    record(&path, ticks);
    std::fs::read(path).unwrap()
}

/// The same, with a snapshot every so many ticks.
pub fn recorded_every(ticks: u64, snapshot_every: u64) -> Vec<u8> {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("session.mcap");
    let mut session = Session::begin(&path, key());
    session.snapshot_every = snapshot_every;
    session.run(ticks);
    session.finish();
    std::fs::read(path).unwrap()
}

/// A session with channels for viewers; ticks come as `ticks` says, so that some may be missing.
pub fn recorded_with_views(ticks: u64, skip: std::ops::Range<u64>) -> Vec<u8> {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("session.mcap");
    let scene = scene();
    let mut recorder = Recorder::create(&path, &header(&scene), key()).unwrap();
    let (mut state, mut workspace) = (State::new(&scene), Workspace::new(&scene));
    recorder.snapshot(BEGAN, 0, &state.to_bytes()).unwrap();
    let mut views = Views::open(&scene, &mut recorder, BEGAN).unwrap();
    let (mut sampler, mut shapes) = (views.sampler(), Shapes::new(&scene));
    recorder.event(BEGAN, Level::Warning, "begins").unwrap();
    let mut missed = 0;
    for k in 0..ticks {
        if skip.contains(&k) {
            missed += 1;
            continue;
        }
        let mut input = input(k);
        input.skipped = std::mem::take(&mut missed);
        let output = tick(&scene, &mut state, &mut workspace, &input, &mut NoProbe);
        let row = Row::new(BEGAN + output.tick * 1_000_000, &input, &output);
        recorder.push(&row).unwrap();
        let due = sampler.is_due(output.tick);
        if due {
            sampler.read(output.tick, &workspace, &mut shapes);
        }
        let shapes = due.then_some(&shapes);
        views
            .tick(&mut recorder, &scene, &row, &output, 1000, shapes)
            .unwrap();
    }
    let end = SessionEnd {
        ticks: recorder.rows(),
        ..SessionEnd::default()
    };
    recorder.finish(end).unwrap();
    std::fs::read(path).unwrap()
}

/// Whether the messages of a channel are exact bytes in a protobuf message.
pub fn is_sealed(topic: &str, encoding: &str) -> bool {
    (topic.starts_with("/exact") || topic == "/events") && encoding == "protobuf"
}

/// The exact bytes in a protobuf message (all four kinds have them in their first field).
pub fn inner(outer: &[u8]) -> Vec<u8> {
    ExactRow::decode(outer).unwrap().row
}

/// The protobuf message around exact bytes.
pub fn sealed(inner: &[u8]) -> Vec<u8> {
    let row = inner.to_vec();
    let message = ExactRow {
        row,
        ..ExactRow::default()
    };
    message.encode_to_vec()
}

/// What an editor may change in a recording, before it is written anew with correct CRCs.
pub struct Edit<'a> {
    /// Changes the bytes of a message of a topic, of an exact one those that the chain covers; `false` leaves it out.
    pub message: &'a mut dyn FnMut(&str, &mut Vec<u8>) -> bool,
    /// Changes the header.
    pub metadata: &'a mut dyn FnMut(&mut BTreeMap<String, String>),
    /// Changes the bytes of an attachment.
    pub attachment: &'a mut dyn FnMut(&str, &mut Vec<u8>),
}

/// The file with one attachment changed, and its hash in the header made right, or not.
pub fn with_attachment(
    bytes: &[u8],
    name: &str,
    rehash: bool,
    mut change: impl FnMut(&mut Vec<u8>),
) -> Vec<u8> {
    let mut hash = None;
    let mut changed = |found: &str, data: &mut Vec<u8>| {
        if found == name {
            change(data);
            hash = Some(blake3::hash(data).to_hex().to_string());
        }
    };
    // The attachments come first, so that a first pass finds the hash.
    let edited = rewritten(
        bytes,
        &mut Edit {
            message: &mut |_, _| true,
            metadata: &mut |_| {},
            attachment: &mut changed,
        },
    );
    let hash = hash.expect("an attachment of that name");
    if !rehash {
        return edited;
    }
    rewritten(
        &edited,
        &mut Edit {
            message: &mut |_, _| true,
            metadata: &mut |pairs| {
                pairs
                    .insert(format!("blake3 {name}"), hash.clone())
                    .expect("it was there");
            },
            attachment: &mut |_, _| {},
        },
    )
}

/// The file written anew, as an honest MCAP tool would, with changes.
pub fn rewritten(bytes: &[u8], edit: &mut Edit<'_>) -> Vec<u8> {
    rewritten_by_record(bytes, Some(edit), &mut |_| {})
}

/// Rewritten with records changed in any way, before anything else is.
pub fn with_records(bytes: &[u8], change: &mut dyn FnMut(&mut Record<'_>)) -> Vec<u8> {
    rewritten_by_record(bytes, None, change)
}

fn rewritten_by_record(
    bytes: &[u8],
    mut edit: Option<&mut Edit<'_>>,
    change: &mut dyn FnMut(&mut Record<'_>),
) -> Vec<u8> {
    let mut out = Vec::new();
    let mut writer = WriteOptions::new()
        .library("sulcus test editor")
        .compression(Some(Compression::Lz4))
        .chunk_size(Some(64 << 10))
        .create(std::io::Cursor::new(&mut out))
        .unwrap();
    let mut topics = BTreeMap::new();
    for record in mcap::read::ChunkFlattener::new(bytes).unwrap() {
        let mut record = record.unwrap();
        change(&mut record);
        match record {
            Record::Schema { header, data } => {
                writer
                    .add_schema_with_id(header.id, &header.name, &header.encoding, &data)
                    .unwrap();
            }
            Record::Channel(c) => {
                writer
                    .add_channel_with_id(
                        c.id,
                        c.schema_id,
                        &c.topic,
                        &c.message_encoding,
                        &c.metadata,
                    )
                    .unwrap();
                let is_sealed = is_sealed(&c.topic, &c.message_encoding);
                topics.insert(c.id, (c.topic, is_sealed));
            }
            Record::Message { header, data } => {
                let Some(edit) = &mut edit else {
                    writer.write_to_known_channel(&header, &data).unwrap();
                    continue;
                };
                let (topic, is_sealed) = &topics[&header.channel_id];
                let (mut bytes, samples) = if *is_sealed {
                    let message = ExactRow::decode(&data[..]).unwrap();
                    (message.row, message.samples)
                } else {
                    (data.into_owned(), Vec::new())
                };
                if (edit.message)(topic, &mut bytes) {
                    let bytes = if *is_sealed {
                        let row = bytes;
                        ExactRow { row, samples }.encode_to_vec()
                    } else {
                        bytes
                    };
                    writer
                        .write_to_known_channel(&MessageHeader { ..header }, &bytes)
                        .unwrap();
                }
            }
            Record::Attachment { header, data, .. } => {
                let mut data = data.into_owned();
                if let Some(edit) = &mut edit {
                    (edit.attachment)(&header.name, &mut data);
                }
                writer
                    .attach(&Attachment {
                        log_time: header.log_time,
                        create_time: header.create_time,
                        name: header.name,
                        media_type: header.media_type,
                        data: data.into(),
                    })
                    .unwrap();
            }
            Record::Metadata(mut metadata) => {
                if let Some(edit) = &mut edit {
                    (edit.metadata)(&mut metadata.metadata);
                }
                writer.write_metadata(&metadata).unwrap();
            }
            Record::DataEnd(_) => break,
            _ => {}
        }
    }
    writer.finish().unwrap();
    drop(writer);
    out
}

/// Rewritten with changed messages only.
pub fn with_messages(bytes: &[u8], mut message: impl FnMut(&str, &mut Vec<u8>) -> bool) -> Vec<u8> {
    rewritten(
        bytes,
        &mut Edit {
            message: &mut message,
            metadata: &mut |_| {},
            attachment: &mut |_, _| {},
        },
    )
}

/// Where the records of a kind are, byte for byte, without a tool: each one's frame says where it ends.
pub fn records_of(bytes: &[u8], opcode: u8) -> Vec<std::ops::Range<usize>> {
    let mut found = Vec::new();
    let mut at = mcap::MAGIC.len();
    while at + mcap::MAGIC.len() < bytes.len() {
        let length = u64::from_le_bytes(bytes[at + 1..at + 9].try_into().unwrap()) as usize;
        if bytes[at] == opcode {
            found.push(at..at + 9 + length);
        }
        at += 9 + length;
    }
    found
}

/// Where the chunks are that hold nothing but what viewers read, by the file's index.
pub fn view_chunks(bytes: &[u8]) -> Vec<std::ops::Range<usize>> {
    let summary = mcap::Summary::read(bytes).unwrap().unwrap();
    let exact = |id: &u16| {
        let topic = &summary.channels[id].topic;
        topic.starts_with("/exact") || topic == "/events"
    };
    let chunks = summary.chunk_indexes.iter().filter(|chunk| {
        let mut ids = chunk.message_index_offsets.keys();
        ids.len() > 0 && !ids.any(exact)
    });
    chunks
        .map(|chunk| {
            let start = chunk.chunk_start_offset as usize;
            start..start + chunk.chunk_length as usize
        })
        .collect()
}
