//! Scenes without what the tick does not read.

use sulcus_core::tissue::TissueModel;
use sulcus_core::{Blending, DisplayMesh, Object, Scene, SphereTree};

/// Level at which what is rigid is touched where a scene has to be small.
const COARSE: u8 = 2;

/// The scene without meshes, finer levels than those in contact, a second level of detail, and the objects that are not kept; with
/// coarser tools and teeth where asked.
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

/// A tree without the levels below `level`. Bounds still enclose what is gone: they may.
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
