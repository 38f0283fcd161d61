//! Identity pictures against rays, seen directly.

use nalgebra::Point2;
use sulcus_proto::display::DisplayScene;
use sulcus_screen::gpu::{Image, Mode, Renderer};
use sulcus_screen::moment::Moment;
use sulcus_screen::quality::Quality;
use sulcus_screen::stage::Owner;

use crate::caster::{Caster, Hit};
use crate::common::{Eye, Seeded, renderer};
use crate::scene::{MIRROR, PROBE, held, mouth};
use crate::shapes::V;

/// Size of the pictures that rays judge.
pub const SIZE: [u32; 2] = [960, 600];
/// Rays of a comparison.
pub const RAYS: usize = 500;
/// Least number of rays that agree exactly.
pub const EXACT: usize = 495;

/// Outcome of a comparison.
#[derive(Debug, Default)]
pub struct Count {
    /// Rays whose pixel shows the same part.
    pub exact: usize,
    /// Rays with another part, which another ray within a pixel meets.
    pub edge: usize,
    /// Places of the other rays.
    pub wrong: Vec<(u32, u32, Hit, Hit)>,
    /// Different parts that the rays met.
    pub parts: Vec<Hit>,
}

impl Count {
    #[track_caller]
    pub fn check(&self, parts: usize) {
        let told = format!("{self:?}");
        assert_eq!(self.exact + self.edge, RAYS, "{told}");
        assert!(self.exact >= EXACT, "{told}");
        assert!(self.parts.len() >= parts, "{told}");
    }
}

/// Part that a pixel of an identity picture shows.
pub fn part_at(picture: &Image, scene: &DisplayScene, x: u32, y: u32) -> Hit {
    let colour = picture.at(x, y);
    let objects = (0..scene.objects.len() as u16).map(Owner::Object);
    let tools = (0..scene.tools.len() as u8).map(Owner::Tool);
    let mut owners = objects.chain(tools);
    owners.find(|owner| Renderer::identity(*owner) == colour)
}

/// Compares a picture with rays through the middles of pixels.
pub fn compare(
    scene: &DisplayScene,
    moment: &Moment,
    eye: &Eye,
    picture: &Image,
    pixels: impl FnMut() -> Option<[u32; 2]>,
) -> Count {
    let caster = Caster::new(scene, moment);
    let mut count = Count::default();
    for [x, y] in std::iter::from_fn(pixels).take(RAYS) {
        let at = Point2::new(f64::from(x) + 0.5, f64::from(y) + 0.5);
        let (drawn, cast) = (part_at(picture, scene, x, y), caster.end(eye, at).hit);
        if !count.parts.contains(&drawn) {
            count.parts.push(drawn);
        }
        if drawn == cast {
            count.exact += 1;
        } else if caster.is_near(eye, at, drawn) {
            count.edge += 1;
        } else {
            count.wrong.push((x, y, drawn, cast));
        }
    }
    count
}

/// Eye of an operator at the buccal side, above the teeth.
pub fn operator() -> Eye {
    let (eye, target) = (V::new(126.0, 315.0, 252.0), V::new(0.0, -4.0, 2.0));
    Eye::looking(eye, target, 46.0, SIZE)
}

/// Seeded pixels of the whole picture.
pub fn anywhere(seed: u64) -> impl FnMut() -> Option<[u32; 2]> {
    let mut seeded = Seeded(seed);
    move || Some(SIZE.map(|n| (seeded.share() * f64::from(n)) as u32))
}

fn judge(name: &str, eye: &Eye, scene: &DisplayScene, moment: &Moment, parts: usize) {
    let Some(mut renderer) = renderer(scene, Quality::Low, Mode::Identity) else {
        return;
    };
    let picture = eye.picture(&mut renderer, moment);
    let count = compare(scene, moment, eye, &picture, anywhere(41));
    println!("{name}: {} exact, {} at edges", count.exact, count.edge);
    count.check(parts);
}

#[test]
fn five_hundred_pixels_show_what_rays_meet() {
    let scene = mouth();
    judge("direct", &operator(), &scene, &held(&scene), 10);
}

#[test]
fn an_eye_aside_of_the_glass_sees_what_rays_meet() {
    let scene = mouth();
    let mut eye = operator();
    eye.eye += V::new(90.0, -60.0, 70.0);
    judge("eye aside", &eye, &scene, &held(&scene), 10);
}

#[test]
fn a_flipped_picture_shows_what_flipped_rays_meet() {
    let scene = mouth();
    let mut eye = operator();
    eye.mirrored = true;
    judge("flipped", &eye, &scene, &held(&scene), 10);
    eye.eye += V::new(-70.0, 40.0, -30.0);
    judge("flipped, eye aside", &eye, &scene, &held(&scene), 10);
}

#[test]
fn a_tool_that_no_hand_holds_is_not_drawn() {
    let scene = mouth();
    let mut moment = held(&scene);
    moment.tools[PROBE].held = false;
    moment.tools[MIRROR].held = false;
    let Some(mut renderer) = renderer(&scene, Quality::Low, Mode::Identity) else {
        return;
    };
    let eye = operator();
    let tools = |picture: &Image| {
        let colours = [0, 1].map(|slot| Renderer::identity(Owner::Tool(slot)));
        picture.rgba.iter().filter(|c| colours.contains(c)).count()
    };
    assert_eq!(tools(&eye.picture(&mut renderer, &moment)), 0);
    assert!(tools(&eye.picture(&mut renderer, &held(&scene))) > 2_000);
}
