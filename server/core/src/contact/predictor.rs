//! Contact prediction of one tool against one object at a time, by list or by traversal.

use super::dual::{STACK, traverse};
use super::front::Search;
use super::near::{Near, any_within};
use super::neighbours::{CAPACITY, Neighbours};
use super::packs::Packs;
use super::posed::{Lever, Posed, PosedTool, levers};
use super::{ContactList, ContactsFull, Distance};
use crate::MAX_TOOLS;
use crate::scene::Scene;
use crate::tree::Node;

/// Work counters of contact prediction since the workspace was created. The counts are the same on every machine.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Work {
    /// Queries of one tool against one object.
    pub queries: u64,
    /// Tested pairs of nodes. A test of a sphere against a family counts as eight, whatever the number of siblings.
    pub tested: u64,
    /// Neighbour lists built.
    pub lists: u64,
    /// Queries without a usable list, answered by traversal.
    pub unlisted: u64,
    /// Lower bounds computed by the broad phase for the distance of a tool to an object, one for each turn tried.
    pub bounds: u64,
}

/// Contact prediction for one scene, with caches. Results do not depend on the caches.
#[derive(Debug)]
pub struct Predictor {
    pub(super) posed: Posed,
    /// Scratch of a traversal: open pairs of a tool node and an object node.
    pub(super) stack: Vec<(u32, u32)>,
    /// Families of each rigid object, by object; `None` for a yielding object.
    packs: Vec<Option<Packs>>,
    /// Neighbour lists by tool and object, tools outermost; `None` for a yielding object.
    neighbours: Vec<Option<Neighbours>>,
    /// Levers by tool slot and node of the tool; empty for a slot without a tool.
    pub(super) levers: [Vec<Lever>; MAX_TOOLS],
    pub(super) search: Search,
    /// Scratch: index of each tool node in `Neighbours::spheres` of the list being built.
    places: Vec<u32>,
    pub(crate) work: Work,
    /// Whether every query traverses both trees, without caches.
    plain: bool,
}

impl Predictor {
    /// Creates contact prediction for `scene`. Rigid objects must not change.
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

    /// Creates contact prediction without caches: every query traverses both trees from their roots. Slower, with the
    /// same results; the reference in tests.
    pub fn plain(scene: &Scene) -> Self {
        Self {
            plain: true,
            ..Self::new(scene)
        }
    }

    /// Whether the predictor works without caches.
    pub(crate) fn is_plain(&self) -> bool {
        self.plain
    }

    /// Returns the posed spheres and the levers of the tool in `slot`, the tool of the last [`Predictor::begin`].
    pub(super) fn posed_for(&mut self, slot: u8) -> (&mut Posed, &[Lever]) {
        (&mut self.posed, &self.levers[usize::from(slot)])
    }

    /// Returns the counts of work since the predictor was created.
    pub fn work(&self) -> Work {
        self.work
    }

    /// Starts the queries of one tool at one pose.
    pub fn begin(&mut self, tool: &PosedTool<'_>) {
        self.posed.begin(tool);
    }

    /// Whether any pair of contact spheres of `tool` and an object has a gap under `d`, metres; see [`any_within`].
    /// `tool` must be the tool of the last [`Predictor::begin`]. Uses no cache and counts no work.
    pub(crate) fn any_within(
        &mut self,
        tool: &PosedTool<'_>,
        object: (&[Node], u8),
        d: f64,
        tests: &mut u32,
    ) -> Near {
        any_within(tool, &mut self.posed, object, d, &mut self.stack, tests)
    }

    /// Appends every pair of contact spheres of `tool` and `object` with a gap under `d` to `out`.
    ///
    /// `tool` must be the tool of the last [`Predictor::begin`]. `object` is the index in the scene, the nodes in world
    /// axes and the level in contact. `d` is a distance in metres, or a [`Distance`] that grows with the lever of the
    /// tool's sphere.
    ///
    /// # Errors
    /// `out` is full and its policy is [`super::Overflow::Stop`]. `out` then holds an arbitrary part of the contacts.
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
