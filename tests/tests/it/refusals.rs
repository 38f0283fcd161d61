//! Bad input gets one clear sentence and exit code 2.

use std::net::UdpSocket;

use sulcus_tests::{Place, Program};

fn scene_with(place: &Place, object: &str) -> String {
    let text = format!(
        "name = \"test\"\n[[tool]]\nname = \"probe\"\nkind = \"periodontal_probe\"\npark_mm = [0, 0, 120]\n[[object]]\nname = \"x\"\n{object}"
    );
    std::fs::write(place.path("scene.toml"), text).expect("writes");
    "scene.toml".into()
}

/// A binary STL of the triangles.
fn stl(triangles: &[[[f32; 3]; 3]]) -> Vec<u8> {
    let mut bytes = vec![0; 80];
    bytes.extend((triangles.len() as u32).to_le_bytes());
    for triangle in triangles {
        bytes.extend([0; 12]);
        bytes.extend(triangle.iter().flatten().flat_map(|x| x.to_le_bytes()));
        bytes.extend([0; 2]);
    }
    bytes
}

/// A tetrahedron of the given size, closed and outward.
fn tetrahedron(size: f32) -> Vec<[[f32; 3]; 3]> {
    let p = [
        [0.0, 0.0, 0.0],
        [size, 0.0, 0.0],
        [0.0, size, 0.0],
        [0.0, 0.0, size],
    ];
    [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]
        .iter()
        .map(|t| t.map(|k| p[k]))
        .collect()
}

#[test]
fn a_mesh_with_a_hole() {
    let place = Place::new();
    std::fs::write(place.path("hole.stl"), stl(&tetrahedron(10.0)[1..])).expect("writes");
    let scene = scene_with(&place, "mesh = \"hole.stl\"\nunit = \"mm\"\n");
    let ended = place.run(Program::Client, &["demo", "--virtual", "--scene", &scene]);
    ended.refused(&["hole.stl", "3", "edges"]);
    place
        .run(Program::Server, &["scene", "check", &scene])
        .refused(&["hole.stl", "3", "edges"]);
    place
        .run(Program::Server, &["tree", "hole.stl"])
        .refused(&["hole.stl", "3", "edges"]);
}

#[test]
fn a_mesh_in_another_unit() {
    let place = Place::new();
    std::fs::write(place.path("metres.stl"), stl(&tetrahedron(0.01))).expect("writes");
    let scene = scene_with(&place, "mesh = \"metres.stl\"\nunit = \"mm\"\n");
    place
        .run(Program::Server, &["scene", "check", &scene])
        .refused(&["metres.stl", "unit"]);
}

#[test]
fn a_mesh_that_is_not_there_or_not_a_mesh() {
    let place = Place::new();
    let scene = scene_with(&place, "mesh = \"absent.stl\"\nunit = \"mm\"\n");
    place
        .run(Program::Client, &["demo", "--virtual", "--scene", &scene])
        .refused(&["absent.stl"]);
    std::fs::write(place.path("text.stl"), "not a mesh").expect("writes");
    let scene = scene_with(&place, "mesh = \"text.stl\"\nunit = \"mm\"\n");
    place
        .run(Program::Client, &["demo", "--virtual", "--scene", &scene])
        .refused(&["text.stl"]);
}

#[test]
fn a_wrong_field_in_a_scene_file() {
    let place = Place::new();
    let scene = scene_with(&place, "kind = \"molar\"\ncolour_of_eyes = 3\n");
    place
        .run(Program::Client, &["demo", "--virtual", "--scene", &scene])
        .refused(&["scene.toml", "colour_of_eyes"]);
    let scene = scene_with(&place, "kind = \"molar\"\nlevel = \"three\"\n");
    place
        .run(Program::Server, &["scene", "check", &scene])
        .refused(&["scene.toml", "level"]);
}

#[test]
fn a_seed_where_no_patient_is_generated() {
    let place = Place::new();
    let serve = |scene: &str| {
        let serve = ["serve", "--listen", "127.0.0.1:0", "--seed", "3"];
        place.run(Program::Server, &[&serve[..], &["--scene", scene]].concat())
    };
    let scene = scene_with(&place, "kind = \"molar\"\n");
    serve(&scene).refused(&["--seed", "no patient", "[mouth]"]);
    let make = ["patient", "make", "--seed", "1", "--out", "patient.toml"];
    place.run(Program::Server, &make).ok();
    let mouth = "name = \"test\"\n[[tool]]\nname = \"probe\"\nkind = \"periodontal_probe\"\npark_mm = [0, 0, 120]\n[mouth]\npatient = \"patient.toml\"\nteeth = [31]\ntooth_level = 3\ntooth_levels = 3\n";
    std::fs::write(place.path("scene.toml"), mouth).expect("writes");
    serve(&scene).refused(&["--seed", "written", "[mouth]"]);
}

#[test]
fn a_busy_port() {
    let place = Place::new();
    let socket = UdpSocket::bind("127.0.0.1:0").expect("a port");
    let address = socket.local_addr().expect("an address").to_string();
    place
        .run(Program::Server, &["serve", "--listen", &address])
        .refused(&[&address, "port"]);
}

#[test]
fn a_server_that_is_not_there() {
    let place = Place::new();
    // A held port that answers nothing: another server could take a free one.
    let held = UdpSocket::bind("127.0.0.1:0").expect("a port");
    let address = held.local_addr().expect("an address").to_string();
    let key = place.path("station.der");
    std::fs::write(&key, self_signed()).expect("writes");
    let run = [
        "run",
        "--server",
        &address,
        "--token",
        "t",
        "--certificate",
        key.to_str().expect("plain"),
        "--duration",
        "1",
    ];
    place.run(Program::Client, &run).refused(&[&address]);
}

/// A certificate that some server might have had.
fn self_signed() -> Vec<u8> {
    let key = rcgen::generate_simple_self_signed(vec!["localhost".into()]).expect("a certificate");
    key.cert.der().to_vec()
}

#[test]
fn a_recording_cut_off_in_its_header_or_not_a_recording() {
    let place = Place::new();
    place
        .run(Program::Client, &["demo", "--virtual", "--duration", "1"])
        .ok();
    let whole = std::fs::read(place.recording()).expect("reads");
    for (name, bytes) in [
        ("cut.mcap", &whole[..200]),
        ("empty.mcap", &[][..]),
        ("text.mcap", b"not a recording"),
    ] {
        std::fs::write(place.path(name), bytes).expect("writes");
        for command in ["replay", "info"] {
            place
                .run(Program::Sessions, &[command, name])
                .refused(&[name]);
        }
    }
    place
        .run(Program::Sessions, &["replay", "absent.mcap"])
        .refused(&["absent.mcap"]);
}

#[test]
fn wrong_usage() {
    let place = Place::new();
    for arguments in [
        &["demo", "--duration", "-3"][..],
        &["demo", "--exercise", "juggling"],
        &["dance"],
    ] {
        assert_eq!(
            place.run(Program::Client, arguments).code,
            2,
            "{arguments:?}"
        );
    }
}
