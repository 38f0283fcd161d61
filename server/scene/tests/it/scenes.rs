//! Compiled scene files: results, refusals, and the cache.

use std::fs;
use std::path::{Path, PathBuf};

use sulcus_core::{Scene, Vec3};
use sulcus_scene::compile::built_in::BuiltIn;
use sulcus_scene::mesh::TriMesh;
use sulcus_scene::mesh::load::to_stl;
use sulcus_scene::mesh::shapes::icosphere;
use sulcus_scene::{BuildOptions, Compiled, compile_default, compile_file, compile_text};

fn quick() -> BuildOptions {
    BuildOptions {
        cache: None,
        deepest: Some(2),
        ..BuildOptions::default()
    }
}

fn compile(dir: &Path, text: &str) -> Result<Compiled, String> {
    let file = dir.join("scene.toml");
    fs::write(&file, text).expect("written");
    compile_file(&file, &quick(), &|_, _| ()).map_err(|error| error.to_string())
}

const BALL: &str = r#"
name = "ball"
[[tool]]
name = "ball end"
mesh = "ball.stl"
unit = "mm"
working_point_mm = [0, 0, 0]
tip_mm = [0, 0, -2]
tip_axis = [0, 0, -2]
park_mm = [0, 0, 50]
park_rotation_deg = [0, 90, 0]
stiffness_n_per_mm = 0.25
[[object]]
name = "ball"
mesh = "ball.stl"
unit = "mm"
translate_mm = [1, 2, 3]
"#;

fn with_ball(mesh: &TriMesh) -> tempfile::TempDir {
    let dir = tempfile::tempdir().expect("temporary directory");
    fs::write(dir.path().join("ball.stl"), to_stl(mesh)).expect("written");
    dir
}

#[test]
fn the_default_scene_is_a_valid_molar_and_probe() {
    let compiled = compile_default(&quick(), &|_, _| ()).expect("compiles");
    let scene = &compiled.scene;
    scene.validate().expect("valid");
    assert!(compiled.warnings.is_empty(), "{:?}", compiled.warnings);
    assert_eq!(
        (scene.name.as_str(), &scene.source_hash),
        ("crown", &compiled.source_hash)
    );
    let (tool, tooth) = (&scene.tools[0], &scene.objects[0]);
    assert_eq!(
        (tooth.fdi, tooth.level, tool.level, tool.bands.len()),
        (36, 2, 2, 15)
    );
    assert_eq!(
        (tool.stiffness_n_per_m, tool.stiffness_nm_per_rad),
        (500.0, 0.5)
    );
    let tip = tool.park.transform(&tool.tip);
    assert!(
        (0.02..0.03).contains(&tip.z),
        "the parked tip is above the crown: {tip:?}"
    );
    // Only working end and shank touch, so levers stay short. The whole instrument is displayed.
    assert!(tool.tree.lever_from(&tool.working_point) < 0.03);
    let highest = tool
        .mesh
        .vertices
        .iter()
        .map(|v| v[2])
        .fold(f32::MIN, f32::max);
    assert!(highest > 0.07, "the handle is shown");
    let bytes = scene.to_bytes().expect("bytes");
    assert_eq!(&Scene::from_bytes(&bytes).expect("scene"), scene);
}

#[test]
fn units_places_and_names_come_from_the_file() {
    let dir = with_ball(&icosphere(0.002, 2));
    let compiled = compile(dir.path(), BALL).expect("compiles");
    let (tool, ball) = (&compiled.scene.tools[0], &compiled.scene.objects[0]);
    let root = &ball.tree.nodes()[0];
    assert!(
        (root.centre - Vec3::new(1e-3, 2e-3, 3e-3)).norm() < 6e-5
            && (root.contact_radius - 2e-3).abs() < 6e-5
    );
    assert!((f64::from(ball.mesh.vertices[0][1]) - 2e-3).abs() < 2.1e-3);
    assert_eq!(tool.stiffness_n_per_m, 250.0);
    assert_eq!(tool.tip_axis, -Vec3::z());
    // A quarter turn about y takes the tip from -z to -x.
    assert!((tool.park.transform(&tool.tip) - Vec3::new(-2e-3, 0.0, 50e-3)).norm() < 1e-12);
}

#[test]
fn the_source_hash_follows_text_and_meshes() {
    let dir = with_ball(&icosphere(0.002, 2));
    let first = compile(dir.path(), BALL).expect("compiles").source_hash;
    assert_eq!(
        compile(dir.path(), BALL).expect("compiles").source_hash,
        first
    );
    assert_ne!(
        compile(dir.path(), &format!("# note\n{BALL}"))
            .expect("compiles")
            .source_hash,
        first
    );
    fs::write(dir.path().join("ball.stl"), to_stl(&icosphere(0.0021, 2))).expect("written");
    assert_ne!(
        compile(dir.path(), BALL).expect("compiles").source_hash,
        first
    );
}

#[test]
fn what_was_repaired_is_a_warning_with_the_name_of_the_part() {
    let whole = icosphere(0.002, 2);
    let dir = with_ball(&whole);
    assert!(
        compile(dir.path(), BALL)
            .expect("compiles")
            .warnings
            .is_empty()
    );
    let mut broken = whole.clone();
    broken.triangles.pop();
    broken.triangles[7].swap(0, 1);
    let dir = with_ball(&broken);
    let compiled = compile(dir.path(), BALL).expect("compiles");
    let [turned, hole, ..] = &compiled.warnings[..] else {
        panic!("{:?}", compiled.warnings)
    };
    assert_eq!(compiled.warnings.len(), 4, "two parts of the same mesh");
    let file = dir.path().join("ball.stl").display().to_string();
    assert!(
        turned.starts_with(&format!("tool `ball end`: {file}: 1 triangle was turned")),
        "{turned}"
    );
    assert!(
        hole.starts_with(&format!(
            "tool `ball end`: {file}: 1 small hole was closed (3 edges, "
        )),
        "{hole}"
    );
    assert!(compiled.warnings[2].starts_with("object `ball`: "));
}

#[test]
fn broken_meshes_and_wrong_units_are_refused_by_file_name() {
    let ball = icosphere(0.002, 2);
    let mut hole = ball.clone();
    let gone = hole.triangles[0][0];
    hole.triangles.retain(|t| !t.contains(&gone));
    let message = compile(with_ball(&hole).path(), BALL).expect_err("refused");
    assert!(
        message.contains("ball.stl: found 5 open edges in 1 hole (5 edges, "),
        "{message}"
    );
    let dir = with_ball(&ball);
    let message = compile(dir.path(), &BALL.replace("\"mm\"", "\"m\"")).expect_err("refused");
    assert!(
        message.contains("in millimetres it would be 4 mm, so write `unit = \"mm\"`"),
        "{message}"
    );
    let message = compile(dir.path(), &BALL.replace("ball.stl", "bell.stl")).expect_err("refused");
    assert!(
        message.contains("bell.stl: cannot read the file"),
        "{message}"
    );
    let missing = compile_file(Path::new("no/scene.toml"), &quick(), &|_, _| ())
        .expect_err("refused")
        .to_string();
    assert!(
        missing.starts_with("no/scene.toml: cannot read the file"),
        "{missing}"
    );
}

#[test]
fn a_tool_parked_inside_something_is_refused_and_an_empty_scene_is_remarked() {
    let dir = with_ball(&icosphere(0.002, 2));
    let message = compile(
        dir.path(),
        &BALL.replace("park_mm = [0, 0, 50]", "park_mm = [1, 2, 4]"),
    )
    .expect_err("refused");
    assert!(
        message.contains("`park_mm` of tool `ball end` is 2.") && message.contains("object `ball`"),
        "{message}"
    );
    let alone = BALL.split("[[object]]").next().expect("tool").to_owned();
    let warnings = compile(dir.path(), &alone).expect("compiles").warnings;
    assert!(
        warnings.len() == 1 && warnings[0].contains("no object can be touched"),
        "{warnings:?}"
    );
}

fn files(dir: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(dir).expect("cache");
    entries.map(|entry| entry.expect("entry").path()).collect()
}

/// Returns the files among `files` whose names begin with `kind`.
fn kept_as(files: &[PathBuf], kind: &str) -> Vec<PathBuf> {
    let name = |file: &&PathBuf| {
        file.file_name()
            .is_some_and(|name| name.to_string_lossy().starts_with(kind))
    };
    files.iter().filter(name).cloned().collect()
}

#[test]
fn a_compiled_scene_is_found_by_its_text_and_options_alone_and_never_with_a_file() {
    let dir = with_ball(&icosphere(0.002, 2));
    let cache = dir.path().join("cache");
    let options = |deepest| BuildOptions {
        cache: Some(cache.clone()),
        deepest,
        ..BuildOptions::default()
    };
    let scenes = || kept_as(&files(&cache), "scene-").len();
    let compile = |text: &str, options: &BuildOptions| {
        compile_text(text, Path::new("a.toml"), options, &|_, _| ()).expect("compiles")
    };
    let crown = BuiltIn::Crown.text();
    compile(crown, &options(None));
    assert_eq!(scenes(), 1);
    // A comment changes nothing but the hash of the source.
    let remarked = format!("# of mine\n{crown}");
    let (mine, first) = (
        compile(&remarked, &options(None)),
        compile(crown, &options(None)),
    );
    assert_eq!(scenes(), 2);
    assert!(mine.scene.objects == first.scene.objects);
    assert_ne!(mine.source_hash, first.source_hash);
    assert!(compile(crown, &options(Some(1))).scene.objects != first.scene.objects);
    assert_eq!(scenes(), 3);
    compile(
        crown,
        &BuildOptions {
            anew: true,
            ..options(Some(1))
        },
    );
    assert_eq!(scenes(), 3);
    // The mesh's file may change while the text stays.
    let file = dir.path().join("ball.toml");
    fs::write(&file, BALL).expect("written");
    let ball = |expected| {
        let ball = compile_file(&file, &options(Some(1)), &|_, _| ()).expect("compiles");
        assert_eq!(scenes(), expected);
        ball.source_hash
    };
    let small = ball(3);
    fs::write(dir.path().join("ball.stl"), to_stl(&icosphere(0.003, 2))).expect("written");
    assert_ne!(ball(3), small);
}

#[test]
fn a_scene_from_the_cache_is_the_same_scene() {
    let dir = tempfile::tempdir().expect("temporary directory");
    let cache = dir.path().join("not/yet/there");
    let options = BuildOptions {
        cache: Some(cache.clone()),
        deepest: Some(2),
        ..BuildOptions::default()
    };
    let built = compile_default(&options, &|_, _| ()).expect("compiles");
    let kept = files(&cache);
    assert_eq!(kept.len(), 3, "one tree for each part, and the scene");
    let stages = std::cell::RefCell::new(String::new());
    let again = || {
        stages.borrow_mut().clear();
        compile_default(&options, &|stage, _| stages.borrow_mut().push_str(stage))
    };
    assert_eq!(again().expect("compiles"), built);
    assert_eq!(*stages.borrow(), "done", "the scene was read whole");
    // The scene is compiled from the trees alone.
    fs::remove_file(&kept_as(&kept, "scene-")[0]).expect("removed");
    assert_eq!(again().expect("compiles"), built);
    assert!(
        stages.borrow().len() > 10 && !stages.borrow().contains("inscribed"),
        "no tree was built: {}",
        stages.borrow()
    );
    // Damaged files are built again, and replaced.
    for file in &kept {
        fs::write(file, b"neither tree nor scene").expect("written");
    }
    assert_eq!(
        compile_default(&options, &|_, _| ()).expect("compiles"),
        built
    );
    assert!(
        kept.iter()
            .all(|file| fs::metadata(file).expect("file").len() > 100)
    );
    // A cache that cannot be written is a warning, not a failure.
    let blocked = dir.path().join("file");
    fs::write(&blocked, b"").expect("written");
    let compiled = compile_default(
        &BuildOptions {
            cache: Some(blocked),
            deepest: Some(1),
            ..BuildOptions::default()
        },
        &|_, _| (),
    )
    .expect("compiles");
    assert!(
        compiled.warnings[0].contains("cannot cache the built tree"),
        "{:?}",
        compiled.warnings
    );
}

#[test]
fn a_mirror_from_numbers_is_a_tool() {
    let dir = with_ball(&icosphere(0.002, 2));
    let (_, object) = BALL.split_once("[[object]]").expect("an object");
    let text = format!(
        "name = \"mirror\"\n[[tool]]\nname = \"mirror\"\nkind = \"mouth_mirror\"\npark_mm = [0, 0, 120]\n[[object]]{object}"
    );
    let scene = compile(dir.path(), &text).expect("compiles").scene;
    let tool = &scene.tools[0];
    assert!((tool.working_point.norm() - 0.09).abs() < 1e-12 && tool.bands.is_empty());
    // Only disc and neck touch; the whole instrument is displayed.
    assert!(tool.tree.lever_from(&tool.working_point) < 0.035);
    let heights = tool.mesh.vertices.iter().map(|v| v[2]);
    assert!(heights.fold(f32::MIN, f32::max) > 0.06);
}

#[test]
fn the_bands_of_a_probe_are_seen_and_kept_in_the_bytes() {
    let text = BuiltIn::Crown.text();
    let who = text.replace(
        "kind = \"periodontal_probe\"",
        "kind = \"periodontal_probe\"\nprobe = { marking = \"who\" }",
    );
    for (text, bands) in [(text, 15), (&*who, 4)] {
        let path = Path::new("my.toml");
        let said = std::cell::RefCell::new(String::new());
        let say = |what: &str, _: f64| said.borrow_mut().push_str(what);
        let mut scene = compile_text(text, path, &quick(), &say)
            .expect("compiles")
            .scene;
        let written = if bands == 4 { "(WHO)" } else { "(UNC-15)" };
        assert!(said.borrow().contains(written), "{}", said.borrow());
        let read = Scene::from_bytes(&scene.to_bytes().expect("bytes")).expect("the same");
        assert_eq!(read, scene);
        let tool = &scene.tools[0];
        assert_eq!(tool.bands.len(), bands);
        let (mesh, colours) = (&tool.mesh, &tool.mesh.vertex_colours);
        assert_eq!(colours.len(), mesh.vertices.len());
        assert!(colours.iter().any(|c| c[0] < 50) && colours.contains(&mesh.colour));
        assert!(scene.objects[0].mesh.vertex_colours.is_empty());
        scene.tools[0].mesh.vertex_colours.pop();
        let error = scene.validate().expect_err("one is missing").to_string();
        assert!(error.contains("vertex colours"), "{error}");
    }
}
