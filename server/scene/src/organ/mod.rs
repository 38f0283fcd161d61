//! Organ by finite elements from a closed surface: tetrahedra, held nodes, condensation, carriers of the tree's
//! spheres.
//!
//! Condensations are cached.

pub mod skeleton;
pub mod springs;
pub mod tetrahedra;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use sulcus_core::SphereTree;
use sulcus_core::tissue::surface::{
    SURFACE_CARRIERS, SurfaceCompliance, SurfaceParams, SurfaceSkin,
};
use sulcus_fem::{CondenseOptions, Condensed, FemError, TetMesh, condense, msh};

use crate::cache;
use crate::mesh::TriMesh;
use crate::mesh::distance::MeshDistance;
use crate::mesh::load::Unit;
use crate::organ::skeleton::{Frame, Holds};
use crate::organ::tetrahedra::{TetraError, hold, tetrahedra};
use crate::parallel;
use crate::tree::carry::{carried, carriers};

/// `[object.surface]`: options of an organ by finite elements.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct SurfaceOptions {
    /// Tetrahedra in the frame of the object's surface, relative to the scene file. Without this key the elements are
    /// made from the surface.
    ///
    /// A Gmsh file `.msh` holds the nodes of its group `fixed`, or without such a group the shares below. A folder of
    /// tables, in mm, has its own held nodes.
    pub elements: Option<PathBuf>,
    /// Unit of a Gmsh file; mm by default.
    pub elements_unit: Option<Unit>,
    /// Edge of the lattice of the elements, mm.
    pub element_mm: f64,
    /// Largest number of moving masters.
    pub masters: usize,
    /// Number of cells of the large-displacement term; 0 omits the term.
    pub cells: usize,
    /// Young's modulus, kPa.
    pub young_kpa: f64,
    /// Poisson's ratio.
    pub poisson: f64,
    /// Time constant of the response to a load, ms.
    pub relaxation_ms: f64,
    /// Held share of the length, from the hindmost end: the root. Tables have their own held nodes.
    pub fixed_root: f64,
    /// Held share of the height, from below: the bottom layer.
    pub fixed_bottom: f64,
    /// Share of the length, from the foremost end, with a free bottom: the tip.
    pub free_tip: f64,
}

impl Default for SurfaceOptions {
    fn default() -> Self {
        let (params, fine) = (SurfaceParams::default(), CondenseOptions::default());
        let holds = Holds::default();
        Self {
            elements: None,
            elements_unit: None,
            element_mm: 5.0,
            masters: fine.masters,
            cells: fine.cells,
            young_kpa: params.young * 1e-3,
            poisson: params.poisson,
            relaxation_ms: params.relaxation * 1e3,
            fixed_root: holds.root,
            fixed_bottom: holds.bottom,
            free_tip: holds.free_tip,
        }
    }
}

impl SurfaceOptions {
    /// Returns the parameters of the model in the tick.
    pub fn params(&self) -> SurfaceParams {
        SurfaceParams {
            young: self.young_kpa * 1e3,
            poisson: self.poisson,
            relaxation: self.relaxation_ms * 1e-3,
            large: 1.0,
        }
    }
}

/// Reason why an organ cannot be made.
#[derive(Debug, thiserror::Error)]
pub enum OrganError {
    /// The surface cannot be filled with finite elements.
    #[error(transparent)]
    Tetrahedra(#[from] TetraError),
    /// The finite elements cannot be read or solved.
    #[error(transparent)]
    Elements(#[from] FemError),
    /// The finite elements belong to another surface.
    #[error(
        "a corner of the finite elements' surface is {found_mm:.1} mm away from the object's surface, expected at most {most_mm:.1} mm: check the frame and the unit of the elements"
    )]
    Elsewhere {
        /// Distance found, mm.
        found_mm: f64,
        /// Largest distance allowed, mm.
        most_mm: f64,
    },
}

/// Largest distance of the corners of the elements' surface from the object's, as a share of the object's diagonal.
/// Elements are coarser than the displayed surface.
const FITS: f64 = 0.05;
/// Version of the condensation. It is raised if the same input gives another result.
const VERSION: u32 = 1;

/// Makes the organ with this surface and the spheres of `tree`.
///
/// # Errors
/// [`OrganError`] if no valid elements fit the surface.
pub fn organ(
    tree: &SphereTree,
    surface: &TriMesh,
    options: &SurfaceOptions,
    folder: &Path,
    kept: Option<&Path>,
    progress: &dyn Fn(&str, f64),
) -> Result<SurfaceCompliance, OrganError> {
    let distance = MeshDistance::new(surface.clone());
    let elements = elements(&distance, options, folder, progress)?;
    fits(&elements, &distance)?;
    let fine = CondenseOptions {
        masters: options.masters,
        cells: options.cells,
    };
    let condensed = condensed(&elements, options.poisson, &fine, kept, progress)?;
    let skin = skin(tree, &distance, &condensed);
    Ok(condensed.model(skin, options.params()))
}

/// Makes or reads the tetrahedra of an organ with this surface, with their held nodes.
///
/// # Errors
/// [`OrganError`] if the surface cannot be filled, or the file cannot be read.
pub fn elements(
    surface: &MeshDistance,
    options: &SurfaceOptions,
    folder: &Path,
    progress: &dyn Fn(&str, f64),
) -> Result<TetMesh, OrganError> {
    let mut mesh = match options.elements.as_ref().map(|path| folder.join(path)) {
        None => {
            let size = options.element_mm * 1e-3;
            let say = |share: f64| progress("filling it with elements", share);
            tetrahedra(surface, size, &say)?
        }
        Some(path) if path.extension().is_some_and(|ending| ending == "msh") => {
            let unit = match options.elements_unit {
                Some(Unit::Metre) => msh::Unit::Metre,
                Some(Unit::Inch) => msh::Unit::Inch,
                Some(Unit::Millimetre) | None => msh::Unit::Millimetre,
            };
            msh::read_msh(&path, unit, None)?
        }
        Some(path) => return Ok(sulcus_fem::files::read_mesh(&path)?),
    };
    if mesh.held.iter().flatten().any(|held| *held) {
        return Ok(mesh);
    }
    let (low, high) = surface.mesh().bounds();
    let frame = Frame::new(low, high);
    let holds = Holds {
        root: options.fixed_root,
        bottom: options.fixed_bottom,
        free_tip: options.free_tip,
    };
    hold(&mut mesh, |node| holds.is_fixed(&frame.share(node)));
    Ok(mesh)
}

fn fits(elements: &TetMesh, surface: &MeshDistance) -> Result<(), OrganError> {
    let (low, high) = surface.mesh().bounds();
    let most = FITS * (high - low).norm();
    let corners = elements.boundary_triangles().concat();
    let far = corners
        .into_iter()
        .map(|node| surface.signed(&elements.nodes[node as usize]).abs())
        .fold(0.0, f64::max);
    if far > most {
        return Err(OrganError::Elsewhere {
            found_mm: far * 1e3,
            most_mm: most * 1e3,
        });
    }
    Ok(())
}

/// Condenses elements, or takes the result from the cache.
///
/// # Errors
/// [`OrganError`] if the elements cannot be solved.
pub fn condensed(
    elements: &TetMesh,
    poisson: f64,
    options: &CondenseOptions,
    kept: Option<&Path>,
    progress: &dyn Fn(&str, f64),
) -> Result<Condensed, FemError> {
    let mut hasher = blake3::Hasher::new();
    hasher.update(b"organ");
    hasher.update(&VERSION.to_le_bytes());
    hasher.update(&poisson.to_bits().to_le_bytes());
    for count in [options.masters, options.cells, elements.nodes.len()] {
        hasher.update(&(count as u64).to_le_bytes());
    }
    for (node, held) in elements.nodes.iter().zip(&elements.held) {
        for x in node.iter() {
            hasher.update(&x.to_bits().to_le_bytes());
        }
        hasher.update(&held.map(u8::from));
    }
    for node in elements.tets.as_flattened() {
        hasher.update(&node.to_le_bytes());
    }
    let key = hasher.finalize();
    let before = kept
        .and_then(|dir| cache::load_bytes(dir, "organ", &key))
        .and_then(|bytes| Condensed::from_bytes(&bytes).ok());
    if let Some(condensed) = before {
        return Ok(condensed);
    }
    let condensed = condense(elements, poisson, options, progress)?;
    if let Some(dir) = kept
        && let Ok(bytes) = condensed.to_bytes()
    {
        // A result that cannot be cached is computed again next time. A failure to cache trees, in the same folder,
        // causes a warning.
        let _ = cache::store_bytes(dir, "organ", &key, &bytes);
    }
    Ok(condensed)
}

/// Search distance of a sphere without a free surface of its own, beyond its nearest free vertex, in its radii.
const FOLLOWS: f64 = 0.25;
/// Least free share of a sphere's own surface. Below it the sphere counts as one without a free surface.
const FREE: f64 = 0.05;

/// Returns the carriers of each node of a tree: the mean over the vertices of the sphere's own surface. A sphere
/// without a free surface uses the nearest free vertices.
///
/// Vertices are weighted by their freedom. The spheres of a thick organ reach from its back to its underside. If the
/// underside is held, the back is the part that tools press.
pub fn skin(tree: &SphereTree, surface: &MeshDistance, organ: &Condensed) -> Vec<SurfaceSkin> {
    let (nodes, vertices) = (tree.nodes(), &surface.mesh().vertices);
    let moving = organ.masters().moving();
    let weights: Vec<_> = vertices
        .iter()
        .map(|v| organ.masters().weights(v))
        .collect();
    let free: Vec<f64> = weights
        .iter()
        .map(|all| {
            all.iter()
                .filter(|(k, _)| *k < moving)
                .map(|(_, w)| w)
                .sum()
        })
        .collect();
    let (first, of) = carried(&carriers(tree, vertices), nodes.len());
    parallel::map(nodes.len(), |k| {
        let node = &nodes[k];
        let own = &of[first[k] as usize..first[k + 1] as usize];
        let of_own: f64 = own.iter().map(|v| free[*v as usize]).sum();
        let followed: Vec<(usize, f64)> = if of_own > FREE * own.len() as f64 {
            own.iter().map(|v| (*v as usize, 1.0)).collect()
        } else {
            let gap =
                |v: usize| ((vertices[v] - node.centre).norm() - node.contact_radius).max(0.0);
            let all = || (0..vertices.len()).filter(|v| free[*v] > FREE);
            let nearest = all().map(gap).fold(f64::INFINITY, f64::min);
            let near = |v: usize| {
                let near = 1.0 - (gap(v) - nearest) / (FOLLOWS * node.contact_radius);
                (near > 0.0).then_some((v, near * near))
            };
            all().filter_map(near).collect()
        };
        let mut sum: BTreeMap<usize, f64> = BTreeMap::new();
        for (v, near) in followed {
            for (master, weight) in weights[v] {
                *sum.entry(master).or_insert(0.0) += free[v] * near * weight;
            }
        }
        // The largest weights are kept.
        let mut sum: Vec<(usize, f64)> = sum.into_iter().collect();
        sum.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
        sum.truncate(SURFACE_CARRIERS);
        let all: f64 = sum.iter().map(|(_, w)| w).sum();
        sum.iter_mut().for_each(|(_, w)| *w /= all);
        organ.skin(&sum)
    })
}

#[cfg(test)]
mod tests {
    use sulcus_core::Vec3;
    use sulcus_core::tissue::TissueModel;

    use super::*;
    use crate::mesh::shapes::cuboid;
    use crate::tree::build::{TreeOptions, build_tree};

    /// The outside of the boxes in the Gmsh file, moved aside.
    fn boxes(aside: f64) -> TriMesh {
        let half = Vec3::new(7.5, 4.0, 3.0) * 1e-3;
        cuboid(half).placed(1.0, half + Vec3::x() * aside)
    }

    #[test]
    fn elements_of_gmsh_make_an_organ_and_those_of_something_else_are_refused() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../fem/tests/data");
        let surface = boxes(0.0);
        let wanted = TreeOptions {
            levels: 2,
            samples: 4000,
            volumetric: true,
            ..TreeOptions::default()
        };
        let tree = build_tree(&surface, &wanted, &|_, _| ()).expect("a tree");
        let options = SurfaceOptions {
            elements: Some("block_41.msh".into()),
            cells: 4,
            ..SurfaceOptions::default()
        };
        let made = |surface: &TriMesh, options: &SurfaceOptions| {
            organ(&tree, surface, options, &folder, None, &|_, _| ())
        };
        let model = made(&surface, &options).expect("an organ");
        assert!(model.masters.moving() > 9 && model.cells.volumes.len() == 4);
        let volume: f64 = model.cells.volumes.iter().sum();
        assert!((volume - 15e-3 * 8e-3 * 6e-3).abs() < 1e-12, "{volume}");
        let model = TissueModel::Surface(Box::new(model));
        model.validate(&tree, 1e-3).expect("stands");
        // A wrong unit, and another place.
        let metres = SurfaceOptions {
            elements_unit: Some(Unit::Metre),
            ..options.clone()
        };
        for (surface, options) in [(boxes(6e-3), &options), (surface, &metres)] {
            let said = made(&surface, options).expect_err("elsewhere").to_string();
            assert!(
                said.contains("away from the object's surface") || said.contains("within 10 m"),
                "{said}"
            );
        }
        let absent = SurfaceOptions {
            elements: Some("nothing.msh".into()),
            ..options
        };
        let said = made(&boxes(0.0), &absent).expect_err("absent").to_string();
        assert!(said.contains("nothing.msh"), "{said}");
    }

    #[test]
    fn what_was_condensed_comes_back_from_the_cache_and_never_damaged() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../fem/tests/data");
        let mesh = msh::read_msh(&folder.join("block_41.msh"), msh::Unit::Millimetre, None);
        let mesh = mesh.expect("a mesh");
        let fine = CondenseOptions {
            masters: 20,
            cells: 2,
        };
        let dir = tempfile::tempdir().expect("a temporary folder");
        let made = || condensed(&mesh, 0.4, &fine, Some(dir.path()), &|_, _| ()).expect("held");
        let first = made();
        let file = std::fs::read_dir(dir.path()).expect("a folder").next();
        let file = file.expect("kept").expect("a file").path();
        assert_eq!(made(), first);
        let bytes = std::fs::read(&file).expect("bytes");
        for damaged in [&bytes[..bytes.len() / 2], &[0; 100]] {
            std::fs::write(&file, damaged).expect("written");
            assert_eq!(made(), first);
        }
        let bytes = first.to_bytes().expect("bytes");
        assert_eq!(Condensed::from_bytes(&bytes).expect("back"), first);
        for cut in (0..bytes.len()).step_by(997) {
            assert!(Condensed::from_bytes(&bytes[..cut]).is_err());
        }
    }
}
