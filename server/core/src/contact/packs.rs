//! Cache-friendly layout of an object's tree: siblings side by side, one array per coordinate.

use wide::f32x8;

use crate::math::{Vec3, fmax, norm};
use crate::tree::{MAX_CHILDREN, Node, Sphere};

/// Relative enlargement of radii in the single-precision filter, four times its rounding error.
const HEADROOM: f64 = 1e-6;

/// Search ball, tested against eight balls at once, in single precision: centre relative to `Packs::origin`, and radius
/// `reach`, metres.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Felt {
    x: f32,
    y: f32,
    z: f32,
    reach: f32,
}

impl Felt {
    /// Creates the ball with its centre at `from`, relative to `Packs::origin`, and the radius `reach`. Both are in
    /// metres.
    #[inline]
    pub fn new(from: &Vec3, reach: f64) -> Self {
        Self {
            x: from.x as f32,
            y: from.y as f32,
            z: from.z as f32,
            reach: (reach * (1.0 + HEADROOM)) as f32,
        }
    }
}

/// Eight balls in single precision, one per lane: centres relative to `Packs::origin`, and radii, metres.
///
/// A conservative filter: may report a ball slightly out of reach, never misses a ball in reach. Empty lanes have no
/// meaning.
#[derive(Clone, Copy, Debug)]
pub(super) struct Balls {
    x: f32x8,
    y: f32x8,
    z: f32x8,
    r: f32x8,
}

/// Family of siblings in the tree. In the masks of siblings, bit `k` is the node `first + k`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Family {
    /// Node index of the first sibling in the tree.
    pub first: u32,
    /// Index in `Packs::families` of the children of the first sibling that has children. The families of the other
    /// siblings with children follow.
    pub first_pack: u32,
    /// Mask of the siblings: bit `k` is set if the node `first + k` belongs to the family.
    pub members: u8,
    /// Mask of the siblings with children.
    parents: u8,
    /// Mask of the used lanes of `Packs::bounds`: the `n` lowest bits for `n` siblings with children.
    inner: u8,
    /// Level of the siblings.
    pub level: u8,
}

/// All families of siblings, in the order of their node indices. The first is the root alone. The lists have one entry
/// per family.
#[derive(Debug)]
pub(super) struct Packs {
    pub families: Vec<Family>,
    /// Balls that enclose the contact spheres of the siblings with children and of their descendants. Lane `k` is the
    /// `k`-th sibling with children.
    pub bounds: Vec<Balls>,
    /// Contact spheres of the siblings. Lane `k` is the node `first + k` of the family.
    pub shapes: Vec<Balls>,
    /// Largest excess of a bound over its node's contact radius in the family, metres.
    pub loose: Vec<f64>,
    /// Origin of all coordinates: the centre of the root in the frame of the nodes, metres.
    pub origin: Vec3,
}

impl Packs {
    /// Creates the packs of a rigid tree, with tight bounds. Tight bounds are costly to compute.
    pub fn new(nodes: &[Node]) -> Self {
        Self::about(nodes, &tight_bounds(nodes))
    }

    /// Creates the packs of a tree with moving spheres; see [`Packs::fit`].
    pub fn moving(nodes: &[Node]) -> Self {
        Self::about(nodes, &own_bounds_of(nodes).collect::<Vec<_>>())
    }

    /// Creates the packs of a tree; `bounds` has a bounding ball for each node.
    fn about(nodes: &[Node], bounds: &[Sphere]) -> Self {
        let inner = nodes.iter().filter(|node| node.children > 0).count();
        let mut packs = Self {
            families: Vec::with_capacity(inner + 1),
            bounds: Vec::with_capacity(inner + 1),
            shapes: Vec::with_capacity(inner + 1),
            loose: Vec::with_capacity(inner + 1),
            origin: nodes[0].centre,
        };
        packs.add(&nodes[..1], &bounds[..1], 0, 1);
        let mut next = 2;
        for node in nodes.iter().filter(|node| node.children > 0) {
            let first = node.first_child as usize;
            let range = first..first + usize::from(node.children);
            let siblings = &nodes[range.clone()];
            packs.add(siblings, &bounds[range], node.first_child, next);
            next += siblings.iter().filter(|child| child.children > 0).count() as u32;
        }
        packs
    }

    /// Updates packs made by [`Packs::moving`] to the current nodes of the tree: origin, bounds and contact spheres.
    pub fn fit(&mut self, nodes: &[Node]) {
        self.origin = nodes[0].centre;
        let Self {
            families,
            bounds,
            shapes,
            loose,
            origin,
        } = self;
        for (k, family) in families.iter().enumerate() {
            let first = family.first as usize;
            let siblings = &nodes[first..first + family.members.count_ones() as usize];
            let parents = siblings.iter().filter(|node| node.children > 0);
            bounds[k] = Balls::new(own_bounds_of(parents), origin);
            shapes[k] = Balls::new(siblings.iter().map(Node::sphere), origin);
            loose[k] = looseness(siblings.iter().zip(own_bounds_of(siblings)));
        }
    }

    /// Appends the family `siblings` with its `bounds`. `first` and `first_pack` are those of [`Family`].
    fn add(&mut self, siblings: &[Node], bounds: &[Sphere], first: u32, first_pack: u32) {
        let bits = |chosen: fn(&Node) -> bool| {
            siblings.iter().enumerate().fold(0u8, |bits, (lane, node)| {
                bits | u8::from(chosen(node)) << lane
            })
        };
        let parents = bits(|node| node.children > 0);
        self.families.push(Family {
            first,
            first_pack,
            members: bits(|_| true),
            parents,
            inner: ((1u16 << parents.count_ones()) - 1) as u8,
            level: siblings[0].level,
        });
        self.loose
            .push(looseness(siblings.iter().zip(bounds.iter().copied())));
        let inner = siblings.iter().zip(bounds);
        let inner = inner.filter(|(node, _)| node.children > 0);
        self.bounds
            .push(Balls::new(inner.map(|(_, bound)| *bound), &self.origin));
        self.shapes
            .push(Balls::new(siblings.iter().map(Node::sphere), &self.origin));
    }
}

/// Returns the largest excess of a bound's radius over its node's contact radius, metres; at least 0.
fn looseness<'a>(bounded: impl Iterator<Item = (&'a Node, Sphere)>) -> f64 {
    bounded.fold(0.0, |most, (node, bound)| {
        fmax(most, bound.radius - node.contact_radius)
    })
}

/// Returns the bounding balls about the nodes' own centres.
fn own_bounds_of<'a>(nodes: impl IntoIterator<Item = &'a Node>) -> impl Iterator<Item = Sphere> {
    nodes.into_iter().map(|node| Sphere {
        centre: node.centre,
        radius: node.bound_radius,
    })
}

/// Number of iterations of [`enclosing`].
const ROUNDS: u32 = 24;

/// Returns, for each node, a ball about all contact spheres below the node, no larger than the ball about the node's
/// own centre. A childless node keeps the ball about its own centre.
///
/// The ball about the own centre extends in all directions as far as the farthest descendant needs in one.
fn tight_bounds(nodes: &[Node]) -> Vec<Sphere> {
    let mut bounds: Vec<Sphere> = own_bounds_of(nodes).collect();
    for (index, node) in nodes.iter().enumerate().rev() {
        if node.children == 0 {
            continue;
        }
        let first = node.first_child as usize;
        let below = first..first + usize::from(node.children);
        let shapes = nodes[below.clone()].iter().map(Node::sphere);
        // Nothing lies below a childless node: its shape suffices.
        let deeper = below.filter(|&child| nodes[child].children > 0);
        bounds[index] = enclosing(bounds[index], || {
            shapes
                .clone()
                .chain(deeper.clone().map(|child| bounds[child]))
        });
    }
    bounds
}

/// Returns a ball that encloses all `balls`: the smallest found, or `start`, which encloses all of them too.
///
/// The method is the first steps of Badoiu and Clarkson's approach to the smallest enclosing ball (SODA 2003, "Smaller
/// core-sets for balls"). Each step moves the centre towards the farthest point, by a decreasing share.
fn enclosing<I: Iterator<Item = Sphere>>(start: Sphere, balls: impl Fn() -> I) -> Sphere {
    let mut best = start;
    let sum = balls().fold((Vec3::zeros(), 0.0), |(sum, n), ball| {
        (sum + ball.centre, n + 1.0)
    });
    let mut centre = sum.0 / sum.1;
    for round in 2..2 + ROUNDS {
        let (mut radius, mut farthest) = (0.0, centre);
        for ball in balls() {
            let away = ball.centre - centre;
            let distance = norm(&away);
            if distance + ball.radius > radius {
                radius = distance + ball.radius;
                let outward = if distance > 0.0 {
                    away / distance
                } else {
                    Vec3::z()
                };
                farthest = ball.centre + outward * ball.radius;
            }
        }
        if radius < best.radius {
            best = Sphere { centre, radius };
        }
        centre += (farthest - centre) / f64::from(round);
    }
    best
}

impl Family {
    /// Returns the mask of the siblings that form the shape at `level`: bit `k` is the node `first + k`.
    #[inline]
    pub fn shapes_at(&self, level: u8) -> u8 {
        if self.level == level {
            self.members
        } else {
            self.members & !self.parents
        }
    }

    /// Returns the mask of [`Family::shapes_at`] and the mask of the lanes of `Packs::bounds` to descend into for the
    /// shape at `level`.
    #[inline]
    pub fn shapes_and_parents(&self, level: u8) -> (u8, u8) {
        if self.level == level {
            (self.members, 0)
        } else {
            (self.members & !self.parents, self.inner)
        }
    }
}

impl Balls {
    fn new(balls: impl Iterator<Item = Sphere>, origin: &Vec3) -> Self {
        let mut lanes = [[0.0; MAX_CHILDREN]; 4];
        for (lane, ball) in balls.enumerate() {
            let from = ball.centre - origin;
            let grown = ball.radius + HEADROOM * (ball.radius + norm(&from)) + 1e-9;
            for (row, value) in lanes.iter_mut().zip([from.x, from.y, from.z, grown]) {
                row[lane] = value as f32;
            }
        }
        let [x, y, z, r] = lanes.map(f32x8::new);
        Self { x, y, z, r }
    }

    /// Returns the mask of the lanes whose ball may overlap `felt`: bit `k` is lane `k`. Bits of empty lanes have no
    /// meaning.
    #[inline(always)]
    pub fn within(&self, felt: Felt) -> u8 {
        let x = f32x8::splat(felt.x) - self.x;
        let y = f32x8::splat(felt.y) - self.y;
        let z = f32x8::splat(felt.z) - self.z;
        let reach = f32x8::splat(felt.reach) + self.r;
        (x * x + y * y + z * z).simd_lt(reach * reach).to_bitmask() as u8
    }
}
