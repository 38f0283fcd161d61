//! Which objects a tool can come near at all: the others cost nothing, however many there are.
//!
//! For each tool and object a lower bound of their distance is found once, and holds until the tool has gone that far:
//! what is `l` from the surface cannot be touched before the path of the working point (and what the object itself
//! moves, if it yields) adds up to `l`. A turn carries a sphere by its lever, so the bound is that of `gap - turn lever`,
//! and it ends with that turn. The next end of all bounds is one number, and as long as it is not reached the list of what is near
//! stays as it is. (Root balls say nothing here: a probe's handle makes its ball as large as the mouth. The bound is found by a
//! descent into both trees that ends where the pair's balls are small beside their distance.)

use super::posed::{Lever, Posed, PosedTool, reach_of};
use super::predictor::Predictor;
use super::{Distance, spread};
use crate::blend::reach;
use crate::math::{Mat3, Vec3, fmax, fmin, norm};
use crate::tree::Node;
use crate::{MAX_TOOLS, Scene};

/// What is closer than this and the farthest that a pass looks is near, metres. Larger: fewer descents, more of what is
/// near, for which lists of neighbours are made (a list takes ten times as long as a bound, and holds for 0.05 mm).
const MARGIN: f64 = 1.5e-4;
/// Path after which what is near is looked at again, metres.
const AGAIN: f64 = 3e-4;
/// Turns that a bound may hold for, the first that leaves the object far: sum of Frobenius norms of differences of rotation
/// matrices. (A tenth of a radian at the far end of a handle is a centimetre, a tooth's width.)
const TURNS: [f64; 3] = [0.1, 0.02, 4e-3];
/// Most pairs of nodes tested for one bound; what takes more is taken to be near. (At 256 three descents of four with a mirror's
/// handle among teeth ended here, and three times as many lists were made.)
const MOST_TESTS: usize = 2000;
/// Size of a pair's balls, in units of the distance between them, up to which they are not opened: a bound need not be sharp,
/// and at 0.5 most descents took more tests than there is time for.
const SMALL: f64 = 2.0;
/// Far above the rounding of all sums here, metres.
const ROUNDING: f64 = 1e-6;

/// Path (metres) and turn at which something ends.
#[derive(Clone, Copy, Debug)]
struct End {
    path: f64,
    turn: f64,
}

/// What is known of one tool.
#[derive(Debug)]
struct OfTool {
    /// Where it was last, and what its path and its turns add up to.
    at: Vec3,
    rotation: Mat3,
    gone: End,
    /// Per object: end of what is known, and whether it is near.
    known: Vec<(End, bool)>,
    /// The first of these ends; nothing is known before the first look.
    next: Option<End>,
    near: Vec<u16>,
}

/// What is near each tool, for one scene. Saves work and never shows in an answer.
#[derive(Debug)]
pub(crate) struct Broad {
    tools: [OfTool; MAX_TOOLS],
    /// Per object: how much farther than elsewhere a pass looks there, where spheres are blended, metres.
    farther: Vec<f64>,
    all: Vec<u16>,
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

    /// Nothing is known any more.
    pub fn forget(&mut self) {
        for tool in &mut self.tools {
            tool.next = None;
        }
    }

    /// The spheres of object `k` have moved by up to `motion` metres.
    pub fn object_moved(&mut self, k: usize, motion: f64) {
        for tool in &mut self.tools {
            let end = &mut tool.known[k].0;
            end.path -= motion;
            if let Some(next) = &mut tool.next {
                next.path = fmin(next.path, end.path);
            }
            // What is not a number is no bound.
            if end.path.is_nan() {
                tool.next = None;
            }
        }
    }

    /// Indices, ascending, of the objects that `tool`, the one that [`Predictor::begin`] was called with, may come closer
    /// to than a pass that looks `d` far looks. `displaced` says how far (metres) the spheres of an object are at most from
    /// where they rest.
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
                    // (What takes too long with one turn does with the next.)
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

/// Frobenius norm.
fn norm_of(m: &Mat3) -> f64 {
    m.norm_squared().sqrt()
}

/// A lower bound of `gap - turn lever` over all pairs of contact spheres, metres; none where some pair is, or may be, under
/// `enough`. And how many pairs of nodes that tested.
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
        // The nearest first: it bounds the others best.
        if let Some(nearest) =
            (first..stack.len()).min_by(|a, b| stack[*a].2.total_cmp(&stack[*b].2))
        {
            let last = stack.len() - 1;
            stack.swap(nearest, last);
        }
    }
    (Some(least), tests)
}
