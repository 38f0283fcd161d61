//! Tools and objects of a scene, one at a time: mesh, check, tree or cached tree, place.

use std::path::{Path, PathBuf};

use sulcus_core::math::exp_rotation;
use sulcus_core::tissue::TissueModel;
use sulcus_core::tissue::gingiva::ToothFrame;
use sulcus_core::{Object, Pose, SphereTree, Tool, Vec3};
use sulcus_program::PathText;

use crate::anatomy::mesh_tissue::{POCKET_PROXIMAL_DEG, Surrounding, charted, model};
use crate::anatomy::{MolarCollar, Tooth};
use crate::cache;
use crate::compile::error::BuildError;
use crate::compile::family;
use crate::compile::options::BuildOptions;
use crate::compile::printed::{printed_gingiva, printed_skeleton};
use crate::file::{ObjectEntry, ObjectKind, TissueEntry, ToolEntry, ToolKind};
use crate::instruments::{Mirror, Probe};
use crate::mesh::TriMesh;
use crate::mesh::check::check;
use crate::mesh::distance::MeshDistance;
use crate::mesh::solid::{Reading, read_solid};
use crate::organ::organ;
use crate::organ::skeleton::skeleton;
use crate::organ::springs::FittedSprings;
use crate::tree::build::{TreeBuildError, TreeOptions, build_tree, build_weighted};
use crate::tree::carry::carriers;
use crate::tree::filled::check_filled;

pub(crate) const TOOTH_COLOUR: [u8; 4] = [238, 230, 208, 255];
const TONGUE_COLOUR: [u8; 4] = [205, 110, 115, 255];
pub(crate) const GINGIVA_COLOUR: [u8; 4] = [214, 126, 128, 255];
const TOOL_COLOUR: [u8; 4] = [176, 182, 188, 255];

/// State that the parts of one scene share during compilation.
pub(crate) struct Compiler<'a> {
    pub path: &'a Path,
    pub options: &'a BuildOptions,
    pub progress: &'a dyn Fn(&str, f64),
    pub hasher: blake3::Hasher,
    pub warnings: Vec<String>,
    /// Whether the compiled scene may be cached. It must depend on its own text alone, and no warning may concern
    /// this run only.
    pub cacheable: bool,
    pub parts: usize,
    pub done: usize,
}

impl Compiler<'_> {
    /// Returns the path of a `file` that the scene file names, relative to the scene file.
    ///
    /// Every input file of a scene is passed to this method.
    pub(crate) fn beside(&mut self, file: &Path) -> PathBuf {
        self.cacheable = false;
        self.path.parent().unwrap_or(Path::new("")).join(file)
    }

    pub fn tool(&mut self, entry: &ToolEntry) -> Result<Tool, BuildError> {
        // The marking on it follows its name.
        let written = match entry.kind {
            Some(ToolKind::PeriodontalProbe) => {
                let marking = entry.probe.as_ref().map(|probe| probe.marking);
                format!(" ({})", marking.unwrap_or_default().name())
            }
            Some(ToolKind::MouthMirror) => {
                format!(" ({})", entry.mirror.clone().unwrap_or_default().name())
            }
            None => String::new(),
        };
        let part = format!("tool `{}`{written}", entry.name);
        let (touching, display, working_point, tip, tip_axis, bands) = match entry.kind {
            Some(ToolKind::PeriodontalProbe) => {
                let probe: Probe = entry.probe.clone().unwrap_or_default();
                let (point, tip, axis) = (probe.working_point(), probe.tip(), probe.tip_axis());
                (
                    probe.touching_mesh(),
                    probe.display(TOOL_COLOUR),
                    point,
                    tip,
                    axis,
                    probe.bands(),
                )
            }
            Some(ToolKind::MouthMirror) => {
                let mirror: Mirror = entry.mirror.clone().unwrap_or_default();
                let (point, tip, axis) = (mirror.working_point(), mirror.tip(), mirror.tip_axis());
                (
                    mirror.touching_mesh(),
                    mirror.display_mesh().to_display(TOOL_COLOUR),
                    point,
                    tip,
                    axis,
                    Vec::new(),
                )
            }
            None => {
                let mesh = self.load(&part, entry.mesh.as_deref(), entry.reading())?;
                let mm = |point: Option<[f64; 3]>| Vec3::from(point.unwrap_or_default()) * 1e-3;
                let axis = Vec3::from(entry.tip_axis.unwrap_or([0.0, 0.0, -1.0])).normalize();
                (
                    mesh.clone(),
                    mesh.to_display(TOOL_COLOUR),
                    mm(entry.working_point_mm),
                    mm(entry.tip_mm),
                    axis,
                    Vec::new(),
                )
            }
        };
        let good_enough = if entry.kind.is_some() {
            5e-6
        } else {
            TreeOptions::default().good_enough
        };
        let wanted = TreeOptions {
            levels: entry.levels,
            good_enough,
            ..TreeOptions::default()
        };
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
            mesh: display,
        })
    }

    /// Makes one of `all` objects.
    pub fn object(
        &mut self,
        entry: &ObjectEntry,
        all: &[ObjectEntry],
    ) -> Result<Object, BuildError> {
        let part = format!("object `{}`", entry.name);
        let mesh = match entry.kind {
            Some(ObjectKind::Molar) => entry.molar.clone().unwrap_or_default().mesh(),
            Some(ObjectKind::Tooth) => {
                let fdi = entry.fdi;
                let tooth = Tooth::lower(fdi);
                let tooth = tooth.ok_or_else(|| BuildError::NoSuchTooth {
                    part: part.clone(),
                    fdi,
                })?;
                let sizes = entry.sizes.clone().unwrap_or_default();
                tooth.with_sizes(&sizes).mesh_of_side()
            }
            Some(ObjectKind::Tongue) => entry.tongue.clone().unwrap_or_default().mesh(),
            Some(ObjectKind::Gingiva) => return self.gingiva(entry, all),
            None if entry.tissue.is_gingiva() => return self.sounded_gingiva(entry, all),
            None => self.load(&part, entry.mesh.as_deref(), entry.reading())?,
        };
        let wanted = TreeOptions {
            levels: entry.levels,
            blended: entry.tissue == TissueEntry::Rigid,
            volumetric: entry.tissue.is_organ(),
            ..TreeOptions::default()
        };
        let place = Vec3::from(entry.translate_mm) * 1e-3;
        // The tree is built in the frame of the mesh, so the cache serves every place.
        let (tree, level) = self.tree(&part, &mesh, entry.level, wanted)?;
        let tissue = match entry.tissue {
            // Gingivae were made above.
            TissueEntry::Rigid | TissueEntry::Gingiva | TissueEntry::PrintedGingiva => {
                TissueModel::Rigid
            }
            TissueEntry::SurfaceCompliance => {
                let mut options = entry.surface.clone().unwrap_or_default();
                options.elements = options.elements.map(|file| self.beside(&file));
                let (done, parts) = (self.done as f64, self.parts as f64);
                let step = |stage: &str, share: f64| {
                    (self.progress)(&format!("{part}: {stage}"), (done - 1.0 + share) / parts);
                };
                let kept = self.options.cache.as_deref();
                let mut made = organ(&tree, &mesh, &options, Path::new(""), kept, &step).map_err(
                    |source| {
                        let part = part.clone();
                        BuildError::Organ { part, source }
                    },
                )?;
                for x in &made.compliance {
                    self.hasher.update(&x.to_bits().to_le_bytes());
                }
                for master in &mut made.masters.places {
                    *master += place;
                }
                TissueModel::Surface(Box::new(made))
            }
            TissueEntry::Skeleton | TissueEntry::PrintedSkeleton => {
                let options = entry.skeleton.clone().unwrap_or_default();
                let mut made = skeleton(&tree, &mesh, &options).map_err(|source| {
                    let part = part.clone();
                    BuildError::Skeleton { part, source }
                })?;
                if let Some(file) = &options.springs_file {
                    let file = self.beside(file);
                    FittedSprings::read(&file)
                        .and_then(|s| s.put_into(&mut made, &tree, options.springs_young_kpa))
                        .map_err(|source| {
                            let part = part.clone();
                            BuildError::Springs { part, source }
                        })?;
                    for spring in &made.coarse.springs {
                        let numbers = spring.stiffness.iter().chain(&spring.coupling);
                        for x in numbers {
                            self.hasher.update(&x.to_bits().to_le_bytes());
                        }
                    }
                }
                if entry.tissue == TissueEntry::PrintedSkeleton {
                    TissueModel::PrintedSkeleton(printed_skeleton(&made, &tree, entry))
                } else {
                    TissueModel::Skeleton(Box::new(made))
                }
            }
        };
        let tree = moved(&tree, &place).map_err(|source| BuildError::Tree { part, source })?;
        let colour = if entry.tissue.is_organ() {
            TONGUE_COLOUR
        } else {
            TOOTH_COLOUR
        };
        let mesh = mesh.placed(1.0, place);
        let carriers = carriers(&tree, &mesh.vertices);
        let mesh = mesh.to_display(colour);
        Ok(Object {
            name: entry.name.clone(),
            fdi: entry.fdi,
            tree,
            level,
            tissue,
            mesh,
            carriers,
        })
    }

    /// Makes the gingiva of one of `all` objects.
    fn gingiva(&mut self, entry: &ObjectEntry, all: &[ObjectEntry]) -> Result<Object, BuildError> {
        let part = format!("object `{}`", entry.name);
        // The check of the file guarantees a molar.
        let tooth = all
            .iter()
            .position(|tooth| Some(&tooth.name) == entry.tooth.as_ref());
        let (molar, place) = tooth.map_or_else(Default::default, |tooth| {
            let tooth = &all[tooth];
            let molar = tooth.molar.clone().unwrap_or_default();
            (molar, Vec3::from(tooth.translate_mm) * 1e-3)
        });
        let params = entry.gingiva.clone().unwrap_or_default().params();
        let pocket = entry.pocket.clone().unwrap_or_default();
        let surface = MeshDistance::new(molar.mesh());
        let collar = MolarCollar::new(&pocket, &surface, params.sink());
        let mesh = collar.mesh();
        let wanted = TreeOptions {
            levels: entry.levels,
            ..TreeOptions::default()
        };
        let importance = |p: &Vec3| collar.importance(p);
        let weights = (&*collar.importance_key(), &importance as &Importance<'_>);
        let (tree, level) = self.weighted(&part, &mesh, entry.level, wanted, Some(weights))?;
        let frame = ToothFrame {
            origin: Vec3::zeros(),
            axis: Vec3::z(),
            mesial: Vec3::x(),
            buccal: Vec3::y(),
        };
        let surrounding = Surrounding {
            tooth: &surface,
            frame,
            mesh: &mesh,
            floor: &|around| collar.floor(around),
            width: pocket.width_mm * 1e-3,
            proximal: POCKET_PROXIMAL_DEG.to_radians(),
            sites: charted(&pocket, &params),
        };
        let mut gingiva = model(&tree, level, params, &surrounding);
        gingiva.tooth.origin += place;
        for of_node in &mut gingiva.places {
            of_node.on_surface += place;
        }
        let tree = moved(&tree, &place).map_err(|source| BuildError::Tree { part, source })?;
        let mesh = mesh.placed(1.0, place);
        let tissue = if entry.tissue == TissueEntry::PrintedGingiva {
            let made = printed_gingiva(&gingiva, &tree, tooth.unwrap_or(0), entry);
            TissueModel::PrintedGingiva(made)
        } else {
            TissueModel::Gingiva(Box::new(gingiva))
        };
        Ok(Object {
            name: entry.name.clone(),
            fdi: entry.fdi,
            carriers: carriers(&tree, &mesh.vertices),
            tree,
            level,
            tissue,
            mesh: mesh.to_display(GINGIVA_COLOUR),
        })
    }

    pub(crate) fn load(
        &mut self,
        part: &str,
        mesh: Option<&Path>,
        reading: Reading,
    ) -> Result<TriMesh, BuildError> {
        // The check of the file guarantees both.
        let file = self.beside(mesh.unwrap_or(Path::new("")));
        let solid = read_solid(&file, reading)?;
        for sentence in solid.repairs.sentences().into_iter().chain(solid.notes) {
            self.warnings
                .push(format!("{part}: {}: {sentence}", file.shown()));
        }
        Ok(solid.mesh)
    }

    /// Builds or fetches a tree. Also returns the contact level, at most the depth of the tree.
    pub(crate) fn tree(
        &mut self,
        part: &str,
        mesh: &TriMesh,
        level: u8,
        wanted: TreeOptions,
    ) -> Result<(SphereTree, u8), BuildError> {
        self.weighted(part, mesh, level, wanted, None)
    }

    /// Works like [`Compiler::tree`] for places of different importance. `weights` has the name of the importance and
    /// its function.
    pub(crate) fn weighted(
        &mut self,
        part: &str,
        mesh: &TriMesh,
        level: u8,
        mut wanted: TreeOptions,
        weights: Option<(&str, &Importance<'_>)>,
    ) -> Result<(SphereTree, u8), BuildError> {
        check(mesh, part)?;
        mesh.hash_into(&mut self.hasher);
        wanted.levels = wanted
            .levels
            .min(self.options.deepest.unwrap_or(u8::MAX))
            .max(if wanted.volumetric { 2 } else { 1 });
        let key = cache::key(mesh, &wanted, weights.map_or("", |weights| weights.0));
        let (done, parts) = (self.done as f64, self.parts as f64);
        self.done += 1;
        let brought = (!self.options.anew).then(|| family::find(&key)).flatten();
        let copied = brought.as_ref().filter(|_| self.options.copies);
        if let (Some(tree), Some(dir)) = (copied, self.options.cache.as_deref()) {
            self.keep(dir, &key, tree);
        }
        let kept = brought.or_else(|| {
            let dir = self.options.cache.as_deref()?;
            // A tree that was cached before trees were checked is built again, and refused.
            cache::load(dir, &key)
                .filter(|tree| check_filled(tree, mesh, &wanted, weights.is_some()).is_ok())
        });
        let tree = match kept {
            Some(tree) => {
                (self.progress)(part, (done + 1.0) / parts);
                tree
            }
            None => {
                let step = |stage: &str, share: f64| {
                    (self.progress)(&format!("{part}: {stage}"), (done + share) / parts)
                };
                let built = match weights {
                    Some((_, importance)) => build_weighted(mesh, &wanted, importance, &step),
                    None => build_tree(mesh, &wanted, &step),
                };
                let tree = built.map_err(|source| BuildError::Tree {
                    part: part.to_owned(),
                    source,
                })?;
                if let Some(dir) = self.options.cache.as_deref() {
                    self.keep(dir, &key, &tree);
                }
                tree
            }
        };
        let level = level.min(tree.depth());
        Ok((tree, level))
    }

    /// Puts a tree into the cache. A failure is a warning.
    fn keep(&mut self, dir: &Path, key: &blake3::Hash, tree: &SphereTree) {
        if let Err(error) = cache::store(dir, key, tree) {
            self.cacheable = false;
            self.warnings.push(format!(
                "{}: cannot cache the built tree in this folder ({error}), so it is built again next time",
                dir.shown()
            ));
        }
    }
}

/// Weight of a place (metres) in the building of a tree.
pub(crate) type Importance<'a> = dyn Fn(&Vec3) -> f64 + Sync + 'a;

/// Returns the tree, moved.
pub(crate) fn moved(tree: &SphereTree, by: &Vec3) -> Result<SphereTree, TreeBuildError> {
    let nodes = tree.nodes().iter().map(|node| {
        let mut node = *node;
        node.centre += by;
        node
    });
    Ok(SphereTree::with_bounds(nodes.collect())?.with_blending(tree.blending().clone())?)
}
