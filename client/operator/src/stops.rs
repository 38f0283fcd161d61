//! Stops of a walking probe: the zones of one side of a tooth in the order of the walk, with their stops.

use std::f64::consts::PI;

use sulcus_core::tissue::gingiva::Site;

use crate::pocket_path::PocketPath;

/// Depth below the margin at which the length of the walk is measured, metres.
const MEASURED_AT: f64 = 2e-3;
/// Smallest angle between a stop and the border of its zone, radians: 4 degrees.
const BORDER: f64 = 0.07;
/// Step of the measurement, radians: half a degree.
const FINE: f64 = PI / 360.0;

/// The stops in one zone.
#[derive(Clone, Debug, PartialEq)]
pub struct Zone {
    /// Site of the zone.
    pub site: Site,
    /// Angles of the stops in the order of the walk, radians from mesial over buccal.
    pub stops: Vec<f64>,
}

/// Parameters of a walk through the zones of a tooth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Walk {
    /// Distance between two stops along the tooth, metres.
    pub advance: f64,
    /// Smallest distance from the plane through the mesial and the distal midline, metres.
    pub col: f64,
    /// Whether each zone has one stop only: nearest to the midline, or in the middle of a zone between two others.
    pub single: bool,
}

/// Zones of one insertion with their stops. All `sites` lie on the same side of the tooth, in the order of the walk.
pub fn zones(path: &PocketPath, sites: &[Site], walk: &Walk) -> Vec<Zone> {
    let proximal = path.gingiva().proximal;
    let mut zones: Vec<Zone> = Vec::new();
    for (k, site) in sites.iter().enumerate() {
        let sign = if site.is_buccal() { 1.0 } else { -1.0 };
        // Angles from mesial, 0 to pi. The first stop of a zone depends on the zone before it.
        let (from, to) = match site.is_mesial() {
            Some(true) => (
                proximal - BORDER,
                inmost(path, sign, true, walk.col, proximal),
            ),
            Some(false) => (
                PI - proximal + BORDER,
                PI - inmost(path, sign, false, walk.col, proximal),
            ),
            None => {
                let (mesial, distal) = (proximal + BORDER, PI - proximal - BORDER);
                let neighbour = k.checked_sub(1).and_then(|before| sites.get(before));
                let after_mesial = neighbour.is_some_and(|site| site.is_mesial() == Some(true));
                let before_distal = neighbour.is_none()
                    && sites
                        .get(k + 1)
                        .is_some_and(|site| site.is_mesial() == Some(false));
                if after_mesial || before_distal {
                    (mesial, distal)
                } else {
                    (distal, mesial)
                }
            }
        };
        let stops = if walk.single {
            vec![if site.is_proximal() { to } else { 0.5 * PI }]
        } else {
            spread(path, sign, from, to, walk.advance)
        };
        zones.push(Zone {
            site: *site,
            stops: stops.into_iter().map(|around| sign * around).collect(),
        });
    }
    zones
}

/// Smallest angle from the midline, radians, at which the shaft clears the neighbours, and no nearer to the midline's
/// plane than `col`.
fn inmost(path: &PocketPath, sign: f64, mesial: bool, col: f64, proximal: f64) -> f64 {
    let from_mesial = |from_midline: f64| {
        if mesial {
            from_midline
        } else {
            PI - from_midline
        }
    };
    let open = |from_midline: f64| path.ceiling(sign * from_mesial(from_midline)).is_some();
    let radius = path.radius(from_mesial(0.0), MEASURED_AT);
    let col = libm::asin((col / radius).clamp(0.0, 1.0));
    let mut at = proximal - BORDER;
    while at > col && open((at - FINE).max(col)) {
        at = (at - FINE).max(col);
    }
    at
}

/// Angles from `from` to `to` in equal steps of about `advance` metres along the tooth, both ends included.
fn spread(path: &PocketPath, sign: f64, from: f64, to: f64, advance: f64) -> Vec<f64> {
    let tip = |around: f64| path.place(sign * around, MEASURED_AT, 0.0).tip;
    let pieces = ((to - from).abs() / FINE).ceil().max(1.0) as usize;
    let angles: Vec<f64> = (0..=pieces)
        .map(|k| from + (to - from) * k as f64 / pieces as f64)
        .collect();
    let lengths = angles
        .windows(2)
        .map(|pair| (tip(pair[1]) - tip(pair[0])).norm());
    let sums: Vec<f64> = std::iter::once(0.0)
        .chain(lengths.scan(0.0, |sum, length| {
            *sum += length;
            Some(*sum)
        }))
        .collect();
    let whole = sums[sums.len() - 1];
    // No step is longer than the advance by more than a tenth, up to the measurement's step.
    let steps = (whole / advance - 0.1).ceil().max(1.0) as usize;
    (0..=steps)
        .map(|k| {
            let length = whole * k as f64 / steps as f64;
            let at = sums.iter().position(|sum| *sum >= length - 1e-12);
            angles[at.unwrap_or(angles.len() - 1)]
        })
        .collect()
}
