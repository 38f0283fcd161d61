//! Metric of a substep: the quadratic form that the substep minimises, with the coordinates that make it the identity.
//!
//! The base of the metric is the coupling `G = diag(k_t, k_r)`. A blended surface that bends inwards under a tool adds
//! the second derivative of its constraint times the press. The sum is the Hessian of the Lagrangian, as in sequential
//! quadratic programming (Nocedal and Wright 2006, chapter 18). The addition affects only the step. At convergence the
//! step is zero, and the forces are those of the coupling.

use crate::math::{Mat3, Vec3, norm};
use crate::scene::tool::Tool;

/// Tolerance of [`Metric::settled`]: the force from the added curvature may be this share of the coupling force, plus
/// this force in newtons.
const SETTLED: (f64, f64) = (2e-3, 2e-5);

/// Quadratic form `1/2 x' K x`, joules, that the substep minimises for one tool. `x` is the step less the step without
/// contact: translation of the working point (metres), rotation vector about it (radians), world axes. The stiffness
/// `K` is that of the coupling, plus that of hollow surfaces under load.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Metric {
    /// Stiffness of the coupling: translation (N/m) and rotation (N m/rad).
    stiffness: (f64, f64),
    /// Square roots of both stiffnesses, in the same order and SI units.
    roots: (f64, f64),
    /// Stiffness of hollow surfaces, added to the coupling's; `None` in most substeps.
    bent: Option<Bent>,
    /// Force of the coupling at the start of the substep, newtons; 0 before [`Metric::scaled_free_step`].
    force: f64,
}

/// Stiffness that hollow surfaces add, and the factor of the sum. Both are 6 x 6 about the working point, translation,
/// then rotation, world axes, SI units.
#[derive(Clone, Copy, Debug)]
struct Bent {
    /// Stiffness added to that of the coupling.
    added: [[f64; 6]; 6],
    /// Lower Cholesky factor `L` of the whole stiffness, coupling included.
    factor: [[f64; 6]; 6],
}

impl Metric {
    /// Metric of an absent tool: stiffnesses 1 N/m and 1 N m/rad.
    pub const UNIT: Metric = Metric {
        stiffness: (1.0, 1.0),
        roots: (1.0, 1.0),
        bent: None,
        force: 0.0,
    };

    /// Returns the metric of the coupling of `tool`, without added stiffness.
    pub fn of(tool: &Tool) -> Self {
        let stiffness = (tool.stiffness_n_per_m, tool.stiffness_nm_per_rad);
        Self {
            stiffness,
            roots: (stiffness.0.sqrt(), stiffness.1.sqrt()),
            bent: None,
            force: 0.0,
        }
    }

    /// Returns the metric of a coupling with the share `share` of the stiffnesses of `tool`, above 0.
    pub fn weak(tool: &Tool, share: f64) -> Self {
        let stiffness = (
            share * tool.stiffness_n_per_m,
            share * tool.stiffness_nm_per_rad,
        );
        Self {
            stiffness,
            roots: (stiffness.0.sqrt(), stiffness.1.sqrt()),
            bent: None,
            force: 0.0,
        }
    }

    /// Adds the stiffness `hollow` of a hollow surface at the point `arm` from the working point. `hollow` (N/m) is
    /// symmetric and positive semi-definite. `arm` is in metres. Both are in world axes.
    pub fn add(&mut self, hollow: &Mat3, arm: &Vec3) {
        let mut added = self.bent.map_or([[0.0; 6]; 6], |bent| bent.added);
        // Motion of the point: `v + w x arm = v - [arm] w`.
        let lever = -arm.cross_matrix();
        let (mixed, turn) = (hollow * lever, lever.transpose() * hollow * lever);
        for i in 0..3 {
            for j in 0..3 {
                added[i][j] += hollow[(i, j)];
                added[i][3 + j] += mixed[(i, j)];
                added[3 + j][i] += mixed[(i, j)];
                added[3 + i][3 + j] += turn[(i, j)];
            }
        }
        let mut factor = added;
        for k in 0..3 {
            factor[k][k] += self.stiffness.0;
            factor[3 + k][3 + k] += self.stiffness.1;
        }
        for i in 0..6 {
            for j in 0..=i {
                let sum = |row: &[f64; 6], column: &[f64; 6]| {
                    let products = row[..j].iter().zip(&column[..j]).map(|(a, b)| a * b);
                    products.fold(0.0, |sum, product| sum + product)
                };
                let entry = factor[i][j] - sum(&factor[i], &factor[j]);
                // The root exists: a positive definite plus a positive semi-definite matrix is positive definite.
                factor[i][j] = if i == j {
                    entry.sqrt()
                } else {
                    entry / factor[j][j]
                };
            }
        }
        self.bent = Some(Bent { added, factor });
    }

    /// Returns the step that the substep would make without contact, in scaled unknowns (sqrt(J)), in which the metric
    /// is the identity. `v` (metres, of the working point) and `w` (radians) lead from the graphic to the haptic pose,
    /// world axes. Stores the force of the coupling.
    pub fn scaled_free_step(&mut self, v: &Vec3, w: &Vec3) -> [f64; 6] {
        self.force = self.stiffness.0 * norm(v);
        match &self.bent {
            None => {
                let (t, r) = self.roots;
                [v.x * t, v.y * t, v.z * t, w.x * r, w.y * r, w.z * r]
            }
            Some(bent) => {
                let (t, r) = self.stiffness;
                bent.forward([v.x * t, v.y * t, v.z * t, w.x * r, w.y * r, w.z * r])
            }
        }
    }

    /// Returns a row in the scaled unknowns of [`Metric::scaled_free_step`], m/sqrt(J). `translation` (m/m) and
    /// `rotation` (m/rad) are the derivatives of the gap, world axes.
    #[inline]
    pub fn scaled_row(&self, translation: &Vec3, rotation: &Vec3) -> [f64; 6] {
        match &self.bent {
            None => {
                let (n, m) = (translation / self.roots.0, rotation / self.roots.1);
                [n.x, n.y, n.z, m.x, m.y, m.z]
            }
            Some(bent) => {
                let (n, m) = (translation, rotation);
                bent.forward([n.x, n.y, n.z, m.x, m.y, m.z])
            }
        }
    }

    /// Returns translation of the working point (metres) and rotation vector (radians), world axes, of the scaled step
    /// `y` (sqrt(J)).
    pub fn step(&self, y: &[f64; 6]) -> (Vec3, Vec3) {
        match &self.bent {
            None => (
                Vec3::new(y[0], y[1], y[2]) / self.roots.0,
                Vec3::new(y[3], y[4], y[5]) / self.roots.1,
            ),
            Some(bent) => {
                let x = bent.backward(*y);
                (Vec3::new(x[0], x[1], x[2]), Vec3::new(x[3], x[4], x[5]))
            }
        }
    }

    /// Whether the force that the added curvature contributes over the step `v` (metres), `w` (radians) is within
    /// [`SETTLED`]. True without added curvature.
    pub fn settled(&self, v: &Vec3, w: &Vec3) -> bool {
        let Some(bent) = &self.bent else {
            return true;
        };
        let step = [v.x, v.y, v.z, w.x, w.y, w.z];
        let force = |k: usize| crate::optimise::dot6(&bent.added[k], &step);
        let added = norm(&Vec3::new(force(0), force(1), force(2)));
        added <= SETTLED.0 * self.force + SETTLED.1
    }
}

impl Bent {
    /// Solves `L x = b` for the factor `L`; `x` holds `b` on entry.
    fn forward(&self, mut x: [f64; 6]) -> [f64; 6] {
        for i in 0..6 {
            for k in 0..i {
                x[i] -= self.factor[i][k] * x[k];
            }
            x[i] /= self.factor[i][i];
        }
        x
    }

    /// Solves `L' x = b` for the factor `L`; `x` holds `b` on entry.
    fn backward(&self, mut x: [f64; 6]) -> [f64; 6] {
        for i in (0..6).rev() {
            for k in i + 1..6 {
                x[i] -= self.factor[k][i] * x[k];
            }
            x[i] /= self.factor[i][i];
        }
        x
    }
}
