//! Tilt of a probe's working end against a tooth, in parts, and its rating at a site.
//!
//! In the middle of a side the working end should be parallel to the tooth's axis. At a proximal site the tip has to
//! pass under the contact into the col. There the shaft leans away from the neighbour or out of the row of teeth, and
//! the tip points towards the neighbour and the midline.

use serde_json::json;
use sulcus_core::Vec3;
use sulcus_core::math::fmax;
use sulcus_core::tissue::gingiva::{Site, ToothFrame};

use crate::exercise::ProbingTask;

/// Time for which the tilt must be wrong, or right again, before an event, seconds.
pub const STEADY_S: f64 = 0.25;

/// Tilt of a working end against a tooth's axis, radians. Zero is parallel, with the tip towards the root.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tilt {
    /// Angle between working end and axis.
    pub total: f64,
    /// Angle in the plane of axis and mesial direction, along the arch; positive if the tip points mesially.
    pub mesiodistal: f64,
    /// Angle in the plane of axis and buccal direction; positive if the tip points buccally.
    pub buccolingual: f64,
}

impl Tilt {
    /// Tilt of a unit vector out of the tip, world axes.
    pub fn of(frame: &ToothFrame, out_of_tip: &Vec3) -> Self {
        let down = -out_of_tip.dot(&frame.axis);
        let (mesial, buccal) = (out_of_tip.dot(&frame.mesial), out_of_tip.dot(&frame.buccal));
        Self {
            total: libm::atan2((mesial * mesial + buccal * buccal).sqrt(), down),
            mesiodistal: libm::atan2(mesial, down),
            buccolingual: libm::atan2(buccal, down),
        }
    }

    /// Angles by which the tip points into the col and out of it at a site, radians. Into the col is towards the
    /// neighbour and the midline of the contact. In the middle of a side the whole tilt is out of the col.
    pub fn into_col(&self, site: Site) -> (f64, f64) {
        let Some(mesially) = site.is_mesial() else {
            return (0.0, self.total);
        };
        // Tangents add up like vectors.
        let towards = |angle: f64, positive: bool| {
            let tangent = libm::tan(fmax(-1.5, if angle > 1.5 { 1.5 } else { angle }));
            if positive { tangent } else { -tangent }
        };
        let parts = [
            towards(self.mesiodistal, mesially),
            towards(self.buccolingual, !site.is_buccal()),
        ];
        let length = |part: [f64; 2]| libm::atan((part[0] * part[0] + part[1] * part[1]).sqrt());
        let into = length(parts.map(|x| fmax(x, 0.0)));
        let out = length(parts.map(|x| fmax(-x, 0.0)));
        // The tip points away from the root.
        if self.total > std::f64::consts::FRAC_PI_2 {
            (0.0, self.total)
        } else {
            (into, out)
        }
    }

    /// Whether the tilt is right at a site.
    pub fn is_right(&self, site: Site, task: &ProbingTask) -> bool {
        let (into, out) = self.into_col(site);
        let most_out = task.mid_tilt_deg.to_radians();
        let [least, most] = task.proximal_tilt_deg.map(f64::to_radians);
        // In this form a NaN is wrong.
        out <= most_out && (!site.is_proximal() || (least..=most).contains(&into))
    }

    /// Data of the event.
    pub fn data(&self, tool: usize, tooth: u8, site: Site, right: bool) -> serde_json::Value {
        json!({
            "tool": tool,
            "tooth": tooth,
            "site": site.name(),
            "right": right,
            "tilt_deg": self.total.to_degrees(),
            "into_col_deg": self.into_col(site).0.to_degrees(),
            "mesiodistal_deg": self.mesiodistal.to_degrees(),
            "buccolingual_deg": self.buccolingual.to_degrees(),
        })
    }
}

/// State of the tilt while a probe bears on the floor.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Watch {
    /// State of the last event; right at first.
    wrong: bool,
    /// First tick of the opposite state.
    since: Option<u64>,
}

impl Watch {
    /// New rating at `tick`, once it has lasted for `steady` ticks; `None` without an event.
    pub fn turns(&mut self, tick: u64, right: bool, steady: u64) -> Option<bool> {
        if right != self.wrong {
            self.since = None;
            return None;
        }
        let since = *self.since.get_or_insert(tick);
        if tick.saturating_sub(since) < steady {
            return None;
        }
        self.wrong = !right;
        self.since = None;
        Some(right)
    }

    /// Leaves out a gap of `ticks` ticks.
    pub fn shifts(&mut self, ticks: u64) {
        self.since = self.since.map(|since| since.saturating_add(ticks));
    }

    /// Takes a tick in which the probe does not bear on the floor.
    pub fn rests(&mut self) {
        self.since = None;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Frame of a lower left tooth, turned against the world: mesial along -y, buccal along x.
    fn frame() -> ToothFrame {
        ToothFrame {
            origin: Vec3::new(0.03, -0.02, 0.01),
            axis: Vec3::z(),
            mesial: -Vec3::y(),
            buccal: Vec3::x(),
        }
    }

    /// Tilt of a tip that points `mesial` and `buccal` degrees off the axis.
    fn pointing(mesial: f64, buccal: f64) -> Tilt {
        let f = frame();
        let along = |degrees: f64| libm::tan(degrees.to_radians());
        let way = -f.axis + f.mesial * along(mesial) + f.buccal * along(buccal);
        Tilt::of(&f, &way.normalize())
    }

    #[test]
    fn the_parts_of_a_constructed_tilt_come_back() {
        for (mesial, buccal) in [
            (0.0, 0.0),
            (17.0, 0.0),
            (0.0, -12.0),
            (-20.0, 9.0),
            (40.0, 35.0),
        ] {
            let tilt = pointing(mesial, buccal);
            assert!((tilt.mesiodistal.to_degrees() - mesial).abs() < 1e-9);
            assert!((tilt.buccolingual.to_degrees() - buccal).abs() < 1e-9);
            let tangent = |degrees: f64| libm::tan(degrees.to_radians());
            let whole = libm::hypot(tangent(mesial), tangent(buccal));
            assert!((libm::tan(tilt.total) - whole).abs() < 1e-9);
        }
    }

    #[test]
    fn into_the_col_is_towards_the_neighbour_and_the_midline() {
        use Site::*;
        // The tip points mesially and lingually. Only at the mesio-buccal site is all of the tilt into the col.
        let tilt = pointing(12.0, -9.0);
        let whole = tilt.total;
        let parts = Site::ALL.map(|site| tilt.into_col(site));
        assert!((parts[MesioBuccal as usize].0 - whole).abs() < 1e-12);
        assert_eq!(parts[MesioBuccal as usize].1, 0.0);
        assert!((parts[DistoLingual as usize].1 - whole).abs() < 1e-12);
        assert!((parts[MesioLingual as usize].0.to_degrees() - 12.0).abs() < 1e-9);
        assert!((parts[MesioLingual as usize].1.to_degrees() - 9.0).abs() < 1e-9);
        assert!((parts[DistoBuccal as usize].0.to_degrees() - 9.0).abs() < 1e-9);
        assert_eq!(parts[Buccal as usize], (0.0, whole));
    }

    #[test]
    fn upright_is_right_in_the_middle_and_wrong_beside_a_neighbour() {
        let task = ProbingTask::default();
        let is = |mesial, buccal, site| pointing(mesial, buccal).is_right(site, &task);
        assert!(is(0.0, 0.0, Site::Buccal) && !is(0.0, 0.0, Site::MesioBuccal));
        assert!(is(14.9, 0.0, Site::Lingual) && !is(15.1, 0.0, Site::Lingual));
        assert!(is(15.0, 0.0, Site::MesioBuccal) && !is(-15.0, 0.0, Site::MesioBuccal));
        assert!(is(-15.0, 0.0, Site::DistoLingual) && !is(15.0, 0.0, Site::DistoLingual));
        assert!(is(0.0, -20.0, Site::DistoBuccal) && is(0.0, 20.0, Site::MesioLingual));
        assert!(!is(9.9, 0.0, Site::MesioBuccal) && is(10.1, 0.0, Site::MesioBuccal));
        assert!(!is(25.1, 0.0, Site::MesioBuccal));
        // Into the col, and too far out of it in the other direction.
        assert!(is(15.0, 10.0, Site::MesioBuccal) && !is(15.0, 16.0, Site::MesioBuccal));
        let f = frame();
        let upside_down = Tilt::of(&f, &f.axis);
        assert!(
            !Site::ALL
                .iter()
                .any(|site| upside_down.is_right(*site, &task))
        );
        let nothing = Tilt::of(&f, &Vec3::from_element(f64::NAN));
        assert!(!Site::ALL.iter().any(|site| nothing.is_right(*site, &task)));
    }

    #[test]
    fn a_tilt_is_told_once_when_it_lasts_and_once_when_it_is_right_again() {
        let mut watch = Watch::default();
        let mut told = Vec::new();
        for tick in 0..3000u64 {
            // Wrong for 200 ticks, which is too short, then wrong from 1000 to 2000.
            let right = !((300..500).contains(&tick) || (1000..2000).contains(&tick));
            told.extend(watch.turns(tick, right, 250).map(|right| (tick, right)));
        }
        assert_eq!(told, [(1250, false), (2250, true)]);
        // Twice 200 ticks with a rest between do not add up to 400.
        let mut watch = Watch::default();
        assert!((0..200).all(|tick| watch.turns(tick, false, 250).is_none()));
        watch.rests();
        assert!((300..500).all(|tick| watch.turns(tick, false, 250).is_none()));
    }
}
