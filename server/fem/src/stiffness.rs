//! Stiffness of a mesh, and its displacements under loads.

use std::array::from_fn;

use faer::linalg::solvers::Solve;
use faer::sparse::linalg::solvers::Llt;
use sulcus_core::Vec3;
use sulcus_core::math::Mat3;

use crate::assembly::Assembly;
use crate::element::gradients;
use crate::error::FemError;
use crate::mesh::TetMesh;

/// An isotropic, linearly elastic material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Elastic {
    /// Young's modulus, Pa, over 0.
    pub young: f64,
    /// Poisson's ratio, 0 to 0.499. For living tissue, which hardly changes its volume, 0.49.
    pub poisson: f64,
}

impl Elastic {
    /// Checks both constants.
    ///
    /// # Errors
    /// [`FemError::Field`] with the field, the value found and the values allowed.
    pub fn validate(&self) -> Result<(), FemError> {
        if !(1.0..=1e12).contains(&self.young) {
            return Err(FemError::field(
                "young",
                self.young.to_string(),
                "1 to 1e12 Pa",
            ));
        }
        if !(0.0..=0.499).contains(&self.poisson) {
            return Err(FemError::field(
                "poisson",
                self.poisson.to_string(),
                "0 to 0.499",
            ));
        }
        Ok(())
    }

    /// Returns Lame's constants lambda and mu, Pa.
    fn lame(&self) -> (f64, f64) {
        let mu = self.young / (2.0 * (1.0 + self.poisson));
        (2.0 * mu * self.poisson / (1.0 - 2.0 * self.poisson), mu)
    }
}

/// Returns the stiffness between nodes `a` and `b` of a tetrahedron, N/m.
///
/// The value is the integral of `lambda grad_a grad_b' + mu (grad_b grad_a' + (grad_a . grad_b) 1)`.
fn block(all: &[([Vec3; 10], f64); 4], (lambda, mu): (f64, f64), a: usize, b: usize) -> Mat3 {
    all.iter().fold(Mat3::zeros(), |sum, (slopes, volume)| {
        let (p, q) = (&slopes[a], &slopes[b]);
        let outer = p * q.transpose();
        sum + (outer * lambda + (outer.transpose() + Mat3::identity() * p.dot(q)) * mu) * *volume
    })
}

/// Returns the forces (N) with which the mesh resists the displacements `moved` (metres), node by node.
pub fn internal_forces(mesh: &TetMesh, material: &Elastic, moved: &[Vec3]) -> Vec<Vec3> {
    let (lambda, mu) = material.lame();
    let mut forces = vec![Vec3::zeros(); mesh.nodes.len()];
    for tet in &mesh.tets {
        let Some(all) = gradients(&mesh.corners(tet)) else {
            continue;
        };
        for (slopes, volume) in &all {
            let strain = tet
                .iter()
                .zip(slopes)
                .fold(Mat3::zeros(), |sum, (node, slope)| {
                    sum + moved[*node as usize] * slope.transpose()
                });
            let strain = (strain + strain.transpose()) * 0.5;
            let stress = strain * (2.0 * mu) + Mat3::identity() * (lambda * strain.trace());
            for (node, slope) in tet.iter().zip(slopes) {
                forces[*node as usize] += stress * slope * *volume;
            }
        }
    }
    forces
}

/// A mesh of a material with its factored stiffness matrix. It solves for displacements.
#[derive(Debug)]
pub struct Factored {
    assembly: Assembly,
    cholesky: Llt<usize, f64>,
}

impl Factored {
    /// Assembles and factors the matrix. 50,000 unknowns take one to two seconds.
    ///
    /// # Errors
    /// [`FemError`] if mesh or material are invalid, or the mesh is not held.
    pub fn new(mesh: &TetMesh, material: &Elastic) -> Result<Self, FemError> {
        material.validate()?;
        let assembly = Assembly::new(mesh)?;
        let lame = material.lame();
        let stiffness = |tet: &[u32; 10]| {
            let all = gradients(&mesh.corners(tet)).unwrap_or([([Vec3::zeros(); 10], 0.0); 4]);
            from_fn(|a| from_fn(|b| block(&all, lame, a, b)))
        };
        let cholesky = assembly.factor(mesh, stiffness)?;
        let cholesky = cholesky.ok_or_else(|| FemError::Factor("not positive definite".into()))?;
        Ok(Self { assembly, cholesky })
    }

    /// Returns the displacements (metres, node by node) under each of the `loads` (newtons, node by node). The
    /// support bears the load on a held node.
    ///
    /// # Errors
    /// [`FemError::Field`] if a load does not have a finite force for each node.
    pub fn solve(&self, loads: &[Vec<Vec3>]) -> Result<Vec<Vec<Vec3>>, FemError> {
        for load in loads {
            check_load(load, self.assembly.nodes())?;
        }
        let answer = self.cholesky.solve(&self.assembly.gather(loads));
        let moved = |c| self.assembly.scatter(answer.as_ref(), c);
        Ok((0..loads.len()).map(moved).collect())
    }
}

/// Checks that a load has a finite force for each node.
pub(crate) fn check_load(load: &[Vec3], nodes: usize) -> Result<(), FemError> {
    if load.len() != nodes {
        let (found, expected) = (load.len().to_string(), nodes.to_string());
        return Err(FemError::field("forces of a load", found, expected));
    }
    let wrong = load.iter().position(|f| !f.iter().all(|x| x.is_finite()));
    wrong.map_or(Ok(()), |k| {
        let found = format!("{:?} on node {k}", load[k]);
        Err(FemError::field("force", found, "finite"))
    })
}
