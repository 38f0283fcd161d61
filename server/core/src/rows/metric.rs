//! The quadratic form that a pass minimises, and the coordinates in which it is the identity.
//!
//! It is the coupling `G = diag(k_t, k_r)`. Where a tool presses on a blended surface that bends
//! inwards, the second derivative of that constraint times the press is added (the Hessian of the
//! Lagrangian, as in sequential quadratic programming; Nocedal and Wright 2006, chapter 18). Only the
//! step is changed: at its end, where the step is nothing, the forces are those of the coupling.

use crate::math::{Mat3, Vec3, norm};
use crate::scene::tool::Tool;

/// Share of the force, and newtons, up to which what the bend adds does not count.
const SETTLED: (f64, f64) = (2e-3, 2e-5);

/// Metric of one tool, about its working point, world axes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Metric {
    stiffness: (f64, f64),
    roots: (f64, f64),
    /// What was added to the coupling; none mostly.
    bent: Option<Bent>,
    /// Force of the coupling at the beginning of the pass, newtons.
    force: f64,
}

#[derive(Clone, Copy, Debug)]
struct Bent {
    /// Added to the coupling: translation, then rotation.
    added: [[f64; 6]; 6],
    /// Lower Cholesky factor of the whole.
    factor: [[f64; 6]; 6],
}

impl Metric {
    /// For a tool that is not there.
    pub const UNIT: Metric = Metric {
        stiffness: (1.0, 1.0),
        roots: (1.0, 1.0),
        bent: None,
        force: 0.0,
    };

    /// The coupling.
    pub fn of(tool: &Tool) -> Self {
        let stiffness = (tool.stiffness_n_per_m, tool.stiffness_nm_per_rad);
        Self {
            stiffness,
            roots: (stiffness.0.sqrt(), stiffness.1.sqrt()),
            bent: None,
            force: 0.0,
        }
    }

    /// Adds the stiffness `hollow` (N/m, symmetric, positive semi-definite) of a point at `arm` from the
    /// working point.
    pub fn add(&mut self, hollow: &Mat3, arm: &Vec3) {
        let mut added = self.bent.map_or([[0.0; 6]; 6], |bent| bent.added);
        // The point moves by v + w x arm = v - [arm] w.
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
                // Adding to a positive definite matrix what is not negative leaves it so.
                factor[i][j] = if i == j {
                    entry.sqrt()
                } else {
                    entry / factor[j][j]
                };
            }
        }
        self.bent = Some(Bent { added, factor });
    }

    /// The step to the hand, `v` (metres) and `w` (radians), in coordinates in which the metric is the
    /// identity: where the pass would end without contact.
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

    /// A row in those coordinates: derivative of a gap by translation and by rotation.
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

    /// Translation (metres) and rotation vector (radians) from those coordinates.
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

    /// Whether what the bend adds to the forces over this step is too little to matter.
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
    /// `L x = b`.
    fn forward(&self, mut x: [f64; 6]) -> [f64; 6] {
        for i in 0..6 {
            for k in 0..i {
                x[i] -= self.factor[i][k] * x[k];
            }
            x[i] /= self.factor[i][i];
        }
        x
    }

    /// `L' x = b`.
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
