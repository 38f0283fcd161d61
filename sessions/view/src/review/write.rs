//! File of a review, written by seconds.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::path::{Path, PathBuf};

use rerun::RecordingStream;

use super::begin::{begin, colour_of, mesh};
use super::entity::entity;
use super::layout;
use super::patches::Patches;
use super::picture::{
    Arrow, FramePicture, Label, Lane, Moment, Numbers, PartKind, PartPicture, ReviewPicture, Weight,
};
use super::waiting::{Arrows, Lines, Poses, Series, Times, Words};
use crate::error::{Refusal, ViewError};

/// Time of the session whose rows are sent together, nanoseconds.
const TOGETHER_NS: i64 = 1_000_000_000;
/// Colour of the total force on a tool, sRGB.
pub(crate) const PUSH: [u8; 3] = [255, 220, 60];

/// File for the viewer that is being written. It takes one time of the session after the other, and sends the rows of a
/// second together as columns. Lengths are in millimetres.
///
/// | entity | rows | content |
/// |---|---|---|
/// | `/mouth/teeth/*`, `/mouth/jaw/*` | one, constant | meshes |
/// | `/mouth/gingiva/*`, `/mouth/tongue/*` | one, constant | meshes of parts that never moved |
/// | `/mouth/gingiva/*/*`, `/mouth/tongue/*/*` | one for each new shape | patches of the meshes of parts that moved: vertices and normals |
/// | `/tools/*` | one a frame | graphic tool, the instrument |
/// | `/hands/*`, `/offsets/*` | one a frame | haptic tool, if the hand is apart from the instrument, and a line between the tips |
/// | `/contacts/*`, `/forces/on_*` | one a frame | forces on the tool: of each contact, and the total with newtons |
/// | `/close_up` | one a frame | frame of the close-up, which follows the tip |
/// | `/plots/*` | one a tick | numbers |
/// | `/lanes/*` | one a change | site, zone of force, visibility of the target |
/// | `/labels/sites` | one a change | texts at the sites on the tip's side of its tooth |
/// | `/events` | one for each event | log |
pub struct ReviewFile {
    path: PathBuf,
    stream: RecordingStream,
    picture: ReviewPicture,
    began: Option<Moment>,
    last: Option<Moment>,
    sent_ns: i64,
    force: Series,
    torque: Series,
    depth: Series,
    called: Series,
    floor: Series,
    work: Series,
    tools: Vec<Poses>,
    hands: Vec<Poses>,
    offsets: Vec<Lines>,
    pushes: Vec<Arrows>,
    contacts: Vec<Arrows>,
    sites: Words,
    close_up: Poses,
    /// Patches of each part that has moved.
    patches: BTreeMap<usize, Patches>,
    events: (Times, Vec<String>, Vec<&'static str>),
    lanes: BTreeMap<Lane, (Times, Vec<String>)>,
}

impl std::fmt::Debug for ReviewFile {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("ReviewFile")
            .field("path", &self.path)
            .field("last", &self.last)
            .finish_non_exhaustive()
    }
}

impl ReviewFile {
    /// Begins the file with the constant part and the layout.
    ///
    /// # Errors
    /// Lists differ in length, or the file cannot be written.
    pub fn create(path: &Path, picture: ReviewPicture) -> Result<Self, ViewError> {
        picture.fits()?;
        let failed = |source| ViewError::Write {
            file: path.to_owned(),
            source,
        };
        let stream = begin(path, &picture).map_err(failed)?;
        let named = |root: &str| -> Vec<String> {
            let names = picture.tools.iter().map(|tool| entity(root, &tool.name));
            names.collect()
        };
        let tools = picture.tools.len();
        Ok(Self {
            path: path.to_owned(),
            stream,
            began: None,
            last: None,
            sent_ns: 0,
            force: Series::new("/plots/force", tools),
            torque: Series::new("/plots/torque", tools),
            depth: Series::new("/plots/depth", 2),
            called: Series::new("/plots/depth/called", 1),
            floor: Series::new("/plots/floor_force", 1),
            work: Series::new("/plots/work", picture.work.len()),
            tools: named("/tools").into_iter().map(Poses::new).collect(),
            hands: named("/hands").into_iter().map(Poses::new).collect(),
            offsets: named("/offsets").into_iter().map(Lines::new).collect(),
            pushes: picture
                .tools
                .iter()
                .map(|tool| Arrows::new(entity("/forces", &format!("on {}", tool.name)), true))
                .collect(),
            contacts: named("/contacts")
                .into_iter()
                .map(|path| Arrows::new(path, false))
                .collect(),
            sites: Words::new(layout::SITES.into()),
            close_up: Poses::new(layout::CLOSE_UP.into()),
            patches: BTreeMap::new(),
            events: (Times::default(), Vec::new(), Vec::new()),
            lanes: BTreeMap::new(),
            picture,
        })
    }

    /// Takes the numbers of a tick. Times come in order.
    ///
    /// # Errors
    /// The lists do not match the picture, or the file cannot be written.
    pub fn tick(&mut self, at: Moment, numbers: &Numbers) -> Result<(), ViewError> {
        let tools = self.picture.tools.len();
        for (field, found, expected) in [
            ("force_n", numbers.force_n.len(), tools),
            ("torque_nmm", numbers.torque_nmm.len(), tools),
            ("work", numbers.work.len(), self.picture.work.len()),
        ] {
            fit("tick", field, found, expected)?;
        }
        let began = *self.began.get_or_insert(at);
        if at.session_ns - began.session_ns - self.sent_ns >= TOGETHER_NS {
            self.sent_ns = at.session_ns - began.session_ns;
            self.send()?;
        }
        self.last = Some(at);
        self.force.push(at, &numbers.force_n);
        self.torque.push(at, &numbers.torque_nmm);
        self.depth
            .push(at, &[numbers.depth_mm, numbers.prescribed_mm]);
        self.floor.push(at, &[numbers.floor_n]);
        self.work.push(at, &numbers.work);
        Ok(())
    }

    /// Takes a frame.
    ///
    /// # Errors
    /// The number of tools differs from the picture.
    pub fn frame(&mut self, at: Moment, frame: &FramePicture) -> Result<(), ViewError> {
        let tools = self.tools.len();
        fit("frame", "tools", frame.tools.len(), tools)?;
        fit("frame", "contacts", frame.contacts.len(), tools)?;
        let scale = self.picture.arrow_mm_per_n;
        for (k, tool) in frame.tools.iter().enumerate() {
            let graphic = tool.as_ref().map(|tool| &tool.graphic);
            let haptic = tool.as_ref().and_then(|tool| tool.haptic.as_ref());
            self.tools[k].push(at, graphic);
            self.hands[k].push(at, haptic);
            let line = tool.as_ref().filter(|tool| tool.haptic.is_some());
            self.offsets[k].push(at, line.map(|tool| tool.tips));
            let push = tool.as_ref().and_then(|tool| tool.push);
            let arrow = push.iter().map(|push| {
                let size = push.force_n.iter().map(|x| x * x).sum::<f32>().sqrt();
                let colour = rerun::Color::from_rgb(PUSH[0], PUSH[1], PUSH[2]);
                let vector = push.force_n.map(|x| x * scale);
                (push.at, vector, colour, format!("{size:.2} N"))
            });
            self.pushes[k].push(at, arrow);
        }
        for (waiting, contacts) in self.contacts.iter_mut().zip(&frame.contacts) {
            let arrows = contacts.iter().map(|arrow: &Arrow| {
                let [r, g, b] = colour_of(arrow.by);
                let colour = rerun::Color::from_rgb(r, g, b);
                let vector = arrow.force_n.map(|x| x * scale);
                (arrow.at, vector, colour, String::new())
            });
            waiting.push(at, arrows);
        }
        self.close_up.push(at, Some(&frame.close_up));
        Ok(())
    }

    /// Takes the shape of a part that is not at rest, or has just come to rest: its vertices, world axes, mm. A part is
    /// at rest until its first shape. A shape follows the tick of the same time.
    ///
    /// # Errors
    /// There is no such part, it does not yield, or the number of vertices differs.
    pub fn part(
        &mut self,
        at: Moment,
        part: usize,
        vertices: &[[f32; 3]],
    ) -> Result<(), ViewError> {
        let Some(of) = self.picture.parts.get(part).filter(|part| part.yields) else {
            return fit(&format!("part {part}"), "number of parts that yield", 0, 1);
        };
        fit(&of.name, "vertices", vertices.len(), of.mesh.vertices.len())?;
        let patches = match self.patches.entry(part) {
            Entry::Occupied(there) => there.into_mut(),
            Entry::Vacant(first) => {
                let mut patches = Patches::new(&entity(of.kind.folder(), &of.name), &of.mesh);
                let begun = patches.begin(&self.stream, &of.mesh);
                begun.map_err(|source| ViewError::Write {
                    file: self.path.clone(),
                    source,
                })?;
                if let Some(began) = self.began.filter(|began| *began < at) {
                    patches.push(began, &of.mesh.vertices);
                }
                first.insert(patches)
            }
        };
        patches.push(at, vertices);
        Ok(())
    }

    /// Sets the texts at the sites in the close-up from this time on.
    pub fn sites(&mut self, at: Moment, labels: &[Label]) {
        self.sites.push(at, labels);
    }

    /// Adds a line of the log.
    pub fn event(&mut self, at: Moment, weight: Weight, text: &str) {
        let level = match weight {
            Weight::Info => rerun::TextLogLevel::INFO,
            Weight::Warning => rerun::TextLogLevel::WARN,
            Weight::Error => rerun::TextLogLevel::ERROR,
        };
        self.events.0.push(at);
        self.events.1.push(text.to_owned());
        self.events.2.push(level);
    }

    /// Adds a called depth, mm.
    pub fn called(&mut self, at: Moment, depth_mm: f64) {
        self.called.push(at, &[depth_mm]);
    }

    /// Sets the state of a lane from this time on; an empty text for no state.
    pub fn state(&mut self, at: Moment, lane: Lane, state: &str) {
        let (times, states) = self.lanes.entry(lane).or_default();
        times.push(at);
        states.push(state.to_owned());
    }

    /// Sends the rest and closes the file; number of rows with a time, by entity.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn finish(mut self) -> Result<BTreeMap<String, u64>, ViewError> {
        self.bounds()?;
        self.send()?;
        self.unmoved().map_err(|source| self.failed(source))?;
        let failed = |error| self.failed(error);
        self.stream
            .flush_blocking()
            .map_err(|error| failed(Refusal::from(error)))?;
        let mut rows = BTreeMap::new();
        let mut add = |path: &str, times: &Times| {
            if times.sent() > 0 {
                rows.insert(path.to_owned(), times.sent());
            }
        };
        for series in [
            &self.force,
            &self.torque,
            &self.depth,
            &self.called,
            &self.floor,
            &self.work,
        ] {
            add(&series.path, &series.times);
        }
        let close_up = std::slice::from_ref(&self.close_up);
        for poses in self.tools.iter().chain(&self.hands).chain(close_up) {
            add(&poses.path, &poses.times);
        }
        for lines in &self.offsets {
            add(&lines.path, &lines.times);
        }
        for arrows in self.pushes.iter().chain(&self.contacts) {
            add(&arrows.path, &arrows.times);
        }
        for (path, times) in self.patches.values().flat_map(Patches::times) {
            add(path, times);
        }
        add(layout::EVENTS, &self.events.0);
        add(&self.sites.path, &self.sites.times);
        for (lane, (times, _)) in &self.lanes {
            add(lane.path(), times);
        }
        Ok(rows)
    }

    fn failed(&self, source: Refusal) -> ViewError {
        ViewError::Write {
            file: self.path.clone(),
            source,
        }
    }

    fn send(&mut self) -> Result<(), ViewError> {
        self.send_all().map_err(|source| self.failed(source))
    }

    fn send_all(&mut self) -> Result<(), Refusal> {
        let stream = &self.stream;
        for series in [
            &mut self.force,
            &mut self.torque,
            &mut self.depth,
            &mut self.called,
            &mut self.floor,
            &mut self.work,
        ] {
            series.send(stream)?;
        }
        let close_up = std::slice::from_mut(&mut self.close_up);
        let poses = self.tools.iter_mut().chain(&mut self.hands);
        for poses in poses.chain(close_up) {
            poses.send(stream)?;
        }
        for lines in &mut self.offsets {
            lines.send(stream)?;
        }
        for arrows in self.pushes.iter_mut().chain(&mut self.contacts) {
            arrows.send(stream)?;
        }
        for patches in self.patches.values_mut() {
            patches.send(stream)?;
        }
        self.sites.send(stream)?;
        let (times, texts, levels) = &mut self.events;
        if times.len() > 0 {
            let columns = rerun::TextLog::update_fields()
                .with_many_text(texts.drain(..))
                .with_many_level(levels.drain(..))
                .columns_of_unit_batches()?;
            times.send(stream, layout::EVENTS, columns)?;
        }
        for (lane, (times, states)) in &mut self.lanes {
            if times.len() > 0 {
                let columns = rerun::StateChange::update_fields()
                    .with_state(states.drain(..))
                    .columns_of_unit_batches()?;
                times.send(stream, lane.path(), columns)?;
            }
        }
        Ok(())
    }

    /// Writes the parts that have never moved.
    fn unmoved(&self) -> Result<(), Refusal> {
        let parts = self.picture.parts.iter().enumerate();
        let unmoved = parts.filter(|(k, _)| !self.patches.contains_key(k));
        unmoved
            .into_iter()
            .try_for_each(|(_, part)| at_rest(&self.stream, part))
    }

    /// Adds lines over the whole plot at the reading band and at the force of trauma.
    fn bounds(&mut self) -> Result<(), ViewError> {
        let (Some(first), Some(last)) = (self.began, self.last) else {
            return Ok(());
        };
        let mut lines = Vec::new();
        lines.extend(self.picture.reading_band_n.map(|b| ("band", b.to_vec())));
        lines.extend(self.picture.trauma_n.map(|t| ("trauma", vec![t])));
        for (name, values) in lines {
            let mut series = Series::new(&format!("/plots/floor_force/{name}"), values.len());
            series.push(first, &values);
            series.push(last, &values);
            series
                .send(&self.stream)
                .map_err(|source| self.failed(source))?;
        }
        Ok(())
    }
}

/// Writes a part that does not move.
pub(crate) fn at_rest(stream: &RecordingStream, part: &PartPicture) -> Result<(), Refusal> {
    let path = entity(part.kind.folder(), &part.name);
    // A part that may be transparent takes its tint from the view.
    let tint = (part.kind != PartKind::Gingiva).then_some([255; 4]);
    stream.log_static(path, &mesh(&part.mesh, tint))?;
    Ok(())
}

fn fit(part: &str, field: &'static str, found: usize, expected: usize) -> Result<(), ViewError> {
    if found == expected {
        return Ok(());
    }
    Err(ViewError::Fit {
        part: part.to_owned(),
        field,
        found,
        expected,
    })
}

impl ReviewPicture {
    fn fits(&self) -> Result<(), ViewError> {
        let tools = self.tools.iter().map(|tool| (&tool.name, &tool.mesh));
        for (name, mesh) in tools.chain(self.parts.iter().map(|part| (&part.name, &part.mesh))) {
            let vertices = mesh.vertices.len();
            let corner = mesh.triangles.iter().flatten().max();
            if let Some(&corner) = corner.filter(|&&corner| corner as usize >= vertices) {
                fit(
                    name,
                    "largest vertex index of a triangle, plus one",
                    corner as usize + 1,
                    vertices,
                )?;
            }
            if !mesh.vertex_colours.is_empty() {
                fit(name, "vertex_colours", mesh.vertex_colours.len(), vertices)?;
            }
        }
        if self.probe >= self.tools.len() {
            fit(
                "picture",
                "tools up to the probe",
                self.tools.len(),
                self.probe + 1,
            )?;
        }
        Ok(())
    }
}
