//! Scenes and frames of displays: exact round trips, strict refusals, no panic on any bytes, nothing hidden.

use proptest::collection::vec;
use proptest::prelude::*;
use sulcus_proto::datagram::WirePose;
use sulcus_proto::display::{
    DisplayBand, DisplayFrame, DisplayMesh, DisplayObject, DisplayScene, DisplayTool, FRAME_BYTES,
    FrameTool, HANDLES, Kind, Moved, MovedHandle, OBJECTS, STEP_M, SceneHash, Skin, Spot, stream,
};
use sulcus_proto::{CodecError, PROTOCOL_VERSION};

fn mesh() -> DisplayMesh {
    let vertices = [[0.01, 0.0, -0.02], [0.03, 0.001, 0.0], [0.02, 0.02, 0.01]];
    DisplayMesh::new(&vertices, &[[0, 1, 2]], [1, 2, 3, 255], &[[9; 4]; 3]).expect("a mesh")
}

fn skin() -> Skin {
    let mut skin = Skin::over(vec![[0.01, 0.0, -0.02], [0.02, 0.02, 0.01]]);
    skin.push([(0, 1.0)]);
    skin.push([(0, 0.25), (1, 0.75)]);
    skin.push([]);
    skin
}

fn scene() -> DisplayScene {
    let plain = |kind, fdi| DisplayObject {
        kind,
        fdi,
        mesh: mesh(),
        skin: None,
        sites: Vec::new(),
    };
    let gingiva = DisplayObject {
        skin: Some(skin()),
        sites: vec![[0.01, 0.02, 0.03]; 6],
        ..plain(Kind::Gingiva, 36)
    };
    DisplayScene {
        tick_ns: 1_000_000,
        tools: vec![DisplayTool {
            name: "probe".into(),
            mesh: mesh(),
            glass: None,
            bands: vec![DisplayBand {
                from: 0.0,
                to: 0.003,
                dark: true,
            }],
            tip: [0.0, 0.0, -0.09],
            tip_axis: [0.0, 0.0, -1.0],
            park: WirePose::IDENTITY,
        }],
        objects: vec![plain(Kind::Tooth, 36), gingiva],
    }
}

fn frame() -> DisplayFrame {
    let moved = |handle, by| MovedHandle { handle, by };
    DisplayFrame {
        sequence: 7,
        scene: SceneHash::of(b"scene").short(),
        tick: 160,
        paused: true,
        tools: [FrameTool::default(); 2],
        moved: vec![Moved {
            object: 1,
            handles: vec![moved(0, [1, -2, 3]), moved(1, [0, 0, i16::MIN])],
        }],
        spots: vec![Spot {
            object: 1,
            site: 5,
            since: 150,
        }],
    }
}

#[test]
fn scene_and_frame_survive_a_round_trip() {
    let bytes = scene().to_bytes().expect("encodes");
    assert_eq!(bytes[0], PROTOCOL_VERSION);
    assert_eq!(DisplayScene::from_bytes(&bytes), Ok(scene()));
    let bytes = frame().to_bytes().expect("encodes");
    assert_eq!(DisplayFrame::from_bytes(&bytes), Ok(frame()));
    assert!(frame().fits(&scene()));
    assert_eq!(frame().moved[0].handles[1].by_m()[2], -32_768.0 * STEP_M);
}

#[test]
fn a_skin_moves_vertices_by_their_handles() {
    let mut moved = [[f32::NAN; 3]; 3];
    skin().displacements(&[[4.0, 0.0, 0.0], [0.0, 8.0, 0.0]], &mut moved);
    assert_eq!(moved, [[4.0, 0.0, 0.0], [1.0, 6.0, 0.0], [0.0; 3]]);
}

#[test]
fn numbers_that_the_scene_lacks_do_not_fit() {
    let with = |change: fn(&mut DisplayFrame)| {
        let mut frame = frame();
        change(&mut frame);
        assert!(frame.to_bytes().is_ok());
        frame.fits(&scene())
    };
    assert!(!with(|frame| frame.moved[0].object = 0), "no skin");
    assert!(!with(|frame| frame.moved[0].object = 2), "no object");
    assert!(!with(|frame| frame.moved[0].handles[1].handle = 2));
    assert!(!with(|frame| frame.spots[0].object = 0), "no sites");
    assert!(with(|frame| frame.spots[0].site = 0));
}

#[test]
fn a_frame_that_breaks_a_rule_is_neither_encoded_nor_decoded() {
    let broken: [fn(&mut DisplayFrame); 8] = [
        |frame| frame.tools[1].graphic.position[0] = f32::NAN,
        |frame| frame.moved.push(frame.moved[0].clone()),
        |frame| frame.moved[0].handles.reverse(),
        |frame| frame.moved[0].handles[0].by = [0; 3],
        |frame| frame.moved[0].handles.clear(),
        |frame| frame.spots.push(frame.spots[0]),
        |frame| frame.spots[0].site = 6,
        |frame| {
            let all = (0..u16::MAX).map(|handle| MovedHandle { handle, by: [1; 3] });
            frame.moved[0].handles = all.collect();
        },
    ];
    for (k, change) in broken.into_iter().enumerate() {
        let mut frame = frame();
        change(&mut frame);
        assert!(frame.to_bytes().is_err(), "rule {k}");
    }
    let long = vec![0; FRAME_BYTES + 1];
    let limit = FRAME_BYTES;
    let found = limit + 1;
    assert_eq!(
        DisplayFrame::from_bytes(&long),
        Err(CodecError::TooLong { found, limit })
    );
}

#[test]
fn a_scene_that_breaks_a_rule_is_neither_encoded_nor_decoded() {
    let broken: [fn(&mut DisplayScene); 9] = [
        |scene| scene.tools.clear(),
        |scene| scene.tick_ns = 0,
        |scene| scene.tools[0].name = "x".repeat(257),
        |scene| scene.tools[0].tip[1] = f32::INFINITY,
        |scene| scene.objects[0].mesh.vertex_colours.truncate(1),
        |scene| scene.objects[0].skin = Some(Skin::over(vec![])),
        |scene| scene.objects[1].sites.truncate(5),
        |scene| {
            let mut skin = Skin::over(vec![[0.0; 3]; HANDLES + 1]);
            (0..3).for_each(|_| skin.push([]));
            scene.objects[1].skin = Some(skin);
        },
        |scene| scene.objects = vec![scene.objects[0].clone(); OBJECTS + 1],
    ];
    for (k, change) in broken.into_iter().enumerate() {
        let mut scene = scene();
        change(&mut scene);
        assert!(scene.to_bytes().is_err(), "rule {k}");
    }
    let bytes = scene().to_bytes().expect("encodes");
    let mut other = bytes.clone();
    other[0] = PROTOCOL_VERSION + 1;
    let found = PROTOCOL_VERSION + 1;
    assert_eq!(
        DisplayScene::from_bytes(&other),
        Err(CodecError::Version { found })
    );
    assert!(DisplayScene::from_bytes(&bytes[..bytes.len() - 1]).is_err());
    assert!(DisplayScene::from_bytes(&[]).is_err());
}

#[test]
fn a_mesh_without_its_vertices_is_refused() {
    let corners = [[0.0; 3]; 2];
    assert!(DisplayMesh::new(&corners, &[[0, 1, 2]], [0; 4], &[]).is_err());
    assert!(DisplayMesh::new(&[[f32::NAN; 3]], &[], [0; 4], &[]).is_err());
    assert!(DisplayMesh::new(&[[11.0, 0.0, 0.0]], &[], [0; 4], &[]).is_err());
    let empty = DisplayMesh::new(&[], &[], [0; 4], &[]).expect("no vertex");
    assert!(empty.is_empty() && empty.triangles().next().is_none());
    // Beyond 16 bits the triangles have other numbers.
    let many: Vec<[f32; 3]> = (0..70_000).map(|k| [k as f32 * 1e-6, 0.0, 0.0]).collect();
    let large = DisplayMesh::new(&many, &[[0, 1, 69_999]], [0; 4], &[]).expect("a mesh");
    assert_eq!(large.triangles().collect::<Vec<_>>(), [[0, 1, 69_999]]);
}

#[test]
fn streams_begin_with_version_and_kind() {
    let bytes = scene().to_bytes().expect("encodes");
    let hash = SceneHash::of(&bytes);
    let head = stream::scene_head(&hash);
    let (kind, content) = head.split_first_chunk().expect("a head");
    assert_eq!(stream::content(*kind), Ok(stream::Content::Scene));
    assert_eq!(stream::scene(content), Ok((hash, None)));
    let mut whole = content.to_vec();
    whole.extend(&bytes);
    assert_eq!(stream::scene(&whole), Ok((hash, Some(&bytes[..]))));
    whole.pop();
    assert!(stream::scene(&whole).is_err(), "another hash");
    assert!(stream::scene(&content[1..]).is_err());
    assert_eq!(
        stream::content(stream::frame_head()),
        Ok(stream::Content::Frame)
    );
    assert!(stream::content([PROTOCOL_VERSION, 0]).is_err());
    assert!(stream::content([PROTOCOL_VERSION + 1, 0x22]).is_err());
}

proptest! {
    #[test]
    fn vertices_are_off_by_half_a_step_at_most(
        vertices in vec(prop::array::uniform3(-0.2f32..0.2), 1..40),
    ) {
        let mesh = DisplayMesh::new(&vertices, &[], [0; 4], &[]).expect("a mesh");
        let span = |k: usize| {
            let all = vertices.iter().map(|v| v[k]);
            all.clone().fold(f32::MIN, f32::max) - all.fold(f32::MAX, f32::min)
        };
        let longest = (0..3).map(span).fold(0.0, f32::max);
        // Half a step, and the rounding of f32.
        let bound = 0.5 * longest / 65_535.0 + 1e-7;
        for (found, wanted) in mesh.vertices().zip(&vertices) {
            for (found, wanted) in found.iter().zip(wanted) {
                prop_assert!((found - wanted).abs() <= bound);
            }
        }
    }

    #[test]
    fn any_bytes_are_refused_or_canonical(bytes in vec(any::<u8>(), 0..300)) {
        if let Ok(frame) = DisplayFrame::from_bytes(&bytes) {
            prop_assert_eq!(frame.to_bytes(), Ok(bytes.clone()));
        }
        if let Ok(scene) = DisplayScene::from_bytes(&bytes) {
            prop_assert_eq!(scene.to_bytes(), Ok(bytes.clone()));
        }
        let _ = stream::scene(&bytes);
    }

    #[test]
    fn a_changed_byte_is_refused_or_canonical(
        at in any::<prop::sample::Index>(),
        byte in any::<u8>(),
        cut in any::<prop::sample::Index>(),
    ) {
        let mut bytes = scene().to_bytes().expect("encodes");
        let at_scene = at.index(bytes.len());
        bytes[at_scene] = byte;
        match DisplayScene::from_bytes(&bytes) {
            // No screen panics on an accepted scene.
            Ok(scene) => {
                prop_assert_eq!(scene.to_bytes(), Ok(bytes));
                for object in &scene.objects {
                    let vertices = object.mesh.vertices().count();
                    let most = object.mesh.triangles().flatten().max();
                    prop_assert!(most.is_none_or(|most| (most as usize) < vertices));
                    if let Some(skin) = &object.skin {
                        let moved = vec![[0.0; 3]; skin.handles.len()];
                        skin.displacements(&moved, &mut vec![[0.0; 3]; vertices]);
                    }
                }
            }
            Err(_) => {
                let cut = cut.index(bytes.len());
                let _ = DisplayScene::from_bytes(&bytes[..cut]);
            }
        }
        let mut bytes = frame().to_bytes().expect("encodes");
        let at = at.index(bytes.len());
        bytes[at] = byte;
        if let Ok(frame) = DisplayFrame::from_bytes(&bytes) {
            let _ = frame.fits(&scene());
            prop_assert_eq!(frame.to_bytes(), Ok(bytes));
        }
    }
}
