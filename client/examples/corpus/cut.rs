//! Scenes reduced to the parts that the tick reads.

use sulcus_core::tissue::TissueModel;
use sulcus_core::{Blending, DisplayMesh, Object, Scene, SphereTree};

/// Largest contact level of tools and rigid objects in a scene that has to be small.
const COARSE: u8 = 2;

/// Reduced `scene`: without meshes, without levels finer than the contact level, and without a second level of detail.
///
/// Only the objects for which `keep` is true remain. With `coarse`, tools and rigid objects have at most the contact
/// level [`COARSE`].
///
/// # Errors
/// The reduced scene is not valid.
pub fn small(
    mut scene: Scene,
    keep: impl Fn(&Object) -> bool,
    coarse: bool,
) -> anyhow::Result<Scene> {
    scene.objects.retain(keep);
    for tool in &mut scene.tools {
        tool.mesh = DisplayMesh::default();
        tool.level = if coarse {
            tool.level.min(COARSE)
        } else {
            tool.level
        };
        tool.tree = up_to(&tool.tree, tool.level)?;
    }
    for object in &mut scene.objects {
        object.mesh = DisplayMesh::default();
        object.carriers = Vec::new();
        match &mut object.tissue {
            TissueModel::Rigid => {
                object.level = if coarse {
                    object.level.min(COARSE)
                } else {
                    object.level
                };
                object.tree = up_to(&object.tree, object.level)?;
            }
            TissueModel::Skeleton(model) => model.fine = None,
            _ => {}
        }
    }
    scene.validate()?;
    Ok(scene)
}

/// `tree` without the levels finer than `level`. The bounds still enclose the removed spheres, which is permitted.
fn up_to(tree: &SphereTree, level: u8) -> anyhow::Result<SphereTree> {
    let nodes = tree
        .nodes()
        .iter()
        .filter(|node| node.level <= level)
        .copied();
    let mut nodes: Vec<_> = nodes.collect();
    for node in nodes.iter_mut().filter(|node| node.level == level) {
        (node.first_child, node.children) = (0, 0);
    }
    let Blending {
        mut lengths,
        mut insets,
    } = tree.blending().clone();
    lengths.truncate(usize::from(level) + 1);
    insets.truncate(nodes.len());
    Ok(SphereTree::from_nodes(nodes)?.with_blending(Blending { lengths, insets })?)
}
