//! Analytic scenes for the hard cases: exact spheres without a mesh, with known answers. World axes, metres.

use sulcus_core::tissue::TissueModel;
use sulcus_core::{
    Blending, DisplayMesh, Object, Params, Pose, Quat, Scene, Sphere, SphereTree, Tool, Vec3,
};

/// Level of detail at which all spheres of a shape are leaves.
const ALL: u8 = sulcus_core::tree::MAX_LEVEL;

/// Radius of the rod's spheres, metres: that of a periodontal probe's tip.
pub const TIP_RADIUS: f64 = 2.5e-4;
/// Distance of the rod's tip centre below its device point, metres.
pub const TIP_BELOW_DEVICE: f64 = 0.09;

/// A straight probe of 15 mm of spheres, with its device point 90 mm above the centre of its tip.
pub fn rod() -> Tool {
    let centre = |k: i32| Vec3::new(0.0, 0.0, -TIP_BELOW_DEVICE + 2.5e-4 * f64::from(k));
    let spheres: Vec<Sphere> = (0..61)
        .map(|k| Sphere {
            centre: centre(k),
            radius: TIP_RADIUS,
        })
        .collect();
    Tool {
        name: "rod".into(),
        tree: tree(&spheres),
        level: ALL,
        working_point: Vec3::new(0.0, 0.0, -TIP_BELOW_DEVICE + 4e-3),
        tip: Vec3::new(0.0, 0.0, -TIP_BELOW_DEVICE - TIP_RADIUS),
        tip_axis: -Vec3::z(),
        stiffness_n_per_m: 500.0,
        stiffness_nm_per_rad: 0.5,
        park: Pose::new(
            Vec3::new(0.0, 0.0, TIP_BELOW_DEVICE + 0.03),
            Quat::identity(),
        ),
        bands: Vec::new(),
        mesh: DisplayMesh::default(),
    }
}

/// Device position that puts the centre of the rod's tip at `tip`, the rod upright.
pub fn device_over(tip: Vec3) -> Vec3 {
    tip + Vec3::new(0.0, 0.0, TIP_BELOW_DEVICE)
}

/// Scene of the rod and `objects`.
pub fn scene(name: &str, objects: Vec<Object>) -> Scene {
    Scene {
        name: name.into(),
        source_hash: String::new(),
        params: Params::default(),
        tools: vec![rod()],
        objects,
    }
}

fn tree(spheres: &[Sphere]) -> SphereTree {
    SphereTree::over_leaves(spheres).expect("analytic spheres are finite and positive")
}

fn object(name: &str, spheres: &[Sphere]) -> Object {
    Object {
        name: name.into(),
        fdi: 0,
        tree: tree(spheres),
        level: ALL,
        tissue: TissueModel::Rigid,
        mesh: DisplayMesh::default(),
        carriers: Vec::new(),
    }
}

/// Points of a square grid of side `2 half` in the plane z = 0.
fn grid(half: f64, spacing: f64) -> impl Iterator<Item = Vec3> {
    let n = (half / spacing).round() as i32;
    (-n..=n).flat_map(move |i| {
        (-n..=n).map(move |j| Vec3::new(f64::from(i) * spacing, f64::from(j) * spacing, 0.0))
    })
}

/// A horizontal plate one sphere thick, 0.5 mm, about 8 mm wide, centred at the origin.
pub fn thin_plate() -> Object {
    plate(TIP_RADIUS)
}

/// A horizontal plate of one layer of spheres of `radius` metres, about 8 mm wide, centred at the origin.
pub fn plate(radius: f64) -> Object {
    let spheres: Vec<_> = grid(4e-3, 0.8 * radius)
        .map(|centre| Sphere { centre, radius })
        .collect();
    object("plate", &spheres)
}

/// Two upright plates along y, from z = 0 down 4.65 mm, with their faces `half` metres to each side of the middle.
pub fn slot(half: f64) -> Object {
    const RADIUS: f64 = 3e-4;
    let sides = [-1.0, 1.0].map(|side| {
        grid(4e-3, 1.5e-4).filter_map(move |p| {
            let centre = Vec3::new(side * (half + RADIUS), p.y, p.x - RADIUS);
            (p.x <= 0.0).then_some(Sphere {
                centre,
                radius: RADIUS,
            })
        })
    });
    let spheres: Vec<Sphere> = sides.into_iter().flatten().collect();
    object("slot", &spheres)
}

/// A round hole of `radius` metres along z, from z = 0 down 5.3 mm, in a collar of spheres.
pub fn hole(radius: f64) -> Object {
    const WALL: f64 = 2e-4;
    let mut spheres = Vec::new();
    for ring in 0..50 {
        for k in 0..24 {
            let angle = f64::from(k) * std::f64::consts::TAU / 24.0;
            let (sine, cosine) = (libm::sin(angle), libm::cos(angle));
            let off = radius + WALL;
            spheres.push(Sphere {
                centre: Vec3::new(off * cosine, off * sine, -1e-4 * f64::from(ring) - WALL),
                radius: WALL,
            });
        }
    }
    object("hole", &spheres)
}

/// An upright post of 1 mm radius and 10 mm height about `centre`.
pub fn post(centre: Vec3) -> Object {
    let spheres: Vec<Sphere> = (-50..=50)
        .map(|k| Sphere {
            centre: centre + Vec3::new(0.0, 0.0, 1e-4 * f64::from(k)),
            radius: 1e-3,
        })
        .collect();
    object("post", &spheres)
}

/// A plate like [`thin_plate`], but 50 mm wide, so that no tool passes beside it.
pub fn wide_plate() -> Object {
    let spheres: Vec<_> = grid(25e-3, 3e-4)
        .map(|centre| Sphere {
            centre,
            radius: TIP_RADIUS,
        })
        .collect();
    object("wide plate", &spheres)
}

/// A tool with a flat face of 12 by 12 spheres over an equal face. Each sphere can settle between four others.
pub fn flat_on_flat() -> Scene {
    faces(12)
}

/// A tool with a flat face of `side` by `side` spheres over an equal face.
pub fn faces(side: u32) -> Scene {
    let face = |z: f64| {
        let middle = 1.5e-4 * f64::from(side - 1);
        (0..side * side).map(move |k| Sphere {
            centre: Vec3::new(
                f64::from(k % side) * 3e-4 - middle,
                f64::from(k / side) * 3e-4 - middle,
                z,
            ),
            radius: 2e-4,
        })
    };
    let mut scene = scene(
        "flat on flat",
        vec![object("face", &face(0.0).collect::<Vec<_>>())],
    );
    scene.tools[0].tree = tree(&face(-TIP_BELOW_DEVICE).collect::<Vec<_>>());
    scene
}

/// A V of two plates along y that open upwards, 15 degrees to each side of the vertical. The rod jams at its own width.
pub fn wedge() -> Object {
    let (sine, cosine) = (libm::sin(0.2618), libm::cos(0.2618));
    let mut spheres = Vec::new();
    for side in [-1.0, 1.0] {
        for p in grid(3e-3, 2.5e-4) {
            // p.x runs up the plate from the bottom of the V.
            let up = p.x + 3e-3;
            let out = up * sine + 3e-4 * cosine;
            spheres.push(Sphere {
                centre: Vec3::new(side * out, p.y, up * cosine),
                radius: 3e-4,
            });
        }
    }
    object("wedge", &spheres)
}

/// A groove along y whose walls rise by `slope` radians to both sides. Its spheres of 0.5 mm radius are blended and
/// inset, so that the tip feels two planes.
pub fn groove(slope: f64) -> Object {
    const RADIUS: f64 = 5e-4;
    const SPACING: f64 = 2.5e-4;
    const BLEND: f64 = 3e-5;
    let mut spheres = Vec::new();
    for side in [-1.0, 1.0] {
        let (sine, cosine) = (libm::sin(slope), libm::cos(slope));
        for p in grid(4e-3, SPACING) {
            // p.x runs up the wall. The face is one radius above the centres.
            let up = p.x + 4e-3;
            spheres.push(Sphere {
                centre: Vec3::new(
                    side * (up * cosine + RADIUS * sine),
                    p.y,
                    up * sine - RADIUS * cosine,
                ),
                radius: RADIUS,
            });
        }
    }
    // The inset of a plane lattice is known.
    let height = RADIUS + TIP_RADIUS;
    let sum: f64 = grid(2e-3, SPACING)
        .map(|p| libm::exp((height - (height * height + p.norm_squared()).sqrt()) / BLEND))
        .sum();
    let inset = BLEND * libm::log(sum);
    let mut groove = object("groove", &spheres);
    let blending = Blending {
        lengths: vec![BLEND; usize::from(groove.tree.depth()) + 1],
        insets: groove
            .tree
            .nodes()
            .iter()
            .map(|node| if node.children == 0 { inset } else { 0.0 })
            .collect(),
    };
    groove.tree = groove
        .tree
        .with_blending(blending)
        .expect("one inset for each sphere, smaller than it");
    groove
}

/// A ridge along y: a row of spheres of 0.1 mm radius on top of a wall, sharper than the tip.
pub fn sharp_edge() -> Object {
    let mut spheres = Vec::new();
    for j in -50..=50 {
        for k in 0..20 {
            spheres.push(Sphere {
                centre: Vec3::new(0.0, f64::from(j) * 1e-4, f64::from(k) * -1e-4),
                radius: 1e-4,
            });
        }
    }
    object("edge", &spheres)
}
