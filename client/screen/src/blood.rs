//! Blood at the sites that bleed.
//!
//! Course after probing, as drawn for indices of papillary bleeding: first a point at the margin, then a line that
//! creeps along the sulcus within some seconds, then the papilla's triangle fills. Sizes and times are chosen by the
//! descriptions; no measured course was found.

use std::ops::Range;

use nalgebra::Vector3;
use sulcus_proto::display::Spot;

use crate::material::Material;
use crate::stage::{Stage, Still};

/// Radius of the point, mm, and time until it is whole, s.
const POINT: (f32, f32) = (0.45, 0.6);
/// Half length of the line along the sulcus, mm, and the times of its begin and end, s.
const LINE: (f32, [f32; 2]) = (1.9, [0.8, 5.0]);
/// Age after which blood spreads no more, s: the end of the line.
pub(crate) const WHOLE_S: f32 = LINE.1[1];
/// Half height of the line, mm.
const HEIGHT: f32 = 0.42;
/// Least cover of the vertex next to whole blood: the whole vertex is drawn as blood.
const SEEN: f32 = 0.6;
/// Largest distance of any blood from its site, mm.
const FAR: f32 = 3.5;

/// Writes the cover by blood of all vertices near the spots, each with the time since its begin in seconds. Returns the
/// ranges of vertices of the parts that may have blood.
pub(crate) fn spread(stage: &mut Stage, spots: &[(Spot, f32)]) -> Vec<Range<usize>> {
    let places: Vec<(u16, Vector3<f32>, Vector3<f32>, f32)> = spots
        .iter()
        .filter_map(|(spot, age)| {
            let sites = stage.sites.get(usize::from(spot.object))?;
            let site = usize::from(spot.site);
            let at = Vector3::from(*sites.get(site)?);
            Some((spot.object, at, along(sites, site), *age))
        })
        .collect();
    let bloody = |material| matches!(material, Material::Flesh | Material::Tooth);
    let parts: Vec<Range<usize>> = stage
        .parts
        .iter()
        .filter(|part| bloody(part.material))
        .map(|part| part.vertices.clone())
        .collect();
    for v in parts.iter().cloned().flatten() {
        let rest = Vector3::from(stage.still[v].rest);
        let cover = |(_, at, along, age): &(u16, Vector3<f32>, Vector3<f32>, f32)| {
            cover(&(rest - at), along, *age)
        };
        stage.moving[v].blood = places.iter().map(cover).fold(0.0, f32::max);
    }
    for (object, at, along, age) in &places {
        for share in [-1.0, -0.5, 0.0, 0.5, 1.0] {
            let at = at + along * (share * reach(*age));
            wet_nearest(stage, *object, &at, *age);
        }
    }
    parts
}

/// Cover of all vertices when every site of the scene bleeds and its blood has spread whole.
pub(crate) fn whole(stage: &Stage) -> Vec<f32> {
    let sites = stage.sites.iter().flat_map(|sites| {
        (0..sites.len()).map(|site| (Vector3::from(sites[site]), along(sites, site)))
    });
    let sites: Vec<(Vector3<f32>, Vector3<f32>)> = sites.collect();
    let of = |still: &Still| {
        let rest = Vector3::from(still.rest);
        let cover =
            |(at, along): &(Vector3<f32>, Vector3<f32>)| cover(&(rest - at), along, WHOLE_S);
        sites.iter().map(cover).fold(0.0, f32::max)
    };
    stage.still.iter().map(of).collect()
}

/// Gives blood to the vertex of an object next to a place. A coarse mesh may have no vertex within the line of blood.
fn wet_nearest(stage: &mut Stage, object: u16, at: &Vector3<f32>, age: f32) {
    let own = stage
        .object(object)
        .filter(|part| part.material == Material::Flesh)
        .map(|part| part.vertices.clone());
    let away = |v: usize| (Vector3::from(stage.still[v].rest) - at).norm_squared();
    let nearest = own
        .into_iter()
        .flatten()
        .map(|v| (v, away(v)))
        .filter(|(_, away)| *away < FAR * FAR)
        .min_by(|a, b| a.1.total_cmp(&b.1));
    if let Some((v, _)) = nearest {
        let blood = &mut stage.moving[v].blood;
        *blood = blood.max(SEEN * ramp(age, [0.0, POINT.1]));
    }
}

/// Share of a course from 0 at its begin to 1 at its end, s.
fn ramp(age: f32, [from, to]: [f32; 2]) -> f32 {
    ((age - from) / (to - from)).clamp(0.0, 1.0)
}

/// Half length of the line at an age, mm.
fn reach(age: f32) -> f32 {
    LINE.0 * ramp(age, LINE.1)
}

/// Unit vector along the margin at a site, from the sites on both sides.
fn along(sites: &[[f32; 3]], site: usize) -> Vector3<f32> {
    let n = sites.len();
    let [before, after] = [n - 1, 1].map(|step| Vector3::from(sites[(site + step) % n]));
    let along = after - before;
    // The line lies level: papillae differ in height.
    Vector3::new(along.x, along.y, 0.0)
        .try_normalize(1e-6)
        .unwrap_or_else(Vector3::x)
}

/// Cover at a place relative to the site, 0 to 1. Values over a half are drawn as blood.
fn cover(from: &Vector3<f32>, along: &Vector3<f32>, age: f32) -> f32 {
    if from.norm() > FAR {
        return 0.0;
    }
    let radius = POINT.0 * ramp(age, [0.0, POINT.1]).sqrt();
    let reach = reach(age);
    let aside = from.dot(along);
    let off = (from - along * aside.clamp(-reach, reach)).norm();
    let thick = radius.max(if reach > 0.0 { HEIGHT } else { 0.0 });
    // Falls from 1 in the middle over a half at the edge.
    if thick > 0.0 {
        (1.0 - 0.5 * off / thick).clamp(0.0, 1.0)
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Length along x and height along z of the cover over a half, mm.
    fn size(age: f32) -> [f32; 2] {
        let step = 0.01;
        let along = |axis: Vector3<f32>| {
            let at = |k: i32| cover(&(axis * (k as f32 * step)), &Vector3::x(), age) > 0.5;
            (-400..=400).filter(|k| at(*k)).count() as f32 * step
        };
        [along(Vector3::x()), along(Vector3::z())]
    }

    #[test]
    fn a_point_becomes_a_line_along_the_margin() {
        assert_eq!(size(0.0), [0.0, 0.0]);
        let [wide, high] = size(0.7);
        assert!(
            (0.7..1.0).contains(&wide) && (wide - high).abs() < 0.05,
            "{wide} {high}"
        );
        let [wide, high] = size(6.0);
        assert!(
            (4.0..5.0).contains(&wide) && (0.7..1.0).contains(&high),
            "{wide} {high}"
        );
        assert_eq!(size(6.0), size(60.0));
    }
}
