//! Shapes made of exact spheres, no mesh and no fit, so that every answer is known: for hard cases,
//! tests and benches. World axes, metres; every shape's reference is said at its function.

use sulcus_core::tissue::TissueModel;
use sulcus_core::tree::MAX_LEVEL;
use sulcus_core::{DisplayMesh, Object, Pose, Quat, Sphere, SphereTree, Tool, TreeError, Vec3};

use crate::mesh::TriMesh;
use crate::shapes::icosphere;

/// Radius of the simple probe's tip, metres: that of a UNC-15 probe.
pub const TIP_RADIUS: f64 = 0.25e-3;
/// Distance from the simple probe's device point to its tip, metres.
pub const REACH: f64 = 0.09;

const SHAPE_COLOUR: [u8; 4] = [200, 196, 186, 255];
const TOOL_COLOUR: [u8; 4] = [176, 182, 188, 255];

/// A rigid object of exactly these spheres.
///
/// # Errors
/// If there is no sphere, or one is not finite and positive.
pub fn object(name: &str, spheres: &[Sphere]) -> Result<Object, TreeError> {
    Ok(Object {
        name: name.to_owned(),
        fdi: 0,
        tree: SphereTree::over_leaves(spheres)?,
        // Leaves lie at several depths; all of them are the shape.
        level: MAX_LEVEL,
        tissue: TissueModel::Rigid,
        mesh: balls(spheres, SHAPE_COLOUR),
    })
}

/// A horizontal plate one sphere thick about the origin, in the plane z = 0: `half_x` by `half_y` are
/// the distances from the origin to the outermost centres.
///
/// # Errors
/// If a size is not finite and positive.
pub fn plate(half_x: f64, half_y: f64, sphere_radius: f64, spacing: f64) -> Result<Object, TreeError> {
    let spheres: Vec<Sphere> = sheet(half_x, half_y, spacing)
        .map(|(x, y)| Sphere { centre: Vec3::new(x, y, 0.0), radius: sphere_radius })
        .collect();
    object("plate", &spheres)
}

/// Two plates that meet in the line x = z = 0 (along y) and open upwards by `angle` (radians, between
/// the planes of their centres): a V. Each is `depth` long from the line and `2 half_y` wide.
///
/// # Errors
/// If a size is not finite and positive.
pub fn wedge(angle: f64, depth: f64, half_y: f64, sphere_radius: f64, spacing: f64) -> Result<Object, TreeError> {
    let (sine, cosine) = (libm::sin(0.5 * angle), libm::cos(0.5 * angle));
    let spheres: Vec<Sphere> = sheet(0.5 * depth, half_y, spacing)
        .flat_map(|(along, y)| {
            let along = along + 0.5 * depth;
            [-1.0, 1.0].map(|side| Sphere {
                centre: Vec3::new(side * along * sine, y, along * cosine),
                radius: sphere_radius,
            })
        })
        .collect();
    object("wedge", &spheres)
}

/// A sharp ridge along y: a roof of two sheets that fall from the line x = z = 0 by `slope` (radians
/// below the horizontal), made of small spheres.
///
/// # Errors
/// If a size is not finite and positive.
pub fn edge(slope: f64, depth: f64, half_y: f64, sphere_radius: f64, spacing: f64) -> Result<Object, TreeError> {
    let (sine, cosine) = (libm::sin(slope), libm::cos(slope));
    let spheres: Vec<Sphere> = sheet(0.5 * depth, half_y, spacing)
        .flat_map(|(along, y)| {
            let along = along + 0.5 * depth;
            [-1.0, 1.0].map(|side| Sphere {
                centre: Vec3::new(side * along * cosine, y, -along * sine),
                radius: sphere_radius,
            })
        })
        .collect();
    object("edge", &spheres)
}

/// A round hole for a peg: rings of spheres around the z axis, from z = 0 down to `-depth`, with a
/// floor. The spheres leave a bore of radius `hole_radius`.
///
/// # Errors
/// If a size is not finite and positive.
pub fn peg_hole(hole_radius: f64, depth: f64, sphere_radius: f64, spacing: f64) -> Result<Object, TreeError> {
    let ring = hole_radius + sphere_radius;
    let around = (std::f64::consts::TAU * ring / spacing).ceil().clamp(3.0, 2e3) as usize;
    let down = (depth / spacing).ceil().clamp(0.0, 2e3) as usize;
    let mut spheres = Vec::with_capacity(around * (down + 1));
    for layer in 0..=down {
        let z = -depth * layer as f64 / down.max(1) as f64;
        spheres.extend((0..around).map(|k| {
            let angle = std::f64::consts::TAU * k as f64 / around as f64;
            Sphere { centre: Vec3::new(ring * libm::cos(angle), ring * libm::sin(angle), z), radius: sphere_radius }
        }));
    }
    // The floor's tops are level with -depth.
    let floor = sheet(ring, ring, spacing)
        .filter(|(x, y)| x * x + y * y <= ring * ring)
        .map(|(x, y)| Sphere { centre: Vec3::new(x, y, -depth - sphere_radius), radius: sphere_radius });
    spheres.extend(floor);
    object("peg hole", &spheres)
}

/// A straight probe with the frame conventions of [`crate::parametric::Probe`]: the device point is
/// the origin, the tip [`REACH`] below it, a working end of 15 mm of spheres of [`TIP_RADIUS`] every
/// 0.2 mm, the reference point 4 mm above the tip. It parks 30 mm above the origin.
///
/// # Errors
/// Never in practice; the tree is checked like any other.
pub fn simple_probe() -> Result<Tool, TreeError> {
    let tip = Vec3::new(0.0, 0.0, -REACH);
    let spheres: Vec<Sphere> = (0..=74)
        .map(|k| Sphere {
            centre: tip + Vec3::new(0.0, 0.0, TIP_RADIUS + 0.2e-3 * f64::from(k)),
            radius: TIP_RADIUS,
        })
        .collect();
    Ok(Tool {
        name: "simple probe".to_owned(),
        tree: SphereTree::over_leaves(&spheres)?,
        level: MAX_LEVEL,
        working_point: tip + Vec3::new(0.0, 0.0, 4e-3),
        tip,
        tip_axis: -Vec3::z(),
        stiffness_n_per_m: 500.0,
        stiffness_nm_per_rad: 0.5,
        park: Pose::new(Vec3::new(0.0, 0.0, REACH + 0.03), Quat::identity()),
        bands: crate::parametric::Probe::default().bands(),
        mesh: balls(&spheres, TOOL_COLOUR),
    })
}

/// Points of a grid about the origin, at most `spacing` apart, its border included.
fn sheet(half_x: f64, half_y: f64, spacing: f64) -> impl Iterator<Item = (f64, f64)> {
    let count = |half: f64| (2.0 * half / spacing).ceil().clamp(0.0, 2e3) as usize;
    let (nx, ny) = (count(half_x), count(half_y));
    let at = |half: f64, k: usize, n: usize| if n == 0 { 0.0 * half } else { half * (2.0 * k as f64 / n as f64 - 1.0) };
    (0..=nx).flat_map(move |i| (0..=ny).map(move |j| (at(half_x, i, nx), at(half_y, j, ny))))
}

/// Icosahedra to look at.
fn balls(spheres: &[Sphere], colour: [u8; 4]) -> DisplayMesh {
    let unit = icosphere(1.0, 0);
    let mut mesh = TriMesh::default();
    for sphere in spheres {
        let base = mesh.vertices.len() as u32;
        mesh.vertices.extend(unit.vertices.iter().map(|v| sphere.centre + v * sphere.radius));
        mesh.triangles.extend(unit.triangles.iter().map(|t| t.map(|v| v + base)));
    }
    mesh.to_display(colour)
}

#[cfg(test)]
mod tests {
    use super::*;
    use sulcus_core::{Params, Scene};

    fn gap(object: &Object, p: &Vec3) -> f64 {
        object
            .tree
            .shape_at(object.level)
            .map(|(_, node)| (p - node.centre).norm() - node.contact_radius)
            .fold(f64::INFINITY, f64::min)
    }

    #[test]
    fn shapes_are_where_they_are_said_to_be() {
        let plate = plate(4e-3, 3e-3, 0.25e-3, 0.3e-3).expect("plate");
        assert!((gap(&plate, &Vec3::new(4e-3, 3e-3, 1e-3)) - 0.75e-3).abs() < 1e-12);
        let wedge = wedge(1.0, 6e-3, 3e-3, 0.25e-3, 0.3e-3).expect("wedge");
        assert!(gap(&wedge, &Vec3::new(0.0, 0.0, 4e-3)) > 1e-3 && gap(&wedge, &Vec3::zeros()) < 0.0);
        let edge = edge(0.8, 4e-3, 3e-3, 0.05e-3, 0.06e-3).expect("edge");
        assert!((gap(&edge, &Vec3::new(0.0, 3e-3, 1e-3)) - 0.95e-3).abs() < 1e-12);
        let hole = peg_hole(0.3e-3, 4e-3, 0.2e-3, 0.15e-3).expect("hole");
        for z in [-0.001, -0.002, -0.003] {
            assert!((gap(&hole, &Vec3::new(0.0, 0.0, z)) - 0.3e-3).abs() < 0.02e-3);
        }
        assert!((gap(&hole, &Vec3::new(0.0, 0.0, -3.9e-3)) - 0.1e-3).abs() < 0.02e-3);
    }

    #[test]
    fn they_make_a_valid_scene() {
        let scene = Scene {
            name: "hard".into(),
            source_hash: String::new(),
            params: Params::default(),
            tools: vec![simple_probe().expect("probe")],
            objects: vec![plate(4e-3, 4e-3, 0.25e-3, 0.3e-3).expect("plate")],
        };
        scene.validate().expect("valid");
        let tool = &scene.tools[0];
        let lowest = tool.tree.shape_at(tool.level).map(|(_, n)| n.centre.z - n.contact_radius).fold(0.0, f64::min);
        assert!((lowest - tool.tip.z).abs() < 1e-12);
    }

    #[test]
    fn nonsense_is_an_error_not_a_panic() {
        assert!(plate(f64::NAN, 1e-3, 1e-4, 1e-4).is_err());
        assert!(plate(1e-3, 1e-3, -1.0, 1e-4).is_err());
        assert!(wedge(f64::INFINITY, 1e-3, 1e-3, 1e-4, 1e-4).is_err());
        assert!(object("nothing", &[]).is_err());
    }
}
