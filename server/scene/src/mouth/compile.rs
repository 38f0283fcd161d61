//! `[mouth]` of a scene file into objects.

use sulcus_core::tissue::TissueModel;
use sulcus_core::{Node, Object, SphereTree, TreeError};

use super::{MouthEntry, Standing, collar, patient, placed_gingiva, placed_mesh, standing};
use crate::build::TreeOptions;
use crate::carry::carriers;
use crate::compile::BuildError;
use crate::parametric::arch::to_world;
use crate::parts::{Compiler, GINGIVA_COLOUR, TOOTH_COLOUR, gingiva_params};
use crate::patient::{LOWER, ToothChart};

/// What a mouth adds to a scene.
pub(crate) struct MouthParts {
    /// Teeth, then gingivae, from the right to the left.
    pub objects: Vec<Object>,
    /// The patient file's text.
    pub patient: String,
}

impl Compiler<'_> {
    /// Makes the teeth and gingivae of a mouth.
    pub fn mouth(&mut self, entry: &MouthEntry) -> Result<MouthParts, BuildError> {
        let folder = self.path.parent().unwrap_or(std::path::Path::new(""));
        let (patient, text) = patient(entry, folder)?;
        self.hasher.update(text.as_bytes());
        let wanted = |fdi: &u8| entry.teeth.as_ref().is_none_or(|teeth| teeth.contains(fdi));
        let charts: Vec<ToothChart> = LOWER
            .into_iter()
            .filter(wanted)
            .filter_map(|fdi| patient.tooth(fdi))
            .collect();
        let fdis: Vec<u8> = charts.iter().map(|chart| chart.fdi).collect();
        let all = standing(&fdis);
        let mut objects = Vec::with_capacity(2 * all.len());
        for tooth in &all {
            objects.push(self.tooth(entry, tooth)?);
        }
        let base = gingiva_params(&entry.gingiva);
        let made = crate::parallel::map(all.len(), |k| {
            let params = sulcus_core::tissue::gingiva::GingivaParams {
                inflammation: charts[k].inflammation,
                ..base
            };
            let collar = collar(&all, k, &charts[k], entry, &params)
                .map_err(|error| BuildError::Patient(error.to_string()))?;
            placed_gingiva(&collar, &charts[k], params, &all[k].frame).map_err(|source| {
                BuildError::Tree {
                    part: format!("gingiva {}", all[k].fdi),
                    source: source.into(),
                }
            })
        });
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

    fn tooth(&mut self, entry: &MouthEntry, tooth: &Standing) -> Result<Object, BuildError> {
        let part = format!("tooth {}", tooth.fdi);
        let wanted = TreeOptions {
            levels: entry.tooth_levels,
            blended: true,
            ..TreeOptions::default()
        };
        // Built where it was drawn, so that both sides and every patient share it.
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
