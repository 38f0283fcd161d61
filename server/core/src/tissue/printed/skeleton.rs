//! The tongue as printed: sections 3.1, 4 and 6.

use serde::{Deserialize, Serialize};

use super::followers::Followers;
use super::load::for_each_press;
use super::ranged;
use super::stability::Spectrum;
use crate::math::{Vec3, fmax};
use crate::scene::Object;
use crate::tissue::skeleton::{CARRIERS, SkeletonLevel, Skin};
use crate::tissue::{Gram, Hands, Site, SiteLoad, Tissue, TissueError, largest_difference};
use crate::tree::SphereTree;

/// Spheres of one level joined by springs, moved by explicit Euler under penalty loads. **As printed**, for
/// comparison: a scene beyond the stable limit of explicit Euler is refused.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PrintedSkeleton {
    /// Level of the tree whose spheres are the skeleton. The paper's: 2.
    pub level: u8,
    /// Springs: pairs of tree nodes of that level (or childless ones above it).
    pub springs: Vec<[u32; 2]>,
    /// Tree nodes of that level that are held: the paper's root and bottom layer.
    pub fixed: Vec<u32>,
    /// For each node of the tree the skeleton's sphere (a tree node) that it follows and loads if it lies below the
    /// skeleton; empty: its ancestor. A tree of inscribed spheres needs it: there a sphere of the upper surface may have an
    /// ancestor in the bottom layer, which is held.
    pub carriers: Vec<u32>,
    /// `k_s` of every spring, N/m. Default 50, range 0.1 to 1e5. Larger: stiffer, nearer to the limit of stability.
    /// Source: section 8.1 has 500 (0.5 N/mm), which needs 0.3 kg per sphere.
    pub spring_n_per_m: f64,
    /// `b_c` of every sphere against its own motion, N s/m. Default 12, range 0 to 1e4. Stable from the
    /// largest eigenvalue times the step up to about twice the mass over the step.
    pub damping_n_s_per_m: f64,
    /// `m` of every sphere, kg. Default 0.02 (Table 1), range 1e-4 to 100.
    pub mass_kg: f64,
    /// `K_p`, N/m for each pair of spheres. Default 5 (Table 1), range 0 to 1e5. Acts once per pair, so finer levels
    /// are loaded more: 7 to 27 times the device's force at level 3.
    pub penalty_n_per_m: f64,
    /// `d` of contact prediction, metres. Default 5e-4 (section 3.2), range 0 to 5e-3.
    pub contact_distance_m: f64,
}

impl PrintedSkeleton {
    /// A skeleton with the default numbers.
    pub fn new(level: u8, springs: Vec<[u32; 2]>, fixed: Vec<u32>) -> Self {
        Self {
            level,
            springs,
            fixed,
            carriers: Vec::new(),
            spring_n_per_m: 50.0,
            damping_n_s_per_m: 12.0,
            mass_kg: 0.02,
            penalty_n_per_m: 5.0,
            contact_distance_m: 5e-4,
        }
    }

    /// The spring graph of a coupled skeleton as printed: the same spheres, springs and held nodes, all springs as stiff as
    /// its are on average; each sphere follows the one that carries most of it there. Other numbers are the defaults.
    pub fn of(coupled: &SkeletonLevel, rest: &SphereTree) -> Self {
        let node = |k: u16| {
            coupled
                .nodes
                .get(usize::from(k))
                .copied()
                .unwrap_or(u32::MAX)
        };
        let springs = coupled
            .springs
            .iter()
            .map(|spring| [node(spring.a), node(spring.b)]);
        let held = coupled.nodes.iter().zip(&coupled.fixed);
        let level = |&id: &u32| rest.nodes().get(id as usize).map(|node| node.level);
        let carrier = |skin: &Skin| {
            let heavier = |best: usize, k: usize| {
                if skin.weights[k] > skin.weights[best] {
                    k
                } else {
                    best
                }
            };
            node(skin.nodes[(1..CARRIERS).fold(0, heavier)])
        };
        let sum = coupled
            .springs
            .iter()
            .flat_map(|spring| spring.stiffness)
            .fold(0.0, |sum, k| sum + k);
        Self {
            carriers: coupled.skin.iter().map(carrier).collect(),
            spring_n_per_m: sum / fmax(3.0 * coupled.springs.len() as f64, 1.0),
            ..Self::new(
                coupled.nodes.iter().filter_map(level).max().unwrap_or(0),
                springs.collect(),
                held.filter(|(_, fixed)| **fixed)
                    .map(|(id, _)| *id)
                    .collect(),
            )
        }
    }

    /// Numbers of state: displacement and velocity of each sphere of the skeleton.
    pub(crate) fn state_len(&self, rest: &SphereTree) -> usize {
        6 * rest.shape_at(self.level).count()
    }

    /// Largest spring stiffness that is stable at the tick's step with this mass (N/m) and the damping that it wants
    /// (N s/m): the given one, unless no spring is stable with that.
    fn stiffest(&self, unit: &Spectrum, dt: f64) -> (f64, f64) {
        let (b, m, kp) = (self.damping_n_s_per_m, self.mass_kg, self.penalty_n_per_m);
        // b >= lambda_max dt, and b <= 2m/dt + lambda_min dt/2.
        let most = (b / dt - kp) / unit.most;
        if most > 0.0 && b <= 2.0 * m / dt + 0.5 * dt * most * unit.least {
            return (most, b);
        }
        // Where both bounds of the damping meet.
        let most = fmax(
            (2.0 * m / (dt * dt) - kp) / (unit.most - 0.5 * unit.least),
            0.0,
        );
        (most, (most * unit.most + kp) * dt)
    }

    /// Range of the stiffness of all modes, N/m, with the penalty of one pair at a sphere (the paper's
    /// `k_s + k_p`). More pairs at one sphere, as there are at level 3, can carry a scene beyond the limit that
    /// this says; the tick then puts it back to rest with [`crate::output::status::FAULT`].
    ///
    /// # Errors
    /// When springs or fixed nodes are none of the skeleton's.
    pub fn spectrum(&self, rest: &SphereTree) -> Result<Spectrum, TissueError> {
        let graph = self.graph(rest)?;
        Ok(graph
            .unit_spectrum()
            .scaled(self.spring_n_per_m, self.penalty_n_per_m))
    }

    pub(crate) fn validate(&self, rest: &SphereTree, tick_s: f64) -> Result<(), TissueError> {
        ranged("spring_n_per_m", self.spring_n_per_m, 0.1, 1e5, "N/m")?;
        ranged(
            "damping_n_s_per_m",
            self.damping_n_s_per_m,
            0.0,
            1e4,
            "N s/m",
        )?;
        ranged("mass_kg", self.mass_kg, 1e-4, 100.0, "kg")?;
        ranged("penalty_n_per_m", self.penalty_n_per_m, 0.0, 1e5, "N/m")?;
        ranged(
            "contact_distance_m",
            self.contact_distance_m,
            0.0,
            5e-3,
            "m",
        )?;
        let graph = self.graph(rest)?;
        graph.connected()?;
        self.stable(&graph.unit_spectrum(), tick_s)
    }

    /// The guard of section 4.4 for the whole skeleton at the tick's step.
    fn stable(&self, unit: &Spectrum, tick_s: f64) -> Result<(), TissueError> {
        let (b, m) = (self.damping_n_s_per_m, self.mass_kg);
        let spectrum = unit.scaled(self.spring_n_per_m, self.penalty_n_per_m);
        let step = spectrum.largest_time_step(b, m);
        if step >= tick_s {
            return Ok(());
        }
        let (stiffest, at) = self.stiffest(unit, tick_s);
        let damping = fmax(b, spectrum.smallest_damping(tick_s));
        Err(TissueError {
            field: "explicit Euler (as printed)",
            found: format!(
                "spring {} N/m, damping {b} N s/m, mass {m} kg, modes of {:.3e} to {:.3e} N/m",
                self.spring_n_per_m, spectrum.least, spectrum.most
            ),
            expected: format!(
                "a stable skeleton: spring at most {stiffest:.4e} N/m (with a damping of {at:.4e} N s/m), mass at least {:.4e} kg \
                 (with a damping of {damping:.4e} N s/m), or a time step of at most {step:.4e} s where the tick has {tick_s} s",
                spectrum.smallest_mass(b, tick_s),
            ),
        })
    }

    pub(super) fn graph(&self, rest: &SphereTree) -> Result<Graph, TissueError> {
        let followers = Followers::new(rest, self.level);
        let place = |field, id: u32| {
            followers
                .movers
                .binary_search(&id)
                .map(|at| at as u32)
                .map_err(|_| TissueError {
                    field,
                    found: format!("node {id}"),
                    expected: format!(
                        "one of the {} nodes of level {}",
                        followers.movers.len(),
                        self.level
                    ),
                })
        };
        if !self.carriers.is_empty() && self.carriers.len() != rest.nodes().len() {
            return Err(TissueError {
                field: "carriers",
                found: format!("{} of them", self.carriers.len()),
                expected: format!(
                    "one for each of {} nodes, or none at all",
                    rest.nodes().len()
                ),
            });
        }
        for &id in &self.carriers {
            place("carriers", id)?;
        }
        let mut fixed = vec![false; followers.movers.len()];
        for &id in &self.fixed {
            fixed[place("fixed", id)? as usize] = true;
        }
        let mut springs = Vec::with_capacity(self.springs.len());
        for &[i, j] in &self.springs {
            if i == j {
                return Err(TissueError {
                    field: "springs",
                    found: format!("one from node {i} to itself"),
                    expected: "two nodes".into(),
                });
            }
            springs.push([place("springs", i)?, place("springs", j)?]);
        }
        Ok(Graph { springs, fixed })
    }
}

/// Tells what loads a printed skeleton: what its own equations say, which is not what the hand feels. For measurements.
#[derive(Debug)]
pub struct PenaltyMeter(ReadySkeleton);

impl PenaltyMeter {
    /// For `object`, whose tissue `model` is, in ticks of `tick_s` seconds.
    pub fn new(model: &PrintedSkeleton, object: &Object, tick_s: f64) -> Self {
        Self(ReadySkeleton::new(
            model,
            &object.tree,
            object.level,
            tick_s,
        ))
    }

    /// Sum of Eq. 2 over all pairs, newtons, and the number of pairs. `state` is the object's part of
    /// [`crate::State::tissue`] before a tick, `hands` that tick's haptic and the last one's graphic poses.
    pub fn load(&mut self, state: &[f64], hands: &Hands<'_>) -> (Vec3, u32) {
        let n = self.0.force.len();
        let pairs = self.0.load(&state[..n], hands);
        let sum = self
            .0
            .force
            .chunks_exact(3)
            .fold(Vec3::zeros(), |sum, f| sum + Vec3::new(f[0], f[1], f[2]));
        (sum, pairs)
    }
}

/// Springs and held nodes, by place in the skeleton.
#[derive(Clone, Debug)]
pub(super) struct Graph {
    pub springs: Vec<[u32; 2]>,
    pub fixed: Vec<bool>,
}

impl Graph {
    pub fn unit_spectrum(&self) -> Spectrum {
        Spectrum::of_unit_springs(self.fixed.len(), &self.springs, &self.fixed)
    }

    /// Whether each sphere hangs on a held one: else nothing brings it back.
    fn connected(&self) -> Result<(), TissueError> {
        let mut held = self.fixed.clone();
        loop {
            let mut more = false;
            for &[i, j] in &self.springs {
                let (i, j) = (i as usize, j as usize);
                more |= held[i] != held[j];
                held[i] |= held[j];
                held[j] |= held[i];
            }
            if !more {
                break;
            }
        }
        match held.iter().filter(|held| !**held).count() {
            0 => Ok(()),
            loose => Err(TissueError {
                field: "springs",
                found: format!("{loose} spheres without a way to a fixed one"),
                expected: "a way from every sphere to a fixed one".into(),
            }),
        }
    }

    /// One step of explicit Euler (Eq. 1 with its sign mended, Eq. 4, Eq. 5): the velocity by the forces at the old place, the place
    /// by the **old** velocity. `now` and `next` hold displacements, then velocities (x, y, z of each sphere); metres,
    /// newtons, kilograms, seconds.
    pub fn euler(
        &self,
        (k, b, m, dt): (f64, f64, f64, f64),
        force: &[f64],
        now: &[f64],
        next: &mut [f64],
    ) {
        let n = 3 * self.fixed.len();
        let (u, v) = now.split_at(n);
        let (next_u, next_v) = next.split_at_mut(n);
        next_v.copy_from_slice(&force[..n]);
        for &[i, j] in &self.springs {
            let (i, j) = (3 * i as usize, 3 * j as usize);
            for axis in 0..3 {
                let pull = k * (u[i + axis] - u[j + axis]);
                next_v[i + axis] -= pull;
                next_v[j + axis] += pull;
            }
        }
        for at in 0..n {
            if self.fixed[at / 3] {
                (next_u[at], next_v[at]) = (0.0, 0.0);
            } else {
                next_v[at] = v[at] + dt / m * (next_v[at] - b * v[at]);
                next_u[at] = u[at] + dt * v[at];
            }
        }
    }
}

/// Displacement beyond which a skeleton has diverged, metres: no organ of a mouth is as long.
const DIVERGED: f64 = 0.2;
/// Below these nothing is left of a motion, metres and metres per second.
const AT_REST: (f64, f64) = (1e-9, 1e-6);

/// A printed skeleton made ready. A configuration is displacements, velocities, and whether it diverged.
#[derive(Debug)]
pub(crate) struct ReadySkeleton {
    model: PrintedSkeleton,
    graph: Graph,
    followers: Followers,
    /// Level in contact.
    level: u8,
    force: Vec<f64>,
    /// Length of a tick, seconds.
    tick_s: f64,
}

impl ReadySkeleton {
    /// For an object touched at `level`; `model` has passed its validation.
    pub fn new(model: &PrintedSkeleton, rest: &SphereTree, level: u8, tick_s: f64) -> Self {
        let followers = Followers::new(rest, model.level).carried_by(&model.carriers);
        let n = followers.movers.len();
        Self {
            graph: model.graph(rest).unwrap_or(Graph {
                springs: Vec::new(),
                fixed: vec![true; n],
            }),
            force: vec![0.0; 3 * n],
            model: model.clone(),
            followers,
            level,
            tick_s,
        }
    }

    /// Sums Eq. 2 over all pairs into the forces; returns how many pairs there were.
    fn load(&mut self, u: &[f64], hands: &Hands<'_>) -> u32 {
        let Self {
            model,
            followers,
            level,
            force,
            ..
        } = self;
        force.fill(0.0);
        let (nodes, place) = followers.posed(u);
        let mut pairs = 0;
        for hand in hands.tools.iter().flatten() {
            pairs += for_each_press(
                hand,
                model.contact_distance_m,
                (nodes, *level),
                |node, _, dp| {
                    if let Some(at) = place[node as usize] {
                        for axis in 0..3 {
                            force[3 * at as usize + axis] += model.penalty_n_per_m * dp[axis];
                        }
                    }
                },
            );
        }
        pairs
    }
}

impl Tissue for ReadySkeleton {
    fn shape_len(&self) -> usize {
        6 * self.followers.movers.len() + 1
    }

    fn goes_by_hands(&self) -> bool {
        // The loads of the method as printed come from the haptic tool.
        true
    }

    fn free_step(
        &mut self,
        state: &[f64],
        hands: &Hands<'_>,
        shape: &mut [f64],
        free: &mut [f64],
    ) -> bool {
        let n = 3 * self.followers.movers.len();
        self.load(&state[..n], hands);
        let loaded = self.force.iter().any(|f| *f != 0.0);
        let moving = state.iter().any(|x| *x != 0.0);
        shape.fill(0.0);
        if loaded || moving {
            let numbers = &self.model;
            let numbers = (
                numbers.spring_n_per_m,
                numbers.damping_n_s_per_m,
                numbers.mass_kg,
                self.tick_s,
            );
            self.graph
                .euler(numbers, &self.force, state, &mut shape[..2 * n]);
            let (u, v) = shape[..2 * n].split_at(n);
            let within = |numbers: &[f64], most: f64| numbers.iter().all(|x| x.abs() <= most);
            if !within(u, DIVERGED) || !v.iter().all(|x| x.is_finite()) {
                shape.fill(0.0);
                shape[2 * n] = 1.0;
            } else if !loaded && within(u, AT_REST.0) && within(v, AT_REST.1) {
                shape.fill(0.0);
            }
        }
        // Deformation comes before the optimisation and does not depend on it: the way is already gone.
        free.copy_from_slice(shape);
        !loaded && !moving
    }

    fn centres(&self, shape: &[f64], ids: &[u32], out: &mut [Vec3]) {
        self.followers.centres(shape, ids, out);
    }

    fn add_gram(&mut self, _: &[Site], _: &mut Gram<'_>) {}

    fn apply(&mut self, _: &[Site], _: &[f64], free: &[f64], shape: &mut [f64]) {
        shape.copy_from_slice(free);
    }

    fn motion(&self, from: &[f64], to: &[f64]) -> f64 {
        let n = 3 * self.followers.movers.len();
        largest_difference(&from[..n], &to[..n])
    }

    fn commit(&mut self, shape: &[f64], _: Option<&[SiteLoad]>, _: &Hands<'_>, state: &mut [f64]) {
        let n = state.len();
        if shape[n] == 0.0 {
            state.copy_from_slice(&shape[..n]);
        } else {
            // What diverged is handed on as what it is; the tick answers with rest and FAULT.
            state.fill(f64::NAN);
        }
    }
}
