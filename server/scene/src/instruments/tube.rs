//! A round bar with its centre line in the xz plane: arcs and straight pieces, a radius that changes along it, round
//! ends.
//!
//! Hand instruments are such bars with a handle at the upper end.
//!
//! Frame of an instrument: the origin is the device point, on the handle's axis. z runs up the handle.

use sulcus_core::Vec3;

use crate::mesh::TriMesh;

/// Corners of a cross-section.
pub(super) const AROUND: usize = 28;

/// A point of the centre line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Station {
    /// Distance along the line from its start.
    pub s: f64,
    /// Place.
    pub point: Vec3,
    /// Unit direction of increasing `s`.
    pub along: Vec3,
}

impl Station {
    /// Unit vector across the line, in the xz plane.
    pub fn side(&self) -> Vec3 {
        Vec3::new(self.along.z, 0.0, -self.along.x)
    }
}

/// A piece of centre line: its length, and its turn, radians, from z towards x.
pub(crate) struct Piece {
    pub length: f64,
    pub turn: f64,
}

/// Walks the pieces from the origin; `start` is the first direction, radians from z towards x.
pub(crate) fn walk(pieces: &[Piece], start: f64, at: f64) -> Station {
    let direction = |angle: f64| Vec3::new(libm::sin(angle), 0.0, libm::cos(angle));
    let (mut point, mut angle, mut left) = (Vec3::zeros(), start, at);
    for (k, piece) in pieces.iter().enumerate() {
        if piece.length <= 0.0 {
            // A bend of no angle.
            continue;
        }
        let part = if left < piece.length || k + 1 == pieces.len() {
            left
        } else {
            piece.length
        };
        let turn = piece.turn * part / piece.length;
        // The chord of an arc points half-way between its end directions.
        let half = 0.5 * turn;
        let shortening = if half.abs() < 1e-9 {
            1.0
        } else {
            libm::sin(half) / half
        };
        point += direction(angle + half) * (part * shortening);
        angle += turn;
        left -= part;
        if left <= 0.0 {
            break;
        }
    }
    Station {
        s: at,
        point,
        along: direction(angle),
    }
}

/// Returns the centre line of an instrument, mm.
///
/// The last of the pieces is the handle. `start` is the first direction. The handle's axis begins `bent` from the
/// start and becomes the z axis. The start lies `reach` from the origin.
pub(crate) fn instrument(
    pieces: Vec<Piece>,
    start: f64,
    bent: f64,
    reach: f64,
) -> impl Fn(f64) -> Station {
    let x = -walk(&pieces, start, bent).point.x;
    let first = Vec3::new(x, 0.0, -(reach * reach - x * x).max(0.0).sqrt());
    move |s| {
        let mut station = walk(&pieces, start, s);
        station.point += first;
        station
    }
}

/// Returns the radii of shank and handle, mm along the line. The shank ends at `from`, the handle at `to`.
pub(crate) fn handle(from: f64, to: f64) -> [(f64, f64); 9] {
    [
        (from, 1.25),
        (from + 2.0, 1.5),
        (from + 9.0, 3.6),
        (from + 12.0, 4.0),
        (from + 14.0, 3.7),
        (from + 18.0, 4.0),
        (from + 44.0, 4.0),
        (to - 25.0, 3.6),
        (to, 3.0),
    ]
}

/// Returns the linear interpolation between the knots (`s`, value), constant beyond them.
pub(crate) fn linear(knots: &[(f64, f64)], s: f64) -> f64 {
    if s <= knots[0].0 {
        return knots[0].1;
    }
    for pair in knots.windows(2) {
        let ((a, ra), (b, rb)) = (pair[0], pair[1]);
        if s <= b && b > a {
            return ra + (rb - ra) * ((s - a) / (b - a)).clamp(0.0, 1.0);
        }
    }
    knots[knots.len() - 1].1
}

/// Least distance of a regular cross-section from a requested one, mm.
const TOO_NEAR: f64 = 0.02;

/// Returns the cross-sections of [`sweep`]: places along the line and radii, ascending.
pub(crate) fn rings(
    radius: &dyn Fn(f64) -> f64,
    from: f64,
    to: f64,
    step: f64,
    also: &[f64],
) -> Vec<(f64, f64)> {
    let mut rings: Vec<(f64, f64)> = Vec::new();
    let (r0, r1) = (radius(from), radius(to));
    const CAP: usize = 8;
    let cap = |k: usize| std::f64::consts::FRAC_PI_2 * k as f64 / CAP as f64;
    for k in 1..CAP {
        rings.push((
            from + r0 * (1.0 - libm::cos(cap(k))),
            r0 * libm::sin(cap(k)),
        ));
    }
    let count = ((to - r1 - from - r0) / step).ceil() as usize;
    for k in 0..=count {
        let s = from + r0 + (to - r1 - from - r0) * k as f64 / count as f64;
        // The cap is a ball of the end's radius. The bar continues smoothly behind it.
        rings.push((
            s,
            if k == 0 {
                r0
            } else if k == count {
                r1
            } else {
                radius(s)
            },
        ));
    }
    // The ends stay. Between them requested cross-sections replace regular ones nearby.
    let (first, last) = (from + r0, to - r1);
    let wanted = also.iter().filter(|s| **s > first && **s < last);
    let inside = |s: f64| s > first && s < last;
    rings.retain(|&(s, _)| !inside(s) || also.iter().all(|a| (a - s).abs() > TOO_NEAR));
    rings.extend(wanted.map(|&s| (s, radius(s))));
    rings.sort_by(|a, b| a.0.total_cmp(&b.0));
    for k in (1..CAP).rev() {
        rings.push((to - r1 * (1.0 - libm::cos(cap(k))), r1 * libm::sin(cap(k))));
    }
    rings
}

/// Sweeps a disc along `line` with radius `radius(s)`, in steps of `step`. Cross-sections are also at each of `also`,
/// which is ascending.
///
/// Both ends are hemispheres inside the ends of the line.
pub(crate) fn sweep(
    line: &dyn Fn(f64) -> Station,
    radius: &dyn Fn(f64) -> f64,
    from: f64,
    to: f64,
    step: f64,
    also: &[f64],
) -> TriMesh {
    let rings = rings(radius, from, to, step, also);
    let mut mesh = TriMesh {
        vertices: vec![line(from).point],
        triangles: Vec::new(),
    };
    let last = rings.len() - 1;
    for (k, &(s, r)) in rings.iter().enumerate() {
        let station = line(s);
        let side = station.side();
        for corner in 0..AROUND {
            let angle = std::f64::consts::TAU * corner as f64 / AROUND as f64;
            mesh.vertices.push(
                station.point + side * (r * libm::cos(angle)) + Vec3::y() * (r * libm::sin(angle)),
            );
        }
        for corner in 0..AROUND {
            let here = |c: usize| (1 + k * AROUND + c % AROUND) as u32;
            let (a, b) = (here(corner), here(corner + 1));
            if k == 0 {
                mesh.triangles.push([0, b, a]);
            } else {
                let (c, d) = (a - AROUND as u32, b - AROUND as u32);
                mesh.triangles.extend([[c, d, b], [c, b, a]]);
            }
            if k == last {
                mesh.triangles
                    .push([(1 + rings.len() * AROUND) as u32, a, b]);
            }
        }
    }
    mesh.vertices.push(line(to).point);
    mesh
}
