//! Objects of `[mouth]` of a scene file.

use sulcus_core::tissue::TissueModel;
use sulcus_core::tissue::gingiva::GingivaParams;
use sulcus_core::{Node, Object, SphereTree, TreeError};

use crate::anatomy::arch::to_world;
use crate::anatomy::collar::Collar;
use crate::anatomy::jaw::{Station, healed, jaw};
use crate::anatomy::mouth::{
    JAW_TOP, Standing, collar, meet, patient, placed_gingiva, placed_mesh, standing,
};
use crate::anatomy::patient::ToothChart;
use crate::compile::error::BuildError;
use crate::compile::parts::{Compiler, GINGIVA_COLOUR, TOOTH_COLOUR};
use crate::file::{LOWER, MouthEntry};
use crate::mesh::TriMesh;
use crate::tree::build::TreeOptions;
use crate::tree::carry::carriers;

/// Overlap of the jaw with the base of the gingivae, mm.
const JAW_OVERLAP: f64 = 0.4;

/// Parts of a scene that a mouth adds.
pub(crate) struct MouthParts {
    /// Teeth, then gingivae, from the right to the left.
    pub objects: Vec<Object>,
    /// The patient file's text.
    pub patient: String,
}

impl Compiler<'_> {
    /// Makes the teeth and gingivae of a mouth. If no patient is named, it is generated from `seed`.
    pub fn mouth(&mut self, entry: &MouthEntry, seed: u64) -> Result<MouthParts, BuildError> {
        let file = entry.patient.as_ref().map(|file| self.beside(file));
        let (patient, text) = patient(file.as_deref(), entry.condition, seed)?;
        self.hasher.update(text.as_bytes());
        let wanted = |fdi: &u8| entry.teeth.as_ref().is_none_or(|teeth| teeth.contains(fdi));
        let charts: Vec<ToothChart> = LOWER
            .into_iter()
            .filter(wanted)
            .filter_map(|fdi| patient.tooth(fdi))
            .collect();
        let arch = standing();
        let there = |tooth: &&Standing| charts.iter().any(|chart| chart.fdi == tooth.fdi);
        let all: Vec<Standing> = arch.iter().filter(there).cloned().collect();
        let mut objects = Vec::with_capacity(2 * all.len());
        for tooth in &all {
            objects.push(self.placed_tooth(entry, tooth)?);
        }
        let base = entry.gingiva.params();
        let params = |k: usize| GingivaParams {
            inflammation: charts[k].inflammation,
            ..base
        };
        let collars: Result<Vec<Collar>, _> = (0..all.len())
            .map(|k| collar(&all, k, &charts[k], entry, &params(k)))
            .collect();
        let mut collars = collars.map_err(|error| BuildError::Patient(error.to_string()))?;
        meet(&mut collars, &all);
        let made = crate::parallel::map(all.len(), |k| {
            let (collar, frame) = (&collars[k], &all[k].frame);
            placed_gingiva(collar, &charts[k], params(k), frame).map_err(|source| {
                BuildError::Tree {
                    part: format!("gingiva {}", all[k].fdi),
                    source: source.into(),
                }
            })
        });
        objects.push(self.jaw(arch)?);
        for tooth in arch
            .iter()
            .filter(|tooth| patient.missing.contains(&tooth.fdi))
        {
            objects.push(self.healed(entry, tooth)?);
        }
        for (tooth, made) in all.iter().zip(made) {
            let made = made?;
            made.mesh.hash_into(&mut self.hasher);
            objects.push(Object {
                name: format!("gingiva {}", tooth.fdi),
                fdi: tooth.fdi,
                level: made.model.level,
                carriers: carriers(&made.tree, &made.mesh.vertices),
                mesh: made.mesh.to_display(GINGIVA_COLOUR),
                tree: made.tree,
                tissue: TissueModel::Gingiva(Box::new(made.model)),
            });
        }
        Ok(MouthParts {
            objects,
            patient: text,
        })
    }

    /// Makes the jaw under all teeth, also missing ones. It is the same for every patient.
    fn jaw(&mut self, arch: &[Standing]) -> Result<Object, BuildError> {
        let wall = MouthEntry::default().wall_mm;
        let stations: Vec<Station> = arch
            .iter()
            .map(|tooth| {
                let (at, buccal) = (tooth.at_jaw(), tooth.frame.buccal.xy().normalize());
                Station {
                    at: [at.x, at.y],
                    buccal: [buccal.x, buccal.y],
                    faces: tooth.faces(wall),
                }
            })
            .collect();
        self.mucosa("jaw", 3, jaw(&stations, JAW_TOP + JAW_OVERLAP), |mesh| mesh)
    }

    /// Makes the healed ridge of a missing tooth.
    fn healed(&mut self, entry: &MouthEntry, tooth: &Standing) -> Result<Object, BuildError> {
        let ends = tooth.ends();
        let mesh = healed(ends, tooth.faces(entry.wall_mm), tooth.base());
        let frame = tooth.frame;
        self.mucosa(&format!("healed ridge {}", tooth.fdi), 2, mesh, |mesh| {
            placed_mesh(&mesh, &frame)
        })
    }

    fn mucosa(
        &mut self,
        name: &str,
        level: u8,
        mesh: TriMesh,
        place: impl Fn(TriMesh) -> TriMesh,
    ) -> Result<Object, BuildError> {
        let wanted = TreeOptions {
            levels: level,
            ..TreeOptions::default()
        };
        let mesh = place(mesh);
        let (tree, level) = self.tree(name, &mesh, level, wanted)?;
        Ok(Object {
            name: name.to_owned(),
            fdi: 0,
            tree,
            level,
            tissue: TissueModel::Rigid,
            mesh: mesh.to_display(GINGIVA_COLOUR),
            carriers: Vec::new(),
        })
    }

    fn placed_tooth(&mut self, entry: &MouthEntry, tooth: &Standing) -> Result<Object, BuildError> {
        let part = format!("tooth {}", tooth.fdi);
        let wanted = TreeOptions {
            levels: entry.tooth_levels,
            blended: true,
            ..TreeOptions::default()
        };
        // The tree is built in the frame of the drawing, so both sides and every patient share it.
        let (tree, level) = self.tree(&part, &tooth.mesh, entry.tooth_level, wanted)?;
        let tree = placed(&tree, tooth).map_err(|source| BuildError::Tree {
            part: part.clone(),
            source: source.into(),
        })?;
        let mesh = placed_mesh(&tooth.mesh, &tooth.frame);
        Ok(Object {
            name: part,
            fdi: tooth.fdi,
            tree,
            level,
            tissue: TissueModel::Rigid,
            mesh: mesh.to_display(TOOTH_COLOUR),
            carriers: Vec::new(),
        })
    }
}

fn placed(tree: &SphereTree, tooth: &Standing) -> Result<SphereTree, TreeError> {
    let nodes = tree.nodes().iter().map(|node| Node {
        centre: to_world(&tooth.frame, &node.centre),
        ..*node
    });
    SphereTree::with_bounds(nodes.collect())?.with_blending(tree.blending().clone())
}
