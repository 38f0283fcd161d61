//! Tests of the blended rows against their definition.

use super::*;
use crate::math::{Mat3, norm};
use proptest::prelude::*;

const TIP: f64 = 2.5e-4;

fn pairs(at: &Vec3, spheres: &[(Vec3, f64)]) -> Blender {
    let mut blender = Blender::with_capacity(spheres.len());
    blender.begin();
    for (k, (centre, radius)) in spheres.iter().enumerate() {
        let distance = norm(&(at - centre));
        let normal = (at - centre) / distance;
        blender.push(Pair::new(
            k as u32,
            distance - radius - TIP,
            normal,
            distance,
        ));
    }
    blender
}

fn rows(
    at: &Vec3,
    spheres: &[(Vec3, f64)],
    blend: f64,
    limit: f64,
) -> Vec<(ContactRow, Vec<Member>)> {
    let (contact_rows, members, _) = written(&mut pairs(at, spheres), blend, limit);
    let of = |line: &ContactRow| members[line.first as usize..][..line.members as usize].to_vec();
    contact_rows.iter().map(|line| (*line, of(line))).collect()
}

/// Returns the rows, their members and the result of [`Blender::rows`].
fn written(
    blender: &mut Blender,
    blend: f64,
    limit: f64,
) -> (Vec<ContactRow>, Vec<Member>, (f64, f64)) {
    let (mut contact_rows, mut members) = (Vec::new(), Vec::new());
    let mut here = Written {
        contact_rows: &mut contact_rows,
        members: &mut members,
    };
    let said = blender.rows(blend, limit, &mut here);
    (contact_rows, members, said)
}

/// Returns the smallest blended gap over all seeds, directly from the definition.
fn smallest(at: &Vec3, spheres: &[(Vec3, f64)], blend: f64) -> f64 {
    let seen: Vec<_> = spheres
        .iter()
        .map(|(centre, radius)| {
            let distance = norm(&(at - centre));
            (distance - radius - TIP, distance, (at - centre) / distance)
        })
        .collect();
    seen.iter().fold(f64::INFINITY, |least, seed| {
        let sum: f64 = seen
            .iter()
            .map(|other| {
                let shared = compatibility(
                    seed.2.dot(&other.2),
                    fmin(seed.1, other.1),
                    other.0 - seed.0,
                    blend,
                );
                shared * libm::exp(-(other.0 - seed.0) / blend)
            })
            .sum();
        fmin(least, seed.0 - blend * libm::log(sum))
    })
}

/// Returns a plate of spheres around the origin, in the plane rotated by `turn`.
fn plate(turn: &Mat3, radius: f64, spacing: f64) -> impl Iterator<Item = (Vec3, f64)> {
    let turn = *turn;
    (-8..=8).flat_map(move |i| {
        (-8..=8).map(move |j| {
            let flat = Vec3::new(f64::from(i) * spacing, f64::from(j) * spacing, -radius);
            (turn * flat, radius)
        })
    })
}

fn turned(angle: f64) -> Mat3 {
    crate::math::exp_rotation(&(Vec3::y() * angle))
        .to_rotation_matrix()
        .into_inner()
}

#[test]
fn on_a_smooth_surface_one_row_is_all_and_it_is_flat() {
    let spheres: Vec<_> = plate(&Mat3::identity(), 1e-3, 2.5e-4).collect();
    // The hard plate has bumps of 16 um over the pits of the lattice.
    let mut gaps = Vec::new();
    for k in 0..40 {
        let at = Vec3::new(1.3e-5 * f64::from(k), 0.7e-5 * f64::from(k), 4e-4);
        let rows = rows(&at, &spheres, 3e-5, 1.0);
        assert_eq!(rows.len(), 1, "at {at:?}");
        let (line, members) = &rows[0];
        assert!(line.normal.z > 0.95, "{:?}", line.normal);
        let sum: f64 = members.iter().map(|m| m.weight).sum();
        assert!((sum - 1.0).abs() < 1e-12);
        gaps.push(line.gap);
    }
    let low = gaps.iter().copied().fold(f64::INFINITY, fmin);
    let high = gaps
        .iter()
        .copied()
        .fold(f64::NEG_INFINITY, crate::math::fmax);
    assert!(high - low < 2e-7, "ripple {:e} m", high - low);
}

#[test]
fn a_row_is_the_derivative_of_its_gap() {
    let spheres: Vec<_> = plate(&turned(0.2), 1e-3, 2.5e-4).collect();
    let at = Vec3::new(1.1e-4, -0.7e-4, 4e-4);
    let (line, _) = rows(&at, &spheres, 3e-5, 1.0).remove(0);
    let step = 1e-8;
    for axis in 0..3 {
        let gap = |side: f64| {
            let mut there = at;
            there[axis] += side * step;
            rows(&there, &spheres, 3e-5, 1.0)[0].0.gap
        };
        let slope = (gap(1.0) - gap(-1.0)) / (2.0 * step);
        assert!(
            (slope - line.normal[axis]).abs() < 1e-6,
            "axis {axis}: {slope} against {}",
            line.normal[axis]
        );
    }
}

#[test]
fn the_walls_of_a_groove_keep_rows_of_their_own() {
    let mut spheres: Vec<_> = plate(&turned(0.7), 1e-3, 2.5e-4).collect();
    spheres.extend(plate(&turned(-0.7), 1e-3, 2.5e-4));
    let at = Vec3::new(0.0, 0.0, 4e-4);
    let rows = rows(&at, &spheres, 3e-5, 1e-3);
    let tilt = |line: &ContactRow| line.normal.x / norm(&line.normal);
    for side in [1.0, -1.0] {
        assert!(
            rows.iter()
                .any(|(line, _)| (tilt(line) * side - 0.644).abs() < 0.05),
            "no row of the wall on side {side}: {:?}",
            rows.iter().map(|(line, _)| line.normal).collect::<Vec<_>>()
        );
    }
}

#[test]
fn nothing_within_the_limit_is_no_row() {
    let spheres: Vec<_> = plate(&Mat3::identity(), 1e-3, 2.5e-4).collect();
    let at = Vec3::new(0.0, 0.0, 2e-3);
    assert!(rows(&at, &spheres, 3e-5, 1e-3).is_empty());
    assert!(rows(&at, &[], 3e-5, 1.0).is_empty());
}

#[test]
fn hollowness_is_the_second_derivative_in_a_groove_and_nothing_on_a_ball() {
    let mut spheres: Vec<_> = plate(&turned(0.15), 1e-3, 2.5e-4).collect();
    spheres.extend(plate(&turned(-0.15), 1e-3, 2.5e-4));
    let blend = 1e-4;
    let contacts = |at: &Vec3| -> Vec<Contact> {
        let normal = |centre: &Vec3| (at - centre) / norm(&(at - centre));
        let contact = |(centre, _): &(Vec3, f64)| Contact {
            tool: 0,
            object: 0,
            object_sphere: 0,
            tool_sphere: 0,
            normal: normal(centre),
            gap: 0.0,
            arm: Vec3::zeros(),
        };
        spheres.iter().map(contact).collect()
    };
    let at = Vec3::new(0.0, 1e-5, 4e-4);
    let (line, members) = rows(&at, &spheres, blend, 1.0).remove(0);
    let bend = hollowness(&line, &members, &contacts(&at), blend);
    let step = 1e-6;
    let there = |side: f64| {
        let at = at + Vec3::x() * (side * step);
        rows(&at, &spheres, blend, 1.0)[0].0.normal.x
    };
    let second = -(there(1.0) - there(-1.0)) / (2.0 * step);
    assert!(
        second > 10.0 && (second - bend[(0, 0)]).abs() < 1e-2 * second,
        "{second} {bend}"
    );
    let ball = [(Vec3::zeros(), 2e-4)];
    let (line, members) = rows(&at, &ball, blend, 1.0).remove(0);
    let normal = at / norm(&at);
    let contact = Contact {
        normal,
        ..contacts(&at)[0]
    };
    assert!(hollowness(&line, &members, &[contact], blend).norm() < 1e-6);
}

proptest! {
    #[test]
    fn rows_hold_the_surface_and_every_core_off(
        at in (-1e-3..1e-3, -1e-3..1e-3, 2e-4..1e-3_f64),
        places in proptest::collection::vec((-1e-3..1e-3_f64, -1e-3..1e-3_f64, -1e-3..0.0_f64, 1e-4..1e-3_f64), 1..40),
        blend in 1e-6..2e-4_f64) {
        let at = Vec3::new(at.0, at.1, at.2);
        let spheres: Vec<_> = places.iter().map(|p| (Vec3::new(p.0, p.1, p.2), p.3)).collect();
        let rows = rows(&at, &spheres, blend, 1.0);
        let least = rows.iter().map(|(line, _)| line.gap).fold(f64::INFINITY, fmin);
        // Left-out rows would bind earlier by at most this share of the blend length. Spheres out of reach add the
        // second term.
        let little = 1.01 * IMPLIED + spheres.len() as f64 * libm::exp(-reach(blend));
        prop_assert!((least - smallest(&at, &spheres, blend)).abs() <= little * blend + 1e-15);
        for (line, members) in &rows {
            let sum: f64 = members.iter().map(|member| member.weight).sum();
            prop_assert!((sum - 1.0).abs() < 1e-9);
            prop_assert!(members.iter().all(|member| member.weight >= 0.0));
            prop_assert!(norm(&line.normal) <= 1.0 + 1e-12);
        }
        let core = spheres.iter().map(|(c, r)| norm(&(at - c)) - r - TIP).fold(f64::INFINITY, fmin);
        prop_assert!(least <= core + 1e-15);
    }
}

proptest! {
    #[test]
    fn no_gap_is_under_the_bound_nor_comes_there_by_less_than_its_motion(
        at in (-1e-3..1e-3, -1e-3..1e-3, 2e-4..1e-3_f64),
        by in (-1e-4..1e-4, -1e-4..1e-4, -1e-4..1e-4_f64),
        places in proptest::collection::vec((-1e-3..1e-3_f64, -1e-3..1e-3_f64, -1e-3..0.0_f64, 1e-4..1e-3_f64), 1..40),
        limit in -1e-3..1e-3_f64,
        blend in 1e-6..2e-4_f64) {
        let (at, by) = (Vec3::new(at.0, at.1, at.2), Vec3::new(by.0, by.1, by.2));
        let spheres: Vec<_> = places.iter().map(|p| (Vec3::new(p.0, p.1, p.2), p.3)).collect();
        let (contact_rows, _, (room, least)) = written(&mut pairs(&at, &spheres), blend, limit);
        let any = contact_rows.iter().any(|line| line.gap < limit);
        prop_assert!(room <= limit);
        prop_assert!(least <= smallest(&at, &spheres, blend));
        prop_assert!(least - norm(&by) <= smallest(&(at + by), &spheres, blend));
        // A lower bound at or above the limit means no row under the limit.
        prop_assert!(!any || least < limit);
    }
}

/// Regression: in a fissure a tip had more rows than the capacity. The wall that the tip was 1.9 um deep in had no row,
/// and ticks there never converged.
#[test]
fn more_walls_than_there_is_room_for_are_told() {
    // Walls all around, each slightly farther than the one before.
    let walls = |count: usize| -> Vec<(Vec3, f64)> {
        (0..count)
            .map(|k| {
                let turn = std::f64::consts::TAU * k as f64 / count as f64;
                let away = 2e-3 + 1e-8 * k as f64;
                (
                    Vec3::new(away * libm::cos(turn), away * libm::sin(turn), 0.0),
                    1.75e-3,
                )
            })
            .collect()
    };
    // The blend length is so small that neighbours on the circle are separate walls.
    let blend = 2e-6;
    for (count, all) in [(MAX_SEEDS, true), (MAX_SEEDS + 1, false)] {
        let (contact_rows, _, (room, _)) =
            written(&mut pairs(&Vec3::zeros(), &walls(count)), blend, 1e-5);
        assert_eq!(room == 1e-5, all, "{count} walls: {room}");
        // On overflow all rows within a shorter limit fit.
        let within = contact_rows.iter().filter(|line| line.gap < room).count();
        assert!(
            within <= MAX_SEEDS && (!all || within == MAX_SEEDS),
            "{count} walls"
        );
    }
    // A smaller limit holds fewer walls, and all of their rows fit.
    let near = walls(MAX_SEEDS + 1);
    let at = Vec3::new(3e-6, 0.0, 0.0);
    let (contact_rows, _, (room, _)) = written(&mut pairs(&at, &near), blend, -1e-6);
    assert!(room == -1e-6 && !contact_rows.is_empty() && contact_rows.len() < MAX_SEEDS);
}
