//! Handles of a gingiva: places on its drawn mesh that carry the mesh.

use sulcus_core::Vec3;
use sulcus_core::math::{fclamp, norm};
use sulcus_proto::display::Skin;

/// Depth below the crest down to which a mesh has handles, metres. Chosen: deeper tissue is not visible and hardly
/// moves.
const DOWN_M: f64 = 2.5e-3;
/// Largest distance of a handle from the tooth's axis, metres: tissue of one tooth.
const OUT_M: f64 = 9e-3;
/// Largest number of handles of a gingiva. They lie 0.8 mm apart, about the reach of a dent.
const HANDLES: usize = 256;
/// Number of handles that carry a vertex.
const CARRIERS: usize = 6;

/// Places of vertices relative to a tooth: height below the crest, and distance from the tooth's axis, metres.
pub struct Place {
    /// Height of the crest at the vertex's angle over the vertex.
    pub below: f64,
    /// Distance from the axis.
    pub off_axis: f64,
}

/// Chooses up to 256 vertices near the margin, spread evenly: each next one is the farthest from all before.
/// Returns their indices and the largest distance of a candidate from its nearest handle, metres.
pub fn choose(vertices: &[Vec3], place: impl Fn(&Vec3) -> Place) -> (Vec<usize>, f64) {
    let near = |v: &Vec3| {
        let place = place(v);
        place.below < DOWN_M && place.off_axis < OUT_M
    };
    let candidates: Vec<usize> = (0..vertices.len())
        .filter(|k| near(&vertices[*k]))
        .collect();
    let mut away = vec![f64::INFINITY; candidates.len()];
    let mut chosen = Vec::new();
    let mut next = 0;
    while chosen.len() < HANDLES && next < candidates.len() && away[next] > 0.0 {
        let handle = candidates[next];
        chosen.push(handle);
        let mut farthest = (0.0, candidates.len());
        for (k, (away, candidate)) in away.iter_mut().zip(&candidates).enumerate() {
            let d = norm(&(vertices[*candidate] - vertices[handle]));
            if d < *away {
                *away = d;
            }
            if *away > farthest.0 {
                farthest = (*away, k);
            }
        }
        next = farthest.1;
    }
    let spacing = away
        .iter()
        .fold(0.0, |most, d| if *d > most { *d } else { most });
    (chosen, spacing)
}

/// Returns the skin of `vertices` over handles that lie `spacing` apart.
///
/// Six handles carry a vertex, with weights proportional to `(1 - d/r)^2`. The range `r` is the distance of the
/// seventh. The sum falls from 1 at `spacing` from the nearest handle to 0 at twice that distance.
pub fn skin(vertices: &[Vec3], handles: &[Vec3], spacing: f64) -> Skin {
    let mut skin = Skin::over(handles.iter().map(crate::display::f32s).collect());
    let mut near: Vec<(f64, usize)> = Vec::with_capacity(handles.len());
    for vertex in vertices {
        near.clear();
        let away = |(k, at): (usize, &Vec3)| (norm(&(at - vertex)), k);
        near.extend(handles.iter().enumerate().map(away));
        near.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let nearest = near.first().map_or(f64::INFINITY, |(d, _)| *d);
        let share = fclamp(2.0 - nearest / spacing.max(1e-9), 0.0, 1.0);
        let range = near.get(CARRIERS).map_or(2.0 * spacing, |(d, _)| *d);
        let weight = |d: f64| {
            let rest = fclamp(1.0 - d / range.max(1e-9), 0.0, 1.0);
            rest * rest
        };
        let carrying = &near[..near.len().min(CARRIERS)];
        let sum: f64 = carrying.iter().map(|(d, _)| weight(*d)).sum();
        let carriers = carrying.iter().filter(|_| share > 0.0 && sum > 0.0);
        skin.push(carriers.map(|(d, k)| (*k as u16, share * weight(*d) / sum)));
    }
    skin
}
