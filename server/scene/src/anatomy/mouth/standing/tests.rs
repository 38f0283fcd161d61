//! Inclinations, curve of Spee, contacts and marginal ridges of the arch, measured on the surfaces of the teeth.

use sulcus_core::Vec3;

use super::*;
use crate::anatomy::arch::{from_world, to_world};
use crate::mesh::distance::MeshDistance;

/// Mesial tip and faciolingual lean of the whole tooth from computed tomography, 31 to 37, degrees.
const PUBLISHED: [[f64; 2]; 7] = [
    [0.0, 26.5],
    [0.0, 24.0],
    [5.0, 12.0],
    [7.0, 6.0],
    [10.0, 0.0],
    [13.0, -14.1],
    [17.5, -15.2],
];
/// Difference between the reference planes of the papers, degrees.
const PLANES: f64 = 5.0;

fn left() -> &'static [Standing] {
    &standing()[7..]
}

/// Points of the surface in the world, mm, whose place in the tooth's frame, mm, fulfils a condition.
fn points(tooth: &Standing, of: impl Fn(&Vec3) -> bool) -> Vec<Vec3> {
    let frame = tooth.frame_mm();
    let mm = tooth.mesh.vertices.iter().map(|v| v * 1e3);
    mm.filter(|p| of(p)).map(|p| to_world(&frame, &p)).collect()
}

/// Highest point in the world, mm, among those that fulfil a condition in the tooth's frame.
fn top(tooth: &Standing, of: impl Fn(&Vec3) -> bool) -> Vec3 {
    let all = points(tooth, of);
    let first = Vec3::repeat(f64::NEG_INFINITY);
    all.into_iter()
        .fold(first, |top, p| if p.z > top.z { p } else { top })
}

fn middle(points: &[Vec3]) -> Vec3 {
    let low = points
        .iter()
        .fold(Vec3::repeat(f64::INFINITY), |low, p| low.inf(p));
    let high = points
        .iter()
        .fold(Vec3::repeat(f64::NEG_INFINITY), |high, p| high.sup(p));
    (low + high) * 0.5
}

#[test]
fn whole_teeth_lean_as_published() {
    let mut wrong = Vec::new();
    for (tooth, [tip, lean]) in left().iter().zip(PUBLISHED) {
        let root = tooth.shape.root_length_mm();
        let apex = middle(&points(tooth, |p| p.z < -root + 2.0));
        let crown = tooth.shape.crown_height_mm();
        let chewing = middle(&points(tooth, |p| p.z > 0.5 * crown));
        let axis = chewing - apex;
        let along = Vec3::new(tooth.frame.mesial.x, tooth.frame.mesial.y, 0.0).normalize();
        let out = Vec3::new(tooth.frame.buccal.x, tooth.frame.buccal.y, 0.0);
        let out = (out - along * out.dot(&along)).normalize();
        let tipped = libm::atan2(axis.dot(&along), axis.z).to_degrees();
        let leaned = libm::atan2(axis.dot(&out), axis.z).to_degrees();
        if (tipped - tip).abs() >= PLANES || (leaned - lean).abs() >= PLANES {
            wrong.push(tooth.fdi);
        }
        println!(
            "{}: tip {tipped:.1}, published {tip}; lean {leaned:.1}, published {lean}",
            tooth.fdi
        );
    }
    assert!(wrong.is_empty(), "{wrong:?}");
}

#[test]
fn the_curves_of_spee_and_wilson_are_an_adults() {
    let all = left();
    let buccal =
        |tooth: &Standing, mesial: bool| top(tooth, |p| p.y > 0.5 && (p.x > 0.0) == mesial);
    let front = top(&all[0], |_| true);
    let back = buccal(&all[6], false);
    // Depth below the line from the incisal edges to the distobuccal cusp of 37.
    let depth = |p: &Vec3| {
        let share = (front.x - p.x) / (front.x - back.x);
        front.z + share * (back.z - front.z) - p.z
    };
    for tooth in all {
        let (m, d) = (buccal(tooth, true), buccal(tooth, false));
        println!(
            "{} mb {:.2} ({:.2} deep) db {:.2} ({:.2} deep)",
            tooth.fdi,
            m.z,
            depth(&m),
            d.z,
            depth(&d)
        );
    }
    let deepest = depth(&buccal(&all[5], true));
    // Means of 1.76 to 2.44 mm by class of the bite (looks: curve of Spee by class), 2.17 as second molars come in.
    let is_deepest = (3..7).all(|k| depth(&buccal(&all[k], true)) < deepest + 0.25);
    // The mesiolingual cusp lies about 0.8 mm lower in the mouth than the mesiobuccal one.
    let lower = |tooth: &Standing| {
        let lingual = top(tooth, |p| p.y < -0.5 && p.x > 0.0);
        buccal(tooth, true).z - lingual.z
    };
    let wilson = [lower(&all[5]), lower(&all[6])];
    println!("{deepest:.2} deep, {wilson:.2?} lower");
    assert!((1.76..2.44).contains(&deepest) && is_deepest);
    assert!(wilson.iter().all(|lower| (0.3..1.4).contains(lower)));
}

#[test]
fn marginal_ridges_of_neighbours_are_level_and_crowns_touch() {
    let mut wrong = false;
    // From the midline backwards on each side, then across the midline.
    let sides = [3, 4].map(|side| {
        let mut all: Vec<&Standing> = standing()
            .iter()
            .filter(|one| one.fdi / 10 == side)
            .collect();
        all.sort_by_key(|one| one.fdi);
        all
    });
    let across = [sides[0][0], sides[1][0]];
    let beside = sides.iter().flat_map(|side| side.windows(2));
    for pair in beside.chain([&across[..]]) {
        let (a, b) = (pair[0], pair[1]);
        if (34..40).contains(&a.fdi) {
            let ridge = |tooth: &Standing, end: usize| {
                let contact = tooth.contacts[end];
                top(tooth, |p| {
                    (p.y - contact.y).abs() < 1.2 && (p.x - contact.x).abs() < 1.3
                })
                .z
            };
            let step = ridge(b, 0) - ridge(a, 1);
            println!("{} to {}: a step of {step:.2} mm", a.fdi, b.fdi);
            wrong |= step.abs() >= 0.5;
        }
        let (from, onto) = (a.frame_mm(), b.frame_mm());
        let surface = MeshDistance::new(b.mesh.clone());
        let crown = a.mesh.vertices.iter().filter(|v| v.z > 0.0);
        let gap = crown
            .map(|v| {
                surface.signed(&(from_world(&onto, &to_world(&from, &(v * 1e3))) * 1e-3)) * 1e3
            })
            .fold(f64::INFINITY, f64::min);
        println!("{} to {}: a gap of {gap:.3} mm", a.fdi, b.fdi);
        wrong |= !(-0.01..0.2).contains(&gap);
    }
    assert!(!wrong, "see above");
}
