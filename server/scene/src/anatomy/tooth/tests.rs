use std::f64::consts::{FRAC_PI_2, PI};

use sulcus_core::math::fmax;

use super::*;
use crate::mesh::check::check;

const ALL: [u8; 7] = [31, 32, 33, 34, 35, 36, 37];

fn all() -> impl Iterator<Item = Tooth> {
    ALL.into_iter().filter_map(Tooth::lower)
}

/// Extreme of the section at height `z` in direction (cos, sin) of `around`, by its support, mm.
fn support(tooth: &Tooth, around: f64, z: f64) -> f64 {
    let (c, s) = (libm::cos(around), libm::sin(around));
    let mut farthest = f64::NEG_INFINITY;
    for k in -30..=30 {
        let side = f64::from(k) * 0.2;
        let at = |r: f64| tooth.distance(&Vec3::new(r * c - side * s, r * s + side * c, z));
        let mut r = 8.0;
        while r > 0.0 && at(r) >= 0.0 {
            r -= 0.02;
        }
        if r > 0.0 && r > farthest {
            farthest = r;
        }
    }
    farthest
}

/// Height of the crown over a point, mm; none outside.
fn top(tooth: &Tooth, x: f64, y: f64) -> Option<f64> {
    let inside = |z: f64| tooth.distance(&Vec3::new(x, y, z)) < 0.0;
    let mut above = tooth.crown_height_mm() + 0.5;
    let mut z = above;
    while !inside(z) {
        above = z;
        z -= 0.15;
        if z < 0.4 * tooth.crown_height_mm() {
            return None;
        }
    }
    for _ in 0..12 {
        let middle = 0.5 * (z + above);
        if inside(middle) {
            z = middle;
        } else {
            above = middle;
        }
    }
    Some(z)
}

#[test]
fn only_lower_teeth_have_a_shape() {
    let drawn: Vec<u8> = (0..=255).filter(|n| Tooth::lower(*n).is_some()).collect();
    assert_eq!(
        drawn,
        [31, 32, 33, 34, 35, 36, 37, 41, 42, 43, 44, 45, 46, 47]
    );
}

#[test]
fn every_tooth_is_a_solid_of_the_size_asked_for() {
    for tooth in all() {
        for factor in [0.9, 1.0, 1.1] {
            let sizes = ToothSizes {
                mesiodistal_mm: Some(tooth.mesiodistal_mm() * factor),
                buccolingual_mm: Some(tooth.buccolingual_mm() * (2.0 - factor)),
                crown_height_mm: Some(tooth.crown_height_mm() * factor),
                root_length_mm: Some(tooth.root_length_mm() * (2.0 - factor)),
                ..ToothSizes::default()
            };
            let tooth = tooth.clone().with_sizes(&sizes);
            let mesh = tooth.mesh();
            let report = check(&mesh, "tooth").expect("a solid");
            assert_eq!(report.genus, 0, "{} {factor}", tooth.fdi());
            let wanted = [
                tooth.mesiodistal_mm(),
                tooth.buccolingual_mm(),
                tooth.crown_height_mm() + tooth.root_length_mm(),
            ];
            for (found, wanted) in report.size_mm.iter().zip(wanted) {
                assert!((found / wanted - 1.0).abs() < 0.01, "{tooth:?} {report:?}");
            }
            let (low, high) = mesh.bounds();
            assert!((high.z * 1e3 / tooth.crown_height_mm() - 1.0).abs() < 0.02);
            assert!((-low.z * 1e3 / tooth.root_length_mm() - 1.0).abs() < 0.02);
            if factor == 1.0 {
                assert!((19_000..26_000).contains(&report.triangles), "{report:?}");
            }
        }
    }
}

#[test]
fn the_right_side_is_the_mirror_image() {
    let sizes = ToothSizes {
        grid_mm: Some(0.4),
        ..ToothSizes::default()
    };
    let of = |fdi| {
        let tooth = Tooth::lower(fdi).expect("a lower tooth");
        tooth.with_sizes(&sizes)
    };
    let (left, right) = (of(34).mesh_of_side(), of(44).mesh_of_side());
    assert_eq!(of(34).mesh(), of(44).mesh());
    check(&right, "tooth").expect("a solid");
    assert!((left.signed_volume() / right.signed_volume() - 1.0).abs() < 1e-9);
    let same = left.vertices.iter().zip(&right.vertices);
    assert!(
        same.into_iter()
            .all(|(l, r)| l.x == r.x && l.y == -r.y && l.z == r.z)
    );
}

#[test]
fn each_side_has_one_contact_point_where_anatomy_has_it() {
    // Height over the crown's: mesial and distal, from Wheeler's thirds.
    let heights = [
        (31, (0.80, 0.98), (0.80, 0.98)),
        (32, (0.80, 0.98), (0.67, 0.95)),
        (33, (0.67, 0.95), (0.33, 0.67)),
        (34, (0.55, 0.75), (0.55, 0.75)),
        (35, (0.55, 0.75), (0.55, 0.75)),
        (36, (0.50, 0.72), (0.50, 0.72)),
        (37, (0.50, 0.72), (0.50, 0.72)),
    ];
    for (fdi, mesial, distal) in heights {
        let tooth = Tooth::lower(fdi).expect("a lower tooth");
        for (contact, (low, high), way) in tooth
            .contacts()
            .into_iter()
            .zip([mesial, distal])
            .zip([1.0, -1.0])
            .map(|((contact, range), way)| (contact, range, way))
        {
            let share = contact.z / tooth.crown_height_mm();
            assert!((low..high).contains(&share), "{fdi}: {share}");
            assert!((-0.4..0.6).contains(&contact.y), "{fdi}: {contact:?}");
            assert!(tooth.distance(&contact).abs() < 1e-3, "{fdi}: {contact:?}");
            let half = 0.5 * tooth.mesiodistal_mm();
            assert!((contact.x * way / half - 1.0).abs() < 0.03, "{contact:?}");
            // Points beyond it are free, and the surface recedes away from it on all sides.
            for k in 0..16 {
                let turn = f64::from(k) * PI / 8.0;
                let aside = Vec3::new(0.0, libm::cos(turn), libm::sin(turn)) * 1.5;
                let p = contact + aside - Vec3::x() * (0.03 * way);
                assert!(tooth.distance(&p) > 0.0, "{fdi}: {contact:?} {aside:?}");
            }
        }
    }
}

#[test]
fn embrasures_open_for_a_tilted_probe() {
    for tooth in all() {
        for (contact, way) in tooth.contacts().into_iter().zip([1.0, -1.0]) {
            let back =
                |aside: f64, by: f64| tooth.distance(&(contact + Vec3::new(-by * way, aside, 0.0)));
            for side in [2.0, -2.0] {
                assert!(back(side, 0.35) > 0.0, "{} {contact:?} {side}", tooth.fdi());
            }
            // An equal neighbour stands behind the plane through the contact.
            //
            // A probe of 0.6 mm with its tip in the midline just below the CEJ comes from the embrasure at 20
            // degrees. It touches neither tooth.
            let around = if way > 0.0 { 0.0 } else { PI };
            for side in [1.0, -1.0] {
                let tip = Vec3::new(contact.x, 0.0, tooth.cej(around) - 1.25);
                let tilt = 20.0_f64.to_radians();
                let axis = Vec3::new(0.0, side * libm::sin(tilt), libm::cos(tilt));
                for k in 3..150 {
                    let p = tip + axis * (0.1 * f64::from(k));
                    assert!(
                        ball_is_free(&tooth, &p, 0.3),
                        "{} {contact:?} {p:?}",
                        tooth.fdi()
                    );
                }
            }
        }
    }
}

/// Returns whether a ball is free of the tooth. Many points of it are tested, because the implicit function is only
/// about a distance.
fn ball_is_free(tooth: &Tooth, centre: &Vec3, radius: f64) -> bool {
    (0..26).all(|k| {
        let (turn, tilt) = (f64::from(k % 13) * PI / 6.5, if k < 13 { 0.0 } else { 0.7 });
        let flat = libm::cos(tilt);
        let out = Vec3::new(
            flat * libm::cos(turn),
            flat * libm::sin(turn),
            -libm::sin(tilt),
        );
        tooth.distance(&(centre + out * radius)) > 0.0
    })
}

#[test]
fn necks_have_their_widths() {
    let widths = [
        (31, 3.5, 5.3),
        (32, 4.0, 5.8),
        (33, 5.5, 7.0),
        (34, 5.0, 6.5),
        (35, 5.0, 7.0),
        (36, 9.0, 9.0),
        (37, 8.0, 9.0),
    ];
    for (fdi, mesiodistal, buccolingual) in widths {
        let tooth = Tooth::lower(fdi).expect("a lower tooth");
        let at = |around: f64| support(&tooth, around, tooth.cej(around));
        let (md, bl) = (at(0.0) + at(PI), at(FRAC_PI_2) + at(-FRAC_PI_2));
        assert!((md / mesiodistal - 1.0).abs() < 0.1, "{fdi}: {md}");
        assert!((bl / buccolingual - 1.0).abs() < 0.1, "{fdi}: {bl}");
    }
}

#[test]
fn the_cej_rises_towards_the_neighbours() {
    for (fdi, mesial) in [
        (31, 3.0),
        (32, 3.0),
        (33, 2.5),
        (34, 1.0),
        (35, 1.0),
        (36, 1.0),
        (37, 1.0),
    ] {
        let tooth = Tooth::lower(fdi).expect("a lower tooth");
        assert!(tooth.cej(FRAC_PI_2).abs() < 1e-9);
        assert!((tooth.cej(0.0) - mesial).abs() < 0.1, "{fdi}");
        let distal = tooth.cej(PI);
        assert!((0.5 * mesial..0.9 * mesial).contains(&distal), "{fdi}");
        assert!((0.0..0.3).contains(&tooth.cej(-FRAC_PI_2)), "{fdi}");
        // Continuous all round.
        for k in 0..720 {
            let (a, b) = (f64::from(k) * PI / 360.0, f64::from(k + 1) * PI / 360.0);
            assert!((tooth.cej(a) - tooth.cej(b)).abs() < 0.06, "{fdi} {a}");
        }
    }
    // The enamel's edge is a palpable step outwards: just above the line the tooth is thicker than a smooth
    // continuation of the root.
    let tooth = Tooth::lower(36).expect("a lower tooth");
    let buccal = |z: f64| support(&tooth, FRAC_PI_2, z);
    assert!(buccal(0.5) - buccal(-0.2) > buccal(-0.2) - buccal(-0.9) + 0.1);
}

#[test]
fn cusps_are_as_many_as_they_should_be() {
    for (fdi, wanted) in [
        (31, 1),
        (32, 1),
        (33, 1),
        (34, 2),
        (35, 3),
        (36, 5),
        (37, 4),
    ] {
        let tooth = Tooth::lower(fdi).expect("a lower tooth");
        let found = peaks(&tooth, 0.2, 0.25);
        assert_eq!(found.len(), wanted, "{fdi}: {found:?}");
    }
}

/// Summits of the crown that stand at least `prominence` mm above the saddle to a higher one.
fn peaks(tooth: &Tooth, step: f64, prominence: f64) -> Vec<Vec3> {
    let half = (6.0 / step) as i32;
    let width = (2 * half + 1) as usize;
    let mut heights = vec![f64::NEG_INFINITY; width * width];
    let mut order = Vec::new();
    for j in -half..=half {
        for i in -half..=half {
            let cell = (j + half) as usize * width + (i + half) as usize;
            if let Some(z) = top(tooth, f64::from(i) * step, f64::from(j) * step) {
                heights[cell] = z;
                order.push(cell);
            }
        }
    }
    order.sort_by(|a, b| heights[*b].total_cmp(&heights[*a]));
    // Land above a falling sea: islands merge, and the lower summit ends.
    let mut island = vec![usize::MAX; width * width];
    let root = |island: &[usize], mut cell: usize| {
        while island[cell] != cell {
            cell = island[cell];
        }
        cell
    };
    let mut found = Vec::new();
    for cell in order.iter().copied() {
        island[cell] = cell;
        for (dj, di) in [
            (-1, -1),
            (-1, 0),
            (-1, 1),
            (0, -1),
            (0, 1),
            (1, -1),
            (1, 0),
            (1, 1),
        ] {
            let beside = cell as i64 + dj * width as i64 + di;
            let Some(other) = usize::try_from(beside).ok().filter(|c| *c < island.len()) else {
                continue;
            };
            if island[other] == usize::MAX {
                continue;
            }
            let (mut a, mut b) = (root(&island, cell), root(&island, other));
            if a == b {
                continue;
            }
            if heights[a] < heights[b] {
                (a, b) = (b, a);
            }
            if heights[b] - heights[cell] > prominence {
                found.push(b);
            }
            island[b] = a;
        }
    }
    found.extend(order.first());
    let place = |k: usize| (k as f64 - f64::from(half)) * step;
    let at = |cell: usize| Vec3::new(place(cell % width), place(cell / width), heights[cell]);
    found.into_iter().map(at).collect()
}

#[test]
fn furcations_are_open_below_their_entrance_and_closed_above() {
    for tooth in all() {
        let found = tooth.furcations();
        if tooth.fdi() % 10 < 6 {
            assert!(found.is_empty());
            continue;
        }
        let [buccal, lingual] = found[..] else {
            panic!("{found:?}");
        };
        assert!(buccal.around > 1.2 && buccal.around < 1.9, "{buccal:?}");
        assert!(
            lingual.around < -1.2 && lingual.around > -1.9,
            "{lingual:?}"
        );
        assert!((-3.4..-2.6).contains(&buccal.height_mm), "{buccal:?}");
        assert!((-4.1..-3.4).contains(&lingual.height_mm), "{lingual:?}");
        // A straight way below the lower entrance leads from side to side, wide enough for a furcation probe.
        let through = lingual.height_mm - 1.0;
        for k in -70..=70 {
            for x in [-0.25, 0.0, 0.25] {
                let p = Vec3::new(x, f64::from(k) * 0.1, through);
                assert!(tooth.distance(&p) > 0.0, "{} {p:?}", tooth.fdi());
            }
        }
        for furcation in found {
            let side = libm::sin(furcation.around);
            let above = Vec3::new(0.0, 2.0 * side, furcation.height_mm + 0.6);
            assert!(tooth.distance(&above) < 0.0, "{} {above:?}", tooth.fdi());
        }
    }
}

#[test]
fn necks_are_star_shaped() {
    for tooth in all() {
        let deepest = tooth
            .furcations()
            .iter()
            .fold(-0.45 * tooth.root_length_mm(), |deepest, furcation| {
                fmax(deepest, furcation.height_mm + 0.3)
            });
        let mut z = deepest;
        while z < 0.35 * tooth.crown_height_mm() {
            for k in 0..72 {
                let around = f64::from(k) * PI / 36.0;
                let (c, s) = (libm::cos(around), libm::sin(around));
                let (mut crossings, mut inside) = (0, true);
                for step in 0..160 {
                    let r = 0.05 * f64::from(step);
                    let now = tooth.distance(&Vec3::new(r * c, r * s, z)) < 0.0;
                    crossings += u32::from(now != inside);
                    inside = now;
                }
                assert_eq!(crossings, 1, "{} at {z} mm, {around}", tooth.fdi());
            }
            z += 0.5;
        }
    }
}
