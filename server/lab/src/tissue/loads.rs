//! Tractions on an organ's surface, as forces on the nodes of its finite elements and on the vertices of its surface.

use sulcus_core::Vec3;

use super::organ::Organ;

/// Each face is integrated over so many parts of each edge.
const PARTS: usize = 6;

/// A traction: everywhere along one direction, with a weight by place.
pub(crate) struct Traction {
    /// Name, for people.
    pub(crate) name: String,
    /// Consistent forces on the nodes of the quadratic elements, newtons.
    pub(crate) on_nodes: Vec<Vec3>,
    /// The same traction lumped to the vertices of the surface, newtons.
    pub(crate) on_vertices: Vec<Vec3>,
}

/// The traction `weight(place, outward normal) direction` of one newton in all; none where nothing that can move is loaded.
/// What acts on held nodes goes into their support, and is kept in both lists.
pub(crate) fn traction(
    organ: &Organ,
    direction: &Vec3,
    weight: &dyn Fn(&Vec3, &Vec3) -> f64,
) -> Option<(Vec<Vec3>, Vec<Vec3>)> {
    let mut on_nodes = vec![0.0; organ.elements.nodes.len()];
    let mut on_vertices = vec![0.0; organ.nodes.len()];
    let mut total = 0.0;
    for (f, face) in organ.faces.iter().enumerate() {
        let c = organ.surface.corners(f);
        let area = organ.surface.area_vector(f);
        let normal = area.normalize();
        let part = 0.5 * area.norm() / (PARTS * PARTS) as f64;
        for l in middles() {
            let place = c[0] * l[0] + c[1] * l[1] + c[2] * l[2];
            let load = part * weight(&place, &normal);
            if load == 0.0 {
                continue;
            }
            total += load;
            for k in 0..3 {
                on_nodes[face.corners[k] as usize] += load * l[k] * (2.0 * l[k] - 1.0);
                on_nodes[face.middles[k] as usize] += load * 4.0 * l[k] * l[(k + 1) % 3];
                on_vertices[organ.vertex_of[&face.corners[k]]] += load * l[k];
            }
        }
    }
    let loaded: f64 = organ.free.iter().map(|&v| on_vertices[v]).sum();
    (loaded > 0.5 * total).then(|| {
        let along = |loads: Vec<f64>| loads.into_iter().map(|f| direction * (f / total)).collect();
        (along(on_nodes), along(on_vertices))
    })
}

/// Barycentric coordinates of the middles of a triangle's equal parts.
fn middles() -> impl Iterator<Item = [f64; 3]> {
    let n = PARTS as f64;
    let at = move |i: usize, j: usize, off: f64| {
        let (a, b) = ((i as f64 + off) / n, (j as f64 + off) / n);
        [1.0 - a - b, a, b]
    };
    (0..PARTS).flat_map(move |i| {
        let up = (0..PARTS - i).map(move |j| at(i, j, 1.0 / 3.0));
        let down = (0..(PARTS - i).saturating_sub(1)).map(move |j| at(i, j, 2.0 / 3.0));
        up.chain(down)
    })
}

/// A round patch: `(1 - (distance / radius)^2)^2` inside `radius` (metres), on faces that `faces` says.
pub(crate) fn patch(
    centre: Vec3,
    radius: f64,
    faces: impl Fn(&Vec3) -> bool,
) -> impl Fn(&Vec3, &Vec3) -> f64 {
    move |place, normal| {
        let q = (place - centre).norm_squared() / (radius * radius);
        if q < 1.0 && faces(normal) {
            (1.0 - q) * (1.0 - q)
        } else {
            0.0
        }
    }
}

/// All faces that look against `direction`, those askance less.
pub(crate) fn facing(direction: Vec3) -> impl Fn(&Vec3, &Vec3) -> f64 {
    move |_, normal| {
        let t = ((-normal.dot(&direction) - 0.2) / 0.3).clamp(0.0, 1.0);
        t * t * (3.0 - 2.0 * t)
    }
}

/// Training loads: round patches of 6 to 12 mm, some of 18 to 30 mm, at places of a low-discrepancy sequence over the surface that can move,
/// each along its inward normal and two tangents; and loads spread over all that faces a direction. The sequence (Roberts
/// 2018: multiples of powers of the root of x^4 = x + 1) knows the surface only.
pub(crate) fn training(organ: &Organ, patches: usize, spread: usize) -> Vec<Traction> {
    const STEPS: [f64; 3] = [
        0.819_172_513_396_164_4,
        0.671_043_606_703_789_2,
        0.549_700_477_901_970_1,
    ];
    let share = |k: usize| STEPS.map(|step| (0.5 + step * k as f64).fract());
    let free: Vec<bool> = (0..organ.nodes.len())
        .map(|v| organ.free.binary_search(&v).is_ok())
        .collect();
    let mut sum = 0.0;
    let areas: Vec<(usize, f64)> = (0..organ.faces.len())
        .filter(|&f| organ.surface.triangles[f].iter().all(|&v| free[v as usize]))
        .map(|f| {
            sum += organ.surface.area_vector(f).norm();
            (f, sum)
        })
        .collect();
    let mut all = Vec::new();
    let mut add = |name: String, direction: Vec3, weight: &dyn Fn(&Vec3, &Vec3) -> f64| {
        if let Some((on_nodes, on_vertices)) = traction(organ, &direction, weight) {
            all.push(Traction {
                name,
                on_nodes,
                on_vertices,
            });
        }
    };
    for k in 0..if areas.is_empty() { 0 } else { patches } {
        let [u, v, w] = share(k);
        let at = areas
            .partition_point(|(_, upto)| *upto < u * sum)
            .min(areas.len() - 1);
        let f = areas[at].0;
        let (a, b) = (v.sqrt(), (u * 977.0).fract());
        let c = organ.surface.corners(f);
        let centre = c[0] * (1.0 - a) + (c[1] * (1.0 - b) + c[2] * b) * a;
        let outward = organ.surface.area_vector(f).normalize();
        let radius = if k % 5 == 4 {
            18e-3 + 12e-3 * w
        } else {
            6e-3 + 6e-3 * w
        };
        let weight = patch(centre, radius, |normal| normal.dot(&outward) > 0.0);
        // Any axis that is not nearly the normal.
        let other = if outward.x.abs() < 0.8 {
            Vec3::x()
        } else {
            Vec3::y()
        };
        let tangent = outward.cross(&other).normalize();
        for (direction, along) in [
            (-outward, "in"),
            (tangent, "along"),
            (outward.cross(&tangent), "across"),
        ] {
            add(format!("patch {k} {along}"), direction, &weight);
        }
    }
    for k in 0..spread {
        let [u, v, _] = share(k);
        let (z, turn) = (2.0 * u - 1.0, std::f64::consts::TAU * v);
        let flat = (1.0 - z * z).sqrt();
        let direction = Vec3::new(flat * turn.cos(), flat * turn.sin(), z);
        add(format!("spread {k}"), direction, &facing(direction));
    }
    all
}

#[cfg(test)]
mod tests;
