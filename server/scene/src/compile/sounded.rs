//! A gingiva that is a mesh: from the scene file to the object. Its tooth may be a mesh too.

use sulcus_core::math::fmax;
use sulcus_core::tissue::TissueModel;
use sulcus_core::{Object, Vec3};

use crate::anatomy::mesh_tissue::{Surrounding, model};
use crate::anatomy::sulcus::Sounded;
use crate::compile::error::BuildError;
use crate::compile::parts::{Compiler, GINGIVA_COLOUR, Importance, moved};
use crate::compile::printed::printed_gingiva;
use crate::file::{ObjectEntry, TissueEntry};
use crate::mesh::TriMesh;
use crate::mesh::distance::MeshDistance;
use crate::mesh::implicit::ramp;
use crate::mesh::solid::read_solid;
use crate::tree::build::TreeOptions;
use crate::tree::carry::carriers;

/// Weight of wall and floor of the sulcus in the distribution of spheres; other tissue has 1.
const POCKET_WEIGHT: f64 = 16.0;
/// Weight of tissue far from the tooth.
const FAR_WEIGHT: f64 = 0.05;
/// Distances from the tooth at which the weight begins to fall, and at which it has fallen, metres.
const FAR: (f64, f64) = (1.5e-3, 5e-3);

impl Compiler<'_> {
    /// Returns the mesh of a tooth of the file, in the world.
    fn tooth(&mut self, entry: &ObjectEntry) -> Result<TriMesh, BuildError> {
        let place = Vec3::from(entry.translate_mm) * 1e-3;
        let mesh = match (&entry.molar, &entry.mesh) {
            (_, Some(mesh)) => read_solid(&self.beside(mesh), entry.reading())?.mesh,
            (molar, None) => molar.clone().unwrap_or_default().mesh(),
        };
        Ok(mesh.placed(1.0, place))
    }

    /// Makes a gingiva from a mesh file, round one of `all` objects.
    pub(crate) fn sounded_gingiva(
        &mut self,
        entry: &ObjectEntry,
        all: &[ObjectEntry],
    ) -> Result<Object, BuildError> {
        let part = format!("object `{}`", entry.name);
        // The check of the file guarantees the object.
        let tooth = all
            .iter()
            .position(|tooth| Some(&tooth.name) == entry.tooth.as_ref())
            .unwrap_or(0);
        let fdi = all[tooth].fdi;
        let given = entry.sulcus.clone().unwrap_or_default();
        let place = Vec3::from(entry.translate_mm) * 1e-3;
        let drawn = self.load(&part, entry.mesh.as_deref(), entry.reading())?;
        let surface = MeshDistance::new(self.tooth(&all[tooth])?);
        let tissue = MeshDistance::new(drawn.clone().placed(1.0, place));
        let sounded = Sounded::new(&surface, &tissue, fdi, &given).map_err(|source| {
            let part = part.clone();
            BuildError::Sulcus { part, source }
        })?;
        let params = entry.gingiva.clone().unwrap_or_default().params();
        // The tree is built in the frame of the mesh, then placed.
        let importance = |p: &Vec3| importance(&sounded, &surface, &(p + place));
        let key = importance_key(&sounded, &surface, &place);
        let wanted = TreeOptions {
            levels: entry.levels,
            ..TreeOptions::default()
        };
        let weights = Some((&*key, &importance as &Importance<'_>));
        let (tree, level) = self.weighted(&part, &drawn, entry.level, wanted, weights)?;
        let tree = moved(&tree, &place).map_err(|source| BuildError::Tree {
            part: part.clone(),
            source,
        })?;
        // A real floor has few vertices of its own, so the sounded points are added.
        let mut mesh = tissue.mesh().clone();
        mesh.vertices.extend(&sounded.on_floor);
        let proximal = given.proximal_deg.to_radians();
        let surrounding = Surrounding {
            tooth: &surface,
            frame: sounded.frame,
            mesh: &mesh,
            floor: &|around| sounded.floor_at(around),
            width: sounded.width,
            proximal,
            sites: sounded.charted(proximal, params.sink(), params.inflammation > 0.0),
        };
        let mut gingiva = model(&tree, level, params, &surrounding);
        // The mesh may contain tissue of other teeth, higher than this tooth's margin.
        gingiva.margin = sounded.margin;
        let fitted = if entry.tissue == TissueEntry::PrintedGingiva {
            TissueModel::PrintedGingiva(printed_gingiva(&gingiva, &tree, tooth, entry))
        } else {
            TissueModel::Gingiva(Box::new(gingiva))
        };
        let mesh = tissue.mesh();
        Ok(Object {
            name: entry.name.clone(),
            fdi: if entry.fdi == 0 { fdi } else { entry.fdi },
            carriers: carriers(&tree, &mesh.vertices),
            tree,
            level,
            tissue: fitted,
            mesh: mesh.to_display(GINGIVA_COLOUR),
        })
    }
}

/// Returns the weight of a point of the tissue's surface: most in the sulcus, least far from the tooth.
fn importance(sounded: &Sounded, tooth: &MeshDistance, p: &Vec3) -> f64 {
    let (around, height) = sounded.frame.cylindrical(p);
    let (off, above) = (tooth.signed(p), height - sounded.floor_at(around));
    let ground = FAR_WEIGHT + (1.0 - FAR_WEIGHT) * ramp(-off, -FAR.1, -FAR.0);
    let near = fmax(sounded.width, 2e-4) + 4e-4;
    let pocket = ramp(-off, -near - 4e-4, -near) * ramp(above, -5e-4, -1e-4);
    // Places in the tooth, or under the floor at its root, are never touched.
    let open = ramp(off, -2e-4, 0.0);
    ground * (0.05 + 0.95 * open) + (POCKET_WEIGHT - ground) * pocket * open
}

/// Returns a name for all inputs of the weight that the tissue's mesh does not show.
fn importance_key(sounded: &Sounded, tooth: &MeshDistance, place: &Vec3) -> String {
    let mut hasher = blake3::Hasher::new();
    tooth.mesh().hash_into(&mut hasher);
    let frame = &sounded.frame;
    let vectors = [
        place,
        &frame.origin,
        &frame.axis,
        &frame.mesial,
        &frame.buccal,
    ];
    let numbers = vectors.into_iter().flatten().chain(&sounded.floor);
    for x in numbers.chain([&sounded.width]) {
        hasher.update(&x.to_bits().to_le_bytes());
    }
    let weights = format!("{POCKET_WEIGHT} {FAR_WEIGHT} {FAR:?}");
    format!("sounded gingiva 1 {weights} {}", hasher.finalize().to_hex())
}
