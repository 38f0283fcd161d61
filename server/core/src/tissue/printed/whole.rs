//! Conversion of a whole scene to the models as printed.

use super::{PrintedGingiva, PrintedSkeleton};
use crate::scene::Scene;
use crate::tissue::TissueModel;

/// Replaces every skeleton and every gingiva of the scene by its model as printed.
///
/// Trees, springs and directions from the tooth stay the same. A skeleton contributes its coarse level.
/// `Params::max_settle_step` becomes 50 N per millisecond, which in effect disables the limit on the change of force.
/// Tissue models without a counterpart in the paper stay unchanged.
///
/// The tooth of a gingiva is the first rigid object with the same FDI number other than 0, else the first rigid object.
/// Without a rigid object the index is 0.
pub fn as_printed(scene: &mut Scene) {
    scene.params.max_settle_step = 50.0;
    let tooth_of = |fdi: u8| {
        let rigid = |k: &usize| scene.objects[*k].tissue.is_rigid();
        let all = || (0..scene.objects.len()).filter(rigid);
        let same = all().find(|&k| fdi != 0 && scene.objects[k].fdi == fdi);
        same.or_else(|| all().next()).unwrap_or(0) as u16
    };
    let teeth: Vec<u16> = scene.objects.iter().map(|o| tooth_of(o.fdi)).collect();
    for (object, tooth) in scene.objects.iter_mut().zip(teeth) {
        let printed = match &object.tissue {
            TissueModel::Skeleton(coupled) => {
                TissueModel::PrintedSkeleton(PrintedSkeleton::of(&coupled.coarse, &object.tree))
            }
            TissueModel::Gingiva(coupled) => {
                TissueModel::PrintedGingiva(PrintedGingiva::of(coupled, &object.tree, tooth))
            }
            _ => continue,
        };
        object.tissue = printed;
    }
}
