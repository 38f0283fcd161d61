//! Rows of an instant of a live view.

use rerun::RecordingStream;
use sulcus_core::{Pose, Quat, Vec3};
use sulcus_proto::TOOLS;
use sulcus_proto::datagram::WirePose;
use sulcus_proto::display::{DisplayScene, Kind};
use sulcus_proto::live::{Hand, Hands};

use super::layout::{DEPTH, FORCE, PUSHES};
use super::picture::{bounds, bounds_of, probe_of};
use crate::error::Refusal;
use crate::review::entity::entity;
use crate::review::layout::CLOSE_UP;
use crate::review::waiting::{Arrows, Poses, Series, Times};
use crate::review::write::PUSH;
use crate::review::{Moment, ReviewPicture, Standing};
use crate::session::follow::{ALONG, Follow};

/// Least force that is drawn, N.
const LEAST_N: f32 = 0.005;
/// Least distance between the hand's tip and the instrument's at which the hand is drawn, metres.
const APART: f64 = 1e-4;
/// Longest time between two instants that the close-up counts, seconds.
const LONGEST_S: f64 = 0.5;

/// Writer of instants.
pub(super) struct Instants {
    tick_ns: u64,
    tools: Vec<Tool>,
    probe: usize,
    /// Middle of each tooth with its number, metres.
    teeth: Vec<(u8, Vec3)>,
    /// Middle of the mouth, metres.
    middle: Vec3,
    follow: Follow,
    close_up: Poses,
    pushes: Arrows,
    arrow_mm_per_n: f32,
    /// Force and depth. Each instant sends the rows of one plot, so that none is much longer than the others.
    plots: [Series; 2],
    next_plot: usize,
    last_s: f64,
}

struct Tool {
    tip: Vec3,
    park: WirePose,
    graphic: Poses,
    haptic: Poses,
    /// Whether the hand was drawn last. A hand that is gone needs one row.
    is_apart: bool,
}

impl Instants {
    pub fn new(scene: &DisplayScene, picture: &ReviewPicture) -> Self {
        let (low, high) = bounds(scene);
        let middle = (vec3(&low) + vec3(&high)) / 2.0;
        let teeth = scene.objects.iter().filter(|o| o.kind == Kind::Tooth);
        let teeth = teeth.filter_map(|tooth| {
            let (low, high) = bounds_of(tooth)?;
            Some((tooth.fdi, (vec3(&low) + vec3(&high)) / 2.0))
        });
        let tools = scene.tools.iter().take(TOOLS).map(|tool| Tool {
            tip: vec3(&tool.tip),
            park: tool.park,
            graphic: Poses::lean(entity("/tools", &tool.name)),
            haptic: Poses::lean(entity("/hands", &tool.name)),
            is_apart: true,
        });
        let mut pushes = Arrows::new(PUSHES.into(), true);
        pushes.times = Times::without_ticks();
        Self {
            tick_ns: scene.tick_ns,
            tools: tools.collect(),
            probe: probe_of(scene),
            teeth: teeth.collect(),
            middle,
            follow: Follow::new(0.0),
            close_up: Poses::lean(CLOSE_UP.into()),
            pushes,
            arrow_mm_per_n: picture.arrow_mm_per_n,
            plots: [(FORCE, 1), (DEPTH, 2)].map(|(path, width)| {
                let mut plot = Series::new(path, width);
                plot.times = Times::without_ticks();
                plot
            }),
            next_plot: 0,
            last_s: 0.0,
        }
    }

    /// Writes the tools at their parking places.
    pub fn parked(&mut self, stream: &RecordingStream) -> Result<(), Refusal> {
        let mut hands = Hands::default();
        for (hand, tool) in hands.tools.iter_mut().zip(&self.tools) {
            (hand.held, hand.graphic, hand.haptic) = (true, tool.park, tool.park);
        }
        self.write(stream, &hands)
    }

    /// Writes an instant.
    pub fn write(&mut self, stream: &RecordingStream, hands: &Hands) -> Result<(), Refusal> {
        let ns = u128::from(hands.tick) * u128::from(self.tick_ns);
        let at = Moment {
            tick: i64::try_from(hands.tick).unwrap_or(i64::MAX),
            session_ns: i64::try_from(ns).unwrap_or(i64::MAX),
        };
        let mut pushes = Vec::new();
        for (tool, hand) in self.tools.iter_mut().zip(&hands.tools) {
            pushes.extend(tool.push(at, hand, self.arrow_mm_per_n));
            tool.graphic.send(stream)?;
            tool.haptic.send(stream)?;
        }
        self.pushes.push(at, pushes.into_iter());
        self.pushes.send(stream)?;
        self.close_up(at, hands);
        self.close_up.send(stream)?;
        let pocket = hands.tools.iter().find_map(|hand| hand.pocket);
        // A NaN is a gap in the plot.
        let gap = |x: Option<f32>| x.map_or(f64::NAN, f64::from);
        let [force, depth] = &mut self.plots;
        force.push(at, &[gap(pocket.map(|at| at.floor_n))]);
        depth.push(
            at,
            &[
                gap(pocket.map(|at| at.depth_mm)),
                gap(pocket.map(|at| at.true_depth_mm)),
            ],
        );
        self.next_plot = (self.next_plot + 1) % self.plots.len();
        self.plots[self.next_plot].send(stream)
    }

    /// Moves the close-up's frame: from the cheek's or the tongue's side of the tooth that is probed.
    fn close_up(&mut self, at: Moment, hands: &Hands) {
        let now_s = at.session_ns as f64 * 1e-9;
        let step_s = (now_s - self.last_s).clamp(0.0, LONGEST_S);
        self.last_s = now_s;
        let (Some(tool), Some(hand)) = (self.tools.get(self.probe), hands.tools.get(self.probe))
        else {
            return;
        };
        let tip = pose(&hand.graphic).transform(&tool.tip);
        let probed = hand.pocket.and_then(|pocket| {
            let tooth = self.teeth.iter().find(|(fdi, _)| *fdi == pocket.tooth)?;
            Some(tooth.1)
        });
        let flat = |v: Vec3| Vec3::new(v.x, v.y, 0.0);
        let towards = match probed {
            Some(tooth) => {
                let out = flat(tooth - self.middle).normalize();
                let from_tooth = flat(tip - tooth);
                let side = if from_tooth.dot(&out) < 0.0 {
                    -1.0
                } else {
                    1.0
                };
                let along = from_tooth - out * from_tooth.dot(&out);
                let length = along.norm().max(1e-3);
                out * side + along * (ALONG / length)
            }
            None => flat(tip - self.middle),
        };
        let is_clear = towards.norm() > 1e-3 && towards.iter().all(|x| x.is_finite());
        let towards = is_clear.then(|| libm::atan2(towards.y, towards.x));
        self.follow.step(tip, towards, step_s);
        self.close_up.push(at, Some(&self.follow.standing()));
    }
}

/// Arrow: origin, vector, colour, text.
type Push = ([f32; 3], [f32; 3], rerun::Color, String);

impl Tool {
    /// Adds rows for an instant. Returns the arrow of the force on the hand, from the tip.
    fn push(&mut self, at: Moment, hand: &Hand, arrow_mm_per_n: f32) -> Option<Push> {
        let held = hand.held;
        self.graphic
            .push(at, held.then(|| standing(&hand.graphic)).as_ref());
        let tips = [&hand.graphic, &hand.haptic].map(|p| pose(p).transform(&self.tip));
        let is_apart = held && (tips[1] - tips[0]).norm() > APART;
        if is_apart || self.is_apart {
            self.haptic
                .push(at, is_apart.then(|| standing(&hand.haptic)).as_ref());
        }
        self.is_apart = is_apart;
        let size = hand.force_n.iter().map(|x| x * x).sum::<f32>().sqrt();
        let from = tips[0] * 1e3;
        (held && size >= LEAST_N).then(|| {
            (
                [from.x, from.y, from.z].map(|x| x as f32),
                hand.force_n.map(|x| x * arrow_mm_per_n),
                rerun::Color::from_rgb(PUSH[0], PUSH[1], PUSH[2]),
                format!("{size:.2} N"),
            )
        })
    }
}

fn vec3(v: &[f32; 3]) -> Vec3 {
    Vec3::from(v.map(f64::from))
}

fn pose(wire: &WirePose) -> Pose {
    let [w, i, j, k] = wire.orientation.map(f64::from);
    Pose::new(vec3(&wire.position), turned(w, i, j, k))
}

/// Unit quaternion.
fn turned(w: f64, i: f64, j: f64, k: f64) -> Quat {
    let mut quat = Quat::identity().into_inner();
    (quat.w, quat.i, quat.j, quat.k) = (w, i, j, k);
    Quat::new_normalize(quat)
}

fn standing(wire: &WirePose) -> Standing {
    let [w, x, y, z] = wire.orientation;
    Standing {
        at: wire.position.map(|x| x * 1e3),
        turned: [x, y, z, w],
    }
}
