//! Skeleton in a tick: one level or two, and the transition between the levels.

use crate::math::{Vec3, fclamp};
use crate::tissue::{Gram, Hands, Site, SiteLoad, Tissue};
use crate::tree::SphereTree;

use super::data::Skeleton;
use super::entry::{Axes, Block, Entry};
use super::lattice::{Lattice, farthest, longest};

/// Largest rate of change of the fine level's share, 1/s: a whole transition takes 0.2 s.
const SHIFT: f64 = 5.0;
/// Threshold of every displacement component below which an unloaded skeleton is set to rest, metres: a hundredth of a
/// micrometre.
const REST_M: f64 = 1e-8;
/// Threshold of every velocity component below which an unloaded skeleton is set to rest, m/s.
const REST_M_PER_S: f64 = 1e-6;

/// [`Skeleton`] prepared for ticks.
///
/// The state lists displacements `u` (m) and velocities `v` (m/s) of the coarse level's free nodes (three numbers a
/// node), then of the fine level's. With two levels the last number is the share of the fine level. An inactive level
/// is all zeros. A configuration is `u` of each level, four numbers a node, and with two levels the share. The
/// configuration alone determines the position of every sphere.
///
/// While the share `s` is between 0 and 1, both levels bear the whole load. The displacement of a sphere is the mixture
/// of both levels' displacements with weights `1 - s` and `s`. The compliance is the same mixture. For a constant share
/// the mixture is passive because its parts are.
#[derive(Debug)]
pub(in crate::tissue) struct Ready<E> {
    rest: Vec<Vec3>,
    coarse: Lattice<E>,
    fine: Option<Lattice<E>>,
    /// Share of the fine level in this tick, 0 to 1.
    share: f64,
    /// Length of a tick, seconds.
    tick_s: f64,
    /// Displacements of both levels at the start of this tick, metres.
    start: Vec<f64>,
    /// Velocities of both levels at the start of this tick, and at its end after the commit, m/s.
    velocity: Vec<f64>,
}

/// Returns a part of a configuration node by node.
fn nodes(shape: &[f64]) -> &[Axes] {
    shape.as_chunks().0
}

fn nodes_mut(shape: &mut [f64]) -> &mut [Axes] {
    shape.as_chunks_mut().0
}

/// Copies three numbers a node to four, the last of them zero.
fn widen(from: &[f64], to: &mut [f64]) {
    for (from, to) in from.chunks_exact(3).zip(nodes_mut(to)) {
        *to = [from[0], from[1], from[2], 0.0];
    }
}

fn narrow(from: &[f64], to: &mut [f64]) {
    for (from, to) in nodes(from).iter().zip(to.chunks_exact_mut(3)) {
        to.copy_from_slice(&from[..3]);
    }
}

/// Prepares `model` for the tree `rest` and ticks of `tick_s` seconds. The model must have passed its validation
/// against the tree.
pub(in crate::tissue) fn ready(
    model: &Skeleton,
    rest: &SphereTree,
    tick_s: f64,
) -> Box<dyn Tissue> {
    if model.couples() {
        Box::new(Ready::<Block>::new(model, rest, tick_s))
    } else {
        Box::new(Ready::<Axes>::new(model, rest, tick_s))
    }
}

impl<E: Entry> Ready<E> {
    /// Prepares `model`, which must have passed its validation against `rest`.
    pub fn new(model: &Skeleton, rest: &SphereTree, tick_s: f64) -> Self {
        let coarse = Lattice::new(&model.coarse, rest, tick_s);
        let fine = model
            .fine
            .as_ref()
            .map(|fine| Lattice::new(fine, rest, tick_s));
        let len = coarse.shape_len() + fine.as_ref().map_or(0, Lattice::<E>::shape_len);
        Self {
            rest: rest.nodes().iter().map(|node| node.centre).collect(),
            coarse,
            fine,
            share: 0.0,
            tick_s,
            start: vec![0.0; len],
            velocity: vec![0.0; len],
        }
    }

    /// Returns the start of the fine level's numbers in a configuration and in the state.
    fn cuts(&self) -> (usize, usize) {
        (self.coarse.shape_len(), 6 * self.coarse.free())
    }

    fn write_share(&self, shape: &mut [f64]) {
        if self.fine.is_some()
            && let Some(share) = shape.last_mut()
        {
            *share = self.share;
        }
    }

    /// Returns the share of the fine level in a configuration, and that level while the share is positive.
    fn share_in(&self, shape: &[f64]) -> (f64, Option<&Lattice<E>>) {
        match (&self.fine, shape.last()) {
            (Some(fine), Some(&share)) => (share, Some(fine).filter(|_| share > 0.0)),
            _ => (0.0, None),
        }
    }
}

/// Reads displacements and velocities of one level from its part of the state.
fn read(state: &[f64], u: &mut [f64], v: &mut [f64]) {
    let (us, vs) = state.split_at(state.len() / 2);
    widen(us, u);
    widen(vs, v);
}

/// Transfers displacements `u` (m) and velocities `v` (m/s) of the active level `from` to the nodes of the level `to`,
/// which becomes active.
fn map<E: Entry>(
    from: &Lattice<E>,
    u: &[f64],
    v: &[f64],
    to: &Lattice<E>,
    to_u: &mut [f64],
    to_v: &mut [f64],
) {
    let all = to
        .tree_nodes()
        .iter()
        .zip(nodes_mut(to_u))
        .zip(nodes_mut(to_v));
    for ((&node, to_u), to_v) in all {
        *to_u = from.displacement(nodes(u), node);
        *to_v = from.displacement(nodes(v), node);
    }
}

impl<E: Entry> Tissue for Ready<E> {
    fn shape_len(&self) -> usize {
        self.start.len() + usize::from(self.fine.is_some())
    }

    fn free_step(
        &mut self,
        state: &[f64],
        hands: &Hands<'_>,
        shape: &mut [f64],
        free: &mut [f64],
    ) -> bool {
        let (cut, state_cut) = self.cuts();
        let (wanted, last) = match (&self.fine, state.last()) {
            (Some(_), Some(share)) => (f64::from(hands.detail.min(1)), fclamp(*share, 0.0, 1.0)),
            _ => (0.0, 0.0),
        };
        let (of_coarse, of_fine) = state.split_at(state_cut);
        let of_fine = &of_fine[..of_fine.len() / 6 * 6];
        let (u, fine_u) = self.start.split_at_mut(cut);
        let (v, fine_v) = self.velocity.split_at_mut(cut);
        // The numbers of an inactive level are ignored.
        let zero = |numbers: &[f64]| numbers.iter().all(|x| *x == 0.0);
        let resting = (last == 1.0 || zero(of_coarse)) && (last == 0.0 || zero(of_fine));
        let towards = fclamp(wanted - last, -SHIFT * self.tick_s, SHIFT * self.tick_s);
        self.share = if resting || towards == wanted - last {
            wanted
        } else {
            last + towards
        };
        if resting {
            // At any share, no sphere is displaced.
            self.start.fill(0.0);
            shape.fill(0.0);
            free.fill(0.0);
            self.write_share(shape);
            self.write_share(free);
            return self.share == last;
        }
        if last < 1.0 {
            read(of_coarse, u, v);
        }
        if let Some(fine) = &self.fine {
            if last > 0.0 {
                read(of_fine, fine_u, fine_v);
                if last == 1.0 && self.share < 1.0 {
                    map(fine, fine_u, fine_v, &self.coarse, u, v);
                }
            } else if self.share > 0.0 {
                map(&self.coarse, u, v, fine, fine_u, fine_v);
            }
        }
        let (free_coarse, free_fine) = free.split_at_mut(cut);
        if self.share < 1.0 {
            self.coarse
                .free_step(nodes(u), nodes(v), nodes_mut(free_coarse));
        } else {
            u.fill(0.0);
            free_coarse.fill(0.0);
        }
        match &mut self.fine {
            Some(fine) if self.share > 0.0 => {
                fine.free_step(nodes(fine_u), nodes(fine_v), nodes_mut(free_fine));
            }
            _ => {
                fine_u.fill(0.0);
                free_fine.fill(0.0);
            }
        }
        shape[..self.start.len()].copy_from_slice(&self.start);
        self.write_share(shape);
        self.write_share(free);
        false
    }

    fn centres(&self, shape: &[f64], ids: &[u32], out: &mut [Vec3]) {
        let (u, fine_u) = shape.split_at(self.cuts().0);
        let (u, fine_u) = (nodes(u), nodes(fine_u));
        match self.share_in(shape) {
            (_, None) => self.coarse.centres(u, &self.rest, ids, out),
            (1.0, Some(fine)) => fine.centres(fine_u, &self.rest, ids, out),
            (s, Some(fine)) => {
                for (id, centre) in ids.iter().zip(out) {
                    let (a, b) = (
                        self.coarse.displacement(u, *id),
                        fine.displacement(fine_u, *id),
                    );
                    let moved: [f64; 3] = std::array::from_fn(|k| (1.0 - s) * a[k] + s * b[k]);
                    *centre = self.rest[*id as usize] + Vec3::from(moved);
                }
            }
        }
    }

    fn add_gram(&mut self, sites: &[Site], gram: &mut Gram<'_>) {
        if self.share < 1.0 {
            self.coarse.add_gram(sites, 1.0 - self.share, gram);
        }
        if let Some(fine) = self.fine.as_mut().filter(|_| self.share > 0.0) {
            fine.add_gram(sites, self.share, gram);
        }
    }

    fn apply(&mut self, sites: &[Site], lambda: &[f64], free: &[f64], shape: &mut [f64]) {
        shape.copy_from_slice(free);
        let (u, fine_u) = shape.split_at_mut(self.cuts().0);
        if self.share < 1.0 {
            self.coarse.load(sites, lambda, nodes_mut(u));
        }
        if let Some(fine) = self.fine.as_mut().filter(|_| self.share > 0.0) {
            fine.load(sites, lambda, nodes_mut(fine_u));
        }
    }

    fn motion(&self, from: &[f64], to: &[f64]) -> f64 {
        let cut = self.cuts().0;
        // A sphere moves by a mean of its carriers' motions, so the farthest of its carriers is a bound.
        let way = |from: &[f64], to: &[f64]| farthest(nodes(from), nodes(to));
        let ((s, _), (t, _)) = (self.share_in(from), self.share_in(to));
        let mut most = 0.0;
        if t < 1.0 {
            most += (1.0 - t) * way(&from[..cut], &to[..cut]);
        }
        if t > 0.0 {
            most += t * way(&from[cut..], &to[cut..]);
        }
        if s != t {
            // Motion by the change of the share alone.
            let far = |u: &[f64]| longest(nodes(u));
            most += (t - s).abs() * (far(&from[..cut]) + far(&from[cut..]));
        }
        most
    }

    fn commit(
        &mut self,
        shape: &[f64],
        loads: Option<&[SiteLoad]>,
        _: &Hands<'_>,
        state: &mut [f64],
    ) {
        let (cut, state_cut) = self.cuts();
        for ((v, now), before) in self.velocity.iter_mut().zip(shape).zip(&self.start) {
            *v = (now - before) / self.tick_s;
        }
        // An inactive level is zero in a configuration, and so at rest.
        let under = |numbers: &[f64], bound: f64| numbers.iter().all(|x| x.abs() < bound);
        if loads.is_some_and(<[SiteLoad]>::is_empty)
            && under(&shape[..self.start.len()], REST_M)
            && under(&self.velocity, REST_M_PER_S)
        {
            state.fill(0.0);
        } else {
            let (of_coarse, of_fine) = state.split_at_mut(state_cut);
            let (u, v) = of_coarse.split_at_mut(state_cut / 2);
            narrow(&shape[..cut], u);
            narrow(&self.velocity[..cut], v);
            let len = of_fine.len() / 6 * 6;
            let (u, v) = of_fine[..len].split_at_mut(len / 2);
            narrow(&shape[cut..], u);
            narrow(&self.velocity[cut..], v);
        }
        if self.fine.is_some()
            && let Some(share) = state.last_mut()
        {
            *share = self.share;
        }
    }
}
