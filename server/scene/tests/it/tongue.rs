//! Tongues from scene files: results and refusals.

use std::fs;
use std::path::Path;

use sulcus_core::Scene;
use sulcus_core::tissue::TissueModel;
use sulcus_core::tissue::skeleton::Skeleton;
use sulcus_scene::anatomy::Tongue;
use sulcus_scene::compile::built_in::BuiltIn;
use sulcus_scene::organ::skeleton::{SkeletonError, SkeletonOptions, skeleton};
use sulcus_scene::tree::build::{TreeOptions, build_tree};
use sulcus_scene::{BuildOptions, Compiled, compile_file};

fn compile(text: &str) -> Result<Compiled, String> {
    let dir = tempfile::tempdir().expect("temporary directory");
    let file = dir.path().join("scene.toml");
    fs::write(&file, text).expect("written");
    let options = BuildOptions {
        cache: None,
        deepest: Some(2),
        ..BuildOptions::default()
    };
    compile_file(Path::new(&file), &options, &|_, _| ()).map_err(|error| error.to_string())
}

#[test]
fn wrong_keys_and_values_are_refused_by_name() {
    let text = BuiltIn::Tongue.text();
    let with = |from: &str, to: &str| {
        assert!(text.contains(from), "{from}");
        compile(&text.replacen(from, to, 1)).expect_err("refused")
    };
    for (from, to, wanted) in [
        (
            "root_factor = 2.0",
            "root_factor = 0.0",
            "`skeleton.root_factor` of object `tongue` is 0, expected 0.1 to 20",
        ),
        (
            "damping_n_s_per_m = 0.3",
            "damping_n_s_per_m = nan",
            "`skeleton.damping_n_s_per_m` of object `tongue` is NaN, expected 0 to 100 N s/m",
        ),
        ("root_factor", "rot_factor", "unknown field `rot_factor`"),
        (
            "tissue = \"skeleton\"",
            "tissue = \"rigid\"",
            "`skeleton` of object `tongue` is given, expected nothing without tissue = \"skeleton\"",
        ),
        (
            "kind = \"tongue\"",
            "kind = \"tongue\"\ntongue.length_mm = 400",
            "`tongue.length_mm` of object `tongue` is 400, expected 40 to 120 mm",
        ),
        (
            "kind = \"tongue\"",
            "kind = \"molar\"\ntongue.length_mm = 70",
            "`tongue` of object `tongue` is given, expected nothing without kind = \"tongue\"",
        ),
        (
            "kind = \"tongue\"\nlevel = 3\nlevels = 3",
            "kind = \"tongue\"\nlevel = 1\nlevels = 1",
            "`levels` of object `tongue` is 1, expected 2 to 5",
        ),
        (
            "root_factor = 2.0",
            "fixed_root = 0.0\nfixed_bottom = 0.0",
            "object `tongue`: found 0 fixed of 64 skeleton nodes",
        ),
    ] {
        let message = with(from, to);
        assert!(message.contains(wanted), "{message}\nwanted {wanted}");
    }
}

fn model(scene: &Scene) -> &Skeleton {
    match &scene.objects[0].tissue {
        TissueModel::Skeleton(model) => model,
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_tongue_is_a_skeleton_stiff_at_the_root_soft_at_the_tip_wherever_it_lies() {
    let scene = compile(BuiltIn::Tongue.text()).expect("compiles").scene;
    let (coarse, tree) = (&model(&scene).coarse, &scene.objects[0].tree);
    assert_eq!(model(&scene).fine, None, "the tree is not deep enough");
    assert_eq!(coarse.nodes.len(), 64);
    assert!(
        (8..32).contains(&(64 - coarse.free())),
        "{} free",
        coarse.free()
    );
    let total = coarse.params.mass * 64.0;
    assert!((0.05..0.09).contains(&total), "a tongue of {total} kg");
    let (mut root, mut tip) = (f64::INFINITY, 0.0_f64);
    for spring in &coarse.springs {
        let [x, y, z] = spring.stiffness;
        assert!((x / y - 6.5 / 5.5).abs() < 1e-12 && y == z);
        let at = |k: u16| tree.nodes()[coarse.nodes[usize::from(k)] as usize].centre.x;
        let middle = 0.5 * (at(spring.a) + at(spring.b));
        if middle < -0.026 {
            root = root.min(z);
        } else if middle > 0.026 {
            tip = tip.max(z);
        }
    }
    assert!(
        (root - 11.0).abs() < 0.1 && (tip - 3.85).abs() < 0.1,
        "{root} {tip}"
    );
    let text = BuiltIn::Tongue.text();
    let elsewhere = text.replace(
        "levels = 3\ntissue",
        "levels = 3\ntranslate_mm = [5, -4, 20]\ntissue",
    );
    assert_ne!(elsewhere, text);
    let moved = compile(&elsewhere).expect("compiles").scene;
    assert_eq!(model(&moved), model(&scene));
}

#[test]
fn a_skeleton_with_a_part_that_hangs_on_nothing_names_the_node() {
    // Two tongues in one mesh, the second far in front: only the first has a root.
    let tongue = Tongue {
        grid_mm: 2.0,
        ..Tongue::default()
    };
    let mut both = tongue.mesh();
    let front = tongue
        .mesh()
        .placed(1.0, sulcus_core::Vec3::new(0.2, 0.0, 0.0));
    let shift = both.vertices.len() as u32;
    both.triangles
        .extend(front.triangles.iter().map(|t| t.map(|v| v + shift)));
    both.vertices.extend(front.vertices);
    let options = TreeOptions {
        levels: 2,
        volumetric: true,
        ..TreeOptions::default()
    };
    let tree = build_tree(&both, &options, &|_, _| ()).expect("a tree");
    let held = SkeletonOptions {
        fixed_bottom: 0.0,
        ..SkeletonOptions::default()
    };
    match skeleton(&tree, &both, &held) {
        Err(SkeletonError::Isolated {
            level: 2, at_mm, ..
        }) => {
            assert!(at_mm[0] > 150.0, "{at_mm:?}");
        }
        other => panic!("{:?}", other.map(|model| model.coarse.springs.len())),
    }
}
