//! The compressible neo-Hookean solid in its rest configuration (total Lagrangian): energy density `W = mu/2 (J^(-2/3) I1 - 3)
//! + K/2 (J - 1)^2` per volume at rest, with `I1 = |F|^2`, `J = det F` (Bonet and Wood, Nonlinear Continuum Mechanics for
//! Finite Element Analysis, 2008, chapter 6; Abaqus and CalculiX call it `*HYPERELASTIC, NEO HOOKE`). At small strain it is
//! [`Elastic`] with the same `mu` and bulk modulus `K`.

use sulcus_core::Vec3;
use sulcus_core::math::Mat3;

use crate::element::gradients;
use crate::{Elastic, TetMesh};

/// Shear and bulk modulus, Pa.
#[derive(Clone, Copy, Debug)]
pub(crate) struct NeoHookean {
    mu: f64,
    bulk: f64,
}

impl NeoHookean {
    /// The solid that is `elastic` at small strain.
    pub fn of(elastic: &Elastic) -> Self {
        Self {
            mu: elastic.young / (2.0 * (1.0 + elastic.poisson)),
            bulk: elastic.young / (3.0 * (1.0 - 2.0 * elastic.poisson)),
        }
    }

    /// First Piola-Kirchhoff stress (Pa) at a deformation gradient; none where that turns the matter inside out.
    pub fn stress(&self, f: &Mat3) -> Option<Mat3> {
        let (j, back) = inverse(f)?;
        let (scale, first) = (self.mu * to_minus_two_thirds(j), f.dot(f));
        Some((f - back * (first / 3.0)) * scale + back * (self.bulk * (j - 1.0) * j))
    }

    /// How that stress changes for a small change `df` of the gradient, Pa.
    pub fn stress_change(&self, f: &Mat3, df: &Mat3) -> Option<Mat3> {
        let (j, back) = inverse(f)?;
        let (scale, first) = (self.mu * to_minus_two_thirds(j), f.dot(f));
        let (volume, of_back) = (back.dot(df), -(back * df.transpose() * back));
        let shear = df
            - back * (2.0 / 3.0 * f.dot(df))
            - of_back * (first / 3.0)
            - (f - back * (first / 3.0)) * (2.0 / 3.0 * volume);
        let pressure = back * ((2.0 * j - 1.0) * j * volume) + of_back * ((j - 1.0) * j);
        Some(shear * scale + pressure * self.bulk)
    }
}

/// `J` and `F^-T`.
fn inverse(f: &Mat3) -> Option<(f64, Mat3)> {
    let j = f.determinant();
    (j > 0.0).then_some(())?;
    Some((j, f.try_inverse()?.transpose()))
}

fn to_minus_two_thirds(j: f64) -> f64 {
    1.0 / libm::cbrt(j * j)
}

/// Forces (N) with which the mesh resists the displacements `moved` (metres), node by node; none where these turn an element
/// inside out.
pub fn neo_hookean_forces(mesh: &TetMesh, material: &Elastic, moved: &[Vec3]) -> Option<Vec<Vec3>> {
    let solid = NeoHookean::of(material);
    let mut forces = vec![Vec3::zeros(); mesh.nodes.len()];
    for tet in &mesh.tets {
        for (slopes, volume) in &gradients(&mesh.corners(tet))? {
            let f = gradient(tet, slopes, moved);
            let stress = solid.stress(&f)? * *volume;
            for (node, slope) in tet.iter().zip(slopes) {
                forces[*node as usize] += stress * slope;
            }
        }
    }
    Some(forces)
}

/// Deformation gradient at a point of integration.
pub(crate) fn gradient(tet: &[u32; 10], slopes: &[Vec3; 10], moved: &[Vec3]) -> Mat3 {
    let terms = tet.iter().zip(slopes);
    terms.fold(Mat3::identity(), |sum, (node, slope)| {
        sum + moved[*node as usize] * slope.transpose()
    })
}
