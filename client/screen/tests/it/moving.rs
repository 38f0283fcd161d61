//! Motion in pictures: tissue, tools between two instants, and rest afterwards.

use nalgebra::{Point2, Rotation3};
use sulcus_proto::display::{DisplayScene, Moved, MovedHandle, STEP_M, Spot};
use sulcus_screen::gpu::{Image, Mode};
use sulcus_screen::moment::Moment;
use sulcus_screen::quality::Quality;
use sulcus_screen::stage::{Owner, Stage};

use crate::common::{Eye, Seeded, pairs, renderer};
use crate::identity::{SIZE, compare, operator, part_at};
use crate::scene::{GINGIVA_36, PROBE, SHEETS, held, mouth, tool_at};
use crate::shapes::V;

/// Both sheets in sight.
fn before_the_sheets() -> Eye {
    Eye::looking(
        V::new(60.0, 380.0, 120.0),
        V::new(0.0, 10.0, -6.0),
        30.0,
        SIZE,
    )
}

/// Displacement of one handle of an object, mm.
fn pulled(object: u16, handle: u16, by: V) -> Moved {
    let steps = (by / (f64::from(STEP_M) * 1e3)).map(|x| x.round() as i16);
    Moved {
        object,
        handles: vec![MovedHandle {
            handle,
            by: steps.into(),
        }],
    }
}

fn with(scene: &DisplayScene, moved: Vec<Moved>, bleeds: bool) -> Moment {
    let spot = Spot {
        object: GINGIVA_36,
        site: 1,
        since: 0,
    };
    Moment {
        moved,
        spots: if bleeds {
            vec![(spot, 4.0)]
        } else {
            Vec::new()
        },
        ..Moment::rest(scene)
    }
}

#[test]
fn moved_vertices_move_their_pixels_and_no_others() {
    let scene = mouth();
    let Some(mut renderer) = renderer(&scene, Quality::Low, Mode::Identity) else {
        return;
    };
    let (eye, by) = (before_the_sheets(), V::new(0.5, 0.0, 3.0));
    let rest = eye.picture(&mut renderer, &Moment::rest(&scene));
    let moment = with(&scene, vec![pulled(SHEETS[0], 1, by)], false);
    let moved = eye.picture(&mut renderer, &moment);
    // Places of the sheet's moved vertices, before and after.
    let object = &scene.objects[usize::from(SHEETS[0])];
    let skin = object.skin.as_ref().expect("a skin");
    let weight = |v: usize| {
        skin.carriers(v)
            .find(|(k, _)| *k == 1)
            .map_or(0.0, |(_, w)| w)
    };
    let places: Vec<Point2<f64>> = (0..)
        .zip(object.mesh.vertices())
        .filter(|(v, _)| weight(*v) > 0.0)
        .flat_map(|(v, at)| {
            let at = V::from(at.map(|x| f64::from(x) * 1e3));
            [at, at + by * f64::from(weight(v))].map(|at| eye.place(&at))
        })
        .collect();
    let border = |pick: fn(f64, f64) -> f64, k: usize| {
        places
            .iter()
            .map(|at| at[k])
            .reduce(pick)
            .expect("a vertex")
    };
    // A triangle of a moved vertex reaches one cell of the sheet, 1.25 mm, beyond.
    let cell = eye.pixels(1.25) + 1.0;
    let low = [0, 1].map(|k| border(f64::min, k) - cell);
    let high = [0, 1].map(|k| border(f64::max, k) + cell);
    let changed: Vec<[f64; 2]> = pairs(&rest, &moved)
        .filter(|(_, _, a, b)| a != b)
        .map(|(x, y, _, _)| [f64::from(x), f64::from(y)])
        .collect();
    println!("{} pixels moved", changed.len());
    // The sheet's edge rises by up to 3 mm over some 5 mm.
    let area = eye.pixels(1.0).powi(2);
    assert!(
        changed.len() as f64 > 5.0 * area,
        "{} pixels",
        changed.len()
    );
    let inside = |at: &[f64; 2]| (0..2).all(|k| (low[k]..high[k]).contains(&at[k]));
    let outside: Vec<_> = changed.iter().filter(|at| !inside(at)).collect();
    assert!(outside.is_empty(), "{outside:?} beyond {low:?} to {high:?}");
    let mut seeded = Seeded(11);
    let pixels = || Some([0, 1].map(|k| seeded.within(low[k], high[k]) as u32));
    let count = compare(&scene, &moment, &eye, &moved, pixels);
    println!(
        "moved sheet: {} exact, {} at edges",
        count.exact, count.edge
    );
    count.check(3);
}

#[test]
fn thinned_tissue_moves_as_far_as_whole_tissue() {
    let scene = mouth();
    let eye = before_the_sheets();
    let pull = vec![pulled(SHEETS[0], 1, V::new(0.5, 0.0, 3.0))];
    let (rest, moment) = (Moment::rest(&scene), with(&scene, pull, false));
    let mut areas = Vec::new();
    for quality in Quality::ALL {
        let Some(mut renderer) = renderer(&scene, quality, Mode::Beauty) else {
            return;
        };
        let [before, moved, after] =
            [&rest, &moment, &rest].map(|moment| eye.picture(&mut renderer, moment));
        assert!(before == after, "{quality:?}: no return to rest");
        // Light changes by little where a surface moves in its own plane.
        let is_far =
            |(_, _, a, b): &(u32, u32, [u8; 4], [u8; 4])| (0..3).any(|k| a[k].abs_diff(b[k]) > 12);
        let area = eye.pixels(1.0).powi(2);
        areas.push(pairs(&before, &moved).filter(is_far).count() as f64 / area);
    }
    println!("moved by level: {areas:.1?} mm2");
    let whole = areas[1];
    assert!(
        whole > 2.0 && areas.iter().all(|own| (0.5..2.0).contains(&(own / whole))),
        "{areas:.1?}"
    );
}

#[test]
fn a_tool_between_two_instants_is_halfway_in_place_and_angle() {
    let scene = mouth();
    let Some(mut renderer) = renderer(&scene, Quality::Low, Mode::Identity) else {
        return;
    };
    let at = |share: f64| {
        let mut moment = held(&scene);
        let axis = V::new(0.2, -1.0, 0.3).normalize() * (1.1 * share);
        let place = V::new(-6.0, 9.0, 1.0) + V::new(14.0, 1.0, 4.0) * share;
        moment.tools[PROBE] = tool_at(place, &Rotation3::new(axis));
        moment
    };
    let eye = operator();
    for share in [0.0, 0.25, 0.5, 1.0] {
        let between = at(0.0).between(&at(1.0), share as f32);
        let picture = eye.picture(&mut renderer, &between);
        let on_probe = |x: u32, y: u32| part_at(&picture, &scene, x, y) == Some(Owner::Tool(0));
        let pixels: Vec<[u32; 2]> = (0..SIZE[1])
            .flat_map(|y| (0..SIZE[0]).map(move |x| [x, y]))
            .filter(|[x, y]| on_probe(*x, *y))
            .collect();
        // Half of the rays at the drawn probe, half beside it.
        let mut seeded = Seeded(3);
        let near = || {
            let [x, y] = pixels[(seeded.share() * pixels.len() as f64) as usize];
            let aside = if seeded.share() < 0.5 { 0.0 } else { 24.0 };
            let x = f64::from(x) + aside * (seeded.share() - 0.5);
            Some([x.clamp(0.0, f64::from(SIZE[0] - 1)) as u32, y])
        };
        let count = compare(&scene, &at(share), &eye, &picture, near);
        println!(
            "share {share}: {} exact, {} at edges",
            count.exact, count.edge
        );
        count.check(4);
    }
}

#[test]
fn half_a_turn_has_no_shortest_way_and_ends_in_the_later_pose() {
    let scene = mouth();
    let (mut a, mut b) = (held(&scene), held(&scene));
    a.tools[PROBE] = tool_at(V::zeros(), &Rotation3::identity());
    b.tools[PROBE] = tool_at(
        V::zeros(),
        &Rotation3::from_euler_angles(std::f64::consts::PI, 0.0, 0.0),
    );
    for share in [0.0, 0.3, 1.0] {
        let turn = a.between(&b, share).tools[PROBE].orientation;
        assert!((turn.norm() - 1.0).abs() < 1e-5, "{turn}");
    }
    assert_eq!(a.between(&b, 1.0).tools[PROBE], b.tools[PROBE]);
}

#[test]
fn tissue_returns_exactly_to_rest() {
    let scene = mouth();
    let by = V::new(0.0, 2.5, -1.5);
    let pull = |object| vec![pulled(object, 3, by)];
    let courses: [&[Moment]; 3] = [
        &[with(&scene, pull(SHEETS[0]), false)],
        &[
            with(&scene, pull(SHEETS[0]), false),
            with(&scene, pull(SHEETS[1]), true),
            with(&scene, Vec::new(), true),
        ],
        // Blood writes all parts to the adapter, the neighbour of a moved sheet among them.
        &[
            with(&scene, pull(SHEETS[0]), true),
            with(&scene, pull(SHEETS[0]), false),
        ],
    ];
    let Some(mut renderer) = renderer(&scene, Quality::Full, Mode::Beauty) else {
        return;
    };
    let (eye, rest) = (before_the_sheets(), Moment::rest(&scene));
    let before = eye.picture(&mut renderer, &rest);
    for (k, course) in courses.into_iter().enumerate() {
        for moment in course {
            let moved: Image = eye.picture(&mut renderer, moment);
            assert!(moved != before, "course {k} moves nothing");
        }
        let after = eye.picture(&mut renderer, &rest);
        let apart = pairs(&before, &after).filter(|(_, _, a, b)| a != b).count();
        assert_eq!(apart, 0, "pixels differ after course {k}");
    }
}

#[test]
fn all_vertices_that_change_with_a_neighbour_are_named() {
    let scene = mouth();
    let mut stage = Stage::new(&scene, 0);
    let pull = vec![pulled(SHEETS[0], 3, V::new(0.0, 2.5, -1.5))];
    for moment in [with(&scene, pull, false), Moment::rest(&scene)] {
        let before = stage.moving.clone();
        let named = stage.follow(&moment);
        let changed = |v: &usize| stage.moving[*v] != before[*v];
        let changed: Vec<usize> = (0..before.len()).filter(changed).collect();
        let own = &stage.object(SHEETS[0]).expect("a sheet").vertices;
        assert!(changed.iter().any(|v| own.contains(v)));
        // The normals of the common border are those of both sheets.
        let neighbour = &stage.object(SHEETS[1]).expect("a sheet").vertices;
        assert!(changed.iter().any(|v| neighbour.contains(v)));
        let missing: Vec<&usize> = changed
            .iter()
            .filter(|v| !named.iter().any(|range| range.contains(v)))
            .collect();
        assert!(
            missing.is_empty(),
            "{} vertices, {missing:?}",
            missing.len()
        );
    }
}
