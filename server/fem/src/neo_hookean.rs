//! The compressible neo-Hookean solid in its rest configuration (total Lagrangian).
//!
//! The energy density per volume at rest is `W = mu/2 (J^(-2/3) I1 - 3) + K/2 (J - 1)^2`, with `I1 = |F|^2` and `J =
//! det F`.
//!
//! Source: Bonet and Wood, Nonlinear Continuum Mechanics for Finite Element Analysis, 2008, chapter 6. Abaqus and
//! CalculiX name it `*HYPERELASTIC, NEO HOOKE`. At small strain it is [`Elastic`] with the same `mu` and bulk modulus
//! `K`.

use sulcus_core::Vec3;
use sulcus_core::math::Mat3;

use crate::element::gradients;
use crate::mesh::TetMesh;
use crate::stiffness::Elastic;

/// Shear and bulk modulus, Pa.
#[derive(Clone, Copy, Debug)]
pub(crate) struct NeoHookean {
    mu: f64,
    bulk: f64,
}

impl NeoHookean {
    /// Returns the solid that equals `elastic` at small strain.
    pub fn of(elastic: &Elastic) -> Self {
        Self {
            mu: elastic.young / (2.0 * (1.0 + elastic.poisson)),
            bulk: elastic.young / (3.0 * (1.0 - 2.0 * elastic.poisson)),
        }
    }

    /// Returns the first Piola-Kirchhoff stress (Pa) at a deformation gradient; `None` if the gradient turns matter
    /// inside out.
    pub fn stress(&self, f: &Mat3) -> Option<Mat3> {
        let (j, back) = inverse(f)?;
        let (scale, first) = (self.mu * to_minus_two_thirds(j), f.dot(f));
        Some((f - back * (first / 3.0)) * scale + back * (self.bulk * (j - 1.0) * j))
    }

    /// Returns the change of the stress for a small change `df` of the gradient, Pa.
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

/// Returns `J` and `F^-T`.
fn inverse(f: &Mat3) -> Option<(f64, Mat3)> {
    let j = f.determinant();
    (j > 0.0).then_some(())?;
    Some((j, f.try_inverse()?.transpose()))
}

fn to_minus_two_thirds(j: f64) -> f64 {
    1.0 / libm::cbrt(j * j)
}

/// Returns the forces (N) with which the mesh resists the displacements `moved` (metres), node by node.
///
/// `None` if an element is turned inside out at a point of integration.
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

/// Returns the deformation gradient at a point of integration.
pub(crate) fn gradient(tet: &[u32; 10], slopes: &[Vec3; 10], moved: &[Vec3]) -> Mat3 {
    let terms = tet.iter().zip(slopes);
    terms.fold(Mat3::identity(), |sum, (node, slope)| {
        sum + moved[*node as usize] * slope.transpose()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const ELASTIC: Elastic = Elastic {
        young: 1e5,
        poisson: 0.49,
    };

    /// Gradients far from rest, with changed volume.
    fn gradients() -> [Mat3; 4] {
        [
            Mat3::identity(),
            Mat3::new(1.3, 0.2, -0.1, 0.05, 0.8, 0.3, -0.2, 0.1, 1.05),
            Mat3::new(0.2, -1.1, 0.0, 0.9, 0.1, 0.4, 0.1, -0.3, 1.2),
            Mat3::new(0.5, 0.0, 0.3, 0.0, 2.0, -0.4, 0.1, 0.2, 0.9),
        ]
    }

    /// A change that is neither a rotation nor symmetric.
    const CHANGE: Mat3 = Mat3::new(0.3, -0.7, 0.2, 0.5, 0.4, -0.1, 0.6, -0.2, 0.8);

    /// Energy density, J/m3, by the formula at the head of the file.
    fn energy(solid: &NeoHookean, f: &Mat3) -> f64 {
        let j = f.determinant();
        let shear = f.norm_squared() / libm::cbrt(j * j) - 3.0;
        0.5 * solid.mu * shear + 0.5 * solid.bulk * (j - 1.0) * (j - 1.0)
    }

    #[test]
    fn stress_is_the_slope_of_the_energy_and_its_change_the_slope_of_the_stress() {
        let solid = NeoHookean::of(&ELASTIC);
        let h = 1e-5;
        for f in gradients() {
            let [less, more] = [-h, h].map(|h| f + CHANGE * h);
            let stress = solid.stress(&f).expect("upright");
            let slope = (energy(&solid, &more) - energy(&solid, &less)) / (2.0 * h);
            let scale = solid.bulk;
            assert!((stress.dot(&CHANGE) - slope).abs() < 1e-7 * scale, "{f}");
            let change = solid.stress_change(&f, &CHANGE).expect("upright");
            let [less, more] = [less, more].map(|f| solid.stress(&f).expect("upright"));
            let slope = (more - less) / (2.0 * h);
            assert!((change - slope).norm() < 1e-7 * scale, "{change} {slope}");
            assert!(change.norm() > 1e-2 * scale, "something to compare");
        }
    }

    #[test]
    fn the_change_is_symmetric_as_an_energy_demands() {
        let solid = NeoHookean::of(&ELASTIC);
        let other = Mat3::new(-0.2, 0.9, 0.4, 0.1, -0.6, 0.3, 0.7, 0.5, 0.2);
        for f in gradients() {
            let change = |by: &Mat3| solid.stress_change(&f, by).expect("upright");
            let (there, back) = (change(&CHANGE).dot(&other), change(&other).dot(&CHANGE));
            assert!((there - back).abs() < 1e-12 * solid.bulk, "{there} {back}");
        }
    }

    #[test]
    fn at_small_strain_it_is_hookes_law_and_twice_as_near_at_half_the_strain() {
        let solid = NeoHookean::of(&ELASTIC);
        let strain = (CHANGE + CHANGE.transpose()) * 0.5;
        let lambda = solid.bulk - 2.0 / 3.0 * solid.mu;
        let linear = strain * (2.0 * solid.mu) + Mat3::identity() * (lambda * strain.trace());
        let off = [1e-4, 5e-5].map(|t| {
            let stress = solid.stress(&(Mat3::identity() + CHANGE * t));
            (stress.expect("upright") / t - linear).norm() / linear.norm()
        });
        assert!(off[0] < 1e-3, "{off:?}");
        assert!((off[0] / off[1] - 2.0).abs() < 0.01, "{off:?}");
        // The two are equal in the limit.
        let change = solid.stress_change(&Mat3::identity(), &CHANGE);
        assert!((change.expect("upright") - linear).norm() < 1e-12 * linear.norm());
    }

    #[test]
    fn a_rotation_costs_nothing_and_turns_the_stress_with_it() {
        let solid = NeoHookean::of(&ELASTIC);
        // A quarter turn about z after a 3-4-5 turn about x.
        let turn = Mat3::new(0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0)
            * Mat3::new(1.0, 0.0, 0.0, 0.0, 0.6, -0.8, 0.0, 0.8, 0.6);
        assert!(solid.stress(&turn).expect("upright").norm() < 1e-9);
        for f in gradients() {
            let stress = solid.stress(&f).expect("upright");
            let turned = solid.stress(&(turn * f)).expect("upright");
            assert!((turned - turn * stress).norm() < 1e-12 * solid.bulk);
        }
    }

    #[test]
    fn nothing_is_said_of_matter_inside_out() {
        let solid = NeoHookean::of(&ELASTIC);
        for f in [
            Mat3::identity() * -1.0,
            Mat3::zeros(),
            Mat3::identity() * f64::NAN,
        ] {
            assert!(solid.stress(&f).is_none());
            assert!(solid.stress_change(&f, &CHANGE).is_none());
        }
    }
}
