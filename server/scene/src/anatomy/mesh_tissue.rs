//! Tissue model of a gingiva that is a mesh: data of each sphere, from the gingiva's tree and the tooth.

use sulcus_core::tissue::gingiva::{Gingiva, GingivaParams, Place, Prescribed, ToothFrame};
use sulcus_core::{Sphere, SphereTree, Vec3};

use crate::anatomy::molar_gingiva::SITES_DEG;
use crate::file::Pocket;
use crate::mesh::TriMesh;
use crate::mesh::distance::MeshDistance;
use crate::parallel;
use crate::tree::nearest_sphere::NearestSphere;

/// Number of angles of the margin.
const ANGLES: usize = 128;
/// Largest height of the centre of a floor sphere over the floor, metres. A higher sphere is the foot of a wall.
const FLOOR_TOP: f64 = 3e-4;
/// Largest distance of floor vertices from the floor's height, metres.
const FLOOR_BAND: f64 = 1.5e-4;

/// Reach of the proximal zones of a [`Pocket`], degrees.
///
/// The pocket's floor runs smoothly from site to site. With mid zones as narrow as this, no place in them is over 0.1
/// mm deeper than prescribed, at the default depths.
pub const POCKET_PROXIMAL_DEG: f64 = 80.0;

/// Surroundings of one tooth, in world axes, metres.
#[derive(Clone, Copy)]
pub struct Surrounding<'a> {
    /// The tooth's surface.
    pub tooth: &'a MeshDistance,
    /// Frame of the tooth.
    pub frame: ToothFrame,
    /// The gingiva's surface.
    pub mesh: &'a TriMesh,
    /// Height of the floor at rest over the frame's origin at an angle (radians from mesial over buccal).
    pub floor: &'a (dyn Fn(f64) -> f64 + Sync),
    /// Width of the pocket at rest.
    pub width: f64,
    /// Reach of the proximal zones from the midlines, radians.
    pub proximal: f64,
    /// Prescription of each site, in the order of `Site::ALL`.
    pub sites: [Prescribed; 6],
}

/// Returns the model of a gingiva whose tree is in contact at `level`.
pub fn model(
    tree: &SphereTree,
    level: u8,
    params: GingivaParams,
    around: &Surrounding<'_>,
) -> Gingiva {
    let floor = floor_nodes(tree, around);
    let nodes = tree.nodes();
    let mut places = parallel::map(nodes.len(), |k| {
        let mut place = place(&nodes[k].sphere(), floor[k], around);
        place.floor &= place.height < FLOOR_TOP;
        // Spheres under the floor also bear the tip when the floor is pressed far down or aside.
        place.floor |= place.height < 0.0;
        place
    });
    for level in 0..=tree.depth() {
        let ids: Vec<usize> = tree.shape_at(level).map(|(id, _)| id as usize).collect();
        let lengths = parallel::map(ids.len(), |k| spread(&places, &ids, ids[k]));
        for (id, length) in ids.iter().zip(lengths) {
            places[*id].spread = length;
        }
    }
    Gingiva {
        params,
        tooth: around.frame,
        margin: margin(around.mesh, &around.frame),
        proximal: around.proximal,
        sites: around.sites,
        places,
        level,
    }
}

/// Returns the prescriptions at the sites of a pocket that is given by six depths.
///
/// The tooth's cemento-enamel junction counts as flat, at the height of the frame's origin. Sites bleed if the tissue
/// is inflamed at all.
pub fn charted(pocket: &Pocket, params: &GingivaParams) -> [Prescribed; 6] {
    let site = |k: usize| {
        let cosine = libm::cos(SITES_DEG[k].to_radians());
        let scallop = cosine * cosine * cosine * cosine;
        let margin = pocket.margin_mm + (pocket.papilla_mm - pocket.margin_mm) * scallop;
        Prescribed {
            depth: pocket.depths_mm[k] * 1e-3,
            recession: -margin * 1e-3,
            bleeds: params.inflammation > 0.0,
        }
    };
    std::array::from_fn(site)
}

fn place(sphere: &Sphere, floor: bool, around: &Surrounding<'_>) -> Place {
    let (centre, frame) = (&sphere.centre, &around.frame);
    let (_, away) = tooth_beside(centre, around);
    let (angle, height) = frame.cylindrical(centre);
    let over = height - (around.floor)(angle);
    // Middle of the pocket beside the sphere, or over it if it lies under the floor.
    let beside = centre + frame.axis * (-over).max(0.0);
    let (surface, out) = tooth_beside(&beside, around);
    let to_pocket = surface + out * (0.5 * around.width) - centre;
    let share = (sphere.radius / to_pocket.norm()).min(1.0);
    Place {
        away,
        on_surface: centre + to_pocket * share,
        // Set below by `spread`.
        spread: 0.0,
        height: over,
        floor,
    }
}

/// Returns the tooth's nearest surface point, and the unit vector away from the tooth, across its axis.
fn tooth_beside(point: &Vec3, around: &Surrounding<'_>) -> (Vec3, Vec3) {
    let frame = &around.frame;
    let nearest = around.tooth.nearest(point);
    let across = |v: Vec3| v - frame.axis * v.dot(&frame.axis);
    // For a point inside the tooth the nearest surface point lies outwards.
    let from_surface = across(point - nearest.point) * nearest.signed.signum();
    let from_axis = across(point - frame.origin);
    let away = [from_surface, from_axis, frame.mesial]
        .into_iter()
        .find(|v| v.norm() > 1e-6)
        .unwrap_or(frame.mesial)
        .normalize();
    // The second projection removes rounding along the axis.
    (nearest.point, across(away).normalize())
}

/// Returns the length of wall of the node `id`: the distance to its nearest neighbour among `ids`, the nodes of its
/// level.
///
/// The floor has no length. Its compliance depends on the tip alone.
fn spread(places: &[Place], ids: &[usize], id: usize) -> f64 {
    let place = &places[id];
    if place.floor {
        return 0.0;
    }
    let others = ids.iter().filter(|&&other| other != id);
    let nearest = others.fold(f64::INFINITY, |nearest, &other| {
        nearest.min((places[other].on_surface - place.on_surface).norm())
    });
    if nearest.is_finite() { nearest } else { 0.0 }
}

/// Returns the floor nodes: at each level those nearest to the vertices of the mesh's floor.
fn floor_nodes(tree: &SphereTree, around: &Surrounding<'_>) -> Vec<bool> {
    let bottom: Vec<Vec3> = {
        let vertices = &around.mesh.vertices;
        let on_floor = parallel::map(vertices.len(), |v| {
            let (angle, height) = around.frame.cylindrical(&vertices[v]);
            (height - (around.floor)(angle)).abs() < FLOOR_BAND
                && (0.0..0.9 * around.width).contains(&around.tooth.signed(&vertices[v]))
        });
        let pairs = vertices.iter().zip(on_floor);
        pairs.filter(|(_, on)| *on).map(|(v, _)| *v).collect()
    };
    let mut floor = vec![false; tree.nodes().len()];
    for level in 0..=tree.depth() {
        let (ids, spheres): (Vec<u32>, Vec<_>) = tree
            .shape_at(level)
            .map(|(id, node)| (id, node.sphere()))
            .unzip();
        let index = NearestSphere::new(&spheres);
        for vertex in &bottom {
            floor[ids[index.nearest(vertex, None).1 as usize] as usize] = true;
        }
    }
    floor
}

/// Returns the height of a collar's crest at equal angles: the highest point of the mesh in the half plane at that
/// angle.
fn margin(mesh: &TriMesh, frame: &ToothFrame) -> Vec<f64> {
    let seen: Vec<[f64; 3]> = parallel::map(mesh.vertices.len(), |v| {
        let from = mesh.vertices[v] - frame.origin;
        [&frame.mesial, &frame.buccal, &frame.axis].map(|axis| from.dot(axis))
    });
    parallel::map(ANGLES, |k| {
        let angle = 2.0 * std::f64::consts::PI * k as f64 / ANGLES as f64;
        let (cosine, sine) = (libm::cos(angle), libm::sin(angle));
        let (along, side) = (
            |p: &[f64; 3]| p[0] * cosine + p[1] * sine,
            |p: &[f64; 3]| p[1] * cosine - p[0] * sine,
        );
        let mut highest = f64::NEG_INFINITY;
        for triangle in &mesh.triangles {
            let corners = triangle.map(|v| seen[v as usize]);
            for e in 0..3 {
                let (a, b) = (&corners[e], &corners[(e + 1) % 3]);
                let (sa, sb) = (side(a), side(b));
                if (sa < 0.0) == (sb < 0.0) {
                    continue;
                }
                let share = sa / (sa - sb);
                if along(a) + share * (along(b) - along(a)) > 0.0 {
                    let height = a[2] + share * (b[2] - a[2]);
                    highest = if height > highest { height } else { highest };
                }
            }
        }
        // A collar has a crest all round. A missing one is replaced by the height of the tooth's origin.
        if highest.is_finite() { highest } else { 0.0 }
    })
}
