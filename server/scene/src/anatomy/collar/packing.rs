//! The collar as spheres, laid out in rows. Rows replace fitting because a patient's gingiva must be ready at once.
//!
//! Columns stand at equal distances round the tooth. The distance is the smallest at which all spheres fit.
//!
//! - Under the floor each column has three spheres, from the tooth to under the wall. One more lies below, between
//!   the column and the next.
//! - Above the floor its spheres are as thick as the tissue; their inner side is the pocket's wall.
//! - Every few columns there are larger spheres for the outer face and for attached tissue below.

use std::f64::consts::{PI, TAU};

use sulcus_core::{Sphere, Vec3};

use super::furcation::between_roots;
use super::{Collar, Packed};

/// Largest number of spheres of a collar.
///
/// With half as many, a tip enters between the columns of a deep pocket. With more, the tick would not keep the whole
/// matrix of their falloff, 8 MiB for each gingiva.
const MOST: usize = 1024;
/// Smallest distance between columns, mm, and its growth from attempt to attempt.
const CLOSEST: f64 = 0.42;
const WIDER: f64 = 1.03;
/// Distance between rows of the wall, as a multiple of the distance of columns. A probe lies along the rows.
const HIGHER: f64 = 1.2;
/// Radii of the spheres of the wall and of the floor, mm.
const WALL: [f64; 2] = [0.2, 0.7];
const FLOOR: f64 = 0.45;
/// Depths of the two outer spheres of the floor inside the tooth's outline and inside the wall, mm.
const INTO_TOOTH: f64 = 0.15;
const INTO_WALL: f64 = 0.05;
/// Distance of the third sphere outside the wall's surface, mm. A tip that presses the wall aside must still find a
/// floor.
const UNDER_WALL: f64 = 0.45;
/// Depth under the floor at which the layer below begins, mm: more than a reading's force sinks in healthy tissue.
///
/// Then the possible radii of its spheres, mm, and the number of places to either side that are compared with the
/// floor.
const UNDER: f64 = 0.55;
const DEEP: [f64; 4] = [0.8, 0.6, 0.45, 0.3];
const REACHED: i32 = 8;
/// Length for the slope of the floor, mm.
const SLOPE_STEP: f64 = 0.1;
/// Radii of spheres outside of the pocket, mm.
const OUTSIDE: [f64; 2] = [0.4, 1.4];
/// Distance between these spheres, as a multiple of the distance of columns.
const COARSER: f64 = 2.5;
/// Height of the rows of attached tissue below, mm.
const BELOW: f64 = 2.0;
/// Thickness that is worth an outer sphere, mm.
const THICK: f64 = 0.5;
/// Reach of wall spheres into the neighbour's half of a papilla, as a share of their own half.
const BORROWED: f64 = 0.5;

/// Returns the collar's spheres, at most 1024.
pub fn pack(collar: &Collar) -> Vec<Packed> {
    let roots = between_roots(collar);
    let mut apart = CLOSEST;
    loop {
        let mut packed = pack_at(collar, apart);
        packed.extend(&roots);
        if packed.len() <= MOST || apart > 10.0 {
            return packed.into_iter().take(MOST).collect();
        }
        apart *= WIDER;
    }
}

fn pack_at(collar: &Collar, apart: f64) -> Vec<Packed> {
    let angles = columns(collar, apart);
    let mut packed = Vec::new();
    for (k, &around) in angles.iter().enumerate() {
        column(collar, around, k, apart, &mut packed);
    }
    let coarse = columns(collar, COARSER * apart);
    for (k, &around) in coarse.iter().enumerate() {
        outside(collar, around, k, COARSER * apart, &mut packed);
    }
    packed
}

/// Angles at equal distances along the floor of the pocket.
fn columns(collar: &Collar, apart: f64) -> Vec<f64> {
    const FINE: usize = 720;
    let place = |k: usize| {
        let around = TAU * k as f64 / FINE as f64;
        let r = collar.inner(around, collar.floor(around)) - 0.5 * collar.sizes.width;
        Vec3::new(
            r * libm::cos(around),
            r * libm::sin(around),
            collar.floor(around),
        )
    };
    let mut length = vec![0.0];
    for k in 0..FINE {
        length.push(length[k] + (place(k + 1) - place(k)).norm());
    }
    let count = (length[FINE] / apart).ceil().max(8.0) as usize;
    let mut angles = Vec::with_capacity(count);
    let mut at = 0;
    for k in 0..count {
        let wanted = length[FINE] * k as f64 / count as f64;
        while length[at + 1] < wanted {
            at += 1;
        }
        let share = (wanted - length[at]) / (length[at + 1] - length[at]);
        angles.push(TAU * (at as f64 + share) / FINE as f64);
    }
    angles
}

/// Depth of the dents between spheres of radius `radius` in a square grid of `apart`. Half of it is added, so the
/// surface is right on average.
fn dent(radius: f64, apart: f64) -> f64 {
    let half = (0.5 * apart).min(0.9 * radius);
    radius - (radius * radius - half * half).sqrt()
}

fn column(collar: &Collar, around: f64, k: usize, apart: f64, packed: &mut Vec<Packed>) {
    let (floor, crest) = (collar.floor(around), collar.crest(around));
    // Three spheres make the floor. The one at the tooth closes grooves under the outline; the others are at the wall
    // and under it.
    //
    // The spheres lie under the floor along its normal. Straight down they would fill a narrow pocket from its sides.
    let at = collar.sections.radius(around, floor).max(0.5);
    let slope = {
        let step = SLOPE_STEP / at;
        (collar.floor(around + step) - collar.floor(around - step)) / (2.0 * SLOPE_STEP)
    };
    let length = (1.0 + slope * slope).sqrt();
    let there = around + slope / length * FLOOR / at;
    let z = floor - FLOOR / length + 0.5 * dent(FLOOR, apart);
    let wall = collar.inner(around, floor);
    for r in [at - INTO_TOOTH, wall - INTO_WALL, wall + UNDER_WALL] {
        put_below(collar, there, r, z, FLOOR, packed);
    }
    // A tip pressed between two columns meets the layer below, shifted by half a column.
    let between = around + 0.5 * apart / at;
    let middle = at + 0.5 * collar.sizes.width;
    let (z, radius) = deep(collar, between, middle);
    put_below(collar, between, middle, z, radius, packed);
    // The wall; every other column is set off by half a row.
    let rows = ((crest - floor) / (HIGHER * apart)).round().max(1.0);
    let step = (crest - floor) / rows;
    let shift = if k.is_multiple_of(2) { 0.25 } else { 0.75 };
    for row in 0..rows as usize {
        let z = floor + step * (row as f64 + shift);
        let inner = collar.inner(around, z);
        let thick = collar.outer(around, z, crest) - inner;
        let shared = if collar.neighbours[usize::from(libm::cos(around) < 0.0)].is_some() {
            1.0 + BORROWED * libm::pow(libm::cos(around), 2.0)
        } else {
            1.0
        };
        let radius = (0.5 * thick * shared)
            .min(crest - z + 0.1)
            .clamp(WALL[0], WALL[1]);
        let inset = 0.5 * (dent(radius, apart) + dent(radius, step));
        put(
            collar,
            around,
            inner - inset + radius,
            z,
            radius,
            false,
            packed,
        );
    }
}

/// Returns height and radius of a sphere of the layer below, at an angle and a distance from the axis.
///
/// Candidates begin [`UNDER`] the floor there and stay below it everywhere. The one with the highest top is chosen.
///
/// A large sphere beside a narrow deep place would fill it from the side: by up to 1.3 mm beside a place 3 mm deeper.
fn deep(collar: &Collar, around: f64, r: f64) -> (f64, f64) {
    let highest = |radius: f64| {
        let under = (-REACHED..=REACHED).map(|k| {
            let aside = radius * f64::from(k) / f64::from(REACHED);
            collar.floor(around + aside / r) - (radius * radius - aside * aside).sqrt()
        });
        under.fold(collar.floor(around) - UNDER - radius, f64::min)
    };
    let top = |at: &(f64, f64)| at.0 + at.1;
    // Of equal ones the first is kept, which is the largest.
    let higher = |best, at| {
        if top(&at) > top(&best) + 1e-9 {
            at
        } else {
            best
        }
    };
    let all = DEEP.map(|radius| (highest(radius), radius));
    all[1..].iter().copied().fold(all[0], higher)
}

/// Adds a sphere under the floor.
///
/// A sphere that reaches over the plane to a neighbour lies no higher than the height at which the neighbour's floor
/// is read. A tip there would otherwise stand on it, or on both floors at once.
///
/// On this side of the plane an additional sphere has the right height.
fn put_below(collar: &Collar, around: f64, r: f64, z: f64, radius: f64, packed: &mut Vec<Packed>) {
    let Some(floor) = collar.beyond(around, (r, z), radius) else {
        return put(collar, around, r, z, radius, true, packed);
    };
    if floor - radius < z {
        let most = collar.plane(around, z, radius).unwrap_or(r);
        put(collar, around, most, z, radius, true, packed);
    }
    put(
        collar,
        around,
        r,
        z.min(floor - radius),
        radius,
        true,
        packed,
    );
}

fn outside(collar: &Collar, around: f64, k: usize, apart: f64, packed: &mut Vec<Packed>) {
    let (floor, crest) = (collar.floor(around), collar.crest(around));
    // Spheres of the outer face above the floor, beyond the reach of the wall's own spheres.
    let mut z = crest - 0.6 * apart;
    while z > floor {
        let (inner, outer) = (collar.inner(around, z), collar.outer(around, z, crest));
        let covered = inner + 2.0 * WALL[1];
        if outer - covered > THICK {
            let radius = (0.5 * (outer - inner)).clamp(OUTSIDE[0], OUTSIDE[1]);
            let radius = radius.min(outer - inner - 0.3);
            put(collar, around, outer - radius, z, radius, false, packed);
        }
        z -= apart;
    }
    // Attached tissue below, under the lowest floor that a sphere can reach. It never rises into the pocket.
    let base = collar.sizes.base;
    let at = collar.sections.radius(around, floor).max(1.0);
    let low = (-3..=3)
        .map(|k| collar.floor(around + f64::from(k) / 3.0 * OUTSIDE[1] / at))
        .fold(floor, f64::min);
    let rows = ((low - 0.5 - base) / BELOW).round().max(1.0);
    let step = (low - 0.5 - base) / rows;
    let shift = if k.is_multiple_of(2) { 0.35 } else { 0.65 };
    for row in 0..rows as usize {
        let z = base + step * (row as f64 + shift);
        let inner = collar.sections.radius(around, z) - 0.2;
        let outer = collar.outer(around, z, crest);
        let radius = (0.5 * (outer - inner)).clamp(OUTSIDE[0], OUTSIDE[1]);
        let radius = radius.min(low - z);
        put(collar, around, outer - radius, z, radius, false, packed);
    }
}

fn put(
    collar: &Collar,
    around: f64,
    r: f64,
    z: f64,
    radius: f64,
    floor: bool,
    packed: &mut Vec<Packed>,
) {
    let (sine, cosine) = (libm::sin(around), libm::cos(around));
    let centre = Vec3::new(r * cosine, r * sine, z);
    let height = z - collar.floor(around);
    // Middle of the pocket beside the sphere, or over it if it lies under the floor.
    let beside = if height < 0.0 { z - height } else { z };
    let middle = collar.inner(around, beside) - 0.5 * collar.sizes.width;
    let to_pocket = Vec3::new(middle * cosine, middle * sine, beside) - centre;
    let share = (radius / to_pocket.norm().max(1e-9)).min(1.0);
    packed.push(Packed {
        sphere: Sphere {
            centre: centre * 1e-3,
            radius: radius * 1e-3,
        },
        away: collar.sections.outward(around, beside),
        on_surface: (centre + to_pocket * share) * 1e-3,
        height: height * 1e-3,
        // Spheres under the floor also bear the tip when the floor is pressed far down or aside.
        floor: floor || height < 0.0,
    });
    debug_assert!(around <= TAU + PI);
}
