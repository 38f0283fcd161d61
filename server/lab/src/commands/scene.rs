//! `sulcus-server scene check` and `scene build`: scene files to compiled scenes.

use std::path::{Path, PathBuf};

use anyhow::Context;
use clap::{Args, Subcommand};
use serde::Serialize;
use sulcus_cases::tissue_scenes::{POCKET_WIDTHS, pocket_text};
use sulcus_core::Scene;
use sulcus_core::scene::displayable::too_stiff;
use sulcus_program::{PathText, ProgressLines, say, tell};
use sulcus_scene::compile::family;
use sulcus_scene::{BuildOptions, BuiltIn, Compiled, compile_built_in, compile_file, compile_text};

use crate::picture::{MOUTH, Still};

/// Check, draw and compile scene files.
#[derive(Clone, Debug, Args)]
pub struct SceneArgs {
    /// Action.
    #[command(subcommand)]
    pub action: SceneAction,
}

/// What `scene` can do.
#[derive(Clone, Debug, Subcommand)]
pub enum SceneAction {
    /// Read a scene file, check every file that it names, and print its content.
    ///
    /// Example: sulcus-server scene check server/scenes/crown.toml
    Check {
        /// Scene file (TOML).
        file: PathBuf,
        /// Print one JSON object as the last line of standard output.
        #[arg(long)]
        json: bool,
    },
    /// Draw a scene at rest from several sides, as PNG files.
    ///
    /// Example: sulcus-server scene picture server/scenes/mouth.toml --out pictures --only tooth --only gingiva
    Picture {
        /// Scene file (TOML).
        file: PathBuf,
        /// Folder for the pictures. A missing folder is created.
        #[arg(long)]
        out: PathBuf,
        /// Draw only objects whose names contain this text. The option may be repeated.
        #[arg(long)]
        only: Vec<String>,
        /// Length of the longer edge, pixels.
        #[arg(long, default_value_t = 1200, value_parser = clap::value_parser!(u16).range(64..=8000))]
        pixels: u16,
    },
    /// Build the trees of all built-in scenes into the file that the program carries. The build takes minutes. A change of
    /// a built-in shape needs it.
    ///
    /// Example: sulcus-server scene family --out server/scenes/family.bin
    Family {
        /// File to write.
        #[arg(long)]
        out: PathBuf,
    },
    /// Compile a scene file into the binary scene that servers and recordings use.
    ///
    /// Example: sulcus-server scene build server/scenes/crown.toml --out crown.scene
    Build {
        /// Scene file (TOML).
        file: PathBuf,
        /// File to write. Default: the name of the scene file with the extension .scene.
        #[arg(long)]
        out: Option<PathBuf>,
        /// Build every tree, without the cache.
        #[arg(long)]
        no_cache: bool,
        /// Print one JSON object as the last line of standard output.
        #[arg(long)]
        json: bool,
    },
}

#[derive(Serialize)]
struct Part<'a> {
    name: &'a str,
    fdi: u8,
    level: u8,
    spheres: usize,
    finest_level: u8,
    finest_spheres: usize,
    triangles: usize,
}

#[derive(Serialize)]
struct Report<'a> {
    scene: &'a str,
    #[serde(serialize_with = "sulcus_program::path::text")]
    file: &'a Path,
    source_hash: &'a str,
    scene_hash: String,
    bytes: usize,
    #[serde(serialize_with = "sulcus_program::path::text_or_null")]
    out: Option<&'a Path>,
    tools: Vec<Part<'a>>,
    objects: Vec<Part<'a>>,
    warnings: &'a [String],
}

/// Runs the command; the exit code is 0.
///
/// # Errors
/// If the scene or a mesh that it names cannot be used, or the result cannot be written.
pub fn run(args: &SceneArgs) -> anyhow::Result<u8> {
    let progress = ProgressLines::default();
    let (file, out, json, cached) = match &args.action {
        SceneAction::Picture {
            file,
            out,
            only,
            pixels,
        } => {
            let say = |stage: &str, share: f64| progress.report(stage, share);
            let compiled = compile_file(file, &BuildOptions::cached(), &say)?;
            return pictures(&compiled.scene, out, only, usize::from(*pixels)).map(|()| 0);
        }
        SceneAction::Family { out } => {
            let say = |stage: &str, share: f64| progress.report(stage, share);
            return build_family(out, &say).map(|()| 0);
        }
        SceneAction::Check { file, json } => (file, None, *json, true),
        SceneAction::Build {
            file,
            out,
            no_cache,
            json,
        } => {
            let out = out.clone().unwrap_or_else(|| file.with_extension("scene"));
            (file, Some(out), *json, !no_cache)
        }
    };
    let options = if cached {
        BuildOptions::cached()
    } else {
        BuildOptions {
            anew: true,
            ..BuildOptions::default()
        }
    };
    let mut compiled = compile_file(file, &options, &|stage, share| {
        progress.report(stage, share)
    })?;
    let too_stiff = too_stiff(&compiled.scene);
    compiled.warnings.extend(
        too_stiff
            .iter()
            .map(|coupling| format!("{coupling}; a graded session refuses it")),
    );
    let bytes = compiled.scene.to_bytes()?;
    if let Some(out) = &out {
        std::fs::write(out, &bytes)
            .with_context(|| format!("{}: cannot write the compiled scene", out.shown()))?;
    }
    for warning in &compiled.warnings {
        tell!("warning: {warning}");
    }
    let report = report(&compiled, file, out.as_deref(), &bytes);
    print(&report);
    if json {
        say!("{}", serde_json::to_string(&report)?);
    }
    Ok(0)
}

/// Compiles all built-in scenes and the pockets of the hard cases with a cache beside `out`, and packs their trees. Trees
/// of unchanged shapes are taken from the present family.
fn build_family(out: &Path, say: &dyn Fn(&str, f64)) -> anyhow::Result<()> {
    let folder = out.with_extension("building");
    let options = BuildOptions {
        cache: Some(folder.clone()),
        copies: true,
        ..BuildOptions::default()
    };
    for scene in BuiltIn::ALL {
        compile_built_in(scene, &options, say)?;
    }
    for width in POCKET_WIDTHS {
        let file = BuiltIn::Pocket.file_name();
        compile_text(&pocket_text(width), file, &options, say)?;
    }
    let bytes = family::pack(&folder).context("the built trees cannot be read back")?;
    std::fs::write(out, &bytes).with_context(|| format!("{}: cannot write", out.shown()))?;
    std::fs::remove_dir_all(&folder)
        .with_context(|| format!("{}: cannot remove", folder.shown()))?;
    say!("{}: {} bytes", out.shown(), bytes.len());
    Ok(())
}

/// Writes one picture for each side.
fn pictures(scene: &Scene, out: &Path, only: &[String], pixels: usize) -> anyhow::Result<()> {
    let still = Still::of(scene, only).with_context(|| {
        let names: Vec<&str> = scene.objects.iter().map(|o| o.name.as_str()).collect();
        format!(
            "`--only` is {only:?}, expected a part of the name of an object: {}",
            names.join(", ")
        )
    })?;
    std::fs::create_dir_all(out).with_context(|| format!("{}: cannot be made", out.shown()))?;
    for side in &MOUTH {
        let file = out.join(format!("{}.png", side.name));
        let png = still.picture(side, pixels).to_png()?;
        std::fs::write(&file, png).with_context(|| format!("{}: cannot write", file.shown()))?;
        say!("{}: {}", file.shown(), side.caption);
    }
    Ok(())
}

fn report<'a>(
    compiled: &'a Compiled,
    file: &'a Path,
    out: Option<&'a Path>,
    bytes: &[u8],
) -> Report<'a> {
    let part = |name: &'a str, fdi, tree: &sulcus_core::SphereTree, level, triangles| Part {
        name,
        fdi,
        level,
        spheres: tree.shape_at(level).count(),
        finest_level: tree.depth(),
        finest_spheres: tree.shape_at(tree.depth()).count(),
        triangles,
    };
    let scene = &compiled.scene;
    Report {
        scene: &scene.name,
        file,
        source_hash: &compiled.source_hash,
        scene_hash: blake3::hash(bytes).to_hex().to_string(),
        bytes: bytes.len(),
        out,
        tools: scene
            .tools
            .iter()
            .map(|t| part(&t.name, 0, &t.tree, t.level, t.mesh.triangles.len()))
            .collect(),
        objects: scene
            .objects
            .iter()
            .map(|o| part(&o.name, o.fdi, &o.tree, o.level, o.mesh.triangles.len()))
            .collect(),
        warnings: &compiled.warnings,
    }
}

fn print(report: &Report) {
    say!("scene `{}` from {}", report.scene, report.file.shown());
    for (what, parts) in [("tool", &report.tools), ("object", &report.objects)] {
        for part in parts {
            let tooth = if part.fdi > 0 {
                format!(" (FDI {})", part.fdi)
            } else {
                String::new()
            };
            say!(
                "  {what} `{}`{tooth}: level {} with {} spheres, built to level {} with {}, {} triangles",
                part.name,
                part.level,
                part.spheres,
                part.finest_level,
                part.finest_spheres,
                part.triangles
            );
        }
    }
    say!("  source {}", report.source_hash);
    say!("  scene  {} ({} bytes)", report.scene_hash, report.bytes);
    if let Some(out) = report.out {
        say!("  written to {}", out.shown());
    }
}
