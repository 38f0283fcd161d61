//! Tools and objects of a scene, one at a time: mesh, check, tree or cached tree, place.

use std::path::Path;

use sulcus_core::math::exp_rotation;
use sulcus_core::tissue::TissueModel;
use sulcus_core::{Object, Pose, SphereTree, Tool, Vec3};

use crate::build::{TreeBuildError, TreeOptions, build_tree};
use crate::cache;
use crate::carry::carriers;
use crate::check::check;
use crate::compile::{BuildError, BuildOptions};
use crate::file::{ObjectEntry, ObjectKind, TissueEntry, ToolEntry, ToolKind};
use crate::load::Unit;
use crate::mesh::TriMesh;
use crate::parametric::{Mirror, Probe};
use crate::skeleton::skeleton;
use crate::solid::read_solid;

const TOOTH_COLOUR: [u8; 4] = [238, 230, 208, 255];
const TONGUE_COLOUR: [u8; 4] = [205, 110, 115, 255];
const TOOL_COLOUR: [u8; 4] = [176, 182, 188, 255];

/// What the parts of one scene share while they are made.
pub(crate) struct Compiler<'a> {
    pub path: &'a Path,
    pub options: &'a BuildOptions,
    pub progress: &'a dyn Fn(&str, f64),
    pub hasher: blake3::Hasher,
    pub warnings: Vec<String>,
    pub parts: usize,
    pub done: usize,
}

impl Compiler<'_> {
    pub fn tool(&mut self, entry: &ToolEntry) -> Result<Tool, BuildError> {
        let part = format!("tool `{}`", entry.name);
        let (touching, display, working_point, tip, tip_axis, bands) = match entry.kind {
            Some(ToolKind::PeriodontalProbe) => {
                let probe: Probe = entry.probe.clone().unwrap_or_default();
                let (point, tip, axis) = (probe.working_point(), probe.tip(), probe.tip_axis());
                (
                    probe.touching_mesh(),
                    probe.display_mesh(),
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
                    mirror.display_mesh(),
                    point,
                    tip,
                    axis,
                    Vec::new(),
                )
            }
            None => {
                let mesh = self.load(&part, entry.mesh.as_deref(), entry.unit)?;
                let mm = |point: Option<[f64; 3]>| Vec3::from(point.unwrap_or_default()) * 1e-3;
                let axis = Vec3::from(entry.tip_axis.unwrap_or([0.0, 0.0, -1.0])).normalize();
                (
                    mesh.clone(),
                    mesh,
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
            mesh: display.to_display(TOOL_COLOUR),
        })
    }

    pub fn object(&mut self, entry: &ObjectEntry) -> Result<Object, BuildError> {
        let part = format!("object `{}`", entry.name);
        let mesh = match entry.kind {
            Some(ObjectKind::Molar) => entry.molar.clone().unwrap_or_default().mesh(),
            Some(ObjectKind::Tongue) => entry.tongue.clone().unwrap_or_default().mesh(),
            None => self.load(&part, entry.mesh.as_deref(), entry.unit)?,
        };
        let wanted = TreeOptions {
            levels: entry.levels,
            blended: entry.tissue == TissueEntry::Rigid,
            volumetric: entry.tissue == TissueEntry::Skeleton,
            ..TreeOptions::default()
        };
        let place = Vec3::from(entry.translate_mm) * 1e-3;
        // The tree is built where the mesh was drawn, so that the cache serves every place.
        let (tree, level) = self.tree(&part, &mesh, entry.level, wanted)?;
        let tissue = match entry.tissue {
            TissueEntry::Rigid => TissueModel::Rigid,
            TissueEntry::Skeleton => {
                let options = entry.skeleton.clone().unwrap_or_default();
                let made = skeleton(&tree, &mesh, &options).map_err(|source| {
                    let part = part.clone();
                    BuildError::Skeleton { part, source }
                })?;
                TissueModel::Skeleton(Box::new(made))
            }
        };
        let tree = moved(&tree, &place).map_err(|source| BuildError::Tree { part, source })?;
        let colour = match entry.tissue {
            TissueEntry::Rigid => TOOTH_COLOUR,
            TissueEntry::Skeleton => TONGUE_COLOUR,
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

    fn load(
        &mut self,
        part: &str,
        mesh: Option<&Path>,
        unit: Option<Unit>,
    ) -> Result<TriMesh, BuildError> {
        // The file was checked to name both.
        let file = self
            .path
            .parent()
            .unwrap_or(Path::new(""))
            .join(mesh.unwrap_or(Path::new("")));
        let solid = read_solid(&file, unit.unwrap_or(Unit::Millimetre))?;
        for sentence in solid.repairs.sentences() {
            self.warnings
                .push(format!("{part}: {}: {sentence}", file.display()));
        }
        Ok(solid.mesh)
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
        wanted.levels = wanted
            .levels
            .min(self.options.deepest.unwrap_or(u8::MAX))
            .max(if wanted.volumetric { 2 } else { 1 });
        let key = cache::key(mesh, &wanted);
        let (done, parts) = (self.done as f64, self.parts as f64);
        self.done += 1;
        let kept = self
            .options
            .cache
            .as_deref()
            .and_then(|dir| cache::load(dir, &key));
        let tree = match kept {
            Some(tree) => {
                (self.progress)(part, (done + 1.0) / parts);
                tree
            }
            None => {
                let step = |stage: &str, share: f64| {
                    (self.progress)(&format!("{part}: {stage}"), (done + share) / parts)
                };
                let tree = build_tree(mesh, &wanted, &step).map_err(|source| BuildError::Tree {
                    part: part.to_owned(),
                    source,
                })?;
                if let Some(dir) = self.options.cache.as_deref()
                    && let Err(error) = cache::store(dir, &key, &tree)
                {
                    self.warnings.push(format!(
                            "{}: cannot keep the built tree there ({error}), so it is built again next time",
                            dir.display()
                        ));
                }
                tree
            }
        };
        let level = level.min(tree.depth());
        Ok((tree, level))
    }
}

fn moved(tree: &SphereTree, by: &Vec3) -> Result<SphereTree, TreeBuildError> {
    let nodes = tree.nodes().iter().map(|node| {
        let mut node = *node;
        node.centre += by;
        node
    });
    Ok(SphereTree::with_bounds(nodes.collect())?.with_blending(tree.blending().clone())?)
}
