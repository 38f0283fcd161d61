//! Tongue model as printed: sections 3.1, 4 and 6 of the paper.

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

/// Skeleton model **as printed**, for comparison: spheres of a tree level, joined by springs, under penalty loads.
///
/// Explicit Euler integrates the motion. Validation refuses a scene beyond the stability limit of explicit Euler.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PrintedSkeleton {
    /// Level of the tree whose shape is the skeleton: its nodes, and childless nodes above. The paper uses 2.
    pub level: u8,
    /// Springs: pairs of tree nodes of `level`, or of childless nodes above that level.
    pub springs: Vec<[u32; 2]>,
    /// Fixed tree nodes of `level`: the root of the tongue and the bottom layer in the paper.
    pub fixed: Vec<u32>,
    /// Carriers: for each node of the tree the skeleton sphere (a tree node) that the node follows and loads.
    ///
    /// Only nodes below the skeleton use their entry. With an empty list, each node follows its ancestor. A tree of
    /// inscribed spheres needs carriers: a sphere of the upper surface may have a fixed ancestor in the bottom layer.
    pub carriers: Vec<u32>,
    /// `k_s` of every spring, N/m. Default 50, range 0.1 to 1e5.
    ///
    /// A larger value is stiffer and nearer to the stability limit. Source: section 8.1 has 500 (0.5 N/mm), which with
    /// the paper's damping needs 0.3 kg per sphere.
    pub spring_n_per_m: f64,
    /// `b_c`, damping of every sphere's motion, N s/m. Default 12, range 0 to 1e4.
    ///
    /// Stable values lie between the largest eigenvalue times the time step and about twice the mass over the time
    /// step.
    pub damping_n_s_per_m: f64,
    /// `m`, mass of every sphere, kg. Default 0.02 (Table 1), range 1e-4 to 100.
    pub mass_kg: f64,
    /// `K_p`, penalty stiffness per pair of spheres, N/m: load per metre from the graphic to the haptic tool. Default 5
    /// (Table 1), range 0 to 1e5.
    ///
    /// The penalty acts once per pair, so a finer level carries more load: 7 to 27 times the device's force at level 3.
    pub penalty_n_per_m: f64,
    /// `d`, prediction distance: gap under which spheres of tool and organ count as a pair, metres. Default 5e-4
    /// (section 3.2), range 0 to 5e-3.
    pub contact_distance_m: f64,
}

impl PrintedSkeleton {
    /// Creates a skeleton with the default parameters.
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

    /// Converts a coupled skeleton to the model as printed.
    ///
    /// Spheres, springs and fixed nodes are the same. All springs have the coupled skeleton's mean stiffness. Each
    /// sphere follows its carrier of largest weight. All other parameters have their defaults.
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

    /// Count of numbers in the state: x, y, z of displacement (m) of each sphere of the skeleton, then of velocity
    /// (m/s).
    pub(crate) fn state_len(&self, rest: &SphereTree) -> usize {
        6 * rest.shape_at(self.level).count()
    }

    /// Computes the largest stable spring stiffness (N/m) at the mass of this model, and its damping (N s/m).
    ///
    /// `unit` is the spectrum of springs of unit stiffness, `dt` the time step in seconds. The damping is that of this
    /// model, if any stiffness is stable with that damping. Otherwise the lower and the upper bound of the damping meet
    /// at the result.
    fn stiffest(&self, unit: &Spectrum, dt: f64) -> (f64, f64) {
        let (b, m, kp) = (self.damping_n_s_per_m, self.mass_kg, self.penalty_n_per_m);
        // b >= lambda_max dt, and b <= 2m/dt + lambda_min dt/2.
        let most = (b / dt - kp) / unit.most;
        if most > 0.0 && b <= 2.0 * m / dt + 0.5 * dt * most * unit.least {
            return (most, b);
        }
        // No stiffness is stable at this damping: take the stiffness at which both bounds of the damping meet.
        let most = fmax(
            (2.0 * m / (dt * dt) - kp) / (unit.most - 0.5 * unit.least),
            0.0,
        );
        (most, (most * unit.most + kp) * dt)
    }

    /// Computes the stiffness range of all modes, N/m, with the penalty of a single pair per sphere.
    ///
    /// This sum is `k_s + k_p` in the paper. Level 3 can have more pairs per sphere, which can exceed the stability
    /// limit of this range. The tick then resets the tissue to rest with [`crate::output::status::FAULT`].
    ///
    /// # Errors
    /// A spring, a fixed node or a carrier is no node of the skeleton.
    pub fn spectrum(&self, rest: &SphereTree) -> Result<Spectrum, TissueError> {
        let graph = self.graph(rest)?;
        Ok(graph
            .unit_spectrum()
            .scaled(self.spring_n_per_m, self.penalty_n_per_m))
    }

    /// Checks parameters, spring graph and stability for the tree `rest` and a tick of `tick_s` seconds.
    ///
    /// # Errors
    /// A parameter is out of range, the graph is invalid, or explicit Euler is unstable.
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

    /// Checks the stability of the whole skeleton (section 4.4) at a time step of `tick_s` seconds. `unit` is the
    /// spectrum of springs of unit stiffness.
    ///
    /// # Errors
    /// A mode is unstable; the error states the stable stiffness, mass and time step.
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

    /// Builds the spring graph on the skeleton's spheres of the tree `rest`.
    ///
    /// # Errors
    /// A spring, a fixed node or a carrier is no node of the skeleton. A spring joins a node to itself. The number of
    /// carriers differs from the number of nodes.
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

/// Meter of the penalty load on a skeleton as printed, for measurements.
///
/// The penalty load of Eq. 2 differs from the force on the hand.
#[derive(Debug)]
pub struct PenaltyMeter(ReadySkeleton);

impl PenaltyMeter {
    /// Creates a meter for `object` with the tissue `model` and ticks of `tick_s` seconds.
    pub fn new(model: &PrintedSkeleton, object: &Object, tick_s: f64) -> Self {
        Self(ReadySkeleton::new(
            model,
            &object.tree,
            object.level,
            tick_s,
        ))
    }

    /// Returns the sum of Eq. 2 over all pairs, newtons, world axes, and the number of pairs.
    ///
    /// `state` is the object's part of [`crate::State::tissue`] before a tick. `hands` holds the haptic poses of that
    /// tick and the graphic poses of the last tick.
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

/// Spring graph, by index of the sphere in the skeleton.
#[derive(Clone, Debug)]
pub(super) struct Graph {
    /// Springs: pairs of indices of spheres.
    pub springs: Vec<[u32; 2]>,
    /// Whether each sphere is fixed.
    pub fixed: Vec<bool>,
}

impl Graph {
    /// Computes the spectrum of the graph for springs of unit stiffness.
    pub fn unit_spectrum(&self) -> Spectrum {
        Spectrum::of_unit_springs(self.fixed.len(), &self.springs, &self.fixed)
    }

    /// Checks that springs connect each sphere to a fixed sphere. Without such a path, a sphere has no restoring force.
    ///
    /// # Errors
    /// Some spheres have no path to a fixed sphere.
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

    /// Advances the spheres by a step of explicit Euler (Eq. 1 with corrected sign, Eq. 4, Eq. 5).
    ///
    /// Forces at the old positions change the velocities. The **old** velocities change the positions. The first
    /// argument is spring stiffness (N/m), damping (N s/m), mass (kg) and time step (s). `force` is in newtons. `now`
    /// and `next` hold displacements (m), then velocities (m/s): x, y, z of each sphere.
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

/// Displacement beyond which a skeleton has diverged, metres. No organ of the mouth is as long.
const DIVERGED: f64 = 0.2;
/// Thresholds of rest: displacement (m) and velocity (m/s). An unloaded skeleton below both is reset to exact rest.
const AT_REST: (f64, f64) = (1e-9, 1e-6);

/// Skeleton as printed, prepared for the tick.
///
/// A configuration holds displacements (m), velocities (m/s) and a flag of divergence (1.0 if diverged).
#[derive(Debug)]
pub(crate) struct ReadySkeleton {
    model: PrintedSkeleton,
    graph: Graph,
    followers: Followers,
    /// Level of the organ's tree at which contact is predicted.
    level: u8,
    /// External force on each sphere of the skeleton (x, y, z), newtons.
    force: Vec<f64>,
    /// Length of a tick, seconds.
    tick_s: f64,
}

impl ReadySkeleton {
    /// Prepares a validated `model` for an object in contact at `level`, with ticks of `tick_s` seconds.
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

    /// Sums the penalty load of Eq. 2 over all pairs into `force` and returns the number of pairs. `u` holds the
    /// displacements of the skeleton after the last tick, metres.
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
        // Deformation precedes the optimisation and does not depend on the multipliers: the step is already complete.
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
            // NaN marks the divergence; the tick then resets the tissue to rest and sets FAULT.
            state.fill(f64::NAN);
        }
    }
}
