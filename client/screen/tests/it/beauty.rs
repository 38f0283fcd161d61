//! Contents of lit pictures at every level of quality: mirror, bands and bared roots.

use nalgebra::Point2;
use sulcus_proto::display::DisplayScene;
use sulcus_screen::gpu::{Image, Mode};
use sulcus_screen::moment::Moment;
use sulcus_screen::quality::Quality;
use sulcus_screen::stage::Owner;

use crate::caster::{Caster, End};
use crate::common::{Eye, Seeded, brightness, mean, renderer};
use crate::identity::{SIZE, operator, part_at};
use crate::scene::{BAND_MM, BORDER_MM, PROBE, held, mouth};
use crate::shapes::V;

/// Rays whose pixels are judged.
const RAYS: usize = 4_000;
/// Bands that are judged: the tip itself and the last band are left out.
const BANDS: std::ops::Range<usize> = 1..14;

/// Pictures of all levels.
fn levels(eye: &Eye, moment: &Moment) -> Option<Vec<(Quality, Image)>> {
    let scene = mouth();
    let draw = |quality| {
        let mut renderer = renderer(&scene, quality, Mode::Beauty)?;
        Some((quality, eye.picture(&mut renderer, moment)))
    };
    Quality::ALL.into_iter().map(draw).collect()
}

/// Pixels of seeded rays inside of parts, two pixels from any border, and what the rays meet.
fn inner(scene: &DisplayScene, moment: &Moment, eye: &Eye) -> Option<Vec<([u32; 2], End)>> {
    let mut renderer = renderer(scene, Quality::Low, Mode::Identity)?;
    let parts = eye.picture(&mut renderer, moment);
    let caster = Caster::new(scene, moment);
    let mut seeded = Seeded(77);
    let pixels = (0..RAYS).map(|_| SIZE.map(|n| seeded.within(2.0, f64::from(n) - 3.0) as u32));
    let is_inner = |[x, y]: &[u32; 2]| {
        let own = part_at(&parts, scene, *x, *y);
        let around = [[x - 2, *y], [x + 2, *y], [*x, y - 2], [*x, y + 2]];
        own.is_some()
            && around
                .iter()
                .all(|[x, y]| part_at(&parts, scene, *x, *y) == own)
    };
    let end = |at: [u32; 2]| {
        let [x, y] = at.map(|n| f64::from(n) + 0.5);
        (at, caster.end(eye, Point2::new(x, y)))
    };
    Some(pixels.filter(is_inner).map(end).collect())
}

/// Share of blue in red of the pixels of rays.
fn tint(picture: &Image, rays: &[([u32; 2], End)], pick: impl Fn(&End) -> bool) -> f64 {
    let picked: Vec<_> = rays.iter().filter(|(_, end)| pick(end)).collect();
    assert!(picked.len() > 20, "{} rays", picked.len());
    let colours = picked.iter().map(|([x, y], _)| picture.at(*x, *y));
    let [r, _, b] = mean(colours).expect("a pixel");
    b / r
}

fn is_tooth(end: &End) -> bool {
    matches!(end.hit, Some(Owner::Object(0..=2)))
}

fn is_gum(end: &End) -> bool {
    matches!(end.hit, Some(Owner::Object(3..=5)))
}

#[test]
fn bared_roots_are_darker_and_yellower_than_crowns_at_every_level() {
    let scene = mouth();
    let (eye, moment) = (operator(), held(&scene));
    let rays = inner(&scene, &moment, &eye);
    let (Some(rays), Some(levels)) = (rays, levels(&eye, &moment)) else {
        return;
    };
    // Merged meshes blur the border by the size of their cells.
    let crown = |end: &End| is_tooth(end) && !end.is_reflected && end.at.z > BORDER_MM + 1.5;
    let root = |end: &End| is_tooth(end) && !end.is_reflected && end.at.z < BORDER_MM - 1.2;
    for (quality, picture) in levels {
        let [crown, root] = [tint(&picture, &rays, crown), tint(&picture, &rays, root)];
        println!("{quality:?}: blue in red {crown:.2} of crowns, {root:.2} of roots");
        assert!(crown > 0.75 && root < 0.65 * crown, "{quality:?}");
    }
}

#[test]
fn the_mirror_shows_teeth_and_gums_in_their_colours_at_every_level() {
    let scene = mouth();
    let (eye, moment) = (operator(), held(&scene));
    let rays = inner(&scene, &moment, &eye);
    let (Some(rays), Some(levels)) = (rays, levels(&eye, &moment)) else {
        return;
    };
    let crown = |end: &End| end.is_reflected && is_tooth(end) && end.at.z > BORDER_MM + 1.5;
    let root = |end: &End| end.is_reflected && is_tooth(end) && end.at.z < BORDER_MM - 1.2;
    let gum = |end: &End| end.is_reflected && is_gum(end);
    for (quality, picture) in levels {
        let crown = tint(&picture, &rays, crown);
        let [root, gum] = [tint(&picture, &rays, root), tint(&picture, &rays, gum)];
        println!(
            "{quality:?}: blue in red {crown:.2} of crowns, {root:.2} of roots, {gum:.2} of gums"
        );
        assert!(
            crown > 0.7 && root < 0.75 * crown && gum < 0.8 * crown,
            "{quality:?}"
        );
    }
}

#[test]
fn bands_are_dark_between_steel_at_every_level() {
    let scene = mouth();
    let (eye, moment) = (operator(), held(&scene));
    let Some(levels) = levels(&eye, &moment) else {
        return;
    };
    let tool = &moment.tools[PROBE];
    let tip = tool.position.cast::<f64>();
    let axis = tool.orientation.cast::<f64>() * V::z();
    let [low, high] = [-0.5, 14.5].map(|along| eye.place(&(tip + axis * along)));
    // Places along the probe that pixels show, in bands; the near side of a slanted probe is not its axis.
    let caster = Caster::new(&scene, &moment);
    let columns = low.x.min(high.x) as u32 - 5..low.x.max(high.x) as u32 + 5;
    let pixels = (high.y as u32..low.y as u32).flat_map(|y| columns.clone().map(move |x| [x, y]));
    let on_probe: Vec<([u32; 2], f64)> = pixels
        .filter_map(|[x, y]| {
            let end = caster.end(&eye, Point2::new(f64::from(x) + 0.5, f64::from(y) + 0.5));
            let is_probe = end.hit == Some(Owner::Tool(PROBE as u8)) && !end.is_reflected;
            is_probe.then(|| ([x, y], (end.at - tip).dot(&axis) / BAND_MM))
        })
        .collect();
    for (quality, picture) in levels {
        let band = |k: usize| {
            let inner = k as f64 + 0.25..k as f64 + 0.75;
            let own = on_probe.iter().filter(|(_, along)| inner.contains(along));
            let own: Vec<f64> = own
                .map(|([x, y], _)| brightness(picture.at(*x, *y)))
                .collect();
            assert!(own.len() > 5, "band {k}: {} pixels", own.len());
            own.iter().sum::<f64>() / own.len() as f64
        };
        let bands: Vec<f64> = BANDS.map(band).collect();
        let worst = BANDS.skip(1).zip(bands.windows(2)).map(|(k, pair)| {
            let [dark, light] = if k % 2 == 1 {
                [pair[1], pair[0]]
            } else {
                [pair[0], pair[1]]
            };
            dark / light
        });
        let worst = worst.fold(0.0f64, f64::max);
        println!("{quality:?}: dark is at most {worst:.2} of steel, {bands:.0?}");
        assert!(worst < 0.6, "{quality:?}: {bands:.0?}");
    }
}
