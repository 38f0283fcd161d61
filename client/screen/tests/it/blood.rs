//! Blood in pictures: where it shows, and how it grows.

use sulcus_proto::display::Spot;
use sulcus_screen::gpu::Mode;
use sulcus_screen::moment::Moment;
use sulcus_screen::quality::Quality;

use crate::common::{Eye, pairs, renderer, rgb};
use crate::identity::SIZE;
use crate::scene::{GINGIVA_36, mouth};
use crate::shapes::V;

/// Farthest blood from its site, mm: the line along the sulcus has a half length of 1.9 mm and grows by its own height.
const REACH_MM: f64 = 3.5;
/// Edge of a triangle of the gingiva, mm: colours run from vertex to vertex.
const EDGE_MM: f64 = 0.4;

#[test]
fn blood_reddens_pixels_near_its_site_alone_and_grows() {
    let scene = mouth();
    let site = scene.objects[usize::from(GINGIVA_36)].sites[1];
    let site = V::from(site.map(|x| f64::from(x) * 1e3));
    let eye = Eye::looking(V::new(40.0, 380.0, 180.0), site, 14.0, SIZE);
    let middle = eye.place(&site);
    for quality in [Quality::Full, Quality::Plain, Quality::Low] {
        let Some(mut renderer) = renderer(&scene, quality, Mode::Beauty) else {
            return;
        };
        let clean = eye.picture(&mut renderer, &Moment::rest(&scene));
        let mut counts = Vec::new();
        for age in [0.15, 0.7, 2.5, 5.0, 60.0] {
            let spot = Spot {
                object: GINGIVA_36,
                site: 1,
                since: 0,
            };
            let moment = Moment {
                spots: vec![(spot, age)],
                ..Moment::rest(&scene)
            };
            let bloody = eye.picture(&mut renderer, &moment);
            let mut red = 0;
            for (x, y, before, after) in pairs(&clean, &bloody) {
                if before == after {
                    continue;
                }
                let off = nalgebra::Point2::new(f64::from(x) + 0.5, f64::from(y) + 0.5) - middle;
                let far = off.norm() / eye.pixels(1.0);
                assert!(
                    far < REACH_MM + EDGE_MM,
                    "{quality:?}, {age} s: {far:.2} mm away"
                );
                let (before, after) = (rgb(before), rgb(after));
                // Blood is darker than gingiva and has less green for its red.
                let is_redder = after[1] * (before[0] + 1.0) < 0.8 * before[1] * (after[0] + 1.0);
                red += usize::from(is_redder && after[1] < before[1]);
            }
            counts.push(red);
        }
        println!("{quality:?}: red pixels {counts:?}");
        assert!(counts[0] > 20, "{counts:?}");
        assert!(
            counts[1] > counts[0] && counts[2] > 2 * counts[1],
            "{counts:?}"
        );
        assert!(
            counts[3] > counts[2] && counts[4] == counts[3],
            "{counts:?}"
        );
        let dry = eye.picture(&mut renderer, &Moment::rest(&scene));
        assert!(dry == clean, "{quality:?}: blood stays");
    }
}

/// A coarse mesh may have no vertex within the small spot of blood.
#[test]
fn no_level_misses_blood_at_any_site_in_sight() {
    let mut scene = mouth();
    scene.objects.retain(|object| object.skin.is_none());
    let eye = Eye::looking(
        V::new(0.0, 340.0, 260.0),
        V::new(0.0, 5.0, -2.0),
        36.0,
        SIZE,
    );
    for quality in Quality::ALL {
        let Some(mut renderer) = renderer(&scene, quality, Mode::Beauty) else {
            return;
        };
        let dry = eye.picture(&mut renderer, &Moment::rest(&scene));
        let mut areas = Vec::new();
        for (object, site) in (3u16..=5).flat_map(|object| [0u8, 1, 2].map(|site| (object, site))) {
            let at = scene.objects[usize::from(object)].sites[usize::from(site)];
            let middle = eye.place(&V::from(at.map(|x| f64::from(x) * 1e3)));
            let spot = Spot {
                object,
                site,
                since: 0,
            };
            let [early, late] = [1.0, 8.0].map(|age| {
                let moment = Moment {
                    spots: vec![(spot, age)],
                    ..Moment::rest(&scene)
                };
                let bloody = eye.picture(&mut renderer, &moment);
                let is_blood = |(x, y, dry, bloody): &(u32, u32, [u8; 4], [u8; 4])| {
                    let off = nalgebra::Point2::new(f64::from(*x), f64::from(*y)) - middle;
                    // A highlight lies over blood as over gingiva, so that only a part of the green is lost.
                    let loss = rgb(*dry)[1] - rgb(*bloody)[1];
                    off.norm() < eye.pixels(REACH_MM) && loss > 24.0
                };
                pairs(&dry, &bloody).filter(is_blood).count() as f64 / eye.pixels(1.0).powi(2)
            });
            areas.push([early, late]);
        }
        let least = |k: usize| {
            areas
                .iter()
                .map(|area| area[k])
                .fold(f64::INFINITY, f64::min)
        };
        println!(
            "{quality:?}: at least {:.2} and {:.2} mm2: {areas:.1?}",
            least(0),
            least(1)
        );
        assert!(least(0) > 0.1 && least(1) > 0.5, "{quality:?}: {areas:.2?}");
    }
}
