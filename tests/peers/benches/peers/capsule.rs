//! The tool of both scenes: a capsule, its frame in its middle, its axis along y.

use sulcus_core::{DisplayMesh, Pose, Sphere, SphereTree, Tool, Vec3, tree};

/// A capsule and the spring that couples it with the hand.
#[derive(Clone, Copy, Debug)]
pub struct Capsule {
    /// Radius, metres.
    pub radius: f64,
    /// Between the spheres that stand for it, metres: what they are short of the capsule is `s^2 / 8 r`.
    pub spacing: f64,
    /// Stiffness of the spring against turning, N m/rad; none where the hand's turn is simply taken over.
    pub turning: Option<f64>,
}

/// Half of the axis, metres.
pub const HALF: f64 = 10e-3;
/// Stiffness of the spring, N/m.
pub const STIFFNESS: f64 = 900.0;
/// Points of the axis between which a depth is asked for: not those of the spheres.
const SAMPLES: i32 = 100;

impl Capsule {
    /// The tool of the tick. It waits where the hand begins.
    pub fn tool(&self, park: Pose) -> Tool {
        let count = (2.0 * HALF / self.spacing).round() as i32;
        let spheres: Vec<Sphere> = (0..=count)
            .map(|k| Sphere {
                centre: Vec3::y() * (2.0 * HALF * f64::from(k) / f64::from(count) - HALF),
                radius: self.radius,
            })
            .collect();
        Tool {
            name: "capsule".into(),
            tree: SphereTree::over_leaves(&spheres).expect("a row of spheres is a tree"),
            level: tree::MAX_LEVEL,
            working_point: Vec3::zeros(),
            tip: Vec3::y() * -(HALF + self.radius),
            tip_axis: -Vec3::y(),
            stiffness_n_per_m: STIFFNESS,
            // As stiff as a scene may be: a hundredth of a degree at what a press of 6 mm can turn it with.
            stiffness_nm_per_rad: self.turning.unwrap_or(1e3),
            park,
            bands: Vec::new(),
            mesh: DisplayMesh::default(),
        }
    }

    /// Points of its axis where it is, metres.
    pub fn axis(pose: &Pose) -> impl Iterator<Item = Vec3> + '_ {
        (0..=SAMPLES).map(|k| {
            pose.transform(&(Vec3::y() * (HALF * (2.0 * f64::from(k) / f64::from(SAMPLES) - 1.0))))
        })
    }

    /// How deep a point is inside of it, metres; negative outside.
    pub fn depth_of(&self, pose: &Pose, point: &Vec3) -> f64 {
        let inside = pose.inverse_transform(point);
        let along = inside.y.clamp(-HALF, HALF);
        self.radius - (inside - Vec3::y() * along).norm()
    }
}
