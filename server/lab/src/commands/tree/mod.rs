//! `sulcus-server tree`: builds a sphere tree for one mesh and measures its error.

mod viewer;
mod zone;

use std::path::{Path, PathBuf};
use std::time::Instant;

use anyhow::Context;
use clap::Args;
use serde::Serialize;
use sulcus_core::Vec3;
use sulcus_program::{PathText, say, tell};
use sulcus_scene::error::{LevelError, Sampling, Spread, ZoneError, measure};
use sulcus_scene::mesh::distance::MeshDistance;
use sulcus_scene::mesh::load::Unit;
use sulcus_scene::mesh::repair::Asked;
use sulcus_scene::mesh::size::Size;
use sulcus_scene::mesh::solid::{Reading, read_solid};
use sulcus_scene::tree::build::{TreeOptions, build_weighted};
use sulcus_scene::tree::zone::importance;
use sulcus_sessions::cli::sibling::{BUILDS_REVIEW, find};

use sulcus_program::ProgressLines;
use viewer::Subject;
pub use zone::ZoneArg;

/// Build a sphere tree for a mesh and measure its error, both ways and level by level.
#[derive(Clone, Debug, Args)]
#[command(
    long_about = "Build a sphere tree for a mesh and measure its error, both ways and level by level.\n\nA mesh whose size is implausible for its kind is refused, and so is a tree that fills a volume much different from the mesh's.\n\nWhat is measured are the spheres themselves; a scene may touch them blended into one smooth surface. Maxima are searched for until nothing larger can be left, not taken from samples. With --out the numbers are written as tree.json, and every level with its spheres and the mesh coloured by error as tree.rrd for the Rerun viewer, where the program sulcus-review is installed.",
    after_long_help = "Examples:\n  sulcus-server tree tooth.stl --levels 4\n  sulcus-server tree tooth.stl --levels 4 --out tooth-tree\n  sulcus-server tree gingiva.stl --levels 3 --zone pocket=near:tooth.stl:0.6 --json | tail -1 | jq .zones\n  sulcus-server tree scan.stl --unit in --keep-largest --close-base\n  sulcus-server tree probe.stl --levels 3 --zone tip=ball:0,0,0,1"
)]
pub struct TreeArgs {
    /// Mesh of a closed surface: STL, OBJ or PLY. Small faults are repaired and reported
    pub mesh: PathBuf,
    /// Finest level, 1 to 6. Level L holds at most 8^L spheres
    #[arg(long, default_value_t = 4, value_parser = clap::value_parser!(u8).range(1..=6))]
    pub levels: u8,
    /// Unit of the file: mm, m or in (inches of 25.4 mm)
    #[arg(long, default_value = "mm")]
    pub unit: Unit,
    /// Kind of object, for the check of its size: tooth, tongue, arch (a jaw, or a gingiva of several teeth), instrument,
    /// mouth (any of these) or any (every size from 0.5 to 500 mm)
    #[arg(long, value_name = "KIND", default_value = "mouth")]
    pub size: Size,
    /// Keep the piece with the largest area and drop all others, such as fragments of a scan
    #[arg(long)]
    pub keep_largest: bool,
    /// Close the one flat opening of a scan without a base
    #[arg(long)]
    pub close_base: bool,
    /// Fill the volume on levels 1 and 2. An object that deforms as a whole needs it
    #[arg(long)]
    pub deformable: bool,
    /// Zone of the surface with more samples and a measurement of its own: [NAME=]near:FILE:MM (at most MM
    /// from the surface of another mesh in the same unit and frame), [NAME=]ball:X,Y,Z,R or
    /// [NAME=]box:X,Y,Z,X,Y,Z (mm). The option may be repeated; entries of one name form one zone: their intersection
    #[arg(long, value_name = "ZONE")]
    pub zone: Vec<ZoneArg>,
    /// Weight of a sample in a zone, relative to other samples, in the build of the tree
    #[arg(long, value_name = "W", default_value_t = 1000.0, requires = "zone", value_parser = weight)]
    pub zone_weight: f64,
    /// Folder for the numbers as JSON and a file for Rerun. A missing folder is created
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Print one JSON object as the last line of standard output
    #[arg(long)]
    pub json: bool,
}

fn weight(text: &str) -> Result<f64, String> {
    let found = text.parse().ok().filter(|x| (1.0..=1e6).contains(x));
    found.ok_or(format!(
        "found `{text}`, expected a number from 1 to 1000000"
    ))
}

#[derive(Serialize)]
struct Report<'a> {
    levels: &'a [LevelError],
    zones: &'a [ZoneError],
    build_s: f64,
    measure_s: f64,
    #[serde(serialize_with = "sulcus_program::path::text")]
    mesh: &'a Path,
    triangles: usize,
    volume_mm3: f64,
    repairs: &'a [String],
    notes: &'a [String],
    #[serde(serialize_with = "sulcus_program::path::text_or_null")]
    rerun: Option<&'a Path>,
}

/// Runs the command; the exit code is 0.
///
/// # Errors
/// If the mesh cannot be read or is not a closed surface, a zone makes no sense, or the result cannot
/// be written.
pub fn run(args: &TreeArgs) -> anyhow::Result<u8> {
    let reading = Reading {
        unit: args.unit,
        size: args.size,
        asked: Asked {
            keep_largest: args.keep_largest,
            close_base: args.close_base,
        },
    };
    let solid = read_solid(&args.mesh, reading)?;
    let (mesh, described, notes) = (solid.mesh, solid.report, solid.notes);
    for note in &notes {
        tell!("note: {note}");
    }
    let repairs = solid.repairs.sentences();
    for repair in &repairs {
        tell!("repaired: {repair}");
    }
    let zones = zone::zones(&args.zone, reading, &mesh, &args.mesh)?;
    let distance = MeshDistance::new(mesh);
    if let Some(out) = &args.out {
        // Minutes of building should not end at a folder that cannot be written.
        writable(out)?;
    }
    let options = TreeOptions {
        levels: args.levels,
        volumetric: args.deformable,
        ..TreeOptions::default()
    };
    let importance = |p: &Vec3| importance(&zones, args.zone_weight, p);
    let progress = ProgressLines::default();
    let say = |stage: &str, share: f64| progress.report(stage, share);
    let started = Instant::now();
    let tree = build_weighted(distance.mesh(), &options, &importance, &say)
        .with_context(|| format!("{}: cannot build the tree", args.mesh.shown()))?;
    let build_s = started.elapsed().as_secs_f64();
    let started = Instant::now();
    let report = measure(&tree, &distance, &zones, &Sampling::default(), &|level| {
        let part = f64::from(level) / (f64::from(tree.depth()) + 1.0);
        progress.report(&format!("measuring level {level}"), part);
    });
    let measure_s = started.elapsed().as_secs_f64();

    say!(
        "{}: {} triangles, {} mm3",
        args.mesh.shown(),
        described.triangles,
        described.volume_mm3
    );
    say!(
        "built in {build_s:.2} s, measured in {measure_s:.2} s; distances in mm (mean, p95, max)\n"
    );
    print(&report.levels);
    for zone in &report.zones {
        say!(
            "\nzone `{}`, {:.2} mm2 of the mesh",
            zone.name,
            zone.area_mm2
        );
        print(&zone.levels);
    }
    let rerun = match &args.out {
        Some(out) => {
            let stem = args.mesh.file_stem().unwrap_or(args.mesh.as_os_str());
            let subject = Subject {
                name: Path::new(stem).shown().to_string(),
                distance: &distance,
                tree: &tree,
                report: &report,
            };
            for_rerun(out, &subject)?
        }
        None => None,
    };
    let json = serde_json::to_string(&Report {
        levels: &report.levels,
        zones: &report.zones,
        build_s,
        measure_s,
        mesh: &args.mesh,
        triangles: described.triangles,
        volume_mm3: described.volume_mm3,
        repairs: &repairs,
        notes: &notes,
        rerun: rerun.as_deref(),
    })?;
    if let Some(out) = &args.out {
        let numbers = out.join("tree.json");
        std::fs::write(&numbers, &json)
            .with_context(|| format!("{}: cannot write the numbers", numbers.shown()))?;
        say!("");
        for path in [Some(&numbers), rerun.as_ref()].into_iter().flatten() {
            say!("written to {}", path.shown());
        }
    }
    if args.json {
        say!("{json}");
    }
    Ok(0)
}

/// Makes the folder if need be and writes a file into it.
pub(crate) fn writable(folder: &Path) -> anyhow::Result<()> {
    let probe = folder.join(".sulcus-tree");
    std::fs::create_dir_all(folder)
        .and_then(|()| std::fs::write(&probe, b""))
        .and_then(|()| std::fs::remove_file(&probe))
        .with_context(|| format!("{}: cannot write into the folder of --out", folder.shown()))
}

/// The path of the written file; none where the program that writes files for Rerun is not installed.
fn for_rerun(folder: &Path, subject: &Subject) -> anyhow::Result<Option<PathBuf>> {
    let program = match find("sulcus-review", BUILDS_REVIEW) {
        Ok(program) => program,
        Err(missing) => {
            tell!("note: no tree.rrd: {missing}");
            return Ok(None);
        }
    };
    let path = folder.join("tree.rrd");
    viewer::write(&program, &path, subject)?;
    Ok(Some(path))
}

fn print(levels: &[LevelError]) {
    say!(
        "level  spheres   mesh to spheres            spheres to mesh           outside %  volume %"
    );
    for level in levels {
        let (out, back) = (&level.mesh_to_spheres_mm, &level.spheres_to_mesh_mm);
        let volume = level.volume.map_or(String::new(), |volume| {
            format!("{:+9.2}", volume.volume_error_percent)
        });
        say!(
            "{:5}  {:7}   {}    {}   {:9.1} {volume}",
            level.level,
            level.spheres,
            three(out),
            three(back),
            level.uncovered_area_percent,
        );
    }
}

/// Mean, percentile and maximum as columns; a stroke where there is no distance.
fn three(spread: &Spread) -> String {
    let [mean, p95, max] = [spread.mean, spread.p95, spread.max].map(|mm| match mm.is_nan() {
        true => "      -".to_owned(),
        false => format!("{mm:7.4}"),
    });
    format!("{mean} {p95} {max}")
}
