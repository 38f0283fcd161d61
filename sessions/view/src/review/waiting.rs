//! Rows that wait until they are sent as columns.

use rerun::{RecordingStream, SerializedComponentColumn, TimeColumn};

use super::picture::Moment;
use crate::error::Refusal;

/// Timeline of the session's time.
pub(crate) const SESSION: &str = "session";
/// Timeline of ticks.
pub(crate) const TICK: &str = "tick";

/// Times of an entity's waiting rows, and the number of sent rows.
#[derive(Debug, Default)]
pub(crate) struct Times {
    ticks: Vec<i64>,
    nanoseconds: Vec<i64>,
    sent: u64,
    /// Whether the timeline of ticks is left out.
    without_ticks: bool,
}

impl Times {
    /// Times on the timeline of the session alone: a row on its own is a tenth shorter.
    pub fn without_ticks() -> Self {
        Self {
            without_ticks: true,
            ..Self::default()
        }
    }

    pub fn push(&mut self, at: Moment) {
        if !self.without_ticks {
            self.ticks.push(at.tick);
        }
        self.nanoseconds.push(at.session_ns);
    }

    pub fn len(&self) -> usize {
        self.nanoseconds.len()
    }

    /// Number of sent rows.
    pub fn sent(&self) -> u64 {
        self.sent
    }

    /// Sends the waiting rows of an entity with these columns, which have one entry per row.
    pub fn send(
        &mut self,
        stream: &RecordingStream,
        path: &str,
        columns: impl IntoIterator<Item = SerializedComponentColumn>,
    ) -> Result<(), Refusal> {
        self.sent += self.nanoseconds.len() as u64;
        let session = TimeColumn::new_duration_nanos(SESSION, self.nanoseconds.drain(..));
        let ticks =
            (!self.without_ticks).then(|| TimeColumn::new_sequence(TICK, self.ticks.drain(..)));
        let times = std::iter::once(session).chain(ticks);
        stream.send_columns(path, times, columns)?;
        Ok(())
    }
}

/// Rows of numbers for a plot, equally many in each row.
#[derive(Debug)]
pub(crate) struct Series {
    pub path: String,
    pub times: Times,
    width: usize,
    values: Vec<f64>,
}

impl Series {
    pub fn new(path: &str, width: usize) -> Self {
        Self {
            path: path.to_owned(),
            times: Times::default(),
            width,
            values: Vec::new(),
        }
    }

    pub fn push(&mut self, at: Moment, values: &[f64]) {
        debug_assert_eq!(values.len(), self.width);
        self.times.push(at);
        self.values.extend_from_slice(values);
    }

    pub fn send(&mut self, stream: &RecordingStream) -> Result<(), Refusal> {
        let rows = self.times.len();
        if rows == 0 || self.width == 0 {
            return Ok(());
        }
        let scalars = rerun::Scalars::new(std::mem::take(&mut self.values));
        let columns = scalars.columns(std::iter::repeat_n(self.width, rows))?;
        self.times.send(stream, &self.path, columns)
    }
}

/// Scale of an absent thing. With scale 0 the viewer would find no transform.
const NOTHING: f32 = 1e-6;
/// Number of rows with a scale after a thing has come back, where present things have none. A viewer that misses rows
/// gets one of them.
const BACK: u8 = 10;

/// Poses of one entity. An absent thing has a tiny scale.
#[derive(Debug)]
pub(crate) struct Poses {
    pub path: String,
    pub times: Times,
    at: Vec<[f32; 3]>,
    turned: Vec<[f32; 4]>,
    size: Vec<f32>,
    /// Rows with a scale to come; `None`: every row has one.
    sizes_left: Option<u8>,
}

impl Poses {
    pub fn new(path: String) -> Self {
        Self {
            path,
            times: Times::default(),
            at: Vec::new(),
            turned: Vec::new(),
            size: Vec::new(),
            sizes_left: None,
        }
    }

    /// Poses that are sent one by one: on the timeline of the session alone, and without a scale while the thing is
    /// present.
    pub fn lean(path: String) -> Self {
        Self {
            times: Times::without_ticks(),
            sizes_left: Some(1),
            ..Self::new(path)
        }
    }

    pub fn push(&mut self, at: Moment, standing: Option<&super::picture::Standing>) {
        self.times.push(at);
        self.at.push(standing.map_or([0.0; 3], |s| s.at));
        let upright = [0.0, 0.0, 0.0, 1.0];
        self.turned.push(standing.map_or(upright, |s| s.turned));
        self.size
            .push(if standing.is_some() { 1.0 } else { NOTHING });
    }

    pub fn send(&mut self, stream: &RecordingStream) -> Result<(), Refusal> {
        if self.times.len() == 0 {
            return Ok(());
        }
        let columns = rerun::Transform3D::update_fields()
            .with_many_translation(self.at.drain(..))
            .with_many_quaternion(self.turned.drain(..).map(rerun::Quaternion::from_xyzw));
        let is_absent = self.size.contains(&NOTHING);
        let sizes = self.size.drain(..).map(rerun::Scale3D::uniform);
        let columns = match &mut self.sizes_left {
            Some(0) if !is_absent => {
                drop(sizes);
                columns
            }
            left => {
                if let Some(left) = left {
                    *left = if is_absent { BACK } else { *left - 1 };
                }
                columns.with_many_scale(sizes)
            }
        };
        let columns = columns.columns_of_unit_batches()?;
        self.times.send(stream, &self.path, columns)
    }
}

/// Arrows of one entity, any number in a row, with or without texts.
#[derive(Debug)]
pub(crate) struct Arrows {
    pub path: String,
    pub times: Times,
    lengths: Vec<usize>,
    origins: Vec<[f32; 3]>,
    vectors: Vec<[f32; 3]>,
    colours: Vec<rerun::Color>,
    labels: Option<Vec<String>>,
}

impl Arrows {
    pub fn new(path: String, labelled: bool) -> Self {
        Self {
            path,
            times: Times::default(),
            lengths: Vec::new(),
            origins: Vec::new(),
            vectors: Vec::new(),
            colours: Vec::new(),
            labels: labelled.then(Vec::new),
        }
    }

    /// Adds a row of arrows: origin, vector (mm), colour and text.
    pub fn push(
        &mut self,
        at: Moment,
        arrows: impl Iterator<Item = ([f32; 3], [f32; 3], rerun::Color, String)>,
    ) {
        let before = self.origins.len();
        for (origin, vector, colour, label) in arrows {
            self.origins.push(origin);
            self.vectors.push(vector);
            self.colours.push(colour);
            if let Some(labels) = &mut self.labels {
                labels.push(label);
            }
        }
        self.times.push(at);
        self.lengths.push(self.origins.len() - before);
    }

    pub fn send(&mut self, stream: &RecordingStream) -> Result<(), Refusal> {
        if self.times.len() == 0 {
            return Ok(());
        }
        let arrows = rerun::Arrows3D::update_fields()
            .with_vectors(self.vectors.drain(..))
            .with_origins(self.origins.drain(..))
            .with_colors(self.colours.drain(..));
        let arrows = match &mut self.labels {
            Some(labels) => arrows.with_labels(labels.drain(..)),
            None => arrows,
        };
        let lengths = std::mem::take(&mut self.lengths);
        self.times
            .send(stream, &self.path, arrows.columns(lengths)?)
    }
}

/// Line of one entity between two points, or no line, in each row.
#[derive(Debug)]
pub(crate) struct Lines {
    pub path: String,
    pub times: Times,
    lengths: Vec<usize>,
    strips: Vec<[[f32; 3]; 2]>,
}

impl Lines {
    pub fn new(path: String) -> Self {
        Self {
            path,
            times: Times::default(),
            lengths: Vec::new(),
            strips: Vec::new(),
        }
    }

    pub fn push(&mut self, at: Moment, line: Option<[[f32; 3]; 2]>) {
        self.times.push(at);
        self.lengths.push(usize::from(line.is_some()));
        self.strips.extend(line);
    }

    pub fn send(&mut self, stream: &RecordingStream) -> Result<(), Refusal> {
        if self.times.len() == 0 {
            return Ok(());
        }
        let columns = rerun::LineStrips3D::update_fields()
            .with_strips(self.strips.drain(..))
            .columns(std::mem::take(&mut self.lengths))?;
        self.times.send(stream, &self.path, columns)
    }
}

/// Texts at places, any number in a row.
#[derive(Debug)]
pub(crate) struct Words {
    pub path: String,
    pub times: Times,
    lengths: Vec<usize>,
    at: Vec<[f32; 3]>,
    texts: Vec<String>,
}

impl Words {
    pub fn new(path: String) -> Self {
        Self {
            path,
            times: Times::default(),
            lengths: Vec::new(),
            at: Vec::new(),
            texts: Vec::new(),
        }
    }

    pub fn push(&mut self, at: Moment, labels: &[super::picture::Label]) {
        self.times.push(at);
        self.lengths.push(labels.len());
        self.at.extend(labels.iter().map(|label| label.at));
        self.texts
            .extend(labels.iter().map(|label| label.text.clone()));
    }

    pub fn send(&mut self, stream: &RecordingStream) -> Result<(), Refusal> {
        if self.times.len() == 0 {
            return Ok(());
        }
        let columns = rerun::Points3D::update_fields()
            .with_positions(self.at.drain(..))
            .with_labels(self.texts.drain(..))
            .columns(std::mem::take(&mut self.lengths))?;
        self.times.send(stream, &self.path, columns)
    }
}
