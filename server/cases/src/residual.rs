//! Query of the *residual*: all pairs of leaves at the levels in use, on the final, deformed shapes.
//!
//! The query uses no tree and no prediction distance. Of the tick it uses only the positions of the spheres.

use sulcus_core::blend::compatibility;
use sulcus_core::{Node, Pose, Scene, SphereTree, Vec3, Workspace};

/// All leaves of a scene at their positions after the last tick.
#[derive(Clone, Debug)]
pub(crate) struct FullQuery {
    tools: Vec<Vec<Node>>,
    solids: Vec<Solid>,
    placed: Vec<(Vec3, f64)>,
}

impl FullQuery {
    /// Leaves of `scene` at its own levels of detail, at rest.
    pub fn new(scene: &Scene) -> Self {
        let leaves =
            |tree: &SphereTree, level| tree.shape_at(level).map(|(_, node)| *node).collect();
        Self {
            tools: scene
                .tools
                .iter()
                .map(|tool| leaves(&tool.tree, tool.level))
                .collect(),
            solids: (0..scene.objects.len())
                .map(|k| Solid::new(scene, k))
                .collect(),
            placed: Vec::new(),
        }
    }

    /// Moves the leaves of deformable objects to their positions after the last tick.
    pub fn deform(&mut self, ws: &Workspace) {
        self.solids.iter_mut().for_each(|solid| solid.deform(ws));
    }

    /// Objects in the order of the scene.
    pub fn solids(&self) -> &[Solid] {
        &self.solids
    }

    /// Deepest overlap of any leaf of tool `t` at `pose` (`world_from_tool`) with any object, metres; 0 without an
    /// overlap.
    pub fn deepest(&mut self, t: usize, pose: &Pose) -> f64 {
        deepest(&self.tools[t], pose, &self.solids, &mut self.placed)
    }
}

/// Leaves of an object at the level in use, world, metres.
#[derive(Clone, Debug)]
pub(crate) struct Solid {
    object: usize,
    /// Indices of the leaves' nodes.
    ids: Vec<u32>,
    /// Centres of the leaves at rest.
    pub rest: Vec<Vec3>,
    /// Whether the object is deformable.
    pub yields: bool,
    /// Centre and radius of each leaf; for blended spheres the radius of the core.
    pub leaves: Vec<(Vec3, f64)>,
    centres: Vec<Vec3>,
    /// Whether all leaves are at rest.
    pub at_rest: bool,
    /// Blend length; 0 for hard spheres.
    blend: f64,
    /// Lower corner of the box around the leaves.
    low: Vec3,
    /// Upper corner of the box around the leaves.
    high: Vec3,
}

/// Number of a tool's spheres that share a box.
const TOGETHER: usize = 16;
/// Number of blend lengths at which the weight of a sphere is 1e-10.
const FAR: f64 = 23.0;

impl Solid {
    fn new(scene: &Scene, k: usize) -> Self {
        let (object, blend) = (&scene.objects[k], scene.blend_of(k));
        let radius = |id, node: &Node| {
            if blend > 0.0 {
                object.tree.core_radius(id, object.level)
            } else {
                node.contact_radius
            }
        };
        let shape = || object.tree.shape_at(object.level);
        let leaves: Vec<_> = shape()
            .map(|(id, node)| (node.centre, radius(id, node)))
            .collect();
        let (low, high) = box_of(&leaves);
        let rest: Vec<Vec3> = shape().map(|(_, node)| node.centre).collect();
        Self {
            object: k,
            ids: shape().map(|(id, _)| id).collect(),
            centres: rest.clone(),
            rest,
            yields: !object.tissue.is_rigid(),
            at_rest: true,
            leaves,
            blend,
            low,
            high,
        }
    }

    /// Moves the leaves to their positions after the last tick. A rigid object has no change.
    fn deform(&mut self, ws: &Workspace) {
        if !self.yields {
            return;
        }
        let at_rest = ws.shape_of(self.object).iter().all(|x| *x == 0.0);
        if at_rest && self.at_rest {
            return;
        }
        self.at_rest = at_rest;
        ws.centres_of(self.object, &self.ids, &mut self.centres);
        for (leaf, centre) in self.leaves.iter_mut().zip(&self.centres) {
            leaf.0 = *centre;
        }
        (self.low, self.high) = box_of(&self.leaves);
    }

    /// Depth of a ball below the blended surface of `leaves`, metres; 0 or less outside. All leaves with a weight above
    /// 1e-10 take part.
    fn blended_depth(&self, leaves: &[(Vec3, f64)], centre: &Vec3, radius: f64) -> f64 {
        let margin = radius + FAR * self.blend;
        if (0..3).any(|k| centre[k] + margin < self.low[k] || centre[k] - margin > self.high[k]) {
            return 0.0;
        }
        let seen: Vec<(f64, f64, Vec3)> = leaves
            .iter()
            .filter(|(c, r)| (centre - c).norm_squared() < (r + margin) * (r + margin))
            .map(|(c, r)| {
                let distance = (centre - c).norm();
                (distance - r - radius, distance, (centre - c) / distance)
            })
            .collect();
        let least = seen.iter().fold(f64::INFINITY, |least, s| least.min(s.0));
        if least - self.blend * (seen.len() as f64).ln() >= 0.0 {
            return 0.0;
        }
        seen.iter()
            .map(|(own, distance, normal)| {
                let sum: f64 = seen
                    .iter()
                    .map(|(gap, other, n)| {
                        let cosine = normal.dot(n);
                        let nearer = distance.min(*other);
                        let shared = compatibility(cosine, nearer, gap - own, self.blend);
                        shared * ((least - gap) / self.blend).exp()
                    })
                    .sum();
                self.blend * sum.ln() - least
            })
            .fold(0.0, f64::max)
    }
}

/// Box around balls.
fn box_of(balls: &[(Vec3, f64)]) -> (Vec3, Vec3) {
    let huge = Vec3::repeat(f64::INFINITY);
    let (mut low, mut high) = (huge, -huge);
    for (centre, radius) in balls {
        low = low.zip_map(&(centre - Vec3::repeat(*radius)), f64::min);
        high = high.zip_map(&(centre + Vec3::repeat(*radius)), f64::max);
    }
    (low, high)
}

/// Deepest overlap of any leaf of a tool with any object, metres; 0 without an overlap. Every pair whose boxes meet is
/// tested.
fn deepest(tool: &[Node], pose: &Pose, solids: &[Solid], placed: &mut Vec<(Vec3, f64)>) -> f64 {
    placed.clear();
    placed.extend(
        tool.iter()
            .map(|node| (pose.transform(&node.centre), node.contact_radius)),
    );
    let (low, high) = box_of(placed);
    let mut depth: f64 = 0.0;
    let (mut near, mut makes) = (Vec::new(), Vec::new());
    for solid in solids {
        let margin = FAR * solid.blend;
        if (0..3).any(|k| solid.low[k] - margin > high[k] || solid.high[k] + margin < low[k]) {
            continue;
        }
        near.clear();
        let beside =
            |(c, r): &&(Vec3, f64)| (0..3).all(|k| c[k] + r >= low[k] && c[k] - r <= high[k]);
        near.extend(solid.leaves.iter().filter(beside));
        // Successive spheres are close to each other: a box around a few of them excludes most pairs.
        for few in placed.chunks(TOGETHER) {
            let (low, high) = box_of(few);
            for (c, r) in &near {
                if (0..3).any(|k| c[k] + r < low[k] || c[k] - r > high[k]) {
                    continue;
                }
                for (centre, radius) in few {
                    let reach = r + radius;
                    let between = centre - c;
                    let squared = between.norm_squared();
                    if squared < reach * reach {
                        depth = depth.max(reach - squared.sqrt());
                    }
                }
            }
            if solid.blend > 0.0 {
                let beside = |(c, r): &&(Vec3, f64)| {
                    let reach = r + margin;
                    (0..3).all(|k| c[k] + reach >= low[k] && c[k] - reach <= high[k])
                };
                makes.clear();
                makes.extend(solid.leaves.iter().filter(beside));
                for (centre, radius) in few {
                    depth = depth.max(solid.blended_depth(&makes, centre, *radius));
                }
            }
        }
    }
    depth
}
