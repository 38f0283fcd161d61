//! Every field that a display receives, by name. A new field does not compile here until it has a reason.

use super::*;
use crate::datagram::WirePose;

/// Sum of the numbers of a scene. The patterns name every field, with the reason why a student may see it.
fn seen_in_scene(scene: &DisplayScene) -> usize {
    let DisplayScene {
        tick_ns: _, // of the scene file, the same for every patient
        tools,
        objects,
    } = scene;
    let mut seen = 0;
    for tool in tools {
        let DisplayTool {
            name: _, // of the scene file
            mesh,
            bands,
            glass: _,    // visible
            tip: _,      // visible
            tip_axis: _, // visible
            park:
                WirePose {
                    position: _,    // of the scene file
                    orientation: _, // of the scene file
                },
        } = tool;
        seen += mesh.len();
        for DisplayBand { from, to, dark: _ } in bands {
            assert!(from <= to);
        }
    }
    for object in objects {
        let DisplayObject {
            kind: _, // visible
            fdi: _,  // visible
            mesh,    // of soft tissue: teeth, recession and inflammation alone
            skin,    // of the mesh alone
            sites,   // on the mesh
        } = object;
        seen += mesh.len() + sites.len();
        if let Some(Skin { handles, .. }) = skin {
            seen += handles.len();
        }
    }
    seen
}

/// The same for a frame.
fn seen_in_frame(frame: &DisplayFrame) -> usize {
    let DisplayFrame {
        sequence: _, // of the feed
        scene: _,    // hash of a scene without hidden truth
        tick: _,     // time
        paused: _,   // known to the student
        tools,
        moved,
        spots,
    } = frame;
    for FrameTool {
        held: _,    // the hand's own
        graphic: _, // visible
    } in tools
    {}
    for Moved {
        object: _,  // visible
        handles: _, // visible: tissue that a tool moves
    } in moved
    {}
    for Spot {
        object: _, // visible after the probe has caused it
        site: _,   // the same
        since: _,  // the same
    } in spots
    {}
    tools.len() + moved.len() + spots.len()
}

#[test]
fn every_field_has_a_reason() {
    let scene = DisplayScene {
        tick_ns: 1,
        tools: vec![],
        objects: vec![],
    };
    assert_eq!(seen_in_scene(&scene), 0);
    assert_eq!(seen_in_frame(&DisplayFrame::default()), crate::TOOLS);
}
