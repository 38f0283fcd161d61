//! Thinned meshes: fewer triangles where a student sees no difference.
//!
//! meshoptimizer collapses edges by quadric errors (Garland and Heckbert 1997). Colour, normal, open share and blood
//! count as distances, so that margins, steps of colour, fissures and places that bleed keep their vertices. A kept
//! vertex has its place, its carriers and its normal of the whole mesh.
//!
//! All soft tissue is one mesh here: vertices of neighbouring objects at one place go together, and no gap opens.

use meshopt::{SimplifyOptions, simplify_scale_decoder, simplify_with_attributes_and_locks_decoder};

use crate::blood;
use crate::material::Material;
use crate::normals::Normals;
use crate::order;
use crate::stage::{Moving, Owner, Part, Stage};

/// Numbers of a vertex beside its place: normal, colour, open share, blood.
const FIELDS: usize = 8;
/// First number of the colour.
const COLOUR: usize = 3;
/// Differences of these numbers that count as much as the allowed distance. Chosen by pictures.
const SAME: [f32; FIELDS] = [0.25, 0.25, 0.25, 0.05, 0.05, 0.05, 0.12, 0.4];

/// Largest distance of a thinned tool from the whole one, mm: a probe's end is half a millimetre thick.
const TOOL_MM: f32 = 0.02;
/// Difference of a colour along an edge, and the length of the edge, mm, from which the step between two colours stays
/// where it is: bands of a probe, the end of the enamel.
const STEP: (f32, f32) = (0.06, 0.35);

/// Vertex of a mesh that is thinned: place, mm, and fields.
type Vertex = ([f32; 3], [f32; FIELDS]);

impl Stage {
    /// Thins the meshes of all objects but those of no tissue. `off` is the allowed distance, mm.
    pub(crate) fn thin(&mut self, off: f32) {
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

    /// Corners of the thinned meshes by part, as numbers of the present vertices.
    fn thinned(&self, off: f32) -> Vec<Vec<u32>> {
        let vertices = self.vertices();
        let of = |parts: &[Part]| -> Vec<u32> {
            let all = parts.iter().flat_map(|part| &self.corners[part.corners.clone()]);
            all.copied().collect()
        };
        let is_flesh = |part: &Part| part.material == Material::Flesh;
        let is_whole = |part: &Part| part.material == Material::Plain;
        // Parts of one material lie side by side.
        let mut classes: Vec<&[Part]> = self.parts.chunk_by(|a, b| is_flesh(a) && is_flesh(b)).collect();
        classes.retain(|class| !class.is_empty());
        let mut made: Vec<Vec<u32>> = classes.iter().map(|class| of(class)).collect();
        std::thread::scope(|scope| {
            for (class, corners) in classes.iter().zip(&mut made) {
                if !is_whole(&class[0]) {
                    let span = class[0].vertices.start..class[class.len() - 1].vertices.end;
                    let first = span.start as u32;
                    let vertices = &vertices[span];
                    let off = if class[0].material == Material::Metal {
                        off.min(TOOL_MM)
                    } else {
                        off
                    };
                    scope.spawn(move || *corners = simplified(vertices, first, corners, off));
                }
            }
        });
        let mut by_part = vec![Vec::new(); self.parts.len()];
        for triangle in made.iter().flat_map(|corners| corners.chunks_exact(3)) {
            let first = triangle[0] as usize;
            let part = self.parts.partition_point(|part| part.vertices.end <= first);
            by_part[part].extend_from_slice(triangle);
        }
        by_part
    }

    /// Vertices with their fields. Vertices of one group have one place.
    fn vertices(&self) -> Vec<Vertex> {
        let whole = blood::whole(self);
        let both = self.still.iter().zip(&self.moving).zip(whole);
        let mut vertices: Vec<Vertex> = both
            .map(|((still, Moving { at, normal, .. }), blood)| {
                let [x, y, z] = *normal;
                let [r, g, b] = [0, 1, 2].map(|k| f32::from(still.albedo[k]) / 255.0);
                let open = f32::from(still.finish[3]) / 255.0;
                (*at, [x, y, z, r, g, b, open, blood])
            })
            .collect();
        for group in self.normals.groups() {
            let at = vertices[group[0] as usize].0;
            for v in group {
                vertices[*v as usize].0 = at;
            }
        }
        vertices
    }
}

/// Corners of a thinned mesh. `first` is the number of the first vertex.
fn simplified(vertices: &[Vertex], first: u32, corners: &[u32], off: f32) -> Vec<u32> {
    let places: Vec<[f32; 3]> = vertices.iter().map(|(at, _)| *at).collect();
    let fields: Vec<f32> = vertices.iter().flat_map(|(_, fields)| *fields).collect();
    let local: Vec<u32> = corners.iter().map(|v| v - first).collect();
    // The library compares fields with places as shares of the mesh's extent.
    let extent = simplify_scale_decoder(&places);
    let tune: Vec<f32> = std::env::var("TUNE").ok().map(|t| t.split(',').map(|x| x.parse().unwrap()).collect()).unwrap_or_default();
    let off = tune.first().map_or(off, |t| off.min(*t));
    let same = if tune.len() > 4 { [tune[1], tune[1], tune[1], tune[2], tune[2], tune[2], tune[3], tune[4]] } else { SAME };
    let weights = same.map(|same| off / same / extent);
    let fixed = if tune.len() > 5 && tune[5] == 0.0 { vec![false; places.len()] } else { steps(vertices, &local) };
    let few = simplify_with_attributes_and_locks_decoder(
        &local,
        &places,
        &fields,
        &weights,
        size_of::<[f32; FIELDS]>(),
        &fixed,
        0,
        off,
        SimplifyOptions::ErrorAbsolute,
        None,
    );
    few.into_iter().map(|v| v + first).collect()
}

/// Whether a vertex lies at a step between two colours.
fn steps(vertices: &[Vertex], corners: &[u32]) -> Vec<bool> {
    let mut fixed = vec![false; vertices.len()];
    for triangle in corners.chunks_exact(3) {
        for k in 0..3 {
            let ends = [triangle[k] as usize, triangle[(k + 1) % 3] as usize];
            let [(a, of_a), (b, of_b)] = ends.map(|v| vertices[v]);
            let length = (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f32>().sqrt();
            let is_step = (COLOUR..COLOUR + 3).any(|k| (of_a[k] - of_b[k]).abs() > STEP.0);
            if is_step && length < STEP.1 {
                fixed[ends[0]] = true;
                fixed[ends[1]] = true;
            }
        }
    }
    fixed
}
