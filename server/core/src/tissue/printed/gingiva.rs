//! Gingiva model as printed: section 5 of the paper.

use serde::{Deserialize, Serialize};

use super::followers::Followers;
use super::load::for_each_press;
use super::ranged;
use crate::MAX_TOOLS;
use crate::math::{Vec3, fmax, norm};
use crate::scene::params::within;
use crate::tissue::gingiva::Gingiva;
use crate::tissue::{Gram, Hands, Site, SiteLoad, Tissue, TissueError, largest_difference};
use crate::tree::SphereTree;

/// Gingiva model **as printed**, for comparison: Hooke's law at fringe spheres, attenuation at their neighbours. A
/// fringe sphere is a sphere of the gingiva within the prediction distance of the tool.
///
/// Two properties of the paper's equations are kept:
/// - The displacement `ds` depends on the last tick's graphic tool, which the displacement itself moves. For a press
///   `h`, `ds(t+1) = (K_p/k_d)(h - ds(t))`, all in metres. This oscillation does not decay for `K_p/k_d` of 1 or more.
/// - Eq. 15 jumps between nearly zero and `2R` at a change of the load's sign.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PrintedGingiva {
    /// Level of the tree whose spheres are displaced. The paper uses 3.
    pub level: u8,
    /// Index of the tooth of this pocket in the scene's objects. Loads on tooth and gingiva are a hybrid contact.
    pub tooth: u16,
    /// `n_inward` (Eq. 13) of each sphere of `level`, in the tree's order: unit vector, world axes.
    ///
    /// The vector points from the nearest sphere of the tooth to the gingiva. Spheres below the pocket's bottom have a
    /// zero vector and never move (section 5.2).
    pub inward: Vec<Vec3>,
    /// Direction out of the pocket along the tooth's axis: unit vector, world axes.
    pub axis: Vec3,
    /// `k_d`, stiffness of a sphere of the gingiva near the tool (fringe sphere), N/m. Default 1000, range 1 to 1e6.
    pub stiffness_n_per_m: f64,
    /// `K_p`, stiffness of the penalty, N/m: load on a fringe sphere per metre from the graphic to the haptic tool.
    /// Default 500, range 0 to 1e6. `K_p/k_d` is the gain of the delayed feedback.
    pub penalty_n_per_m: f64,
    /// `a` of Eq. 14: share of a fringe sphere's displacement that is left at a distance of one millimetre. Default
    /// 0.3, range 0.01 to 0.99. A larger value widens the dents.
    pub attenuation_per_mm: f64,
    /// Range of the attenuation: largest distance between a fringe sphere and a neighbour that moves along, metres.
    /// Default 4e-3, range 0 to 2e-2.
    ///
    /// At the default, neighbours beyond this distance would move by less than a hundredth of the fringe sphere's
    /// displacement.
    pub neighbourhood_m: f64,
    /// `2R` of Eq. 15, diameter of the tool's tip, metres. Default 5e-4, range 0 to 5e-3.
    pub tip_diameter_m: f64,
    /// `d`, prediction distance: gap under which spheres of tool and gingiva count as a pair, metres. Default 5e-4,
    /// range 0 to 5e-3.
    pub contact_distance_m: f64,
}

impl PrintedGingiva {
    /// Creates a gingiva with the default parameters.
    pub fn new(level: u8, tooth: u16, inward: Vec<Vec3>, axis: Vec3) -> Self {
        Self {
            level,
            tooth,
            inward,
            axis,
            stiffness_n_per_m: 1000.0,
            penalty_n_per_m: 500.0,
            attenuation_per_mm: 0.3,
            neighbourhood_m: 4e-3,
            tip_diameter_m: 5e-4,
            contact_distance_m: 5e-4,
        }
    }

    /// Converts a coupled gingiva to the model as printed.
    ///
    /// `rest` is the gingiva's tree, `tooth` the index of its tooth in the scene. The directions from the tooth are the
    /// same; spheres at the pocket's floor and below never move. `k_d` is the wall's stiffness and `K_p` half of `k_d`.
    /// All other parameters have their defaults.
    pub fn of(coupled: &Gingiva, rest: &SphereTree, tooth: u16) -> Self {
        let inward = rest.shape_at(coupled.level).map(|(id, _)| {
            let place = coupled.places.get(id as usize);
            let wall = place.filter(|place| place.height > 0.0 && !place.floor);
            wall.map_or_else(Vec3::zeros, |place| place.away)
        });
        let stiffness = coupled.params.wall_stiffness;
        Self {
            stiffness_n_per_m: stiffness,
            penalty_n_per_m: 0.5 * stiffness,
            ..Self::new(coupled.level, tooth, inward.collect(), coupled.tooth.axis)
        }
    }

    /// Count of numbers in the state: x, y, z of displacement per sphere, metres, and a flag of hybrid contact per
    /// tool.
    pub(crate) fn state_len(&self, rest: &SphereTree) -> usize {
        3 * rest.shape_at(self.level).count() + MAX_TOOLS
    }

    /// Checks the parameters against their ranges and the directions against the tree `rest`.
    ///
    /// # Errors
    /// A parameter is out of range, or the directions do not fit the tree.
    pub(crate) fn validate(&self, rest: &SphereTree) -> Result<(), TissueError> {
        ranged("stiffness_n_per_m", self.stiffness_n_per_m, 1.0, 1e6, "N/m")?;
        ranged("penalty_n_per_m", self.penalty_n_per_m, 0.0, 1e6, "N/m")?;
        ranged(
            "attenuation_per_mm",
            self.attenuation_per_mm,
            0.01,
            0.99,
            "per mm",
        )?;
        ranged("neighbourhood_m", self.neighbourhood_m, 0.0, 2e-2, "m")?;
        ranged("tip_diameter_m", self.tip_diameter_m, 0.0, 5e-3, "m")?;
        ranged(
            "contact_distance_m",
            self.contact_distance_m,
            0.0,
            5e-3,
            "m",
        )?;
        ranged("axis", norm(&self.axis), 1.0 - 1e-9, 1.0 + 1e-9, "long")?;
        let spheres = rest.shape_at(self.level).count();
        if self.inward.len() != spheres {
            return Err(TissueError {
                field: "inward",
                found: format!("{} directions", self.inward.len()),
                expected: format!(
                    "one for each of the {spheres} spheres of level {}",
                    self.level
                ),
            });
        }
        let bad = |n: &Vec3| !(*n == Vec3::zeros() || within(norm(n), 1.0 - 1e-9, 1.0 + 1e-9));
        match self.inward.iter().position(bad) {
            None => Ok(()),
            Some(at) => Err(TissueError {
                field: "inward",
                found: format!("{:?} for sphere {at}", self.inward[at]),
                expected: "a unit vector, or zero for a sphere that stays".into(),
            }),
        }
    }
}

/// Neighbour of a sphere within the range of the attenuation.
#[derive(Clone, Copy, Debug)]
struct Neighbour {
    /// Index in `Followers::movers`.
    place: u32,
    /// Share of the sphere's displacement that the neighbour takes, 0 to 1: `a^d` of Eq. 14, with `d` in millimetres.
    share: f64,
}

/// Gingiva as printed, prepared for the tick. A configuration holds the displacements of all spheres of the level: x,
/// y, z of each, metres.
#[derive(Debug)]
pub(crate) struct ReadyGingiva {
    model: PrintedGingiva,
    followers: Followers,
    /// Level of the gingiva's tree at which contact is predicted.
    level: u8,
    /// Neighbour lists of all spheres, concatenated. The list of a moving sphere includes the sphere itself; the list
    /// of a sphere that never moves is empty.
    neighbours: Vec<Neighbour>,
    /// End of each sphere's list in `neighbours`.
    ends: Vec<u32>,
    /// Height of the gingival margin along the axis from the world's origin, metres: top of the highest sphere that can
    /// move.
    margin: f64,
    /// Displacement of each sphere by the tool alone, along its direction `inward`, metres; zero for all but fringe
    /// spheres.
    fringe: Vec<f64>,
}

impl ReadyGingiva {
    /// Prepares a validated `model` for an object in contact at `level`.
    pub fn new(model: &PrintedGingiva, rest: &SphereTree, level: u8) -> Self {
        let followers = Followers::new(rest, model.level);
        let node = |place: usize| &rest.nodes()[followers.movers[place] as usize];
        let n = followers.movers.len();
        let moves = |place: &usize| {
            model
                .inward
                .get(*place)
                .is_some_and(|n| *n != Vec3::zeros())
        };
        let (mut neighbours, mut ends) = (Vec::new(), Vec::with_capacity(n));
        for i in 0..n {
            for j in (0..n).filter(|j| moves(&i) && moves(j)) {
                let distance = norm(&(node(i).centre - node(j).centre));
                if distance <= model.neighbourhood_m {
                    let share = libm::pow(model.attenuation_per_mm, distance * 1e3);
                    let place = j as u32;
                    neighbours.push(Neighbour { place, share });
                }
            }
            ends.push(neighbours.len() as u32);
        }
        let margin = (0..n).filter(moves).fold(f64::NEG_INFINITY, |most, at| {
            fmax(
                most,
                model.axis.dot(&node(at).centre) + node(at).contact_radius,
            )
        });
        Self {
            fringe: vec![0.0; n],
            model: model.clone(),
            followers,
            level,
            neighbours,
            ends,
            margin,
        }
    }

    /// Computes the displacements of the fringe spheres (Eq. 11 to 13, 15, 16). Returns whether any is positive. `u`
    /// holds the displacements after the last tick, metres. `hybrid` holds a flag of hybrid contact per tool slot, 0
    /// for none.
    fn press(&mut self, u: &[f64], hybrid: &[f64], hands: &Hands<'_>) -> bool {
        let Self {
            model,
            followers,
            level,
            margin,
            fringe,
            ..
        } = self;
        fringe.fill(0.0);
        let (nodes, place) = followers.posed(u);
        for (hand, hybrid) in hands.tools.iter().zip(hybrid) {
            let Some(hand) = hand else { continue };
            let withdrawn = model.axis.dot(&hand.haptic.transform(&hand.tool.tip)) > *margin;
            // Displacement of a fringe sphere without a load away from the tooth.
            let otherwise = match (*hybrid != 0.0, withdrawn) {
                // Eq. 11: the sphere returns to its rest position.
                (false, _) => 0.0,
                // Eq. 15, type 1: the tool stays in the pocket, so the gingiva leaves room for the tip.
                (true, false) => model.tip_diameter_m,
                // Eq. 16, type 3: the tool has left the pocket, so the sphere is released.
                (true, true) => 0.0,
            };
            for_each_press(
                hand,
                model.contact_distance_m,
                (nodes, *level),
                |node, _, dp| {
                    let Some(at) = place[node as usize] else {
                        return;
                    };
                    let at = at as usize;
                    if model.inward[at] == Vec3::zeros() {
                        return;
                    }
                    let along = model.penalty_n_per_m * dp.dot(&model.inward[at]);
                    let pressed = if *hybrid != 0.0 && withdrawn {
                        0.0
                    } else if along > 0.0 {
                        along / model.stiffness_n_per_m
                    } else {
                        otherwise
                    };
                    fringe[at] = fmax(fringe[at], pressed);
                },
            );
        }
        fringe.iter().any(|ds| *ds > 0.0)
    }

    /// Spreads the displacements of the fringe spheres to their neighbours (Eq. 14) in `shape`, metres. Each neighbour
    /// takes the largest of its displacements.
    fn spread(&self, shape: &mut [f64]) {
        let mut first = 0;
        for (at, &end) in self.ends.iter().enumerate() {
            let neighbours = &self.neighbours[first..end as usize];
            first = end as usize;
            if self.fringe[at] <= 0.0 {
                continue;
            }
            for neighbour in neighbours {
                let ds = self.model.inward[at] * (neighbour.share * self.fringe[at]);
                let there = &mut shape[3 * neighbour.place as usize..][..3];
                let now = there[0] * there[0] + there[1] * there[1] + there[2] * there[2];
                if ds.dot(&ds) > now {
                    there.copy_from_slice(ds.as_slice());
                }
            }
        }
    }
}

impl Tissue for ReadyGingiva {
    fn shape_len(&self) -> usize {
        3 * self.followers.movers.len()
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
        let (u, hybrid) = state.split_at(shape.len());
        let pressed = self.press(u, hybrid, hands);
        shape.fill(0.0);
        if pressed {
            self.spread(shape);
        }
        // Deformation precedes the optimisation and does not depend on the multipliers.
        free.copy_from_slice(shape);
        !pressed && state.iter().all(|x| *x == 0.0)
    }

    fn centres(&self, shape: &[f64], ids: &[u32], out: &mut [Vec3]) {
        self.followers.centres(shape, ids, out);
    }

    fn add_gram(&mut self, _: &[Site], _: &mut Gram<'_>) {}

    fn apply(&mut self, _: &[Site], _: &[f64], free: &[f64], shape: &mut [f64]) {
        shape.copy_from_slice(free);
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
        let (u, hybrid) = state.split_at_mut(shape.len());
        u.copy_from_slice(shape);
        let Some(loads) = loads else { return };
        for (t, hybrid) in hybrid.iter_mut().enumerate() {
            let on_tooth = |hand: &crate::tissue::Hand<'_>| {
                let load = hand.loads.get(usize::from(self.model.tooth));
                load.is_some_and(|load| norm(&load.force) > 0.0)
            };
            let both = loads.iter().any(|load| usize::from(load.tool) == t)
                && hands.tools[t].as_ref().is_some_and(on_tooth);
            *hybrid = f64::from(u8::from(both));
        }
    }
}
