//! Equilibrium of the neo-Hookean solid under dead loads. A dead load keeps its place in the matter and its direction
//! in space.
//!
//! Newton's method with the exact tangent; the load grows in steps, each halved until its equilibrium is found.
//!
//! Source: Bonet and Wood, Nonlinear Continuum Mechanics for Finite Element Analysis, 2008, chapter 9.
//!
//! The tangent is factored as positive definite, so every result is a stable equilibrium. A slender part that buckles
//! is refused at the point of buckling.
//!
//! Inversion of an element is tested at its points of integration, not at its corners.

use faer::linalg::solvers::Solve;
use faer::sparse::linalg::solvers::Llt;
use sulcus_core::Vec3;
use sulcus_core::math::Mat3;

use crate::assembly::Assembly;
use crate::error::FemError;
use crate::mesh::TetMesh;
use crate::neo_hookean::NeoHookean;
use crate::neo_hookean::neo_hookean_forces;
use crate::stiffness::Elastic;
use crate::stiffness::check_load;
use crate::tangent::tangent;

/// Options of the search for equilibrium.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NewtonOptions {
    /// Steps of the load as long as every step converges, 1 to 1000, 4 by default. More steps take longer and reach
    /// higher loads before a step must be halved.
    pub steps: u32,
    /// Largest number of times that a step may be halved, 0 to 20, 8 by default.
    pub halvings: u32,
    /// Corrections in a step after which it counts as not converging, 1 to 100, 10 by default.
    pub corrections: u32,
    /// Tangents factored in all, 1 to 10,000, 300 by default. They bound the work.
    pub tangents: u32,
    /// Tolerance: residual forces as a share of the load on the nodes that may move, 1e-12 to 0.01, 1e-8 by default.
    ///
    /// Both are roots of sums of squares. Convergence is quadratic, so a smaller tolerance costs little.
    pub tolerance: f64,
}

impl Default for NewtonOptions {
    fn default() -> Self {
        Self {
            steps: 4,
            halvings: 8,
            corrections: 10,
            tangents: 300,
            tolerance: 1e-8,
        }
    }
}

impl NewtonOptions {
    /// Checks all options.
    ///
    /// # Errors
    /// [`FemError::Field`] with the field, the value found and the values allowed.
    pub fn validate(&self) -> Result<(), FemError> {
        let whole = [
            ("steps", self.steps, 1, 1000),
            ("halvings", self.halvings, 0, 20),
            ("corrections", self.corrections, 1, 100),
            ("tangents", self.tangents, 1, 10_000),
        ];
        for (field, found, least, most) in whole {
            if !(least..=most).contains(&found) {
                let expected = format!("{least} to {most}");
                return Err(FemError::field(field, found.to_string(), expected));
            }
        }
        if (1e-12..=0.01).contains(&self.tolerance) {
            return Ok(());
        }
        let found = self.tolerance.to_string();
        Err(FemError::field("tolerance", found, "1e-12 to 0.01"))
    }
}

/// Progress of a solver, reported after each correction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NewtonProgress {
    /// Share of the load at the end of the current step, 0 to 1.
    pub load: f64,
    /// Corrections made in the step.
    pub correction: u32,
    /// Residual forces as a share of the whole load; see [`NewtonOptions::tolerance`].
    pub left: f64,
    /// Tangents factored so far.
    pub tangents: u32,
}

/// Returns the displacements (metres, node by node) at which the mesh is in equilibrium with the dead `load`
/// (newtons, node by node).
///
/// The solid is neo-Hookean, and `material` at small strain. The support bears the load on a held node.
///
/// # Errors
/// [`FemError`] if mesh, material, load or options are invalid, or the mesh is not held. [`FemError::Newton`] has the
/// largest share of the load with an equilibrium.
pub fn solve_neo_hookean(
    mesh: &TetMesh,
    material: &Elastic,
    load: &[Vec3],
    options: &NewtonOptions,
    progress: &mut dyn FnMut(&NewtonProgress),
) -> Result<Vec<Vec3>, FemError> {
    material.validate()?;
    options.validate()?;
    check_load(load, mesh.nodes.len())?;
    let assembly = Assembly::new(mesh)?;
    let mut solver = Solver {
        mesh,
        material,
        options,
        load,
        whole: size(mesh, load),
        assembly,
        tangents: 0,
    };
    solver.run(progress)
}

/// Returns the root of the sum of squares of the forces on nodes that may move, N.
fn size(mesh: &TetMesh, forces: &[Vec3]) -> f64 {
    let free = |(force, held): (&Vec3, &[bool; 3])| -> f64 {
        let parts = force.iter().zip(held);
        parts.map(|(f, held)| if *held { 0.0 } else { f * f }).sum()
    };
    forces.iter().zip(&mesh.held).map(free).sum::<f64>().sqrt()
}

struct Solver<'a> {
    mesh: &'a TetMesh,
    material: &'a Elastic,
    options: &'a NewtonOptions,
    load: &'a [Vec3],
    /// Size of the load, N.
    whole: f64,
    assembly: Assembly,
    tangents: u32,
}

impl Solver<'_> {
    fn run(&mut self, progress: &mut dyn FnMut(&NewtonProgress)) -> Result<Vec<Vec3>, FemError> {
        let mut moved = vec![Vec3::zeros(); self.mesh.nodes.len()];
        if self.whole == 0.0 {
            return Ok(moved);
        }
        // The load is counted in the smallest possible steps, without rounding.
        let longest = 1_u64 << self.options.halvings;
        let all = u64::from(self.options.steps) * longest;
        let (mut reached, mut step) = (0, longest);
        let share = |part: u64| part as f64 / all as f64;
        while reached < all {
            let aim = (reached + step).min(all);
            match self.step(&moved, share(aim), progress)? {
                Ok(found) => {
                    (moved, reached) = (found, aim);
                    step = (2 * step).min(longest);
                }
                Err(why) => {
                    if step == 1 || self.tangents >= self.options.tangents {
                        let (reached, aim) = (share(reached), share(aim));
                        return Err(FemError::Newton { reached, aim, why });
                    }
                    step /= 2;
                }
            }
        }
        Ok(moved)
    }

    /// Searches for the equilibrium at a share `aim` of the load, starting from `moved`; returns the reason if there
    /// is none.
    fn step(
        &mut self,
        moved: &[Vec3],
        aim: f64,
        progress: &mut dyn FnMut(&NewtonProgress),
    ) -> Result<Result<Vec<Vec3>, &'static str>, FemError> {
        let mut moved = moved.to_vec();
        for correction in 0..=self.options.corrections {
            let Some(inner) = neo_hookean_forces(self.mesh, self.material, &moved) else {
                return Ok(Err("an element is turned inside out"));
            };
            let forces = self.load.iter().zip(&inner);
            let rest: Vec<Vec3> = forces.map(|(load, inner)| load * aim - inner).collect();
            let left = size(self.mesh, &rest) / self.whole;
            if correction > 0 {
                progress(&NewtonProgress {
                    load: aim,
                    correction,
                    left,
                    tangents: self.tangents,
                });
            }
            if left <= self.options.tolerance * aim {
                return Ok(Ok(moved));
            }
            if correction == self.options.corrections {
                break;
            }
            if self.tangents >= self.options.tangents {
                return Ok(Err("no more tangents may be factored"));
            }
            let Some(tangent) = self.tangent(&moved)? else {
                return Ok(Err("the tangent is not positive definite"));
            };
            let change = tangent.solve(&self.assembly.gather(std::slice::from_ref(&rest)));
            let change = self.assembly.scatter(change.as_ref(), 0);
            moved.iter_mut().zip(&change).for_each(|(u, du)| *u += du);
        }
        Ok(Err("the corrections do not converge"))
    }

    fn tangent(&mut self, moved: &[Vec3]) -> Result<Option<Llt<usize, f64>>, FemError> {
        self.tangents += 1;
        let solid = NeoHookean::of(self.material);
        let mesh = self.mesh;
        self.assembly.factor(mesh, |tet| {
            // The forces were finite here, so the element is not inside out.
            tangent(mesh, &solid, tet, moved).unwrap_or([[Mat3::zeros(); 10]; 10])
        })
    }
}
