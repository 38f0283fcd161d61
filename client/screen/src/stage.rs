//! Content of a picture: the meshes of a display scene at rest, in millimetres.
//!
//! All vertices lie in one list and all triangles in another. A [`Part`] is the range of one object or one tool. Vertices
//! of an object lie in world axes, vertices of a tool in the tool's frame.

use std::ops::Range;

use nalgebra::Vector3;
use sulcus_proto::display::{DisplayGlass, DisplayMesh, DisplayScene, Finish, Skin, Spot};

use crate::material::Material;
use crate::normals::Normals;
use crate::occlusion;
use crate::order;
use crate::plan::{self, Chunk};

/// Millimetres in a metre.
pub(crate) const MM: f32 = 1e3;

/// Constant values of a vertex.
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Still {
    /// Place at rest, mm: noise is a function of it, so that patterns move with the tissue.
    pub rest: [f32; 3],
    /// Colour, sRGB; the last number is the material's.
    pub albedo: [u8; 4],
    /// Roughness, stippling, thinness, and the share of the surroundings that is open, 255ths.
    pub finish: [u8; 4],
}

/// Changing values of a vertex.
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Moving {
    /// Place, mm.
    pub at: [f32; 3],
    /// Unit normal, outwards.
    pub normal: [f32; 3],
    /// Cover by blood, 0 to 1.
    pub blood: f32,
}

/// Owner of a part.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Owner {
    /// Object by its number in the scene.
    Object(u16),
    /// Tool by its slot.
    Tool(u8),
}

/// Mesh of one object or tool.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// Owner.
    pub owner: Owner,
    /// Material.
    pub material: Material,
    /// Vertices in [`Stage::still`] and [`Stage::moving`].
    pub vertices: Range<usize>,
    /// Corners in [`Stage::corners`].
    pub corners: Range<usize>,
}

/// Meshes of a scene.
pub struct Stage {
    /// Constant values of all vertices.
    pub still: Vec<Still>,
    /// Present values of all vertices.
    pub moving: Vec<Moving>,
    /// Corners of all triangles, as numbers of vertices.
    pub corners: Vec<u32>,
    /// Objects, then tools.
    pub parts: Vec<Part>,
    /// Glass of each tool.
    pub glasses: Vec<Option<DisplayGlass>>,
    /// Skins by object, and for each kept vertex its number in the object's mesh.
    pub(crate) skins: Vec<Option<(Skin, Vec<u32>)>>,
    /// Six sites of bleeding by object, mm.
    pub(crate) sites: Vec<Vec<[f32; 3]>>,
    pub(crate) normals: Normals,
    /// Ranges of triangles that passes leave out when they lie beside the picture.
    pub(crate) chunks: Vec<Chunk>,
    /// Objects that are not at rest.
    pub(crate) displaced: Vec<u16>,
    /// Blood of all vertices: each spot with its age, at most [`crate::blood::WHOLE_S`].
    pub(crate) bled: Vec<(Spot, f32)>,
}

impl Stage {
    /// Stage of a scene. Meshes of objects are thinned, so that they differ from the scene's by about `thinned_um`
    /// micrometres; 0 keeps them whole. Takes some tenths of a second for a whole mouth.
    pub fn new(scene: &DisplayScene, thinned_um: u32) -> Self {
        let mut stage = Self::whole(scene);
        if thinned_um > 0 {
            stage.thin(thinned_um as f32 * 1e-3);
        }
        stage.chunks = plan::chunks(&stage);
        stage
    }

    fn whole(scene: &DisplayScene) -> Self {
        let mut stage = Self {
            still: Vec::new(),
            moving: Vec::new(),
            corners: Vec::new(),
            parts: Vec::new(),
            glasses: scene.tools.iter().map(|tool| tool.glass).collect(),
            skins: Vec::new(),
            sites: Vec::new(),
            normals: Normals::default(),
            chunks: Vec::new(),
            displaced: Vec::new(),
            bled: Vec::new(),
        };
        stage.skins.resize_with(scene.objects.len(), || None);
        stage.sites.resize_with(scene.objects.len(), Vec::new);
        // Parts of one material lie side by side: one draw serves several.
        let mut order: Vec<usize> = (0..scene.objects.len()).collect();
        order.sort_by_key(|k| Material::of(scene.objects[*k].kind));
        for k in order {
            let object = &scene.objects[k];
            let owner = Owner::Object(k as u16);
            let kept = stage.push(owner, Material::of(object.kind), &object.mesh);
            stage.skins[k] = object.skin.clone().map(|skin| (skin, kept));
            let mm = |at: &[f32; 3]| at.map(|x| x * MM);
            stage.sites[k] = object.sites.iter().map(mm).collect();
        }
        let objects = stage.parts.len();
        for (k, tool) in (0..).zip(&scene.tools) {
            stage.push(Owner::Tool(k), Material::Metal, &tool.mesh);
        }
        stage.normals = Normals::new(&stage.parts, &stage.moving);
        let all: Vec<usize> = (0..stage.parts.len()).collect();
        stage
            .normals
            .update(&all, &stage.parts, &stage.corners, &mut stage.moving);
        occlusion::bake(
            &stage.parts[..objects],
            &stage.corners,
            &stage.moving,
            &mut stage.still,
        );
        let end = stage.parts[..objects]
            .last()
            .map_or(0, |part| part.corners.end);
        occlusion::smooth(
            &stage.corners[..end],
            stage.normals.groups(),
            &mut stage.still,
        );
        stage
    }

    /// Appends a mesh. Returns the numbers of its kept vertices.
    fn push(&mut self, owner: Owner, material: Material, mesh: &DisplayMesh) -> Vec<u32> {
        let first = self.still.len();
        let places: Vec<[f32; 3]> = mesh.vertices().map(|at| at.map(|x| x * MM)).collect();
        let mut triangles: Vec<[u32; 3]> = mesh.triangles().collect();
        order::sort(&places, &mut triangles);
        let kept = order::by_use(places.len(), &mut triangles);
        for v in &kept {
            let v = *v as usize;
            let [r, g, b, _] = mesh.vertex_colours.get(v).copied().unwrap_or(mesh.colour);
            let finish = mesh.finishes.get(v).copied().unwrap_or(material.finish());
            let Finish {
                roughness,
                stipple,
                thin,
            } = finish;
            self.still.push(Still {
                rest: places[v],
                albedo: [r, g, b, material.number()],
                finish: [roughness, stipple, thin, 255],
            });
            self.moving.push(Moving {
                at: places[v],
                normal: [0.0, 0.0, 1.0],
                blood: 0.0,
            });
        }
        let corner = self.corners.len();
        self.corners
            .extend(triangles.iter().flatten().map(|v| v + first as u32));
        self.parts.push(Part {
            owner,
            material,
            vertices: first..self.still.len(),
            corners: corner..self.corners.len(),
        });
        kept
    }

    /// Part of an object.
    pub fn object(&self, object: u16) -> Option<&Part> {
        let owner = Owner::Object(object);
        self.parts.iter().find(|part| part.owner == owner)
    }

    /// Number of triangles.
    pub fn triangles(&self) -> usize {
        self.corners.len() / 3
    }

    /// Lowest and highest corner of the box of all objects at rest, mm; `None` without a vertex.
    pub fn bounds(&self) -> Option<[Vector3<f32>; 2]> {
        let objects = self
            .parts
            .iter()
            .filter(|part| matches!(part.owner, Owner::Object(_)));
        let places = objects.flat_map(|part| &self.still[part.vertices.clone()]);
        places
            .map(|still| Vector3::from(still.rest))
            .fold(None, |found, at| {
                let [low, high] = found.unwrap_or([at, at]);
                Some([low.inf(&at), high.sup(&at)])
            })
    }
}
