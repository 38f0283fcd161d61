//! What `export` writes, read back: tables with a line for every tick, meshes that are where the tissue was.

use std::collections::BTreeMap;
use std::path::Path;

use sulcus_sessions::Recording;
use sulcus_tests::{Place, Program, files_with, rows};

/// The columns of a table by name.
fn table(path: &Path) -> BTreeMap<String, Vec<String>> {
    let mut csv = csv::Reader::from_path(path).expect("a table");
    let names: Vec<String> = csv
        .headers()
        .expect("a head")
        .iter()
        .map(str::to_owned)
        .collect();
    let mut columns: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for line in csv.records() {
        let line = line.expect("as many fields as the head has");
        for (name, field) in names.iter().zip(line.iter()) {
            columns
                .entry(name.clone())
                .or_default()
                .push(field.to_owned());
        }
    }
    assert_eq!(columns.len(), names.len(), "no name twice");
    columns
}

/// Vertices of a binary PLY of ours.
fn ply_vertices(path: &Path) -> Vec<[f32; 3]> {
    let bytes = std::fs::read(path).expect("a file");
    let end = b"end_header\n";
    let at = bytes.windows(end.len()).position(|window| window == end);
    let body = at.expect("a head's end") + end.len();
    let head = std::str::from_utf8(&bytes[..body]).expect("text");
    let number = |what: &str| -> usize {
        let line = head.lines().find_map(|line| line.strip_prefix(what));
        line.expect("its number").parse().expect("a number")
    };
    let (vertices, faces) = (number("element vertex "), number("element face "));
    assert_eq!(bytes.len(), body + 16 * vertices + 13 * faces, "{path:?}");
    let x = |bytes: &[u8]| f32::from_le_bytes(bytes.try_into().expect("four"));
    bytes[body..body + 16 * vertices]
        .chunks_exact(16)
        .map(|v| [x(&v[..4]), x(&v[4..8]), x(&v[8..12])])
        .collect()
}

#[test]
fn tables_have_every_tick_and_meshes_are_where_the_tissue_was() {
    let place = Place::new();
    let demo = ["demo", "--virtual", "--duration", "10", "--json"];
    place.run(Program::Client, &demo).ok();
    let file = place.recording();
    let plain = file.to_str().expect("a plain path");
    let said = place
        .run(
            Program::Sessions,
            &[
                "export", plain, "--out", "all", "--csv", "--meshes", "ply", "--at", "0", "--at",
                "6", "--json",
            ],
        )
        .ok()
        .json();
    assert_eq!(
        (&said["identical"], &said["mesh_frames"]),
        (&true.into(), &2.into())
    );

    let recording = Recording::open(&file).expect("a recording");
    let rows = rows(&recording);
    let ticks = table(&place.path("all/ticks.csv"));
    assert_eq!(ticks["tick"].len(), rows.len());
    assert_eq!(said["tick_lines"], rows.len());
    let number = |column: &str, k: usize| -> f64 {
        let field = &ticks[column][k];
        field
            .parse()
            .unwrap_or_else(|error| panic!("{column} {k} `{field}`: {error}"))
    };
    let mut deepest = 0.0f64;
    for (k, row) in rows.iter().enumerate() {
        assert_eq!(ticks["tick"][k], row.tick.to_string());
        assert_eq!(ticks["hash"][k], format!("'{:016x}", row.hash));
        assert_eq!(ticks["probe_status"][k], row.status[0].to_string());
        if !ticks["probe_force_x_n"][k].is_empty() {
            for (c, column) in ["x", "y", "z"].into_iter().enumerate() {
                let sent = number(&format!("probe_force_{column}_n"), k);
                assert_eq!(sent as f32, row.wrench[0][c]);
            }
        }
        if !ticks["probe_depth_mm"][k].is_empty() {
            deepest = deepest.max(number("probe_depth_mm", k));
        }
    }
    assert!(deepest > 0.5, "the probe was {deepest} mm in a pocket");
    let events = table(&place.path("all/events.csv"));
    assert_eq!(events["time_s"].len() as u64, recording.facts().events);
    assert!(events["kind"].iter().any(|kind| kind == "site_reached"));

    // By then the mirror holds the tongue aside; before, nothing has been touched.
    let frames = table(&place.path("all/meshes/frames.csv"));
    let shown = |time: &str, part: &str| {
        let lines = frames["time_s"]
            .iter()
            .zip(&frames["part"])
            .zip(&frames["file"]);
        let mut files = lines.filter(|((at, of), _)| *at == time && *of == part);
        files.next().expect("it is shown").1.clone()
    };
    assert_eq!(shown("0", "tongue"), "rest/tongue.ply");
    let late = shown("6", "tongue");
    assert_eq!(late, "6001/tongue.ply");
    assert_eq!(shown("6", "tooth_36"), "rest/tooth_36.ply");
    let meshes = place.path("all/meshes");
    let (rest, held) = (
        ply_vertices(&meshes.join("rest/tongue.ply")),
        ply_vertices(&meshes.join(late)),
    );
    assert_eq!(rest.len(), held.len());
    let far = rest.iter().zip(&held).map(|(a, b)| {
        let square = |k: usize| f64::from(a[k] - b[k]).powi(2);
        (square(0) + square(1) + square(2)).sqrt()
    });
    let far = far.fold(0.0, f64::max);
    assert!(
        (1e-3..0.03).contains(&far),
        "the tongue was moved by {far} m"
    );
    // The probe's mesh has its tip where the table says.
    let line = 6000;
    let tip = ["x", "y", "z"].map(|c| number(&format!("probe_tip_{c}_m"), line));
    let probe = ply_vertices(&meshes.join("6001/probe.ply"));
    let near = probe.iter().map(|v| {
        let square = |k: usize| (f64::from(v[k]) - tip[k]).powi(2);
        (square(0) + square(1) + square(2)).sqrt()
    });
    let near = near.fold(f64::MAX, f64::min);
    assert!(near < 0.5e-3, "the nearest vertex is {near} m from the tip");

    // The same as text; every so many ticks; nothing is overwritten.
    place
        .run(
            Program::Sessions,
            &[
                "export", plain, "--out", "text", "--meshes", "obj", "--at", "6",
            ],
        )
        .ok();
    let obj = std::fs::read_to_string(place.path("text/meshes/6001/tongue.obj")).expect("a file");
    let vertices = obj.lines().filter(|line| line.starts_with("v ")).count();
    assert_eq!(vertices, held.len());
    assert!(files_with(&place.path("text"), "ply").is_empty());
    place
        .run(
            Program::Sessions,
            &["export", plain, "--out", "few", "--every-ticks", "100"],
        )
        .ok();
    assert_eq!(
        table(&place.path("few/ticks.csv"))["tick"].len(),
        rows.len().div_ceil(100)
    );
    place
        .run(Program::Sessions, &["export", plain, "--out", "few"])
        .refused(&["few/events.csv", "exists"]);
    place
        .run(
            Program::Sessions,
            &[
                "export", plain, "--out", "bad", "--meshes", "ply", "--every", "0",
            ],
        )
        .refused(&["every", "0", "more than 0 s"]);
}
