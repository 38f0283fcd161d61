//! A session drawn while it runs: parts that decode one by one and one behind the other, with tools that move.
#![allow(clippy::unwrap_used)]

use std::collections::BTreeMap;

use rerun::StoreKind;
use rerun::external::re_log_encoding::rrd::DecoderApp;
use rerun::log::{Chunk, LogMsg};
use sulcus_proto::datagram::WirePose;
use sulcus_proto::display::{
    DisplayBand, DisplayMesh, DisplayObject, DisplayScene, DisplayTool, Kind as ObjectKind,
};
use sulcus_proto::live::{self, Hands, InPocket, Kind, ViewerFile};
use sulcus_view::live::{INSTANT_BYTES, LiveError, VIEWER_FILES, draw, write_viewer};

/// Number of instants.
const INSTANTS: u64 = 40;

fn mesh(half: f32) -> DisplayMesh {
    let corner = |k: u32| {
        let side = |bit: u32| if k & bit == 0 { -half } else { half };
        [side(1), side(2), side(4)]
    };
    let vertices: Vec<[f32; 3]> = (0..8).map(corner).collect();
    let triangles = [
        [0, 1, 2],
        [1, 3, 2],
        [4, 6, 5],
        [5, 6, 7],
        [0, 2, 4],
        [2, 6, 4],
    ];
    DisplayMesh::new(&vertices, &triangles, [200, 180, 160, 255], &[]).unwrap()
}

fn scene() -> DisplayScene {
    let tool = |name: &str, bands: Vec<DisplayBand>| DisplayTool {
        name: name.into(),
        mesh: mesh(0.002),
        bands,
        glass: None,
        tip: [0.0, 0.0, -0.09],
        tip_axis: [0.0, 0.0, -1.0],
        park: WirePose {
            position: [0.0, 0.0, 0.2],
            ..WirePose::IDENTITY
        },
    };
    let band = DisplayBand {
        from: 0.0,
        to: 0.003,
        dark: true,
    };
    let object = |kind, fdi| DisplayObject {
        kind,
        fdi,
        mesh: mesh(0.004),
        skin: None,
        sites: Vec::new(),
    };
    DisplayScene {
        tick_ns: 1_000_000,
        tools: vec![tool("mirror", vec![]), tool("probe", vec![band])],
        objects: vec![
            object(ObjectKind::Tooth, 36),
            object(ObjectKind::Gingiva, 36),
            object(ObjectKind::Tongue, 0),
            object(ObjectKind::Mucosa, 0),
        ],
    }
}

/// Both tools move along x, the probe in a pocket, with force.
fn hands(k: u64) -> Hands {
    let mut hands = Hands {
        tick: 100 * (k + 1),
        ..Hands::default()
    };
    for (slot, tool) in hands.tools.iter_mut().enumerate() {
        tool.held = true;
        tool.graphic.position = [0.001 * k as f32, 0.01 * slot as f32, 0.09];
        tool.haptic = tool.graphic;
        tool.haptic.position[2] -= 0.001;
        tool.force_n = [0.0, 0.05, 0.2];
    }
    hands.tools[1].pocket = Some(InPocket {
        tooth: 36,
        site: 1,
        depth_mm: 3.5,
        true_depth_mm: 5.0,
        floor_n: 0.2,
        zone: 0,
    });
    hands
}

fn feed() -> Vec<u8> {
    let mut feed = Vec::new();
    live::write(&mut feed, Kind::Scene, &scene().to_bytes().unwrap()).unwrap();
    for k in 0..INSTANTS {
        live::write(&mut feed, Kind::Hands, &hands(k).to_bytes().unwrap()).unwrap();
    }
    feed
}

fn parts(mut bytes: &[u8]) -> Vec<(Kind, Vec<u8>)> {
    std::iter::from_fn(|| live::read(&mut bytes).unwrap()).collect()
}

/// Times and number of constant rows of each entity, number of blueprints, and all places by entity.
#[derive(Default)]
struct Found {
    times_ns: BTreeMap<String, Vec<i64>>,
    constant: BTreeMap<String, u64>,
    blueprints: u64,
    places: BTreeMap<String, Vec<[f32; 3]>>,
}

fn decode(bytes: &[u8]) -> Found {
    let mut found = Found::default();
    for message in DecoderApp::decode_lazy(std::io::Cursor::new(bytes.to_vec())) {
        match message.unwrap() {
            LogMsg::ArrowMsg(store, message) if store.kind() == StoreKind::Recording => {
                let chunk = Chunk::from_arrow_msg(&message).unwrap();
                let path = chunk.entity_path().to_string();
                if chunk.is_static() {
                    *found.constant.entry(path).or_default() += chunk.num_rows() as u64;
                    continue;
                }
                let timeline = chunk
                    .timelines()
                    .values()
                    .find(|column| column.timeline().name().as_str() == "session");
                let times = timeline.unwrap().times_raw().to_vec();
                found
                    .times_ns
                    .entry(path.clone())
                    .or_default()
                    .extend(times);
                let name = rerun::Transform3D::descriptor_translation().component;
                if chunk.components().contains_component(name) {
                    let places = chunk.iter_slices::<[f32; 3]>(name);
                    let places = places.flat_map(<[[f32; 3]]>::to_vec);
                    found.places.entry(path).or_default().extend(places);
                }
            }
            LogMsg::BlueprintActivationCommand(_) => found.blueprints += 1,
            _ => {}
        }
    }
    found
}

#[test]
fn parts_decode_one_by_one_and_together_and_both_tools_move() {
    let mut output = Vec::new();
    draw(feed().as_slice(), &mut output).unwrap();
    let parts = parts(&output);
    assert_eq!(parts.len() as u64, 1 + INSTANTS);
    assert_eq!(parts[0].0, Kind::Begin);
    let first = decode(&parts[0].1);
    assert_eq!(first.blueprints, 1);
    for (entity, least) in [
        ("/mouth/teeth/tooth_36_0", 1),
        ("/mouth/gingiva/gingiva_36_1", 1),
        ("/mouth/tongue/tongue_2", 1),
        ("/mouth/jaw/mucosa_3", 1),
        ("/tools/probe", 1),
        ("/tools/mirror", 1),
    ] {
        assert!(
            first.constant.get(entity) >= Some(&least),
            "{entity}: {:?}",
            first.constant
        );
    }
    for (kind, part) in &parts[1..] {
        assert_eq!(*kind, Kind::Further);
        assert!(part.len() < INSTANT_BYTES, "{} bytes", part.len());
        let found = decode(part);
        assert!(found.constant.is_empty() && found.times_ns["/tools/probe"].len() == 1);
    }
    // A viewer that comes late gets the first part and any later ones.
    let late: Vec<u8> = parts
        .iter()
        .take(1)
        .chain(&parts[20..])
        .flat_map(|(_, part)| part.clone())
        .collect();
    let all: Vec<u8> = parts.iter().flat_map(|(_, part)| part.clone()).collect();
    let late = decode(&late);
    assert_eq!(late.times_ns["/tools/probe"].len(), 1 + 21);
    let found = decode(&all);
    let newest = hands(INSTANTS - 1).tick as i64 * 1_000_000;
    for tool in ["/tools/probe", "/tools/mirror"] {
        assert_eq!(found.times_ns[tool].last(), Some(&newest));
        assert!(found.times_ns[tool].is_sorted());
        let places = &found.places[tool];
        let moves = places
            .windows(2)
            .skip(1)
            .filter(|two| two[1][0] > two[0][0] + 0.9);
        assert_eq!(moves.count() as u64, INSTANTS - 1, "{tool}: {places:?}");
    }
    for entity in [
        "/hands/probe",
        "/forces/hands",
        "/close_up",
        "/plots/floor_force",
        "/plots/depth",
    ] {
        // A plot may lag by one instant.
        assert!(
            found.times_ns[entity].len() as u64 >= INSTANTS - 1,
            "{entity}"
        );
    }
}

#[test]
fn an_end_of_the_input_is_no_error_and_nonsense_is_one() {
    let mut output = Vec::new();
    draw([].as_slice(), &mut output).unwrap();
    assert!(output.is_empty());
    let only_scene = &feed()[..live::HEAD + scene().to_bytes().unwrap().len()];
    draw(only_scene, &mut output).unwrap();
    assert_eq!(parts(&output).len(), 1);
    for (bytes, named) in [
        (b"nonsense, no message".to_vec(), "standard input"),
        (feed()[..30].to_vec(), "standard input"),
        (
            [&feed()[..], &feed()[..]].concat(),
            "found a message of kind Scene",
        ),
    ] {
        let told = draw(bytes.as_slice(), &mut Vec::new())
            .unwrap_err()
            .to_string();
        assert!(told.contains(named), "{told}");
    }
    let mut wrong = Vec::new();
    live::write(&mut wrong, Kind::Scene, b"x").unwrap();
    let told = draw(wrong.as_slice(), &mut Vec::new()).unwrap_err();
    assert!(
        matches!(
            told,
            LiveError::Content {
                kind: Kind::Scene,
                ..
            }
        ),
        "{told}"
    );
}

#[test]
fn the_viewers_files_come_compressed_and_small_enough() {
    let mut output = Vec::new();
    write_viewer(&mut output).unwrap();
    let files: Vec<ViewerFile> = parts(&output)
        .into_iter()
        .map(|(kind, body)| {
            assert_eq!(kind, Kind::File);
            ViewerFile::from_bytes(&body).unwrap()
        })
        .collect();
    let names: Vec<&str> = files.iter().map(|file| file.name.as_str()).collect();
    assert_eq!(names, VIEWER_FILES);
    for file in &files {
        assert_eq!(&file.gzip[..2], [0x1f, 0x8b], "{}", file.name);
        assert!(file.version.starts_with("0.36"), "{}", file.version);
    }
    assert!(
        files[1].gzip.len() < 20 << 20,
        "{} bytes",
        files[1].gzip.len()
    );
}
