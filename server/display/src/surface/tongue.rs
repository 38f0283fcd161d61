//! Colours and finish of a tongue, by the shape of its mesh alone.
//!
//! The longest horizontal extent of the mesh is the tongue's length; its tip points forwards (x). The numbers are
//! chosen; studies give the body (L 49.5) and redder sides and tip.

use sulcus_core::math::{fclamp, fmax, fmin};
use sulcus_core::{DisplayMesh, Vec3};
use sulcus_proto::display::Finish;

use super::lab::{Lab, mix, srgb};
use super::noise::noise;

const BODY: Lab = [51.0, 24.0, 12.0];
const SIDES: Lab = [49.0, 30.0, 15.0];
const UNDERSIDE: Lab = [45.0, 33.0, 17.0];
const COATING: Lab = [64.0, 11.0, 8.0];
const VEIN: Lab = [42.0, 18.0, 4.0];
const FUNGIFORM: Lab = [48.0, 34.0, 16.0];
/// Largest share of the coating.
const COATED: f64 = 0.6;
/// Roughness of the back, the sides and the underside.
const ROUGH: [f64; 3] = [0.45, 0.22, 0.12];

/// Colour and finish of each vertex of a tongue's mesh, metres.
pub(crate) fn tongue(mesh: &DisplayMesh) -> (Vec<[u8; 4]>, Vec<Finish>) {
    let vertices: Vec<Vec3> = mesh
        .vertices
        .iter()
        .map(|v| Vec3::from(v.map(f64::from)) * 1e3)
        .collect();
    let (mut low, mut high) = (Vec3::repeat(f64::INFINITY), Vec3::repeat(f64::NEG_INFINITY));
    for v in &vertices {
        (low, high) = (low.zip_map(v, fmin), high.zip_map(v, fmax));
    }
    let normals = normals(mesh, &vertices);
    vertices
        .iter()
        .zip(&normals)
        .map(|(at, normal)| vertex(at, normal, &low, &high))
        .unzip()
}

fn vertex(at: &Vec3, normal: &Vec3, low: &Vec3, high: &Vec3) -> ([u8; 4], Finish) {
    let size = high - low;
    // 0 at the root, 1 at the tip.
    let along = (at.x - low.x) / fmax(size.x, 1e-9);
    let aside = 2.0 * (at.y - 0.5 * (low.y + high.y)).abs() / fmax(size.y, 1e-9);
    let back = ramp(normal.z, 0.15, 0.75);
    let under = ramp(-normal.z, 0.1, 0.6);
    let tip = ramp(along, 0.8, 1.0);
    let mut lab = mix(SIDES, BODY, back * (1.0 - 0.7 * tip));
    // The coating lies on the middle of the back and grows towards the root.
    let patches = 0.5 + 0.5 * noise(at, 6.0, 6) + 0.3 * noise(at, 2.0, 7);
    let where_coated = ramp(0.9 - aside, 0.0, 0.5) * ramp(0.85 - along, 0.0, 0.45);
    lab = mix(
        lab,
        COATING,
        COATED * fclamp(patches, 0.0, 1.0) * where_coated * back,
    );
    // Fungiform papillae are denser towards the tip.
    let spots = fclamp((noise(at, 1.6, 8) - 0.62) * 6.0, 0.0, 1.0);
    lab = mix(
        lab,
        FUNGIFORM,
        0.3 * spots * back * (0.25 + 0.75 * ramp(along, 0.4, 0.9)),
    );
    lab = mix(lab, UNDERSIDE, under);
    let vein = fmax(1.0 - (aside - 0.35).abs() / 0.12, 0.0);
    lab = mix(lab, VEIN, 0.6 * vein * under * ramp(along, 0.4, 0.6));
    lab[0] += 1.5 * noise(at, 5.0, 9);
    // The root runs into the dark of the throat.
    let dark = ramp(0.22 - along, 0.0, 0.22);
    lab = mix(lab, [9.0, 7.0, 4.0], dark);
    let rough = ROUGH[1] + (ROUGH[0] - ROUGH[1]) * back + (ROUGH[2] - ROUGH[1]) * under;
    let finish = Finish {
        roughness: (255.0 * fclamp(rough + 0.05 * noise(at, 2.5, 10), 0.0, 1.0)).round() as u8,
        stipple: 0,
        thin: 0,
    };
    (srgb(lab), finish)
}

fn ramp(x: f64, from: f64, to: f64) -> f64 {
    let t = fclamp((x - from) / (to - from), 0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// Unit normals of the vertices.
fn normals(mesh: &DisplayMesh, vertices: &[Vec3]) -> Vec<Vec3> {
    let mut sums = vec![Vec3::zeros(); vertices.len()];
    for triangle in &mesh.triangles {
        let [a, b, c] = triangle.map(|v| vertices[v as usize]);
        let area = (b - a).cross(&(c - a));
        for v in triangle {
            sums[*v as usize] += area;
        }
    }
    sums.iter()
        .map(|sum| sum / fmax(sum.norm(), 1e-12))
        .collect()
}
