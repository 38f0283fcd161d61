//! The real lower left arch as a scene, from the data folder beside the project.

use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use sulcus_core::tissue::TissueModel;
use sulcus_core::tissue::gingiva::Gingiva;
use sulcus_core::{Scene, Vec3};
use sulcus_scene::mesh::distance::MeshDistance;
use sulcus_scene::mesh::load::Unit;
use sulcus_scene::{BuildOptions, compile_text, read_solid};

/// Files of the teeth, with their FDI numbers.
const TEETH: [(u8, &str); 7] = [
    (31, "tooth_31_central_incisor"),
    (32, "tooth_32_lateral_incisor"),
    (33, "tooth_33_canine"),
    (34, "tooth_34_first_premolar"),
    (35, "tooth_35_second_premolar"),
    (36, "tooth_36_first_molar"),
    (37, "tooth_37_second_molar"),
];

/// Two tools, the gingiva of tooth 36, and a tongue that was put into this jaw.
const REST: &str = r#"
name = "real arch"

[[tool]]
name = "probe"
kind = "periodontal_probe"
level = 3
levels = 3
park_mm = [3.0, 60.0, 140.0]

[[tool]]
name = "mirror"
kind = "mouth_mirror"
level = 3
levels = 3
stiffness_nmm_per_rad = 3000.0
park_mm = [60.0, -40.0, 180.0]

[[object]]
name = "gingiva 36"
mesh = "gingiva_patch_36_pocket.stl"
unit = "mm"
tooth = "tooth 36"
tissue = "gingiva"
level = 3
levels = 3

[[object]]
name = "tongue"
mesh = "tongue.stl"
unit = "mm"
translate_mm = [-18.0, 0.0, -30.0]
tissue = "skeleton"
level = 3
levels = 3
"#;

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data/meshes")
}

/// The mesh in a file of the data folder, metres; none where there is no data.
pub fn mesh(name: &str) -> Option<MeshDistance> {
    let file = sulcus_support::data(&format!("meshes/{name}.stl"))?;
    let solid = read_solid(&file, Unit::Millimetre).expect("a solid");
    Some(MeshDistance::new(solid.mesh))
}

/// The file of a tooth.
pub fn file_of(fdi: u8) -> &'static str {
    let found = TEETH.iter().find(|(of, _)| *of == fdi);
    found.expect("a tooth of the arch").1
}

/// The whole scene; none where there is no data.
pub fn scene() -> Option<&'static Scene> {
    static SCENE: OnceLock<Option<Scene>> = OnceLock::new();
    let made = SCENE.get_or_init(|| {
        mesh("tongue")?;
        let mut text = REST.to_owned();
        for (fdi, file) in TEETH {
            text += &format!(
                "[[object]]\nname = \"tooth {fdi}\"\nfdi = {fdi}\nmesh = \"{file}.stl\"\nunit = \"mm\"\nlevel = 3\nlevels = 3\n"
            );
        }
        let path = folder().join("real-arch.toml");
        let made = compile_text(&text, &path, &BuildOptions::cached(), &|_, _| ());
        Some(made.expect("the real arch").scene)
    });
    made.as_ref()
}

/// Number of an object in the scene.
pub fn object(scene: &Scene, name: &str) -> usize {
    let found = scene.objects.iter().position(|object| object.name == name);
    found.expect("an object of that name")
}

/// The gingiva of tooth 36.
pub fn gingiva(scene: &Scene) -> &Gingiva {
    match &scene.objects[object(scene, "gingiva 36")].tissue {
        TissueModel::Gingiva(model) => model,
        other => panic!("{other:?}"),
    }
}

/// Tooth 36 and an explorer whose mesh has its tip at the lower end; none where there is no data.
pub fn explorer() -> Option<Scene> {
    let mesh = mesh("dental_probe")?;
    let low = |a: &&Vec3, b: &&Vec3| a.z.total_cmp(&b.z);
    let tip = *mesh.mesh().vertices.iter().min_by(low)?;
    let [x, y, z] = [tip.x, tip.y, tip.z].map(|x| x * 1e3);
    let text = format!(
        r#"
name = "explorer"
[[tool]]
name = "explorer"
mesh = "dental_probe.stl"
unit = "mm"
tip_mm = [{x}, {y}, {z}]
tip_axis = [0, 0, -1]
working_point_mm = [{x}, {y}, {}]
level = 3
levels = 3
park_mm = [0, 60, 140]
[[object]]
name = "tooth 36"
fdi = 36
mesh = "tooth_36_first_molar.stl"
unit = "mm"
level = 3
levels = 3
"#,
        z + 4.0
    );
    let path = folder().join("explorer.toml");
    let made = compile_text(&text, &path, &BuildOptions::cached(), &|_, _| ());
    Some(made.expect("an explorer").scene)
}
