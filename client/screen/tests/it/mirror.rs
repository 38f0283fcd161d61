//! Identity pictures against rays, seen in the mirror.

use nalgebra::Point2;
use sulcus_proto::display::{DisplayScene, Kind};
use sulcus_screen::gpu::Mode;
use sulcus_screen::moment::{Moment, ToolAt};
use sulcus_screen::quality::Quality;
use sulcus_screen::stage::Owner;
use sulcus_screen::views::View;

use crate::caster::Caster;
use crate::common::{Eye, Seeded, renderer};
use crate::identity::{RAYS, SIZE, compare, operator, part_at};
use crate::scene::{GLASS_MM, MIRROR, held, mirror_at, mouth, object};
use crate::shapes::{Shape, V};

/// Seeded pixels on the glass of a mirror, whatever lies before it.
fn on_glass(eye: &Eye, tool: &ToolAt, seed: u64) -> impl FnMut() -> [u32; 2] {
    let mut seeded = Seeded(seed);
    let (eye, tool) = (*eye, *tool);
    move || {
        loop {
            let (around, out) = (
                seeded.within(0.0, std::f64::consts::TAU),
                seeded.share().sqrt(),
            );
            let on = V::new(around.cos(), around.sin(), 0.0) * (0.99 * GLASS_MM * out);
            let world = tool.orientation.cast::<f64>() * on + tool.position.cast::<f64>();
            let at = eye.place(&world);
            let is_inside = |x: f64, size: u32| (0.0..f64::from(size)).contains(&x);
            if is_inside(at.x, eye.size[0]) && is_inside(at.y, eye.size[1]) {
                return [at.x as u32, at.y as u32];
            }
        }
    }
}

/// Compares 500 reflected rays with the glass; `parts` is the least number of parts that show in it.
fn judge(name: &str, eye: &Eye, scene: &DisplayScene, moment: &Moment, parts: usize) {
    let Some(mut renderer) = renderer(scene, Quality::Low, Mode::Identity) else {
        return;
    };
    let picture = eye.picture(&mut renderer, moment);
    let caster = Caster::new(scene, moment);
    let mut pixel = on_glass(eye, &moment.tools[MIRROR], 7);
    let mut is_reflected = |at: &[u32; 2]| {
        let [x, y] = at.map(|n| f64::from(n) + 0.5);
        caster.end(eye, Point2::new(x, y)).is_reflected
    };
    let reflected = || {
        std::iter::repeat_with(&mut pixel)
            .take(10_000)
            .find(&mut is_reflected)
    };
    let count = compare(scene, moment, eye, &picture, reflected);
    println!("{name}: {} exact, {} at edges", count.exact, count.edge);
    count.check(parts);
}

/// The glass from near, as a student looks at it.
fn near() -> Eye {
    let mut eye = operator();
    let middle = V::new(0.0, -14.0, 6.0);
    eye.glass = eye
        .glass
        .map(|at| middle + (at - V::new(0.0, -4.0, 2.0)) * 0.6);
    eye
}

#[test]
fn five_hundred_pixels_of_the_glass_show_what_reflected_rays_meet() {
    let scene = mouth();
    judge("mirror", &operator(), &scene, &held(&scene), 4);
    judge("mirror from near", &near(), &scene, &held(&scene), 4);
}

#[test]
fn the_glass_is_true_for_an_eye_aside_and_for_flipped_pictures() {
    let scene = mouth();
    let moment = held(&scene);
    for (name, by, mirrored) in [
        ("mirror, eye aside", V::new(80.0, -50.0, 60.0), false),
        ("mirror, flipped", V::zeros(), true),
        (
            "mirror, flipped, eye aside",
            V::new(-60.0, 40.0, 30.0),
            true,
        ),
    ] {
        let mut eye = near();
        eye.eye += by;
        eye.mirrored = mirrored;
        judge(name, &eye, &scene, &moment, 4);
    }
}

#[test]
fn a_glass_that_is_cut_by_the_border_of_the_picture_is_true() {
    let scene = mouth();
    let moment = held(&scene);
    for by in [V::new(-30.0, 0.0, 0.0), V::new(12.0, 0.0, 12.0)] {
        let mut eye = near();
        eye.glass = eye.glass.map(|at| at + by);
        judge("mirror at the border", &eye, &scene, &moment, 3);
    }
}

/// Walls of a room show in a glass that the eye sees almost from the side: the far plane of the reflection, which
/// leans with the glass, must not cut them.
#[test]
fn a_far_wall_shows_in_a_steep_glass_flipped_or_not() {
    let mut scene = mouth();
    for (from, to) in [
        ([-700.0, -720.0], [700.0, -700.0]),
        ([-720.0, -700.0], [-700.0, 700.0]),
        ([700.0, -700.0], [720.0, 700.0]),
    ] {
        let [low, high] = [(from, -600.0), (to, 700.0)].map(|([x, y], z)| V::new(x, y, z));
        let wall = Shape::block(low, high, 1).coloured([9, 9, 9, 255]);
        scene.objects.push(object(Kind::Other, 0, &wall));
    }
    let middle = V::new(0.0, 0.0, 60.0);
    let mut eye = Eye::looking(V::new(0.0, 420.0, 60.0), middle, 30.0, SIZE);
    for (side, mirrored) in [(-1.0, false), (-1.0, true), (1.0, false), (1.0, true)] {
        let mut moment = held(&scene);
        moment.tools[MIRROR] = mirror_at(middle, V::new(side, 0.1, 0.0));
        eye.mirrored = mirrored;
        judge("steep mirror", &eye, &scene, &moment, 1);
    }
}

#[test]
fn a_glass_from_behind_reflects_nothing() {
    let scene = mouth();
    let mut moment = held(&scene);
    moment.tools[MIRROR] = mirror_at(V::new(-4.0, 6.0, 18.0), V::new(-0.1, -1.5, -0.4));
    let eye = operator();
    let Some(mut renderer) = renderer(&scene, Quality::Low, Mode::Identity) else {
        return;
    };
    // An earlier picture leaves a reflection behind.
    eye.picture(&mut renderer, &held(&scene));
    let picture = eye.picture(&mut renderer, &moment);
    let mut pixel = on_glass(&eye, &moment.tools[MIRROR], 5);
    let count = compare(&scene, &moment, &eye, &picture, || Some(pixel()));
    println!(
        "from behind: {} exact, {} at edges",
        count.exact, count.edge
    );
    count.check(1);
    let mut pixel = on_glass(&eye, &moment.tools[MIRROR], 6);
    let back = (0..RAYS).filter(|_| {
        let [x, y] = pixel();
        part_at(&picture, &scene, x, y) == Some(Owner::Tool(MIRROR as u8))
    });
    let back = back.count();
    assert!(back > 400, "{back} pixels show the back of the mirror");
}

/// Over a tongue that it holds aside, a glass showed the palate to an eye in front of the mouth, and no tooth.
#[test]
fn the_eye_of_the_view_sees_the_teeth_beside_a_mirror_that_lies_on_the_tongue() {
    let scene = mouth();
    let mut moment = held(&scene);
    for side in [1.0, -1.0] {
        // The glass leans to the teeth by 27 degrees.
        let tilt = 27f64.to_radians();
        let normal = V::new(0.0, side * tilt.sin(), tilt.cos());
        let centre = V::new(0.0, -14.0 * side, 6.0);
        moment.tools[MIRROR] = mirror_at(centre, normal);
        let camera = View::Mirror.camera(&scene, &moment, None, 1.5);
        let to_eye = (camera.eye() - centre).normalize();
        let seen = normal * (2.0 * normal.dot(&to_eye)) - to_eye;
        assert!(seen.y * side > 0.9 && seen.z < 0.0, "{side}: {seen:?}");
        assert!(to_eye.z > 0.6, "{side}: {to_eye:?}");
    }
    // In front of the teeth the eye is in the middle plane, but for the side of the operator.
    moment.tools[MIRROR] = mirror_at(V::new(0.0, 0.0, 20.0), V::new(0.6, 0.0, 0.8));
    let camera = View::Mirror.camera(&scene, &moment, None, 1.5);
    let to_eye = (camera.eye() - camera.middle()).normalize();
    assert!(to_eye.y.abs() < 0.3 && to_eye.x > 0.4, "{to_eye:?}");
}
