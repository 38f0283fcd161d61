//! `sulcus-server tree`: builds a sphere tree for one mesh and measures it.

use std::path::{Path, PathBuf};
use std::time::Instant;

use anyhow::Context;
use clap::Args;
use serde::Serialize;
use sulcus_scene::build::{TreeOptions, build_tree};
use sulcus_scene::distance::MeshDistance;
use sulcus_scene::error::{LevelError, tree_errors};
use sulcus_scene::load::Unit;
use sulcus_scene::solid::{Solid, read_solid};

use super::scene::Narrator;

/// Build a sphere tree for a mesh and measure its error, both ways and level by level.
///
/// Example: sulcus-server tree tooth.stl --levels 4
#[derive(Clone, Debug, Args)]
pub struct TreeArgs {
    /// Closed surface as binary or ASCII STL.
    pub mesh: PathBuf,
    /// Finest level, 1 to 6. Level L holds at most 8^L spheres.
    #[arg(long, default_value_t = 4, value_parser = clap::value_parser!(u8).range(1..=6))]
    pub levels: u8,
    /// Unit of the file: mm or m.
    #[arg(long, default_value = "mm")]
    pub unit: Unit,
    /// Weight of place against inscribed balls: 0.4 for bulky things, near 0 for rods.
    #[arg(long, default_value_t = 0.4)]
    pub alpha: f64,
    /// Print one JSON object on the last line of standard output.
    #[arg(long)]
    pub json: bool,
}

#[derive(Serialize)]
struct Report<'a> {
    levels: &'a [LevelError],
    build_s: f64,
    mesh: &'a Path,
    triangles: usize,
    volume_mm3: f64,
}

/// Runs the command; the exit code is 0.
///
/// # Errors
/// If the mesh cannot be read or is not a closed surface.
pub fn run(args: &TreeArgs) -> anyhow::Result<u8> {
    let Solid {
        mesh,
        report: described,
        ..
    } = read_solid(&args.mesh, args.unit)?;
    let defaults = TreeOptions::default();
    let options = TreeOptions {
        levels: args.levels,
        alpha: args.alpha,
        samples: defaults
            .samples
            .max(10 * 8_usize.pow(u32::from(args.levels))),
        ..defaults
    };
    let narrator = Narrator::default();
    let started = Instant::now();
    let tree = build_tree(&mesh, &options, &|stage, share| narrator.say(stage, share))
        .with_context(|| format!("{}: cannot build the tree", args.mesh.display()))?;
    let build_s = started.elapsed().as_secs_f64();
    narrator.say("measuring", 1.0);
    let levels = tree_errors(&tree, &MeshDistance::new(mesh));

    println!(
        "{}: {} triangles, {} mm3",
        args.mesh.display(),
        described.triangles,
        described.volume_mm3
    );
    println!("built in {build_s:.2} s; distances in mm (mean, p95, max)\n");
    println!("level  spheres   mesh to spheres            spheres to mesh");
    for level in &levels {
        let (m, s) = (&level.mesh_to_spheres_mm, &level.spheres_to_mesh_mm);
        println!(
            "{:5}  {:7}   {:7.4} {:7.4} {:7.4}    {:7.4} {:7.4} {:7.4}",
            level.level, level.spheres, m.mean, m.p95, m.max, s.mean, s.p95, s.max
        );
    }
    if args.json {
        let report = Report {
            levels: &levels,
            build_s,
            mesh: &args.mesh,
            triangles: described.triangles,
            volume_mm3: described.volume_mm3,
        };
        println!("{}", serde_json::to_string(&report)?);
    }
    Ok(0)
}
