//! Scenes for the hard cases of tissue: built-in scenes with changed values.

use std::collections::BTreeMap;
use std::sync::Mutex;

use sulcus_core::tissue::TissueModel;
use sulcus_core::{DisplayMesh, Object, Scene, Sphere, SphereTree, Vec3};
use sulcus_scene::{BuildOptions, BuiltIn, compile_text};

/// Text of a built-in scene with other values of some keys, in every line that sets the key.
///
/// # Panics
/// The scene has no such key, which is a fault of the table of cases.
fn changed_text(which: BuiltIn, values: &[(&str, &str)]) -> String {
    let mut found = vec![false; values.len()];
    let lines = which.text().lines().map(|line| {
        let of = |k: &(&str, &str)| line.split('=').next().is_some_and(|key| key.trim() == k.0);
        match values.iter().position(of) {
            Some(k) => {
                found[k] = true;
                format!("{} = {}\n", values[k].0, values[k].1)
            }
            None => format!("{line}\n"),
        }
    });
    let text: String = lines.collect();
    assert!(
        found.iter().all(|found| *found),
        "{values:?} are not all in {which:?}"
    );
    text
}

/// A built-in scene with other values of some keys. Cases share compiled scenes.
///
/// # Panics
/// The scene has no such key or does not compile, which is a fault of the table of cases.
pub fn changed(which: BuiltIn, values: &[(&str, &str)]) -> Scene {
    static BUILT: Mutex<BTreeMap<String, Scene>> = Mutex::new(BTreeMap::new());
    let text = changed_text(which, values);
    let mut built = BUILT.lock().expect("no build panicked");
    if let Some(scene) = built.get(&text) {
        return scene.clone();
    }
    let compiled = compile_text(
        &text,
        which.file_name(),
        &BuildOptions::cached(),
        &|_, _| {},
    );
    let scene = compiled.expect("the built-in scenes compile").scene;
    built.insert(text, scene.clone());
    scene
}

/// The shipped tongue with a coupling of the mirror of `coupling` N/mm.
pub fn tongue(coupling: f64) -> Scene {
    let mut scene = changed(BuiltIn::Tongue, &[]);
    scene.tools[0].stiffness_n_per_m = coupling * 1e3;
    scene
}

/// The shipped tongue of finite elements with a coupling of the mirror of `coupling` N/mm.
pub fn organ(coupling: f64) -> Scene {
    let mut scene = changed(BuiltIn::Organ, &[]);
    scene.tools[0].stiffness_n_per_m = coupling * 1e3;
    scene
}

/// Widths of the pockets of the hard cases, millimetres. The program contains their trees.
pub const POCKET_WIDTHS: [&str; 4] = ["0.4", "0.5", "0.65", "0.8"];

/// Keys and values of the molar with a pocket of `width` mm, 4 mm deep all round.
fn pocket_keys(width: &str) -> [(&str, &str); 2] {
    [
        ("width_mm", width),
        ("depths_mm", "[4.0, 4.0, 4.0, 4.0, 4.0, 4.0]"),
    ]
}

/// The molar with a pocket of `width` mm, 4 mm deep all round.
pub fn pocket(width: &str) -> Scene {
    changed(BuiltIn::Pocket, &pocket_keys(width))
}

/// Text of the scene of [`pocket`].
pub fn pocket_text(width: &str) -> String {
    changed_text(BuiltIn::Pocket, &pocket_keys(width))
}

/// The scene with its first tool twice.
pub fn twice(mut scene: Scene) -> Scene {
    let mut second = scene.tools[0].clone();
    second.name.push_str(" in the other hand");
    scene.tools.push(second);
    scene
}

/// The scene with a thousand times the stiffness in every deformable object.
pub fn stiff(mut scene: Scene) -> Scene {
    for object in &mut scene.objects {
        stiffen(&mut object.tissue, 1e3);
    }
    scene
}

/// Multiplies all stiffnesses of a tissue by `by`, within their ranges.
fn stiffen(tissue: &mut TissueModel, by: f64) {
    match tissue {
        TissueModel::Gingiva(gingiva) => {
            let p = &mut gingiva.params;
            for stiffness in [
                &mut p.wall_stiffness,
                &mut p.shear_stiffness,
                &mut p.floor_stiffness,
            ] {
                *stiffness = (*stiffness * by).min(1e6);
            }
        }
        TissueModel::Skeleton(skeleton) => {
            let levels = [Some(&mut skeleton.coarse), skeleton.fine.as_mut()];
            for level in levels.into_iter().flatten() {
                for spring in &mut level.springs {
                    spring.stiffness = spring.stiffness.map(|k| k * by);
                }
            }
        }
        TissueModel::Surface(organ) => {
            organ.params.young = (organ.params.young * by).min(1e8);
        }
        _ => {}
    }
}

/// A rigid bar of 1 mm radius along x through `centre`.
pub fn bar(centre: Vec3) -> Object {
    let spheres: Vec<Sphere> = (-120..=120)
        .map(|k| Sphere {
            centre: centre + Vec3::new(f64::from(k) * 1e-4, 0.0, 0.0),
            radius: 1e-3,
        })
        .collect();
    Object {
        name: "bar".into(),
        fdi: 0,
        tree: SphereTree::over_leaves(&spheres).expect("finite and positive"),
        level: sulcus_core::tree::MAX_LEVEL,
        tissue: TissueModel::Rigid,
        mesh: DisplayMesh::default(),
        carriers: Vec::new(),
    }
}
