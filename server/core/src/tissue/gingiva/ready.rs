//! Gingiva prepared for ticks.
//!
//! State: the memory of each tool ([`super::pocket`]), then the displacement of each yielding sphere. Configuration:
//! the displacements alone, metres, x y z sphere by sphere.

use std::f64::consts::TAU;

use super::kernel::{Falloff, Root, Stretch};
use super::pocket::{self, Tip};
use super::{Gingiva, MEMORY};
use crate::math::{Vec3, fclamp, fmax};
use crate::output::PocketReading;
use crate::tissue::{Gram, Hands, Site, SiteLoad, Tissue, all_zero, largest_difference};
use crate::tree::{Sphere, SphereTree};

/// Marker in `Ready::slots` of a node that does not yield.
const NONE: u32 = u32::MAX;
/// Capacity for the rows of both tools on one tissue.
const MOST_ROWS: usize = 1024 * crate::MAX_TOOLS;
/// Weight of the squared distance across the wall in the search for the wall beside a tip. The weight is small because
/// of tips that slipped out between two papillae. Such a tip can be nearer to the wall at its side than to the wall
/// behind it.
const ACROSS: f64 = 0.1;
/// Number of sectors round the tooth. The wall of a tip lies in the tip's sector or in a neighbouring sector.
const SECTORS: usize = 8;
/// Threshold of all displacement components below which the free configuration is set to rest, metres.
const AT_REST: f64 = 1e-9;

/// Returns the sector of an angle (radians), counted from mesial over buccal, 0 to 7.
fn sector(around: f64) -> usize {
    let turns = around / TAU;
    ((turns - libm::floor(turns)) * SECTORS as f64) as usize % SECTORS
}

/// Gingiva prepared for ticks.
#[derive(Debug)]
pub struct Ready {
    model: Gingiva,
    /// Rest centre of each node, world axes, metres.
    rest: Vec<Vec3>,
    /// Bound radius of the tree's root node at rest, metres.
    bound: f64,
    /// Index of the yielding sphere that each node moves with, or `NONE`.
    slots: Vec<u32>,
    /// Wall spheres by sector: index of the yielding sphere, rest centre (metres), unit vector to the outer side. Wall
    /// spheres yield and lie above the floor, so they have a tooth's side and an outer side.
    walls: [Vec<(u32, Vec3, Vec3)>; SECTORS],
    /// Root of each yielding sphere's compliance over one tick, (m/N)^1/2.
    roots: Vec<Root>,
    falloff: Falloff,
    /// Fraction of a displacement that is left one tick after release.
    kept: f64,
    /// Scratch of [`Tissue::add_gram`]: for each row the root times the normal, and the yielding sphere.
    turned: Vec<(Vec3, u32)>,
    /// Scratch of [`Tissue::apply`]: for each yielding sphere the falloff-weighted sum of roots times loads, by axis.
    sums: [Vec<f64>; 3],
}

impl Ready {
    /// Prepares `model` for the tree `rest` and ticks of `tick_s` seconds. The model must have passed
    /// [`Gingiva::validate`].
    pub fn new(model: &Gingiva, rest: &SphereTree, tick_s: f64) -> Self {
        let nodes: Vec<u32> = rest.shape_at(model.level).map(|(id, _)| id).collect();
        let mut slots = vec![NONE; rest.nodes().len()];
        for (slot, &node) in nodes.iter().enumerate() {
            slots[node as usize] = slot as u32;
        }
        // Parents precede their children, so one pass is enough.
        for (k, node) in rest.nodes().iter().enumerate() {
            let slot = slots[k];
            if slot != NONE && node.children > 0 {
                let first = node.first_child as usize;
                slots[first..first + usize::from(node.children)].fill(slot);
            }
        }
        let params = &model.params;
        let kept = params.relaxation / (params.relaxation + tick_s);
        let firmness = params.firmness();
        let (wall, shear, floor) = (
            1.0 / (firmness * params.wall_stiffness),
            1.0 / (firmness * params.shear_stiffness),
            params.floor_compliance(),
        );
        let roots = nodes.iter().map(|&node| {
            let place = &model.places[node as usize];
            let (axis, away) = (model.tooth.axis, place.away);
            // 0 at the floor and below, 1 above the taper.
            let t = fclamp(place.height / fmax(params.floor_taper, 1e-9), 0.0, 1.0);
            let share = t * t * (3.0 - 2.0 * t);
            let along = shear * share + floor * (1.0 - share);
            let root = |compliance: f64| ((1.0 - kept) * compliance).sqrt();
            Root::along([
                (root(wall), away),
                (root(shear), axis.cross(&away)),
                (root(along), axis),
            ])
        });
        let roots: Vec<Root> = roots.collect();
        let stretches = nodes.iter().map(|&node| {
            let place = &model.places[node as usize];
            Stretch::new(place.on_surface, &model.tooth.axis, place.spread)
        });
        let wall = |node: u32| {
            let place = &model.places[node as usize];
            place.height > 0.0 && !place.floor
        };
        let mut walls: [Vec<(u32, Vec3, Vec3)>; SECTORS] = Default::default();
        for (slot, &node) in (0..).zip(&nodes).filter(|(_, node)| wall(**node)) {
            let (centre, away) = (
                rest.nodes()[node as usize].centre,
                model.places[node as usize].away,
            );
            let (around, _) = model.tooth.cylindrical(&centre);
            walls[sector(around)].push((slot, centre, away));
        }
        Self {
            rest: rest.nodes().iter().map(|node| node.centre).collect(),
            bound: rest.nodes()[0].bound_radius,
            walls,
            falloff: Falloff::new(stretches.collect(), params.reach),
            sums: std::array::from_fn(|_| vec![0.0; nodes.len()]),
            turned: Vec::with_capacity(MOST_ROWS),
            model: model.clone(),
            slots,
            roots,
            kept,
        }
    }

    /// Returns the tip of the tool in `slot`, if the tip is in the pocket. The number is the squared distance of the
    /// tip from the centre of the nearest wall sphere, m^2.
    ///
    /// A tip in the pocket is below the margin. The tip lies on the tooth's side of the nearest wall sphere and of the
    /// wall sphere beside it, at their displaced positions. `shape` holds the displacements, metres.
    fn tip_in_pocket(&self, slot: usize, hands: &Hands<'_>, shape: &[f64]) -> Option<(f64, Tip)> {
        let root = (&self.rest[0], self.bound);
        let tip = pocket::tip_below_margin(&self.model, slot, hands, root)?;
        // Smallest measure so far, and the tip's distance outside that wall sphere, negative inside.
        let (mut nearest, mut beside) = ((f64::INFINITY, 0.0), (f64::INFINITY, 0.0));
        let here = sector(tip.around) + SECTORS;
        let beside_it = (here - 1..=here + 1).flat_map(|sector| &self.walls[sector % SECTORS]);
        for (wall, rest, away) in beside_it {
            let at = 3 * *wall as usize;
            let moved = Vec3::new(shape[at], shape[at + 1], shape[at + 2]);
            let from = tip.point - (rest + moved);
            let (outside, squared) = (from.dot(away), from.dot(&from));
            if squared < nearest.0 {
                nearest = (squared, outside);
            }
            let along = squared - (1.0 - ACROSS) * outside * outside;
            if along < beside.0 {
                beside = (along, outside);
            }
        }
        (nearest.1 < 0.0 && beside.1 < 0.0).then_some((nearest.0, tip))
    }
}

impl Tissue for Ready {
    fn shape_len(&self) -> usize {
        3 * self.falloff.len()
    }

    fn free_step(
        &mut self,
        state: &[f64],
        _: &Hands<'_>,
        shape: &mut [f64],
        free: &mut [f64],
    ) -> bool {
        shape.copy_from_slice(&state[MEMORY..]);
        let asleep = all_zero(state);
        let mut most = 0.0;
        for (free, now) in free.iter_mut().zip(&*shape) {
            *free = self.kept * now;
            most = fmax(most, free.abs());
        }
        // Exponential decay alone would never reach the rest.
        if most < AT_REST {
            free.fill(0.0);
        }
        asleep
    }

    fn centres(&self, shape: &[f64], ids: &[u32], out: &mut [Vec3]) {
        for (id, centre) in ids.iter().zip(out) {
            *centre = self.rest[*id as usize];
            let slot = self.slots[*id as usize];
            if slot != NONE {
                let at = 3 * slot as usize;
                *centre += Vec3::new(shape[at], shape[at + 1], shape[at + 2]);
            }
        }
    }

    fn add_gram(&mut self, sites: &[Site], gram: &mut Gram<'_>) {
        self.turned.clear();
        let (slots, roots) = (&self.slots, &self.roots);
        self.turned.extend(sites.iter().map(|site| {
            let slot = slots[site.sphere as usize];
            match roots.get(slot as usize) {
                Some(root) => (root.times(&site.normal), slot),
                None => (Vec3::zeros(), 0),
            }
        }));
        for (i, (a, from)) in self.turned.iter().enumerate() {
            let falloff = self.falloff.from(*from as usize);
            gram.add(i, i, falloff(*from as usize) * a.dot(a));
            for (j, (b, to)) in self.turned[..i].iter().enumerate() {
                let compliance = falloff(*to as usize) * a.dot(b);
                gram.add(i, j, compliance);
                gram.add(j, i, compliance);
            }
        }
    }

    fn apply(&mut self, sites: &[Site], lambda: &[f64], free: &[f64], shape: &mut [f64]) {
        shape.copy_from_slice(free);
        let Self {
            slots,
            roots,
            falloff,
            sums,
            ..
        } = self;
        let mut any = false;
        let mut next = 0;
        while let Some(site) = sites.get(next) {
            // Rows of one sphere are adjacent and share one row of the matrix.
            let (slot, mut load) = (slots[site.sphere as usize], Vec3::zeros());
            while let Some(same) = sites.get(next).filter(|same| same.sphere == site.sphere) {
                load -= same.normal * lambda[next];
                next += 1;
            }
            if slot == NONE || load == Vec3::zeros() {
                continue;
            }
            if !any {
                sums.iter_mut().for_each(|sum| sum.fill(0.0));
                any = true;
            }
            let load = roots[slot as usize].times(&load);
            let row = falloff.row(slot as usize);
            let [x, y, z] = &mut *sums;
            for (((x, y), z), share) in x.iter_mut().zip(y).zip(z).zip(row) {
                *x += share * load.x;
                *y += share * load.y;
                *z += share * load.z;
            }
        }
        if !any {
            return;
        }
        let [x, y, z] = sums;
        for (k, (root, moved)) in roots.iter().zip(shape.chunks_exact_mut(3)).enumerate() {
            let by = root.times(&Vec3::new(x[k], y[k], z[k]));
            for axis in 0..3 {
                moved[axis] += by[axis];
            }
        }
    }

    fn motion(&self, from: &[f64], to: &[f64]) -> f64 {
        largest_difference(from, to)
    }

    fn commit(
        &mut self,
        shape: &[f64],
        loads: Option<&[SiteLoad]>,
        hands: &Hands<'_>,
        state: &mut [f64],
    ) {
        let (memory, moved) = state.split_at_mut(MEMORY);
        moved.copy_from_slice(shape);
        let Some(loads) = loads else { return };
        let pressed = std::array::from_fn(|slot| {
            let floor = |load: &&SiteLoad| {
                usize::from(load.tool) == slot && self.model.places[load.sphere as usize].floor
            };
            let mut ours = loads.iter().filter(floor).peekable();
            // Floor spheres far down can also be loaded from outside the gingiva. Such a load is not in the pocket.
            if ours.peek().is_none() || self.tip_in_pocket(slot, hands, shape).is_none() {
                return 0.0;
            }
            ours.fold(0.0, |sum, load| {
                sum - load.force.dot(&self.model.tooth.axis)
            })
        });
        pocket::remember(&self.model.params, &pressed, memory);
    }

    fn pocket(&self) -> Option<Sphere> {
        Some(Sphere {
            centre: self.rest[0],
            radius: self.bound,
        })
    }

    fn reading(
        &self,
        slot: usize,
        hands: &Hands<'_>,
        state: &[f64],
    ) -> Option<(f64, PocketReading)> {
        let (memory, shape) = state.split_at(MEMORY);
        let (from_wall, tip) = self.tip_in_pocket(slot, hands, shape)?;
        Some((from_wall, pocket::reading(&tip, slot, memory)))
    }
}
