//! Depth by the bands: the length of the probe between its tip and the gingival margin at a charted site.

use nalgebra::Vector3;
use sulcus_proto::display::{DisplayScene, Kind};

use crate::camera::Vector;
use crate::moment::Moment;
use crate::views::tip;

/// Largest distance of a site from the line of the probe, mm.
const ASIDE_MM: f64 = 1.5;
/// Largest depth, mm: the last band of a probe.
const MOST_MM: f64 = 15.0;

/// Depth of the tip of the held probe below the margin of the nearest charted site, mm. `None`: no probe in a hand, or
/// no site near its line.
///
/// The number is what the bands show: a length along the probe to the margin at rest. The display has no other depth.
pub fn by_bands(scene: &DisplayScene, moment: &Moment) -> Option<f64> {
    let (tip, out) = tip(scene, moment)?;
    let gingivae = scene.objects.iter().filter(|one| one.kind == Kind::Gingiva);
    let sites = gingivae.flat_map(|one| &one.sites);
    let near = sites.filter_map(|site| {
        let from = Vector3::from(site.map(|x| f64::from(x) * 1e3)) - tip;
        let along: f64 = -from.dot(&out);
        let aside = (from + out * along).norm();
        (aside < ASIDE_MM && (0.0..MOST_MM).contains(&along)).then_some((aside, along))
    });
    let nearest = near.min_by(|a: &(f64, f64), b| a.0.total_cmp(&b.0));
    nearest.map(|(_, along)| along)
}

/// Largest distance of the drawn margin between two sites from the line of the probe, mm. The margin bulges over the
/// chord between its sites.
const OFF_CHORD_MM: f64 = 2.0;

/// Depth of the tip of the held probe below the margin, mm, also between two charted sites of a side: the margin is
/// the chord between them. `None`: no probe in a hand, or no margin near its line.
pub fn along_margin(scene: &DisplayScene, moment: &Moment) -> Option<f64> {
    let (tip, out) = tip(scene, moment)?;
    let gingivae = scene.objects.iter().filter(|one| one.kind == Kind::Gingiva);
    let sides = gingivae.filter(|one| one.sites.len() == 6);
    let chords = sides.flat_map(|one| {
        let at = |k: usize| millimetres(one.sites[k]);
        [[0, 1], [1, 2], [3, 4], [4, 5]].map(|[a, b]| [at(a), at(b)])
    });
    let near = chords.filter_map(|[a, b]| {
        // Across the probe, the chord is a segment in a plane, and the probe is the origin.
        let across = |v: Vector| v - out * v.dot(&out);
        let (from, way) = (across(a - tip), across(b - a));
        let share = (-from.dot(&way) / way.norm_squared().max(1e-12)).clamp(0.0, 1.0);
        let aside = (from + way * share).norm();
        let along = -(a + (b - a) * share - tip).dot(&out);
        (aside < OFF_CHORD_MM && (0.0..MOST_MM).contains(&along)).then_some((aside, along))
    });
    let nearest = near.min_by(|a: &(f64, f64), b| a.0.total_cmp(&b.0));
    nearest.map(|(_, along)| along)
}

/// Vector of millimetres, for callers that have metres of the wire.
pub fn millimetres(at: [f32; 3]) -> Vector {
    Vector::from(at.map(|x| f64::from(x) * 1e3))
}

#[cfg(test)]
mod tests {
    use super::*;
    use sulcus_proto::datagram::WirePose;
    use sulcus_proto::display::{DisplayBand, DisplayMesh, DisplayObject, DisplayTool};

    fn scene() -> DisplayScene {
        let mesh = || DisplayMesh::new(&[[0.0; 3]], &[], [255; 4], &[]).expect("a mesh");
        let band = DisplayBand {
            from: 0.0,
            to: 0.001,
            dark: false,
        };
        DisplayScene {
            tick_ns: 1_000_000,
            tools: vec![DisplayTool {
                name: "probe".into(),
                mesh: mesh(),
                bands: vec![band],
                glass: None,
                tip: [0.0, 0.0, -0.09],
                tip_axis: [0.0, 0.0, -1.0],
                park: WirePose::IDENTITY,
            }],
            objects: vec![DisplayObject {
                kind: Kind::Gingiva,
                fdi: 36,
                mesh: mesh(),
                skin: None,
                sites: (0..6).map(|k| [0.004 * k as f32, 0.0, 0.0]).collect(),
            }],
        }
    }

    #[test]
    fn between_two_sites_the_margin_is_their_chord() {
        let mut scene = scene();
        scene.objects[0].sites[1][2] = 0.001;
        let mut moment = Moment::rest(&scene);
        moment.tools[0].held = true;
        // Sites are 4 mm apart, the second one is 1 mm higher.
        moment.tools[0].position = Vector3::new(2.0, 0.3, 87.0);
        let depth = along_margin(&scene, &moment).expect("a depth");
        assert!((depth - 3.5).abs() < 1e-4, "{depth}");
        assert_eq!(by_bands(&scene, &moment), None, "no site is near");
        moment.tools[0].position = Vector3::new(10.0, 0.3, 87.0);
        assert_eq!(along_margin(&scene, &moment), None, "between the sides");
        moment.tools[0].position = Vector3::new(2.0, 2.5, 87.0);
        assert_eq!(along_margin(&scene, &moment), None, "beside the margin");
    }

    #[test]
    fn the_depth_is_the_length_below_the_nearest_site() {
        let scene = scene();
        let mut moment = Moment::rest(&scene);
        moment.tools[0].position = Vector3::new(4.3, 0.2, 90.0 - 5.0);
        assert_eq!(by_bands(&scene, &moment), None, "in no hand");
        moment.tools[0].held = true;
        let depth = by_bands(&scene, &moment).expect("a depth");
        assert!((depth - 5.0).abs() < 1e-4, "{depth}");
        moment.tools[0].position.z = 91.0;
        assert_eq!(by_bands(&scene, &moment), None, "above the margin");
        moment.tools[0].position = Vector3::new(4.0, 3.0, 85.0);
        assert_eq!(by_bands(&scene, &moment), None, "beside all sites");
    }
}
