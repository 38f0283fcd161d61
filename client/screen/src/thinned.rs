//! Thinned meshes: fewer triangles where a student sees no difference.
//!
//! meshoptimizer collapses edges by quadric errors (Garland and Heckbert 1997). Colour, normal, open share and blood
//! count as distances, and so do the weights of carriers: margins, places that bleed and places that move keep their
//! vertices. A kept
//! vertex has its place, its carriers and its normal of the whole mesh.
//!
//! All soft tissue is one mesh here: vertices of neighbouring objects at one place go together, and no gap opens.

use std::collections::BTreeMap;

use meshopt::{
    SimplifyOptions, simplify_scale_decoder, simplify_with_attributes_and_locks_decoder,
};

use crate::blood;
use crate::material::Material;
use crate::normals::Normals;
use crate::order;
use crate::stage::{Moving, Owner, Part, Stage};

/// Numbers of a vertex beside its place: normal, colour, open share, blood, carriers.
const FIELDS: usize = 9;
/// First number of the colour.
const COLOUR: usize = 3;
/// Differences of these numbers that count as much as the allowed distance. Chosen by pictures.
const SAME: [f32; FIELDS] = [0.25, 0.25, 0.25, 0.05, 0.05, 0.05, 0.12, 0.4, 0.2];

/// Largest distance of a thinned tool from the whole one, mm: a probe's end is half a millimetre thick.
const TOOL_MM: f32 = 0.05;
/// Difference of a colour along an edge from which the step between two colours stays where it is: on teeth the ends of
/// the enamel and of fissures, on tools the bands. Chosen below the colours' own differences.
const TOOTH_STEP: f32 = 0.025;
const BAND_STEP: f32 = 0.45;
/// Longest edge that is a step, mm.
const STEP_MM: f32 = 0.35;
/// Distance up to which the steps on teeth stay, mm: coarser meshes have no edges for them.
const FINE_MM: f32 = 0.05;

/// Edge of cells that keep a vertex each, mm, of fine and of coarse meshes: light and blood run from vertex to vertex,
/// and a flat surface would have none. Chosen.
const CELL_MM: [f32; 2] = [1.6, 3.0];

/// Vertex of a mesh that is thinned: place, mm, and fields.
type Vertex = ([f32; 3], [f32; FIELDS]);

/// Limits of one mesh.
struct Limits {
    /// Allowed distance, mm.
    off: f32,
    /// Difference of two colours from which their step stays.
    step: Option<f32>,
    /// Edge of the cells that keep a vertex, mm.
    cell: Option<f32>,
}

impl Limits {
    fn of(material: Material, off: f32) -> Self {
        let [fine, coarse] = CELL_MM;
        let is_fine = off <= FINE_MM;
        let cell = Some(if is_fine { fine } else { coarse });
        match material {
            Material::Metal => Self {
                off: off.min(TOOL_MM),
                step: Some(BAND_STEP),
                cell: None,
            },
            Material::Tooth => Self {
                off,
                step: is_fine.then_some(TOOTH_STEP),
                cell,
            },
            _ => Self {
                off,
                step: None,
                cell,
            },
        }
    }
}

impl Stage {
    /// Thins the meshes of all objects but those of no tissue. `off` is the allowed distance, mm.
    pub(crate) fn thin(&mut self, off: f32) {
        self.close();
        let corners = self.thinned(off);
        let (mut still, mut moving, mut all) = (Vec::new(), Vec::new(), Vec::new());
        for (part, corners) in self.parts.iter_mut().zip(corners) {
            let start = part.vertices.start;
            let own = &self.moving[part.vertices.clone()];
            let places: Vec<[f32; 3]> = own.iter().map(|v| v.at).collect();
            let local = |v: &u32| v - start as u32;
            let triangles = corners.chunks_exact(3);
            let triangles = triangles.map(|t| [local(&t[0]), local(&t[1]), local(&t[2])]);
            let mut triangles: Vec<[u32; 3]> = triangles.collect();
            order::sort(&places, &mut triangles);
            let kept = order::by_use(places.len(), &mut triangles);
            if let Owner::Object(object) = part.owner
                && let Some((_, numbers)) = &mut self.skins[usize::from(object)]
            {
                *numbers = kept.iter().map(|v| numbers[*v as usize]).collect();
            }
            let first = still.len();
            still.extend(kept.iter().map(|v| self.still[start + *v as usize]));
            moving.extend(kept.iter().map(|v| self.moving[start + *v as usize]));
            let corner = all.len();
            all.extend(triangles.iter().flatten().map(|v| v + first as u32));
            part.vertices = first..still.len();
            part.corners = corner..all.len();
        }
        (self.still, self.moving, self.corners) = (still, moving, all);
        self.normals = Normals::new(&self.parts, &self.moving);
        self.normals
            .keep(&self.parts, &self.corners, &mut self.moving);
    }

    /// Puts the vertices of each group into one place. Gaps of a thousandth of a millimetre show along long edges.
    fn close(&mut self) {
        for group in self.normals.groups() {
            let at = self.still[group[0] as usize].rest;
            for v in group {
                self.still[*v as usize].rest = at;
                self.moving[*v as usize].at = at;
            }
        }
    }

    /// Corners of the thinned meshes by part, as numbers of the present vertices.
    fn thinned(&self, off: f32) -> Vec<Vec<u32>> {
        let vertices = self.vertices();
        let of = |parts: &[Part]| -> Vec<u32> {
            let all = parts
                .iter()
                .flat_map(|part| &self.corners[part.corners.clone()]);
            all.copied().collect()
        };
        let is_flesh = |part: &Part| part.material == Material::Flesh;
        let is_whole = |part: &Part| part.material == Material::Plain;
        // Parts of one material lie side by side.
        let mut classes: Vec<&[Part]> = self
            .parts
            .chunk_by(|a, b| is_flesh(a) && is_flesh(b))
            .collect();
        classes.retain(|class| !class.is_empty());
        let mut made: Vec<Vec<u32>> = classes.iter().map(|class| of(class)).collect();
        std::thread::scope(|scope| {
            for (class, corners) in classes.iter().zip(&mut made) {
                if !is_whole(&class[0]) {
                    let span = class[0].vertices.start..class[class.len() - 1].vertices.end;
                    let first = span.start as u32;
                    let vertices = &vertices[span];
                    let limits = Limits::of(class[0].material, off);
                    scope.spawn(move || *corners = simplified(vertices, first, corners, &limits));
                }
            }
        });
        let mut by_part = vec![Vec::new(); self.parts.len()];
        for triangle in made.iter().flat_map(|corners| corners.chunks_exact(3)) {
            let first = triangle[0] as usize;
            let part = self
                .parts
                .partition_point(|part| part.vertices.end <= first);
            by_part[part].extend_from_slice(triangle);
        }
        by_part
    }

    /// For each vertex the sum of its carriers' weights, each times a number of the carrier. Where a carrier's weight
    /// changes, so does the sum.
    fn carried(&self) -> Vec<f32> {
        let mut carried = vec![0.0; self.still.len()];
        for part in &self.parts {
            let Owner::Object(object) = part.owner else {
                continue;
            };
            let Some((skin, numbers)) = &self.skins[usize::from(object)] else {
                continue;
            };
            for (carried, number) in carried[part.vertices.clone()].iter_mut().zip(numbers) {
                let carriers = skin.carriers(*number as usize);
                // Multiples of the golden ratio: neighbouring numbers differ.
                *carried = carriers
                    .map(|(k, weight)| weight * (f32::from(k) * 0.618_034).fract())
                    .sum();
            }
        }
        carried
    }

    /// Vertices with their fields.
    fn vertices(&self) -> Vec<Vertex> {
        let carried = self.carried();
        let whole = blood::whole(self).into_iter().zip(carried);
        let both = self.still.iter().zip(&self.moving).zip(whole);
        both.map(|((still, Moving { at, normal, .. }), (blood, carried))| {
            let [x, y, z] = *normal;
            let [r, g, b] = [0, 1, 2].map(|k| f32::from(still.albedo[k]) / 255.0);
            let open = f32::from(still.finish[3]) / 255.0;
            (*at, [x, y, z, r, g, b, open, blood, carried])
        })
        .collect()
    }
}

/// Corners of a thinned mesh. `first` is the number of the first vertex.
fn simplified(vertices: &[Vertex], first: u32, corners: &[u32], limits: &Limits) -> Vec<u32> {
    let places: Vec<[f32; 3]> = vertices.iter().map(|(at, _)| *at).collect();
    let fields: Vec<f32> = vertices.iter().flat_map(|(_, fields)| *fields).collect();
    let local: Vec<u32> = corners.iter().map(|v| v - first).collect();
    // The library compares fields with places as shares of the mesh's extent.
    let extent = simplify_scale_decoder(&places);
    let weights = SAME.map(|same| limits.off / same / extent);
    let mut fixed = vec![false; places.len()];
    if let Some(step) = limits.step {
        keep_steps(vertices, &local, step, &mut fixed);
    }
    if let Some(cell) = limits.cell {
        keep_cells(&places, cell, &mut fixed);
    }
    let few = simplify_with_attributes_and_locks_decoder(
        &local,
        &places,
        &fields,
        &weights,
        size_of::<[f32; FIELDS]>(),
        &fixed,
        0,
        limits.off,
        SimplifyOptions::ErrorAbsolute,
        None,
    );
    few.into_iter().map(|v| v + first).collect()
}

/// Keeps the vertex nearest to the middle of each cell.
fn keep_cells(places: &[[f32; 3]], cell: f32, fixed: &mut [bool]) {
    let mut nearest: BTreeMap<[i32; 3], (f32, usize)> = BTreeMap::new();
    for (v, place) in places.iter().enumerate() {
        let at = place.map(|x| x / cell);
        let off = at
            .map(|x| (x - x.floor() - 0.5).powi(2))
            .iter()
            .sum::<f32>();
        let found = nearest
            .entry(at.map(|x| x.floor() as i32))
            .or_insert((off, v));
        if off < found.0 {
            *found = (off, v);
        }
    }
    for (_, v) in nearest.into_values() {
        fixed[v] = true;
    }
}

/// Keeps the vertices at steps between two colours.
fn keep_steps(vertices: &[Vertex], corners: &[u32], step: f32, fixed: &mut [bool]) {
    for triangle in corners.chunks_exact(3) {
        for k in 0..3 {
            let ends = [triangle[k] as usize, triangle[(k + 1) % 3] as usize];
            let [(a, of_a), (b, of_b)] = ends.map(|v| vertices[v]);
            let length = (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f32>().sqrt();
            let is_step = (COLOUR..COLOUR + 3).any(|k| (of_a[k] - of_b[k]).abs() > step);
            if is_step && length < STEP_MM {
                fixed[ends[0]] = true;
                fixed[ends[1]] = true;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sheet of 40 by 40 squares of 0.25 mm, white in one half and brown in the other.
    fn sheet() -> (Vec<Vertex>, Vec<u32>) {
        let n = 41u32;
        let at = |k: u32| k as f32 * 0.25;
        let vertex = |v: u32| {
            let colour = if v % n < 20 { 0.9 } else { 0.4 };
            let fields = [0.0, 0.0, 1.0, colour, colour, colour, 1.0, 0.0, 0.0];
            ([at(v % n), at(v / n), 0.0], fields)
        };
        let squares = (0..n * n).filter(|v| v % n + 1 < n && v / n + 1 < n);
        let corners = squares.flat_map(|v| [v, v + 1, v + n, v + 1, v + n + 1, v + n]);
        ((0..n * n).map(vertex).collect(), corners.collect())
    }

    #[test]
    fn a_flat_sheet_loses_its_inner_vertices_and_keeps_a_step_of_colour() {
        let (vertices, corners) = sheet();
        let few = |step, cell| {
            let off = 0.05;
            simplified(&vertices, 0, &corners, &Limits { off, step, cell })
        };
        let area = |corners: &[u32]| -> f32 {
            let of = |t: &[u32]| {
                let [a, b, c] = [0, 1, 2].map(|k| vertices[t[k] as usize].0);
                0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))
            };
            corners.chunks_exact(3).map(of).sum()
        };
        let plain = few(None, None);
        assert!(plain.len() * 20 < corners.len(), "{} corners", plain.len());
        assert!((area(&plain) - 100.0).abs() < 0.01, "{}", area(&plain));
        let crisp = few(Some(TOOTH_STEP), None);
        assert!((area(&crisp) - 100.0).abs() < 0.01);
        for v in (0..vertices.len()).filter(|v| [19, 20].contains(&(v % 41))) {
            assert!(
                crisp.contains(&(v as u32)),
                "vertex {v} at the step is gone"
            );
        }
        let celled = few(None, Some(2.0));
        let kept: std::collections::BTreeSet<u32> = celled.iter().copied().collect();
        assert!(
            (25..120).contains(&kept.len()),
            "{} vertices in 25 cells",
            kept.len()
        );
    }
}
