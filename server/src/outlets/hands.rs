//! State of the tools for instructors, with the truth that no student gets.

use std::collections::BTreeSet;

use sulcus_core::output::{ForceZone, status};
use sulcus_core::tissue::gingiva::Site;
use sulcus_core::{Pose, Scene, TickOutput, ToolOutput, Vec3};
use sulcus_proto::datagram::WirePose;
use sulcus_proto::live::{Hand, Hands, InPocket};
use sulcus_sessions::Events;
use sulcus_sessions::exercise::events::Standing;
use sulcus_sessions::grade::sites::prescribed;

/// Depth of a site by the scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrueDepth {
    /// FDI number of the tooth.
    pub tooth: u8,
    /// Site.
    pub site: Site,
    /// Depth, millimetres.
    pub depth_mm: f32,
}

/// State of the tools after a tick. `events` has taken the tick before.
pub(super) fn hands(
    output: &TickOutput,
    paused: bool,
    depths: &[TrueDepth],
    events: &Events,
) -> Hands {
    let tool = |k: usize| {
        let standing = events.standing(k);
        hand(&output.tools[k], standing.map(|at| in_pocket(depths, at)))
    };
    Hands {
        tick: output.tick,
        paused,
        tools: std::array::from_fn(tool),
    }
}

fn hand(out: &ToolOutput, pocket: Option<InPocket>) -> Hand {
    let (graphic, haptic) = (wire_pose(&out.graphic), wire_pose(&out.haptic));
    let force_n = plain(&out.wrench.force);
    let mut numbers = [&graphic, &haptic]
        .into_iter()
        .flat_map(|pose| pose.position.iter().chain(&pose.orientation))
        .chain(&force_n);
    if !numbers.all(|x| x.is_finite()) {
        return Hand::default();
    }
    Hand {
        held: out.status & status::ABSENT == 0,
        graphic,
        haptic,
        force_n,
        pocket,
    }
}

fn in_pocket(depths: &[TrueDepth], at: &Standing) -> InPocket {
    let site = Site::ALL.iter().position(|site| *site == at.site);
    InPocket {
        tooth: at.tooth,
        site: site.map_or(0, |k| k as u8),
        depth_mm: finite((at.depth * 1e3) as f32),
        true_depth_mm: true_depth(depths, at),
        floor_n: finite(at.force as f32),
        zone: zone(at.zone),
    }
}

/// Depth of each site of a scene.
pub(super) fn depths(scene: &Scene) -> Vec<TrueDepth> {
    // A tooth and its gingiva have the same number.
    let teeth: BTreeSet<u8> = scene.objects.iter().map(|object| object.fdi).collect();
    let sites = teeth
        .into_iter()
        .filter(|fdi| *fdi > 0)
        .flat_map(|fdi| Site::ALL.map(|site| (fdi, site)));
    sites
        .filter_map(|(tooth, site)| {
            let depth = prescribed(scene, tooth, site)?.depth;
            Some(TrueDepth {
                tooth,
                site,
                depth_mm: finite((depth * 1e3) as f32),
            })
        })
        .collect()
}

/// Depth of the site of a tip, millimetres; 0 at a site without a depth.
pub(super) fn true_depth(depths: &[TrueDepth], at: &Standing) -> f32 {
    let found = depths
        .iter()
        .find(|depth| (depth.tooth, depth.site) == (at.tooth, at.site));
    found.map_or(0.0, |depth| depth.depth_mm)
}

/// Number of a zone, lightest first.
pub(super) fn zone(zone: ForceZone) -> u8 {
    let found = ForceZone::ALL.iter().position(|other| *other == zone);
    found.map_or(0, |k| k as u8)
}

fn wire_pose(pose: &Pose) -> WirePose {
    let q = &pose.orientation;
    WirePose {
        position: plain(&pose.position),
        orientation: [q.w as f32, q.i as f32, q.j as f32, q.k as f32],
    }
}

fn plain(v: &Vec3) -> [f32; 3] {
    [v.x, v.y, v.z].map(|x| x as f32)
}

fn finite(x: f32) -> f32 {
    if x.is_finite() { x } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hand_that_is_not_finite_is_not_held_and_its_state_is_encoded() {
        let mut out = ToolOutput::absent(Pose::identity());
        out.status = 0;
        out.wrench.force = Vec3::new(1.0, 2.0, 3.0);
        let hand_of = |out: &ToolOutput| hand(out, None);
        let whole = hand_of(&out);
        assert!(whole.held && whole.force_n == [1.0, 2.0, 3.0]);
        out.haptic.position.y = f64::NAN;
        let broken = hand_of(&out);
        assert_eq!(broken, Hand::default());
        let hands = Hands {
            tools: [whole, broken],
            ..Hands::default()
        };
        assert!(hands.to_bytes().is_ok());
    }
}
