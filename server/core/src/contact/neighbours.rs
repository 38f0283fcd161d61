//! Neighbour list of one tool on one rigid object: pairs (family of siblings, tool sphere).
//!
//! The list holds all pairs that can come closer than `d` before the tool has moved by more than a skin. Such a list is
//! Verlet's (Phys. Rev. 159, 98, 1967, doi:10.1103/PhysRev.159.98) with two changes:
//! - The list ends one level above the spheres: short, quick to build, and tested eight spheres at a time.
//! - The skin is a translation and a turn: a sphere with the lever `l` from the working point may move by `translation
//!   + turn * l`. Spheres near the tip therefore do not depend on the motion of the far end of the shaft.

use super::front::Search;
use super::packs::{Felt, Packs};
use super::posed::{Lever, Posed, PosedTool};
use super::{ContactList, ContactsFull, Distance, spread};
use crate::math::{Mat3, Vec3, fclamp, fmax, norm};
use crate::tree::Node;

/// Largest number of pairs in a list.
pub(super) const CAPACITY: usize = 4096;
/// Translation of the working point for which a list is valid, metres, times its [`spread`]. A larger value means fewer
/// and longer lists.
///
/// Measured with a probe round a molar, with this value and the turn doubled. At level 5 the mean tick takes a tenth
/// longer and the median a fifth longer; at level 3 the mean takes a fifth less.
const TRANSLATION: f64 = 5e-5;
/// Turn of the tool for which a list is valid, times its [`spread`]: largest Frobenius norm of the difference of two
/// rotation matrices. The norm is about 1.4 times the angle in radians.
const TURN: f64 = 8.5e-3;
/// Share of the tool's motion during the last list for which the next list is valid. The share applies only where it
/// exceeds [`TRANSLATION`] or [`TURN`], as with a fast tool. Without the enlargement a fast hand needs a new list in
/// every pass.
const FAST: f64 = 0.7;
/// Limit of the enlargement for a fast tool, in units of [`TRANSLATION`] and [`TURN`].
const FASTEST: f64 = 4.0;
/// Largest number of tool spheres tested against one family before the family's contacts are written. With more spheres
/// the contacts need sorting.
const RUN: usize = 192;
/// Length added to every search distance, metres. Far above rounding at the 10 m that a scene may span, far below any
/// other length.
pub(super) const ROUNDING: f64 = 1e-9;

/// Neighbour list of one tool on one rigid object, and the range of its validity.
#[derive(Debug)]
pub(super) struct Neighbours {
    /// Pairs: index of the family in `Packs::families`, then index of the tool sphere in `spheres`. Sorted by family,
    /// then by node of the tool.
    pairs: Vec<(u32, u32)>,
    /// Nodes of the tool in the list, in the order of their first pairs.
    spheres: Vec<u32>,
    /// World positions and search balls of `spheres` in the current query, in the same order.
    placed: Vec<Placed>,
    /// Rotation matrix of the tool when the list was built, `world_from_tool`.
    rotation: Mat3,
    /// Working point when the list was built, world axes, metres.
    working_point: Vec3,
    /// Levels of the tool's and of the object's tree in contact; `None` before the first list.
    levels: Option<(u8, u8)>,
    /// Largest sum of the working point's translation since the list was built and `Distance::base` of a query, metres.
    reach: f64,
    /// Largest sum of the tool's turn since the list was built (Frobenius norm, see [`TURN`]) and `Distance::turn` of a
    /// query, radians.
    turn: f64,
    /// Factor on the translation and turn of a list; see [`spread`].
    spread: f64,
    /// Capacity of `pairs`.
    most: usize,
    /// Whether all pairs fitted into the list.
    usable: bool,
}

/// Sphere of the tool in the current query.
#[derive(Clone, Copy, Debug)]
struct Placed {
    /// Centre, world axes, metres.
    at: Vec3,
    /// Search ball: the contact sphere grown by `d`.
    felt: Felt,
    /// Prediction distance of the sphere, metres.
    d: f64,
}

impl Neighbours {
    /// Allocates the list for a tool with `spheres` nodes on object `k` with `families` families.
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

    /// Whether the list is complete. Only a traversal answers queries of an incomplete list.
    pub fn usable(&self) -> bool {
        self.usable
    }

    /// Returns the number of spheres tested by a query.
    pub fn tests(&self) -> u64 {
        8 * self.pairs.len() as u64
    }

    /// Whether no pair outside the list can be closer than `d` at the pose of `posed`. False if `levels`, of tool and
    /// object, are not those of the list.
    pub fn covers(&self, posed: &Posed, levels: (u8, u8), d: Distance) -> bool {
        // Bound on the motion of any point x: |(R - R0) x| <= |R - R0|_F |x|, for any matrices.
        let turned = posed.rotation - self.rotation;
        let spare = self.turn - d.turn;
        let moved = norm(&(posed.working_point - self.working_point));
        self.levels == Some(levels)
            && moved + d.base <= self.reach
            && turned.norm_squared() <= spare * spare
            && spare >= 0.0
    }

    /// Builds the list for the pose of `posed` and the distance `d`, on the families `packs` in contact at `level`.
    /// `levers` are by tool node; `search` and `places` are scratch. Returns the number of tested pairs of nodes.
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
            // The range enlarged for a fast tool did not fit; retry with the normal range.
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

    /// Appends the contacts with a gap under `d` to `out`, sorted if no family has more than [`RUN`] tool spheres in
    /// the list. `object` is the index in the scene; `nodes` and `packs` are the object's. The list must cover `d` at
    /// this pose.
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
            // Object spheres outermost, so that the contacts come sorted.
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

/// Returns the search distance beyond the radius of a tool sphere, metres, as a function of its lever, metres. `reach`
/// (metres) and `turn` (radians) are the limits of the list.
#[inline]
pub(super) fn slack(reach: f64, turn: f64) -> impl Fn(f64) -> f64 {
    move |lever| fmax(0.0, reach) + turn * lever + ROUNDING
}
