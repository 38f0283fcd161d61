//! Meshes on which trees are measured, each with the options of its tree, shared by tests and bench.
//!
//! Real meshes come from the data folder beside the project, if it exists. Parametric parts are always there.

// Each user needs a part of this module.
#![allow(dead_code)]

use std::sync::Arc;

use sulcus_core::{SphereTree, Vec3};
use sulcus_scene::anatomy::Molar;
use sulcus_scene::instruments::{Mirror, Probe};
use sulcus_scene::mesh::TriMesh;
use sulcus_scene::mesh::distance::MeshDistance;
use sulcus_scene::mesh::load::Unit;
use sulcus_scene::mesh::solid::read_solid;
use sulcus_scene::tree::build::{TreeOptions, build_weighted};
use sulcus_scene::tree::zone::{Region, Zone, importance};

/// Weight of the pocket's walls. The largest error there is reduced by its sixth root.
const WALL_WEIGHT: f64 = 8000.0;

/// A mesh with the options of its tree.
pub struct Part {
    pub name: &'static str,
    source: Source,
    volumetric: bool,
    zones: Vec<Zone>,
}

enum Source {
    File(&'static str),
    Made(fn() -> TriMesh),
}

impl Part {
    /// Returns the mesh; `None` and a message if its file is absent.
    pub fn mesh(&self) -> Option<TriMesh> {
        match self.source {
            Source::Made(make) => Some(make()),
            Source::File(file) => data(file),
        }
    }

    pub fn zones(&self) -> &[Zone] {
        &self.zones
    }

    pub fn tree(&self, mesh: &TriMesh, levels: u8) -> SphereTree {
        let options = TreeOptions {
            levels,
            volumetric: self.volumetric,
            ..TreeOptions::default()
        };
        let importance = |p: &Vec3| importance(&self.zones, WALL_WEIGHT, p);
        build_weighted(mesh, &options, &importance, &|_, _| ()).expect("a tree")
    }
}

/// A mesh of the data folder, millimetres.
pub fn data(file: &str) -> Option<TriMesh> {
    let path = sulcus_support::data(&format!("meshes/{file}"))?;
    Some(read_solid(&path, Unit::Millimetre).expect("a solid").mesh)
}

pub fn part(name: &str) -> Part {
    all()
        .into_iter()
        .find(|part| part.name == name)
        .expect("a part of that name")
}

pub fn all() -> Vec<Part> {
    let part = |name, source| Part {
        name,
        source,
        volumetric: false,
        zones: Vec::new(),
    };
    vec![
        part("tooth 36", Source::File("tooth_36_first_molar.stl")),
        part("probe", Source::File("dental_probe.stl")),
        part("mirror", Source::File("dental_mirror_parametric.stl")),
        Part {
            volumetric: true,
            ..part("tongue", Source::File("tongue.stl"))
        },
        Part {
            zones: pocket_walls(),
            ..part("pocket patch", Source::File("gingiva_patch_36_pocket.stl"))
        },
        part("parametric molar", Source::Made(|| Molar::default().mesh())),
        part(
            "parametric probe",
            Source::Made(|| Probe::default().touching_mesh()),
        ),
        part(
            "parametric mirror",
            Source::Made(|| Mirror::default().touching_mesh()),
        ),
    ]
}

/// The walls of the patch's pocket stand 0.4 mm off the tooth, above a floor at z = 1 mm.
fn pocket_walls() -> Vec<Zone> {
    let Some(tooth) = data("tooth_36_first_molar.stl") else {
        return Vec::new();
    };
    vec![Zone {
        name: "pocket walls".into(),
        regions: vec![
            Region::Near {
                mesh: Arc::new(MeshDistance::new(tooth)),
                within: 0.45e-3,
            },
            Region::Box {
                low: Vec3::new(-1.0, -1.0, 1.2e-3),
                high: Vec3::repeat(1.0),
            },
        ],
    }]
}
