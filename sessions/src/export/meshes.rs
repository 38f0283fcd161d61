//! `meshes/`: meshes of the scene at chosen times.
//!
//! `rest/NAME` is an object at rest. `frames.csv` names the file of each part at each time: the file at rest, or
//! `TICK/NAME` for tools and for tissue that is touched or moves.

use std::io::Write as _;
use std::path::{Path, PathBuf};

use sulcus_core::{DisplayMesh, DisplaySkin, Pose, Scene, TickOutput, Vec3, Workspace};

use super::cells;
use super::error::{ExportError, create, create_folder};
use super::mesh_file::MeshFormat;
use super::options::ExportOptions;
use crate::record::channels::{is_held, paths};

pub(super) struct Meshes {
    folder: PathBuf,
    format: MeshFormat,
    list: PathBuf,
    csv: csv::Writer<std::io::BufWriter<std::fs::File>>,
    tools: Vec<String>,
    objects: Vec<String>,
    /// Skins, made when first needed, because making one is slow.
    skins: Vec<Option<DisplaySkin>>,
    /// Single times still to come, ascending.
    at_s: Vec<f64>,
    every_s: Option<f64>,
    next_s: f64,
    frames: u64,
    files: u64,
}

impl Meshes {
    pub fn create(
        folder: &Path,
        scene: &Scene,
        format: MeshFormat,
        options: &ExportOptions,
    ) -> Result<Self, ExportError> {
        let folder = folder.join("meshes");
        create_folder(&folder.join("rest"))?;
        let list = folder.join("frames.csv");
        let mut csv = csv::Writer::from_writer(create(&list)?);
        csv.write_record(["time_s", "tick", "part", "file"])
            .map_err(|source| ExportError::write(&list, source))?;
        let mut at_s = options.at_s.clone();
        at_s.sort_by(f64::total_cmp);
        let mut meshes = Self {
            folder,
            format,
            list,
            csv,
            tools: paths(scene.tools.iter().map(|tool| tool.name.as_str())),
            objects: paths(scene.objects.iter().map(|object| object.name.as_str())),
            skins: vec![None; scene.objects.len()],
            at_s,
            every_s: options.every_s,
            next_s: 0.0,
            frames: 0,
            files: 0,
        };
        for k in 0..scene.objects.len() {
            let mesh = &scene.objects[k].mesh;
            let name = meshes.file("rest", &meshes.objects[k]);
            meshes.write(&name, mesh, &mesh.vertices)?;
        }
        Ok(meshes)
    }

    fn file(&self, folder: &str, part: &str) -> String {
        format!("{folder}/{part}.{}", self.format.extension())
    }

    fn write(
        &mut self,
        name: &str,
        mesh: &DisplayMesh,
        vertices: &[[f32; 3]],
    ) -> Result<(), ExportError> {
        let path = self.folder.join(name);
        let mut out = create(&path)?;
        self.files += 1;
        self.format
            .write(&mut out, mesh, vertices)
            .and_then(|()| out.flush())
            .map_err(|source| ExportError::write(&path, source))
    }

    /// Whether the tick at this time is the first at or after a requested time.
    fn is_due(&mut self, seconds: f64) -> bool {
        // Times in a file are whole nanoseconds.
        let now = seconds + 1e-9;
        let single = self.at_s.iter().take_while(|at| **at <= now).count();
        self.at_s.drain(..single);
        let mut due = single > 0;
        if let Some(every) = self.every_s
            && now >= self.next_s
        {
            self.next_s = ((now / every).floor() + 1.0) * every;
            due = true;
        }
        due
    }

    pub fn tick(
        &mut self,
        seconds: f64,
        scene: &Scene,
        output: &TickOutput,
        shapes: &Workspace,
    ) -> Result<(), ExportError> {
        if !self.is_due(seconds) {
            return Ok(());
        }
        self.frames += 1;
        let own = output.tick.to_string();
        create_folder(&self.folder.join(&own))?;
        for (t, tool) in scene.tools.iter().enumerate() {
            let out = &output.tools[t];
            if is_held(out) {
                let name = self.file(&own, &self.tools[t]);
                self.write(&name, &tool.mesh, &posed(&tool.mesh, &out.graphic))?;
                self.say(seconds, output.tick, &self.tools[t].clone(), &name)?;
            }
        }
        for (k, object) in scene.objects.iter().enumerate() {
            let part = self.objects[k].clone();
            let name = if shapes.is_awake(k) {
                let skin = self.skins[k].get_or_insert_with(|| DisplaySkin::of(object));
                let vertices = deformed(&object.mesh, skin, &shapes.carriers_moved(scene, k));
                let name = self.file(&own, &part);
                self.write(&name, &object.mesh, &vertices)?;
                name
            } else {
                self.file("rest", &part)
            };
            self.say(seconds, output.tick, &part, &name)?;
        }
        Ok(())
    }

    fn say(&mut self, seconds: f64, tick: u64, part: &str, file: &str) -> Result<(), ExportError> {
        self.csv
            .write_record([
                &seconds.to_string(),
                &tick.to_string(),
                &*cells::text(part),
                file,
            ])
            .map_err(|source| ExportError::write(&self.list, source))
    }

    /// Closes the table; number of times and of files.
    pub fn finish(mut self) -> Result<(u64, u64), ExportError> {
        let flushed = self.csv.flush();
        flushed.map_err(|source| ExportError::write(&self.list, source))?;
        Ok((self.frames, self.files))
    }
}

/// Vertices of a tool's mesh at `world_from_tool`.
fn posed(mesh: &DisplayMesh, world_from_tool: &Pose) -> Vec<[f32; 3]> {
    let to_world = |v: &[f32; 3]| narrow(&world_from_tool.transform(&Vec3::from(v.map(f64::from))));
    mesh.vertices.iter().map(to_world).collect()
}

/// Vertices of a tissue's mesh, by the displacements `moved` of its carriers.
fn deformed(mesh: &DisplayMesh, skin: &DisplaySkin, moved: &[Vec3]) -> Vec<[f32; 3]> {
    let mut by = vec![Vec3::zeros(); mesh.vertices.len()];
    skin.displacements(moved, &mut by);
    let add = |(v, by): (&[f32; 3], &Vec3)| narrow(&(Vec3::from(v.map(f64::from)) + by));
    mesh.vertices.iter().zip(&by).map(add).collect()
}

fn narrow(v: &Vec3) -> [f32; 3] {
    [v.x as f32, v.y as f32, v.z as f32]
}
