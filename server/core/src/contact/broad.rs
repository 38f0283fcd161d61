//! Broad phase: the objects that a tool can reach. Far objects cost nothing, however many there are.
//!
//! A lower bound of the distance is cached for each pair of tool and object. The bound `l` is valid until the path of
//! the working point plus the motion of a yielding object adds up to `l`. A turn of the tool carries a sphere by its
//! lever: the bound is that of `gap - turn * lever`, and expires with that turn. The earliest expiry over all objects
//! is kept: the list of near objects stays valid until then.
//!
//! Root spheres give no useful bound, because a probe's handle makes the root sphere as large as the mouth. A bound
//! comes from a descent into both trees, which stops at pairs of nodes that are small compared with their distance.

use super::posed::{Lever, Posed, PosedTool, reach_of};
use super::predictor::Predictor;
use super::{Distance, spread};
use crate::blend::reach;
use crate::math::{Mat3, Vec3, fmax, fmin, norm};
use crate::tree::Node;
use crate::{MAX_TOOLS, Scene};

/// Margin beyond the search distance of a pass within which an object counts as near, metres.
///
/// A larger margin means fewer descents and more near objects, for which neighbour lists are built. A list takes ten
/// times as long as a bound, and stays valid for 0.05 mm.
const MARGIN: f64 = 1.5e-4;
/// Path of the tool's working point after which a near object is tested again, metres. The motion of a yielding object
/// counts too.
const AGAIN: f64 = 3e-4;
/// Turns of the tool for which a bound may stay valid: sums of Frobenius norms of differences of rotation matrices. A
/// value is about 1.4 times the angle in radians. The turns are tried in order until the bound exceeds the search
/// distance and its margin.
///
/// A turn of 0.1 takes 10 mm, the width of a tooth, off the bound at the far end of a handle of 100 mm.
const TURNS: [f64; 3] = [0.1, 0.02, 4e-3];
/// Limit of tested node pairs for one bound. An object beyond the limit counts as near.
///
/// At 256, three of four descents with a mirror's handle among teeth stopped at the limit, and three times as many
/// lists were built.
const MOST_TESTS: usize = 2000;
/// Largest ratio of size to distance at which a pair of nodes (tool, object) beyond the search distance is not opened.
/// The size is the sum of both culling radii, the distance is the lower bound for the pair. A bound need not be sharp.
/// At 0.5 most descents exceeded [`MOST_TESTS`].
const SMALL: f64 = 2.0;
/// Length subtracted from each bound for rounding, metres: far above the rounding of all sums here.
const ROUNDING: f64 = 1e-6;

/// Expiry of cached data, or motion so far: path of the tool's working point, metres, and turn of the tool. The turn is
/// a sum of Frobenius norms as in [`TURNS`].
#[derive(Clone, Copy, Debug)]
struct End {
    path: f64,
    turn: f64,
}

/// Cached data of one tool: its motion so far, and the bounds of all objects.
#[derive(Debug)]
struct OfTool {
    /// Working point at the last query, world axes, metres.
    at: Vec3,
    /// Rotation matrix at the last query, `world_from_tool`.
    rotation: Mat3,
    /// Path and turn accumulated over all queries.
    gone: End,
    /// Per object: values of `gone` at which the bound expires, and whether the object is near.
    known: Vec<(End, bool)>,
    /// Earliest expiry over all objects; `None` before the first query and after [`Broad::forget`].
    next: Option<End>,
    /// Indices of the near objects, ascending.
    near: Vec<u16>,
}

/// Near objects of each tool in one scene. A cache: results do not depend on the cache.
#[derive(Debug)]
pub(crate) struct Broad {
    tools: [OfTool; MAX_TOOLS],
    /// Additional search distance of a pass where spheres are blended, metres, per object: the reach of the blending; 0
    /// without blending.
    farther: Vec<f64>,
    /// Indices of all objects, the result of a plain predictor.
    all: Vec<u16>,
    /// Scratch of [`clearance`]: tool node, object node, lower bound for the pair in metres.
    stack: Vec<(u32, u32, f64)>,
}

impl Broad {
    pub fn new(scene: &Scene) -> Self {
        let objects = scene.objects.len();
        let of_tool = |_| OfTool {
            at: Vec3::zeros(),
            rotation: Mat3::identity(),
            gone: End {
                path: 0.0,
                turn: 0.0,
            },
            known: vec![
                (
                    End {
                        path: 0.0,
                        turn: 0.0
                    },
                    true
                );
                objects
            ],
            next: None,
            near: Vec::with_capacity(objects),
        };
        let blend = |k: usize| match scene.blend_of(k) {
            0.0 => 0.0,
            blend => reach(blend) * blend,
        };
        Self {
            tools: std::array::from_fn(of_tool),
            farther: (0..objects).map(blend).collect(),
            all: (0..objects as u16).collect(),
            stack: Vec::with_capacity(MOST_TESTS + 8),
        }
    }

    /// Invalidates all cached bounds.
    pub fn forget(&mut self) {
        for tool in &mut self.tools {
            tool.next = None;
        }
    }

    /// Shortens the cached bounds of object `k` after a motion of its spheres by up to `motion` (metres).
    pub fn object_moved(&mut self, k: usize, motion: f64) {
        for tool in &mut self.tools {
            let end = &mut tool.known[k].0;
            end.path -= motion;
            if let Some(next) = &mut tool.next {
                next.path = fmin(next.path, end.path);
            }
            // NaN is no valid bound.
            if end.path.is_nan() {
                tool.next = None;
            }
        }
    }

    /// Returns the indices, ascending, of the objects that `tool` may reach within the search distance `d` of a pass.
    ///
    /// `tool` must be the tool of the last [`Predictor::begin`], and `longest` its longest lever, metres. `displaced`
    /// returns the largest displacement of an object's spheres from rest, metres.
    pub fn near(
        &mut self,
        scene: &Scene,
        predictor: &mut Predictor,
        tool: &PosedTool<'_>,
        (d, longest): (Distance, f64),
        displaced: impl Fn(usize) -> f64,
    ) -> &[u16] {
        if predictor.is_plain() {
            return &self.all;
        }
        let d = d.at(longest);
        let slot = usize::from(tool.slot);
        let of_tool = &mut self.tools[slot];
        let posed = &predictor.posed;
        let by = End {
            path: norm(&(posed.working_point - of_tool.at)),
            turn: norm_of(&(posed.rotation - of_tool.rotation)),
        };
        (of_tool.at, of_tool.rotation) = (posed.working_point, posed.rotation);
        of_tool.gone.path += by.path;
        of_tool.gone.turn += by.turn;
        if !(of_tool.gone.path.is_finite() && of_tool.gone.turn.is_finite()) {
            (of_tool.gone.path, of_tool.gone.turn, of_tool.next) = (0.0, 0.0, None);
        }
        let gone = of_tool.gone;
        let holds = |end: &End| gone.path + d <= end.path && gone.turn <= end.turn;
        if of_tool.next.as_ref().is_some_and(holds) {
            return &self.tools[slot].near;
        }
        let fresh = of_tool.next.is_none();
        let mut next = End {
            path: f64::INFINITY,
            turn: f64::INFINITY,
        };
        of_tool.near.clear();
        for (k, object) in scene.objects.iter().enumerate() {
            if fresh || !holds(&of_tool.known[k].0) {
                let spread = spread(k);
                let nodes = (object.tree.nodes(), object.level);
                let enough = d + self.farther[k] + displaced(k) + MARGIN;
                let Predictor {
                    posed,
                    levers,
                    work,
                    ..
                } = &mut *predictor;
                let levers = &levers[slot];
                let (mut bound, mut turn) = (None, 0.0);
                for most in TURNS {
                    turn = most * spread;
                    let skin = (turn, enough);
                    let (found, tests) =
                        clearance(tool, posed, levers, nodes, skin, &mut self.stack);
                    work.bounds += 1;
                    work.tested += tests;
                    bound = found;
                    // A descent over the test limit exceeds it with a smaller turn as well.
                    if bound.is_some() || tests > MOST_TESTS as u64 {
                        break;
                    }
                }
                if bound.is_none() {
                    turn = TURNS[1] * spread;
                }
                let near = bound.is_none();
                let path =
                    d + bound.map_or(AGAIN * spread, |bound| bound - enough + MARGIN - ROUNDING);
                let end = End {
                    path: gone.path + path,
                    turn: gone.turn + turn,
                };
                of_tool.known[k] = (end, near);
            }
            let (end, near) = of_tool.known[k];
            next.path = fmin(next.path, end.path);
            next.turn = fmin(next.turn, end.turn);
            if near {
                of_tool.near.push(k as u16);
            }
        }
        of_tool.next = Some(next);
        &self.tools[slot].near
    }
}

/// Returns the Frobenius norm of `m`: the root of the sum of the squared entries.
fn norm_of(m: &Mat3) -> f64 {
    m.norm_squared().sqrt()
}

/// Returns a lower bound of `gap - turn * lever` over all pairs of contact spheres of tool and object, metres. The
/// second value is the number of tested node pairs.
///
/// The bound is `None` when some pair is or may be at or below `enough` (metres), or when [`MOST_TESTS`] is exceeded.
/// `nodes` are the object's in world axes, in contact at `level`; `turn` is as in [`TURNS`].
fn clearance(
    tool: &PosedTool<'_>,
    posed: &mut Posed,
    levers: &[Lever],
    (nodes, level): (&[Node], u8),
    (turn, enough): (f64, f64),
    stack: &mut Vec<(u32, u32, f64)>,
) -> (Option<f64>, u64) {
    let mut bound = |t: u32, o: u32| {
        let (node, other) = (&tool.nodes[t as usize], &nodes[o as usize]);
        let is_shape = node.is_shape_at(tool.level);
        let between = norm(&(posed.centre_of(tool, t) - other.centre));
        let size = reach_of(node, is_shape) + reach_of(other, other.is_shape_at(level));
        (
            between - size - turn * levers[t as usize].of(is_shape),
            size,
        )
    };
    let (mut least, mut tests) = (f64::INFINITY, 1);
    stack.clear();
    stack.push((0, 0, bound(0, 0).0));
    while let Some((t, o, low)) = stack.pop() {
        if low >= least {
            continue;
        }
        let (node, other) = (&tool.nodes[t as usize], &nodes[o as usize]);
        let (is_shape, other_is_shape) = (node.is_shape_at(tool.level), other.is_shape_at(level));
        let size = reach_of(node, is_shape) + reach_of(other, other_is_shape);
        if low > enough && size < SMALL * low {
            least = low;
            continue;
        }
        if is_shape && other_is_shape {
            if low <= enough {
                return (None, tests);
            }
            least = low;
            continue;
        }
        let open_tool = !is_shape && (other_is_shape || node.bound_radius > other.bound_radius);
        let opened = if open_tool { node } else { other };
        let children = opened.first_child..opened.first_child + u32::from(opened.children);
        tests += u64::from(opened.children);
        if tests > MOST_TESTS as u64 {
            return (None, tests);
        }
        let first = stack.len();
        for child in children {
            let (t, o) = if open_tool { (child, o) } else { (t, child) };
            let low = fmax(low, bound(t, o).0);
            if low < least {
                stack.push((t, o, low));
            }
        }
        // Nearest first: the smallest bound prunes most of the others.
        if let Some(nearest) =
            (first..stack.len()).min_by(|a, b| stack[*a].2.total_cmp(&stack[*b].2))
        {
            let last = stack.len() - 1;
            stack.swap(nearest, last);
        }
    }
    (Some(least), tests)
}
