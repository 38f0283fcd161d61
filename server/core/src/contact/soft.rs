//! Neighbour list of one tool on one tissue: pairs of spheres.
//!
//! The list holds all pairs that can come closer than `d` before tool and tissue together have moved by more than a
//! skin. The list of `neighbours` for rigid objects ends at families; here the list goes down to single spheres. The
//! tissue model computes the centres of the listed spheres in every pass. The tree is not refitted for a query.

use super::coarse::{CoarseSearch, TURN};
use super::neighbours::{CAPACITY as FAMILIES, slack};
use super::packs::Packs;
use super::posed::{Posed, PosedTool};
use super::predictor::Predictor;
use super::{ContactList, ContactsFull, Distance, spread};
use crate::math::{Mat3, Vec3, norm};
use crate::scene::tool::Tool;
use crate::tissue::Tissue;
use crate::tree::Node;

/// Motion of working point and tissue together for which a list is valid, metres, times its [`spread`].
const TRANSLATION: f64 = 2.6e-4;
/// Largest number of pairs in a list. A mirror that lies in a tongue has 4,000 to 10,000 pairs.
const CAPACITY: usize = 12_288;
/// Number of times that [`TRANSLATION`] is halved for a list that does not fit.
///
/// Without a list every query traverses both trees, half of the time of a tick with a mirror deep in a tongue.
const HALVINGS: u32 = 3;

/// Neighbour list of one tool on one tissue, and the range of its validity.
#[derive(Debug)]
pub(crate) struct SoftNeighbours {
    /// Pairs: index of the object's sphere in `spheres`, then node of the tool's tree. Sorted by both.
    pairs: Vec<(u32, u32)>,
    /// Nodes of the object in the list, ascending.
    spheres: Vec<u32>,
    /// Centres of `spheres` in the current query, world axes, metres.
    centres: Vec<Vec3>,
    /// Families of the object, refitted to the tissue's shape for each list that is built without `coarse`.
    packs: Packs,
    /// Search in the tool's families, for a tissue with spheres larger than the tool's; otherwise `None`.
    coarse: Option<CoarseSearch>,
    /// Scratch: mask of the siblings of a family within reach of each tool sphere; bit `k` is the sibling `k`.
    masks: Vec<u8>,
    /// Rotation matrix of the tool when the list was built, `world_from_tool`.
    rotation: Mat3,
    /// Working point when the list was built, world axes, metres.
    working_point: Vec3,
    /// Shape of the tissue when the list was built.
    shape: Vec<f64>,
    /// Whether the list was built for the rest shape.
    at_rest: bool,
    /// Level of the tool's tree in contact; `None` before the first list and after [`SoftNeighbours::forget`].
    level: Option<u8>,
    /// Largest sum of three lengths, metres: motion of the working point and of the tissue since the list was built,
    /// and `Distance::base` of a query.
    reach: f64,
    /// Largest sum of the tool's turn since the list was built (Frobenius norm, see [`TURN`]) and `Distance::turn` of a
    /// query, radians.
    turn: f64,
    /// Factor on [`TRANSLATION`]; see [`spread`].
    spread: f64,
    /// Capacity of `pairs`.
    most: usize,
    /// Whether all pairs fitted into the list.
    usable: bool,
}

impl SoftNeighbours {
    /// Creates the list for a tool on object `k`, whose shape has `shape_len` numbers. `nodes` are the object's, in
    /// contact at `level`. `tool` is `None` for an empty slot.
    pub fn new(
        tool: Option<&Tool>,
        (k, shape_len): (usize, usize),
        (nodes, level): (&[Node], u8),
    ) -> Self {
        let shape = |nodes: &[Node], level| {
            let shape = nodes.iter().filter(|node| node.is_shape_at(level));
            shape.count()
        };
        let (own, theirs) = (
            tool.map_or(0, |tool| shape(tool.tree.nodes(), tool.level)),
            shape(nodes, level),
        );
        let most = CAPACITY.min(own.saturating_mul(theirs));
        Self {
            pairs: Vec::with_capacity(most),
            spheres: Vec::with_capacity(most.min(theirs)),
            centres: vec![Vec3::zeros(); most.min(theirs)],
            most,
            packs: Packs::moving(nodes),
            coarse: tool.and_then(|tool| CoarseSearch::new(tool, (nodes, level))),
            masks: Vec::with_capacity(FAMILIES.min(own)),
            rotation: Mat3::identity(),
            working_point: Vec3::zeros(),
            shape: vec![0.0; shape_len],
            at_rest: false,
            level: None,
            reach: 0.0,
            turn: 0.0,
            spread: spread(k),
            usable: false,
        }
    }

    /// Invalidates the list.
    pub fn forget(&mut self) {
        self.level = None;
    }

    /// Whether the list is complete. Only a traversal answers queries of an incomplete list.
    pub fn usable(&self) -> bool {
        self.usable
    }

    /// Whether no pair outside the list can be closer than `d` at this pose and shape. `level` is the tool's. The shape
    /// `None` is the rest shape.
    pub fn covers(
        &self,
        predictor: &Predictor,
        level: u8,
        (model, shape): (&dyn Tissue, Option<&[f64]>),
        d: Distance,
    ) -> bool {
        let posed = &predictor.posed;
        let turned = posed.rotation - self.rotation;
        let spare = self.turn - d.turn;
        let moved = norm(&(posed.working_point - self.working_point)) + d.base;
        if self.level != Some(level)
            || moved > self.reach
            || turned.norm_squared() > spare * spare
            || spare < 0.0
        {
            return false;
        }
        match shape {
            None if self.at_rest => true,
            None => false,
            Some(shape) => moved + model.motion(&self.shape, shape) <= self.reach,
        }
    }

    /// Builds the list for the present pose, `shape` and distance `d`. `nodes` are the object's, refitted to the shape;
    /// `level` is the object's. The shape `None` is the rest shape.
    pub fn list(
        &mut self,
        predictor: &mut Predictor,
        tool: &PosedTool<'_>,
        (nodes, level): (&[Node], u8),
        shape: Option<&[f64]>,
        d: Distance,
    ) {
        let posed = &predictor.posed;
        (self.rotation, self.working_point) = (posed.rotation, posed.working_point);
        self.level = Some(tool.level);
        self.at_rest = shape.is_none();
        match shape {
            Some(shape) => self.shape.copy_from_slice(shape),
            None => self.shape.fill(0.0),
        }
        predictor.work.lists += 1;
        let mut skin = self.spread * TRANSLATION;
        for _ in 0..=HALVINGS {
            (self.reach, self.turn) = (d.base + skin, d.turn + TURN);
            self.pairs.clear();
            self.spheres.clear();
            match self.coarse.take() {
                Some(mut search) => {
                    self.list_coarse(&mut search, predictor, tool, (nodes, level), d);
                    self.coarse = Some(search);
                }
                None => self.list_fine(predictor, tool, (nodes, level)),
            }
            if self.usable {
                break;
            }
            skin *= 0.5;
        }
    }

    /// Builds the list by [`CoarseSearch`]: each sphere of the object descends the tool's tree. An overflow leaves the
    /// list unusable.
    fn list_coarse(
        &mut self,
        search: &mut CoarseSearch,
        predictor: &mut Predictor,
        tool: &PosedTool<'_>,
        (nodes, level): (&[Node], u8),
        d: Distance,
    ) {
        let Self {
            pairs,
            spheres,
            usable,
            reach,
            most,
            ..
        } = self;
        let reach = (*reach, d.turn);
        *usable = true;
        for (o, node) in nodes.iter().enumerate() {
            if !node.is_shape_at(level) {
                continue;
            }
            let (first, place) = (pairs.len(), spheres.len() as u32);
            let found = |t: u32| {
                let room = pairs.len() < *most;
                if room {
                    pairs.push((place, t));
                }
                room
            };
            let posed = (tool, &predictor.posed);
            match search.run(posed, &node.sphere(), reach, found) {
                Some(tested) => predictor.work.tested += tested,
                None => {
                    *usable = false;
                    return;
                }
            }
            if pairs.len() > first {
                spheres.push(o as u32);
            }
        }
    }

    /// Builds the list from the object's families, refitted to `nodes`. An overflow leaves the list unusable.
    fn list_fine(
        &mut self,
        predictor: &mut Predictor,
        tool: &PosedTool<'_>,
        (nodes, level): (&[Node], u8),
    ) {
        self.packs.fit(nodes);
        let Predictor {
            posed,
            search,
            levers,
            work,
            ..
        } = predictor;
        let slack = slack(self.reach, self.turn);
        let levers = &levers[usize::from(tool.slot)];
        let packs = (&self.packs, level);
        let (usable, tested) = search.run(tool, posed, packs, levers, slack, FAMILIES);
        work.tested += tested;
        self.usable = usable;
        let mut rest = search.keys();
        while let Some(first) = rest.first() {
            let p = first >> 32;
            let run = rest.iter().take_while(|key| *key >> 32 == p).count();
            let (now, later) = rest.split_at(run);
            rest = later;
            let (family, balls) = (
                &self.packs.families[p as usize],
                &self.packs.shapes[p as usize],
            );
            let shapes = family.shapes_at(level);
            self.masks.clear();
            self.masks.extend(now.iter().map(|key| {
                // The search reports families; this test selects the spheres.
                shapes & balls.within(search.felt(*key as u32))
            }));
            let mut any = self.masks.iter().fold(0, |any, mask| any | mask);
            // Object spheres outermost, so that the pairs come sorted.
            while any != 0 {
                if self.pairs.len() == self.most {
                    self.usable = false;
                    return;
                }
                let lane = any.trailing_zeros();
                any &= any - 1;
                let place = self.spheres.len() as u32;
                self.spheres.push(family.first + lane);
                for (mask, key) in self.masks.iter().zip(now) {
                    if mask & 1 << lane != 0 {
                        if self.pairs.len() == self.most {
                            self.usable = false;
                            return;
                        }
                        self.pairs.push((place, *key as u32));
                    }
                }
            }
        }
    }

    /// Appends the contacts with a gap under `d` at the present pose and `shape` to `out`, sorted. `object` is the
    /// index in the scene. `nodes` are the object's, used only for their radii. The list must cover `d`.
    pub fn query(
        &mut self,
        predictor: &mut Predictor,
        tool: &PosedTool<'_>,
        (object, nodes): (u16, &[Node]),
        (model, shape): (&dyn Tissue, &[f64]),
        d: Distance,
        out: &mut ContactList,
    ) -> Result<(), ContactsFull> {
        let centres = &mut self.centres[..self.spheres.len()];
        model.centres(shape, &self.spheres, centres);
        predictor.work.tested += self.pairs.len() as u64;
        let (posed, levers) = predictor.posed_for(tool.slot);
        for &(place, t) in &self.pairs {
            let o = self.spheres[place as usize];
            let mut sphere = nodes[o as usize].sphere();
            sphere.centre = centres[place as usize];
            let at = Posed::centre_of(posed, tool, t);
            let d = d.at(levers[t as usize].own);
            if let Some(contact) = posed.contact(tool, (object, o, &sphere), (t, &at), d) {
                out.push(contact)?;
            }
        }
        Ok(())
    }
}
