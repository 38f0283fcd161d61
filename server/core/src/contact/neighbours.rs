//! The neighbours of one tool on one rigid object: pairs (family of siblings, tool sphere) that can come
//! closer than `d` before the tool has moved by more than a skin.
//!
//! Verlet's list (Phys. Rev. 159, 98, 1967, doi:10.1103/PhysRev.159.98) with two changes. It ends one level
//! above the spheres, so that it is short, quick to make, and tested eight spheres at a time. And its skin is
//! not one distance but a translation and a turn: a sphere with the lever `l` from the working point may move
//! `translation + turn l`, so spheres near the tip need not wait for what the far end of the shaft does.

use super::front::Search;
use super::packs::{Felt, Packs};
use super::posed::{Lever, Posed, PosedTool};
use super::{ContactList, ContactsFull, Distance, spread};
use crate::math::{Mat3, Vec3, fclamp, fmax, norm};
use crate::tree::Node;

/// Most pairs in a list.
pub(super) const CAPACITY: usize = 4096;
/// Translation that a list allows for, metres, times its [`spread`]. Larger: fewer, longer lists. Measured with a probe round a
/// molar: with twice as much of this and of the turn the mean tick at level 5 takes a tenth longer, at level 3 a fifth
/// less, and the median at level 5 a fifth longer.
const TRANSLATION: f64 = 5e-5;
/// Turn that a list allows for: largest Frobenius norm of a difference of rotation matrices.
const TURN: f64 = 8.5e-3;
/// A tool that has gone farther than a list allows for when that is asked for again is fast: the next one allows for this share of
/// how far it went, at most so many times what it does else. Otherwise a fast hand takes a list in every pass.
const FAST: f64 = 0.7;
const FASTEST: f64 = 4.0;
/// Most tool spheres that one family is tested against before its contacts are written; where more
/// are near, the contacts need sorting.
const RUN: usize = 192;
/// Added to every reach: far above rounding at the 10 m that a scene may span, far below anything else.
pub(super) const ROUNDING: f64 = 1e-9;

/// A list and what it holds for.
#[derive(Debug)]
pub(super) struct Neighbours {
    /// Family and place in `spheres`, in the order of both.
    pairs: Vec<(u32, u32)>,
    /// Nodes of the tool in the list.
    spheres: Vec<u32>,
    /// Where they are, and how far from there an object's surface counts: as of the present query.
    placed: Vec<Placed>,
    rotation: Mat3,
    working_point: Vec3,
    /// Level of the tool and of the object; none before the first list.
    levels: Option<(u8, u8)>,
    /// Translation plus prediction distance that it holds for, metres.
    reach: f64,
    /// Turn that it holds for, what the distance itself has of it included.
    turn: f64,
    /// Factor of what a list allows for.
    spread: f64,
    /// Most pairs that it has room for.
    most: usize,
    /// Whether all pairs found room.
    usable: bool,
}

/// A sphere of the tool in world axes.
#[derive(Clone, Copy, Debug)]
struct Placed {
    at: Vec3,
    felt: Felt,
    d: f64,
}

impl Neighbours {
    /// Room for the neighbours of a tool of so many `spheres` on object `k`, which has so many `families`.
    pub fn new(spheres: usize, (k, families): (usize, usize)) -> Self {
        let pairs = CAPACITY.min(spheres.saturating_mul(families));
        Self {
            pairs: Vec::with_capacity(pairs),
            spheres: Vec::with_capacity(spheres.min(pairs)),
            placed: Vec::with_capacity(spheres.min(pairs)),
            spread: spread(k),
            most: pairs,
            rotation: Mat3::identity(),
            working_point: Vec3::zeros(),
            levels: None,
            reach: 0.0,
            turn: 0.0,
            usable: false,
        }
    }

    /// Whether the list is whole; where it is not, only a traversal can tell.
    pub fn usable(&self) -> bool {
        self.usable
    }

    /// Spheres tested by a query.
    pub fn tests(&self) -> u64 {
        8 * self.pairs.len() as u64
    }

    /// Whether no pair outside the list can be closer than `d` at this pose.
    pub fn covers(&self, posed: &Posed, levels: (u8, u8), d: Distance) -> bool {
        // |(R - R0) x| <= |R - R0|_F |x|, for any matrices.
        let turned = posed.rotation - self.rotation;
        let spare = self.turn - d.turn;
        let moved = norm(&(posed.working_point - self.working_point));
        self.levels == Some(levels)
            && moved + d.base <= self.reach
            && turned.norm_squared() <= spare * spare
            && spare >= 0.0
    }

    /// Makes the list for this pose; returns how many pairs of nodes that tested.
    pub fn list(
        &mut self,
        tool: &PosedTool<'_>,
        posed: &mut Posed,
        (packs, level): (&Packs, u8),
        levers: &[Lever],
        d: Distance,
        (search, places): (&mut Search, &mut [u32]),
    ) -> u64 {
        let (translation, turns) = (self.spread * TRANSLATION, self.spread * TURN);
        let (mut further, mut turn) = (translation, turns);
        if self.levels.is_some() {
            let moved = norm(&(posed.working_point - self.working_point));
            let turned = (posed.rotation - self.rotation).norm_squared().sqrt();
            further = fclamp(FAST * moved, translation, FASTEST * translation);
            turn = fclamp(FAST * turned, turns, FASTEST * turns);
        }
        (self.rotation, self.working_point) = (posed.rotation, posed.working_point);
        self.levels = Some((tool.level, level));
        let mut tested = 0;
        loop {
            (self.reach, self.turn) = (d.base + further, d.turn + turn);
            let slack = slack(self.reach, self.turn);
            let found = search.run(tool, posed, (packs, level), levers, slack, self.most);
            self.usable = found.0;
            tested += found.1;
            // What is too much for a fast tool may have room as it is else.
            if self.usable || (further == translation && turn == turns) {
                break;
            }
            (further, turn) = (translation, turns);
        }
        self.pairs.clear();
        self.spheres.clear();
        for key in search.keys() {
            places[*key as u32 as usize] = u32::MAX;
        }
        for key in search.keys() {
            let t = *key as u32;
            let place = &mut places[t as usize];
            if *place == u32::MAX {
                *place = self.spheres.len() as u32;
                self.spheres.push(t);
            }
            self.pairs.push(((key >> 32) as u32, *place));
        }
        tested
    }

    /// Appends the contacts under `d`, in order.
    pub fn query(
        &mut self,
        tool: &PosedTool<'_>,
        posed: &mut Posed,
        (object, nodes, packs): (u16, &[Node], &Packs),
        (d, levers): (Distance, &[Lever]),
        out: &mut ContactList,
    ) -> Result<(), ContactsFull> {
        self.placed.clear();
        for &t in &self.spheres {
            let d = d.at(levers[t as usize].own);
            let at = posed.centre_of(tool, t);
            let reach = tool.nodes[t as usize].contact_radius + d;
            self.placed.push(Placed {
                at,
                felt: Felt::new(&(at - packs.origin), reach),
                d,
            });
        }
        let level = self.levels.map_or(0, |levels| levels.1);
        let mut rest = self.pairs.as_slice();
        while let Some(&(p, _)) = rest.first() {
            let family = &packs.families[p as usize];
            let shapes = family.shapes_at(level);
            let balls = &packs.shapes[p as usize];
            let run = rest.iter().take(RUN).take_while(|pair| pair.0 == p);
            let (now, later) = rest.split_at(run.count());
            rest = later;
            let (mut masks, mut any) = ([0; RUN], 0);
            for (mask, &(_, place)) in masks.iter_mut().zip(now) {
                let placed = &self.placed[place as usize];
                *mask = shapes & balls.within(placed.felt);
                any |= *mask;
            }
            // Sphere by sphere of the object, so that the contacts come sorted.
            while any != 0 {
                let lane = any.trailing_zeros();
                any &= any - 1;
                let o = family.first + lane;
                let sphere = nodes[o as usize].sphere();
                for (mask, &(_, place)) in masks.iter().zip(now) {
                    if mask & 1 << lane == 0 {
                        continue;
                    }
                    let t = self.spheres[place as usize];
                    let Placed { at, d, .. } = &self.placed[place as usize];
                    if let Some(contact) = posed.contact(tool, (object, o, &sphere), (t, at), *d) {
                        out.push(contact)?;
                    }
                }
            }
        }
        Ok(())
    }
}

/// How much farther than its radius a tool's sphere must be felt for.
#[inline]
pub(super) fn slack(reach: f64, turn: f64) -> impl Fn(f64) -> f64 {
    move |lever| fmax(0.0, reach) + turn * lever + ROUNDING
}
