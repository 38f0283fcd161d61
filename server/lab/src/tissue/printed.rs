//! The method as printed, at rest.

use sulcus_core::tissue::printed::PrintedSkeleton;
use sulcus_core::tissue::skeleton::{CARRIERS, Skeleton, SkeletonLevel, Spring, StretchLaw};

use super::organ::Organ;

/// What a skeleton as printed comes to rest at: all its springs as stiff, each sphere after one of the skeleton's. Its explicit
/// Euler and this implicit one differ on the way, not at rest, where springs balance loads.
pub(crate) fn as_printed(skeleton: &Skeleton, organ: &Organ) -> Skeleton {
    let printed = PrintedSkeleton::of(&skeleton.coarse, &organ.tree);
    let mut coarse: SkeletonLevel = skeleton.coarse.clone();
    coarse.params.law = StretchLaw::LINEAR;
    for spring in &mut coarse.springs {
        *spring = Spring {
            stiffness: [printed.spring_n_per_m; 3],
            coupling: [0.0; 3],
            ..*spring
        };
    }
    one_carrier(&mut coarse);
    Skeleton { coarse, fine: None }
}

/// Leaves each sphere the one node that carries most of it.
pub(crate) fn one_carrier(level: &mut SkeletonLevel) {
    for skin in &mut level.skin {
        let most = (1..CARRIERS).fold(0, |most, k| {
            if skin.weights[k] > skin.weights[most] {
                k
            } else {
                most
            }
        });
        skin.weights = std::array::from_fn(|k| f64::from(u8::from(k == most)));
    }
}
