//! Small scene: two balls as tools over a plate of spheres. World axes, metres.

use sulcus_core::tissue::TissueModel;
use sulcus_core::{DisplayMesh, Object, Params, Pose, Quat, Scene, Sphere, SphereTree, Tool, Vec3};

/// Radius of a ball, metres.
const BALL: f64 = 1e-3;
/// Radius of the plate's spheres, metres. Their centres are at the height 0.
const PLATE: f64 = 5e-4;
/// Number of spheres along half a side of the plate.
const HALF: i32 = 6;
/// Level of detail at which all spheres are leaves.
const ALL: u8 = sulcus_core::tree::MAX_LEVEL;

/// Height of a ball's centre in contact with the plate, metres.
pub const CONTACT: f64 = BALL + PLATE;

/// Returns the scene.
pub fn small() -> Scene {
    let spheres: Vec<Sphere> = (-HALF..=HALF)
        .flat_map(|i| (-HALF..=HALF).map(move |j| (i, j)))
        .map(|(i, j)| Sphere {
            centre: Vec3::new(f64::from(i), f64::from(j), 0.0) * (0.8 * PLATE),
            radius: PLATE,
        })
        .collect();
    Scene {
        name: "two balls over a plate".into(),
        source_hash: String::new(),
        params: Params::default(),
        tools: ["left", "right"].map(ball).into(),
        objects: vec![Object {
            name: "plate".into(),
            fdi: 0,
            tree: tree(&spheres),
            level: ALL,
            tissue: TissueModel::Rigid,
            mesh: DisplayMesh::default(),
            carriers: Vec::new(),
        }],
    }
}

fn ball(name: &str) -> Tool {
    Tool {
        name: name.into(),
        tree: tree(&[Sphere {
            centre: Vec3::zeros(),
            radius: BALL,
        }]),
        level: ALL,
        working_point: Vec3::zeros(),
        tip: Vec3::zeros(),
        tip_axis: -Vec3::z(),
        stiffness_n_per_m: 500.0,
        stiffness_nm_per_rad: 0.5,
        park: Pose::new(Vec3::new(0.0, 0.0, 0.03), Quat::identity()),
        bands: Vec::new(),
        mesh: DisplayMesh::default(),
    }
}

fn tree(spheres: &[Sphere]) -> SphereTree {
    SphereTree::over_leaves(spheres).expect("spheres are finite and positive")
}
