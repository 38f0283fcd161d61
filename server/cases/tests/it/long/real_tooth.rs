//! The crown of a real molar, explored.

use std::path::PathBuf;

use sulcus_scene::compile_file;
use sulcus_support::long;

use crate::crown::{assert_good, options, perform};

#[test]
fn a_good_hand_explores_a_real_crown() {
    if !long::selected("real-tooth") {
        return;
    }
    let Some(mesh) = sulcus_support::data("meshes/tooth_36_first_molar.stl") else {
        return;
    };
    let folder = std::env::temp_dir().join(format!("sulcus-real-tooth-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("temporary folder");
    let file: PathBuf = folder.join("real.toml");
    let text = format!(
        "name = \"real tooth\"\n[[tool]]\nname = \"probe\"\nkind = \"periodontal_probe\"\nlevel = 3\nlevels = 4\npark_mm = [3.0, 21.0, 125.0]\n\
         [[object]]\nname = \"tooth 36\"\nfdi = 36\nmesh = {mesh:?}\nunit = \"mm\"\nlevel = 3\nlevels = 4\ntissue = \"rigid\"\n"
    );
    std::fs::write(&file, text).expect("scene file");
    let compiled =
        compile_file(&file, &options(), &|_, _| {}).expect("a real tooth is a good mesh");
    std::fs::remove_dir_all(&folder).expect("temporary folder");
    assert_good("real tooth 36", &perform(&compiled.scene, 8.0, 36));
}
