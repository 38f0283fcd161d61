//! From a scene file to a [`Scene`]: meshes loaded or made, checked, turned into sphere trees
//! (or taken from the cache), put in place, validated.

use std::path::{Path, PathBuf};

use sulcus_core::math::exp_rotation;
use sulcus_core::tissue::TissueModel;
use sulcus_core::{Object, Pose, Scene, SceneError, SphereTree, Tool, Vec3};

use crate::build::{TreeBuildError, TreeOptions, build_tree};
use crate::cache;
use crate::check::{MeshError, check};
use crate::file::{self, FileError, ObjectEntry, ObjectKind, SceneFile, TissueEntry, ToolEntry, ToolKind};
use crate::load::{LoadError, Unit, load_stl};
use crate::mesh::TriMesh;
use crate::parametric::{Molar, Probe};

/// Text of the scene that is used when none is named.
pub const DEFAULT_SCENE: &str = include_str!("../../scenes/crown.toml");

const TOOTH_COLOUR: [u8; 4] = [238, 230, 208, 255];
const TOOL_COLOUR: [u8; 4] = [176, 182, 188, 255];

/// How to build, apart from what the scene file says.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BuildOptions {
    /// Directory of built trees; none builds every time.
    pub cache: Option<PathBuf>,
    /// Builds no tree deeper than this (contact levels follow), for quick tries and tests.
    pub deepest: Option<u8>,
}

impl BuildOptions {
    /// Uses the cache at its usual place.
    pub fn cached() -> Self {
        Self { cache: cache::default_cache_dir(), deepest: None }
    }
}

/// A scene ready to run.
#[derive(Clone, Debug, PartialEq)]
pub struct Compiled {
    /// The scene.
    pub scene: Scene,
    /// What is usable but probably not meant, a sentence each.
    pub warnings: Vec<String>,
    /// Hash of scene file and meshes, hexadecimal; also in the scene.
    pub source_hash: String,
}

/// Why there is no scene. One sentence each.
#[derive(Debug, thiserror::Error)]
pub enum BuildError {
    /// The scene file.
    #[error(transparent)]
    File(#[from] FileError),
    /// A mesh file cannot be read.
    #[error(transparent)]
    Load(#[from] LoadError),
    /// A mesh is not a solid.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// A tree cannot be built.
    #[error("{part}: {source}")]
    Tree {
        /// Tool or object.
        part: String,
        /// Why.
        source: TreeBuildError,
    },
    /// The parts do not make a scene.
    #[error("{}: {source}", file.display())]
    Scene {
        /// The scene file.
        file: PathBuf,
        /// Why.
        source: SceneError,
    },
    /// A tool waits inside something.
    #[error("{}: `park_mm` of tool `{tool}` is {depth_mm:.2} mm inside object `{object}`, expected a place outside everything", file.display())]
    ParkedInside {
        /// The scene file.
        file: PathBuf,
        /// The tool.
        tool: String,
        /// What it is inside of.
        object: String,
        /// How deep, millimetres.
        depth_mm: f64,
    },
}

/// Compiles a scene file. `progress` gets what is being done and how much of the whole is done.
///
/// # Errors
/// One sentence that names the file and what is wrong in it.
pub fn compile_file(
    path: &Path,
    options: &BuildOptions,
    progress: &dyn Fn(&str, f64),
) -> Result<Compiled, BuildError> {
    let (scene, text) = file::read(path)?;
    compile(&scene, &text, path, options, progress)
}

/// Compiles the scene that is used when none is named: a lower molar and a probe.
///
/// # Errors
/// Only if the program was built from a broken source.
pub fn compile_default(options: &BuildOptions, progress: &dyn Fn(&str, f64)) -> Result<Compiled, BuildError> {
    let path = Path::new("crown.toml");
    compile(&file::parse(DEFAULT_SCENE, path)?, DEFAULT_SCENE, path, options, progress)
}

/// The default scene, from the cache at its usual place where possible.
///
/// # Errors
/// Only if the program was built from a broken source.
pub fn default_scene() -> Result<Scene, BuildError> {
    Ok(compile_default(&BuildOptions::cached(), &|_, _| ())?.scene)
}

struct Compiler<'a> {
    path: &'a Path,
    options: &'a BuildOptions,
    progress: &'a dyn Fn(&str, f64),
    hasher: blake3::Hasher,
    warnings: Vec<String>,
    parts: usize,
    done: usize,
}

fn compile(
    source: &SceneFile,
    text: &str,
    path: &Path,
    options: &BuildOptions,
    progress: &dyn Fn(&str, f64),
) -> Result<Compiled, BuildError> {
    let mut hasher = blake3::Hasher::new();
    hasher.update(text.as_bytes());
    let parts = source.tools.len() + source.objects.len();
    let mut compiler = Compiler { path, options, progress, hasher, warnings: Vec::new(), parts, done: 0 };
    let mut tools = Vec::new();
    for entry in &source.tools {
        tools.push(compiler.tool(entry)?);
    }
    let mut objects = Vec::new();
    for entry in &source.objects {
        objects.push(compiler.object(entry)?);
    }
    let source_hash = compiler.hasher.finalize().to_hex().to_string();
    let mut warnings = compiler.warnings;
    if objects.is_empty() {
        warnings.push(format!("{}: there is no [[object]], so there is nothing to touch", path.display()));
    }
    let scene =
        Scene { name: source.name.clone(), source_hash: source_hash.clone(), params: source.params.clone(), tools, objects };
    scene.validate().map_err(|source| BuildError::Scene { file: path.to_owned(), source })?;
    parked_outside(&scene, path)?;
    progress("done", 1.0);
    Ok(Compiled { scene, warnings, source_hash })
}

impl Compiler<'_> {
    fn tool(&mut self, entry: &ToolEntry) -> Result<Tool, BuildError> {
        let part = format!("tool `{}`", entry.name);
        let (touching, display, working_point, tip, tip_axis, bands, alpha) = match entry.kind {
            Some(ToolKind::PeriodontalProbe) => {
                let probe: Probe = entry.probe.clone().unwrap_or_default();
                let (point, tip, axis) = (probe.working_point(), probe.tip(), probe.tip_axis());
                (probe.touching_mesh(), probe.display_mesh(), point, tip, axis, probe.bands(), ROD_ALPHA)
            }
            None => {
                let mesh = self.load(entry.mesh.as_deref(), entry.unit)?;
                let mm = |point: Option<[f64; 3]>| Vec3::from(point.unwrap_or_default()) * 1e-3;
                let axis = Vec3::from(entry.tip_axis.unwrap_or([0.0, 0.0, -1.0])).normalize();
                (mesh.clone(), mesh, mm(entry.working_point_mm), mm(entry.tip_mm), axis, Vec::new(), 0.3)
            }
        };
        let good_enough = if entry.kind.is_some() { 5e-6 } else { TreeOptions::default().good_enough };
        let wanted = TreeOptions { levels: entry.levels, alpha, good_enough, ..TreeOptions::default() };
        let (tree, level) = self.tree(&part, &touching, entry.level, wanted)?;
        let turn = Vec3::from(entry.park_rotation_deg).map(f64::to_radians);
        Ok(Tool {
            name: entry.name.clone(),
            tree,
            level,
            working_point,
            tip,
            tip_axis,
            stiffness_n_per_m: entry.stiffness_n_per_mm * 1e3,
            stiffness_nm_per_rad: entry.stiffness_nmm_per_rad * 1e-3,
            park: Pose::new(Vec3::from(entry.park_mm) * 1e-3, exp_rotation(&turn)),
            bands,
            mesh: display.to_display(TOOL_COLOUR),
        })
    }

    fn object(&mut self, entry: &ObjectEntry) -> Result<Object, BuildError> {
        let part = format!("object `{}`", entry.name);
        let mesh = match entry.kind {
            Some(ObjectKind::Molar) => entry.molar.clone().unwrap_or_else(Molar::default).mesh(),
            None => self.load(entry.mesh.as_deref(), entry.unit)?,
        };
        let wanted = TreeOptions { levels: entry.levels, ..TreeOptions::default() };
        let place = Vec3::from(entry.translate_mm) * 1e-3;
        // The tree is built where the mesh was drawn, so that the cache serves every place.
        let (tree, level) = self.tree(&part, &mesh, entry.level, wanted)?;
        let tree = moved(&tree, &place).map_err(|source| BuildError::Tree { part, source })?;
        let tissue = match entry.tissue {
            TissueEntry::Rigid => TissueModel::Rigid,
        };
        let mesh = mesh.placed(1.0, place).to_display(TOOTH_COLOUR);
        Ok(Object { name: entry.name.clone(), fdi: entry.fdi, tree, level, tissue, mesh })
    }

    fn load(&self, mesh: Option<&Path>, unit: Option<Unit>) -> Result<TriMesh, BuildError> {
        // The file was checked to name both.
        let file = self.path.parent().unwrap_or(Path::new("")).join(mesh.unwrap_or(Path::new("")));
        let mesh = load_stl(&file, unit.unwrap_or(Unit::Millimetre))?;
        check(&mesh, &file.display().to_string())?;
        Ok(mesh)
    }

    /// Builds or fetches a tree; also gives the contact level, no deeper than the tree.
    fn tree(
        &mut self,
        part: &str,
        mesh: &TriMesh,
        level: u8,
        mut wanted: TreeOptions,
    ) -> Result<(SphereTree, u8), BuildError> {
        check(mesh, part)?;
        mesh.hash_into(&mut self.hasher);
        wanted.levels = wanted.levels.min(self.options.deepest.unwrap_or(u8::MAX)).max(1);
        // Ten samples for each sphere of the finest level.
        wanted.samples = wanted.samples.max(10 * 8_usize.pow(u32::from(wanted.levels)));
        let key = cache::key(mesh, &wanted);
        let (done, parts) = (self.done as f64, self.parts as f64);
        self.done += 1;
        let kept = self.options.cache.as_deref().and_then(|dir| cache::load(dir, &key));
        let tree = match kept {
            Some(tree) => {
                (self.progress)(part, (done + 1.0) / parts);
                tree
            }
            None => {
                let step = |stage: &str, share: f64| (self.progress)(&format!("{part}: {stage}"), (done + share) / parts);
                let tree = build_tree(mesh, &wanted, &step)
                    .map_err(|source| BuildError::Tree { part: part.to_owned(), source })?;
                if let Some(dir) = self.options.cache.as_deref() {
                    if let Err(error) = cache::store(dir, &key, &tree) {
                        self.warnings.push(format!(
                            "{}: cannot keep the built tree there ({error}), so it is built again next time",
                            dir.display()
                        ));
                    }
                }
                tree
            }
        };
        Ok((tree, level.min(wanted.levels)))
    }
}

/// Rods are shared out along their axis, not around it.
const ROD_ALPHA: f64 = 0.02;

fn moved(tree: &SphereTree, by: &Vec3) -> Result<SphereTree, TreeBuildError> {
    let nodes = tree.nodes().iter().map(|node| {
        let mut node = *node;
        node.centre += by;
        node
    });
    Ok(SphereTree::with_bounds(nodes.collect())?)
}

/// Every tool must wait outside of everything, or its first way would begin in penetration.
fn parked_outside(scene: &Scene, path: &Path) -> Result<(), BuildError> {
    for tool in &scene.tools {
        let spheres: Vec<_> =
            tool.tree.shape_at(tool.level).map(|(_, node)| (tool.park.transform(&node.centre), node.contact_radius)).collect();
        for object in &scene.objects {
            let mut depth = 0.0;
            for (_, node) in object.tree.shape_at(object.level) {
                for (centre, radius) in &spheres {
                    let gap = (centre - node.centre).norm() - radius - node.contact_radius;
                    depth = if -gap > depth { -gap } else { depth };
                }
            }
            if depth > 0.0 {
                return Err(BuildError::ParkedInside {
                    file: path.to_owned(),
                    tool: tool.name.clone(),
                    object: object.name.clone(),
                    depth_mm: depth * 1e3,
                });
            }
        }
    }
    Ok(())
}
