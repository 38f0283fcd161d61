//! One tool against one object after the other, by the way that suits the object.

use super::dual::{STACK, traverse};
use super::front::Search;
use super::neighbours::{CAPACITY, Neighbours};
use super::packs::Packs;
use super::posed::{Lever, Posed, PosedTool, levers};
use super::{ContactList, ContactsFull, Distance};
use crate::MAX_TOOLS;
use crate::scene::Scene;
use crate::tree::Node;

/// What contact prediction did since the workspace was made: counts, so the same on every machine.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Work {
    /// Queries of one tool against one object.
    pub queries: u64,
    /// Pairs of spheres tested, each sphere of a family counted.
    pub tested: u64,
    /// Lists of neighbours made anew.
    pub lists: u64,
    /// Queries that no list could answer.
    pub unlisted: u64,
    /// Bounds of the distance of a tool and an object found anew.
    pub bounds: u64,
}

/// Contact prediction for one scene. What it keeps from query to query saves work and never
/// shows in an answer.
#[derive(Debug)]
pub struct Predictor {
    pub(super) posed: Posed,
    pub(super) stack: Vec<(u32, u32)>,
    /// Families of each rigid object; none for what yields.
    packs: Vec<Option<Packs>>,
    /// Per tool and object, tools outermost.
    neighbours: Vec<Option<Neighbours>>,
    /// Per tool and node.
    pub(super) levers: [Vec<Lever>; MAX_TOOLS],
    pub(super) search: Search,
    /// Place in a list's spheres of each node of a tool.
    places: Vec<u32>,
    pub(crate) work: Work,
    plain: bool,
}

impl Predictor {
    /// Contact prediction for `scene`: rigid objects are taken to stay as they are.
    pub fn new(scene: &Scene) -> Self {
        let packs: Vec<Option<Packs>> = scene
            .objects
            .iter()
            .map(|object| {
                object
                    .tissue
                    .is_rigid()
                    .then(|| Packs::new(object.tree.nodes()))
            })
            .collect();
        let neighbours = scene
            .tools
            .iter()
            .flat_map(|tool| {
                let spheres = tool.tree.nodes().len();
                packs.iter().enumerate().map(move |(k, packs)| {
                    let families = packs.as_ref()?.families.len();
                    Some(Neighbours::new(spheres, (k, families)))
                })
            })
            .collect();
        let tool_nodes = scene.tools.iter().map(|tool| tool.tree.nodes().len()).max();
        let tool_nodes = tool_nodes.unwrap_or(0);
        Self {
            posed: Posed::with_capacity(tool_nodes),
            stack: Vec::with_capacity(STACK),
            packs,
            neighbours,
            levers: std::array::from_fn(|t| scene.tools.get(t).map_or(Vec::new(), levers)),
            search: Search::new(tool_nodes, CAPACITY),
            places: vec![0; tool_nodes],
            work: Work::default(),
            plain: false,
        }
    }

    /// The same without any memory: every query traverses both trees from their roots. Slower, the same
    /// answers: what the other is tested against.
    pub fn plain(scene: &Scene) -> Self {
        Self {
            plain: true,
            ..Self::new(scene)
        }
    }

    /// Whether nothing is kept from query to query.
    pub(crate) fn is_plain(&self) -> bool {
        self.plain
    }

    /// The spheres of the tool in `slot`, the one that [`Predictor::begin`] was called with, and their levers.
    pub(super) fn posed_for(&mut self, slot: u8) -> (&mut Posed, &[Lever]) {
        (&mut self.posed, &self.levers[usize::from(slot)])
    }

    /// What was done so far.
    pub fn work(&self) -> Work {
        self.work
    }

    /// Begins the queries of one tool at one pose.
    pub fn begin(&mut self, tool: &PosedTool<'_>) {
        self.posed.begin(tool);
    }

    /// Appends every pair of contact spheres of `tool`, the one that [`Predictor::begin`] was called with,
    /// and `object` (its index in the scene, its nodes in world axes, its level in contact) with a gap
    /// under `d` to `out`: a distance, or one that grows with the lever of the tool's sphere.
    ///
    /// # Errors
    /// When `out` is full and [`super::Overflow::Stop`] holds; it then has an arbitrary part.
    pub fn predict(
        &mut self,
        tool: &PosedTool<'_>,
        object: (u16, &[Node], u8),
        d: impl Into<Distance>,
        out: &mut ContactList,
    ) -> Result<(), ContactsFull> {
        let d = d.into();
        self.work.queries += 1;
        let (k, t) = (usize::from(object.0), usize::from(tool.slot));
        let at = t * self.packs.len() + k;
        if let (Some(packs), Some(neighbours), false) =
            (&self.packs[k], &mut self.neighbours[at], self.plain)
        {
            let level = object.2;
            if !neighbours.covers(&self.posed, (tool.level, level), d) {
                self.work.lists += 1;
                self.work.tested += neighbours.list(
                    tool,
                    &mut self.posed,
                    (packs, level),
                    &self.levers[t],
                    d,
                    (&mut self.search, &mut self.places),
                );
            }
            if neighbours.usable() {
                self.work.tested += neighbours.tests();
                return neighbours.query(
                    tool,
                    &mut self.posed,
                    (object.0, object.1, packs),
                    (d, &self.levers[t]),
                    out,
                );
            }
            self.work.unlisted += 1;
        }
        let counted = (&mut self.stack, &mut self.work.tested);
        let within = (d, self.levers[t].as_slice());
        traverse(tool, &mut self.posed, object, within, counted, out)
    }
}
