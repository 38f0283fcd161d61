//! Vectors of a review.

use sulcus_core::Vec3;

/// Vector in millimetres as f32.
pub(super) fn millimetres(at: &Vec3) -> [f32; 3] {
    plain(&(at * 1e3))
}

/// Vector as f32.
pub(super) fn plain(v: &Vec3) -> [f32; 3] {
    [v.x, v.y, v.z].map(|x| x as f32)
}
