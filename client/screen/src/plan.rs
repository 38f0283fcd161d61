//! Draws of a pass: which triangles, in which order, in how few calls.
//!
//! Triangles lie in chunks. A pass leaves out the chunks beside its picture and takes the others from front to back, so
//! that hidden pixels are not lit. All chunks with the same constants go into one call: a software adapter pays about a
//! millisecond for each.

use std::ops::Range;

use nalgebra::Matrix4;

use crate::ball::Ball;
use crate::camera::Matrix;
use crate::moment::Moment;
use crate::stage::{Owner, Part, Stage};

/// Number of corners of a chunk. Chosen.
const CHUNK: usize = 3 * 400;

/// Neighbouring triangles of a part.
#[derive(Clone, Debug)]
pub(crate) struct Chunk {
    /// Number of the part.
    pub part: usize,
    /// Corners in the stage.
    pub corners: Range<usize>,
    /// Ball around the present places.
    pub ball: Ball,
}

/// Objects that have the same constants.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Alike {
    /// None.
    Nothing,
    /// Objects of one material.
    Material,
    /// All.
    Objects,
}

/// Pass for which draws are planned.
pub(crate) struct Pass<'a> {
    /// Instant.
    pub moment: &'a Moment,
    /// Clip space from world.
    pub clip: &'a Matrix,
    /// Tool that is left out: the mirror in its own glass.
    pub without: Option<usize>,
    /// Objects that one call may serve.
    pub alike: Alike,
}

/// Call of a pass.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Draw {
    /// Part that has the constants.
    pub part: usize,
    /// Whether the part is a tool.
    pub is_tool: bool,
    /// Corners in the pass's own list.
    pub corners: Range<u32>,
}

/// Draws with the chunks of the pass's list, in its order.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Plan {
    pub draws: Vec<Draw>,
    pub chunks: Vec<u32>,
}

/// Cuts all parts into chunks.
pub(crate) fn chunks(stage: &Stage) -> Vec<Chunk> {
    let mut all = Vec::new();
    for (k, part) in stage.parts.iter().enumerate() {
        for start in part.corners.clone().step_by(CHUNK) {
            let corners = start..part.corners.end.min(start + CHUNK);
            all.push(Chunk {
                part: k,
                ball: around(stage, &corners),
                corners,
            });
        }
    }
    all
}

/// Ball around the present places of corners.
pub(crate) fn around(stage: &Stage, corners: &Range<usize>) -> Ball {
    let corners = stage.corners[corners.clone()].iter();
    Ball::around(corners.map(|v| &stage.moving[*v as usize]))
}

/// World from the axes of a part.
pub(crate) fn world(owner: Owner, moment: &Moment) -> Matrix4<f32> {
    match owner {
        Owner::Object(_) => Matrix4::identity(),
        Owner::Tool(tool) => moment.tools[usize::from(tool)].matrix(),
    }
}

/// Plans a pass. Tools are nearest to the eye and come first.
pub(crate) fn plan(stage: &Stage, pass: &Pass<'_>) -> Plan {
    let mut seen: Vec<(usize, f64, usize)> = Vec::new();
    for (k, chunk) in stage.chunks.iter().enumerate() {
        let part = &stage.parts[chunk.part];
        let world = world(part.owner, pass.moment);
        if is_drawn(part, pass) && chunk.ball.is_seen(&world, pass.clip) {
            let call = call(chunk.part, part, pass.alike);
            seen.push((call, chunk.ball.depth(&world, pass.clip), k));
        }
    }
    seen.sort_unstable_by(|a, b| a.1.total_cmp(&b.1).then(a.2.cmp(&b.2)));
    // Calls in the order of their nearest chunks, tools before objects.
    let mut calls: Vec<(usize, bool)> = Vec::new();
    for (call, _, k) in &seen {
        let part = &stage.parts[stage.chunks[*k].part];
        if calls.iter().all(|(other, _)| other != call) {
            calls.push((*call, matches!(part.owner, Owner::Tool(_))));
        }
    }
    calls.sort_by_key(|(_, is_tool)| !is_tool);
    let mut plan = Plan::default();
    let mut end = 0;
    for (call, is_tool) in calls {
        let start = end;
        let mut part = 0;
        for (_, _, k) in seen.iter().filter(|(own, _, _)| *own == call) {
            plan.chunks.push(*k as u32);
            end += stage.chunks[*k].corners.len() as u32;
            part = stage.chunks[*k].part;
        }
        plan.draws.push(Draw {
            part,
            is_tool,
            corners: start..end,
        });
    }
    plan
}

/// The list of corners of a plan.
pub(crate) fn corners(stage: &Stage, plan: &Plan) -> Vec<u32> {
    let chunks = plan.chunks.iter().map(|k| &stage.chunks[*k as usize]);
    chunks
        .flat_map(|chunk| &stage.corners[chunk.corners.clone()])
        .copied()
        .collect()
}

fn is_drawn(part: &Part, pass: &Pass<'_>) -> bool {
    match part.owner {
        Owner::Object(_) => true,
        Owner::Tool(tool) => {
            let tool = usize::from(tool);
            pass.moment.tools[tool].held && pass.without != Some(tool)
        }
    }
}

/// Number of the call that serves a part: that of the part itself, or a number beyond all parts.
fn call(number: usize, part: &Part, alike: Alike) -> usize {
    match (alike, part.owner) {
        (Alike::Material, Owner::Object(_)) => usize::MAX - 1 - usize::from(part.material.number()),
        (Alike::Objects, Owner::Object(_)) => usize::MAX,
        _ => number,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::{Camera, Vector};
    use sulcus_proto::datagram::WirePose;
    use sulcus_proto::display::{DisplayMesh, DisplayObject, DisplayScene, DisplayTool, Kind};

    /// Triangle of 2 mm about a place in mm.
    fn triangle(at: [f32; 3]) -> DisplayMesh {
        let corner = |y: f32, z: f32| [at[0], at[1] + y, at[2] + z].map(|x| x * 1e-3);
        let corners = [corner(-1.0, -1.0), corner(1.0, -1.0), corner(0.0, 1.0)];
        DisplayMesh::new(&corners, &[[0, 1, 2]], [200; 4], &[]).expect("a mesh")
    }

    /// A far tooth, a near one, a tongue between them, a tooth beside the picture, and a tool.
    fn scene() -> DisplayScene {
        let object = |(kind, at)| DisplayObject {
            kind,
            fdi: 0,
            mesh: triangle(at),
            skin: None,
            sites: Vec::new(),
        };
        let objects = [
            (Kind::Tooth, [-20.0, 0.0, 0.0]),
            (Kind::Tooth, [20.0, 0.0, 0.0]),
            (Kind::Tongue, [0.0, 0.0, 0.0]),
            (Kind::Tooth, [0.0, 500.0, 0.0]),
        ];
        let tool = DisplayTool {
            name: "probe".into(),
            mesh: triangle([0.0; 3]),
            bands: Vec::new(),
            glass: None,
            tip: [0.0; 3],
            tip_axis: [0.0, 0.0, -1.0],
            park: WirePose::IDENTITY,
        };
        DisplayScene {
            tick_ns: 1_000_000,
            tools: vec![tool],
            objects: objects.map(object).into(),
        }
    }

    #[test]
    fn a_pass_takes_what_it_sees_from_front_to_back_in_few_calls() {
        let scene = scene();
        let stage = Stage::new(&scene, 0);
        let eye = Vector::new(400.0, 0.0, 0.0);
        let camera = Camera::looking(eye, Vector::zeros(), Vector::z(), 10.0, 1.5);
        let clip = camera.pass().matrix();
        let mut moment = Moment::rest(&scene);
        let owners = |alike, moment: &Moment, without| {
            let pass = Pass {
                moment,
                clip: &clip,
                without,
                alike,
            };
            let plan = plan(&stage, &pass);
            let corners = corners(&stage, &plan);
            let ends = plan.draws.last().map_or(0, |draw| draw.corners.end);
            assert_eq!(corners.len(), ends as usize);
            let part = |k: &u32| stage.parts[stage.chunks[*k as usize].part].owner;
            let owners: Vec<Owner> = plan.chunks.iter().map(part).collect();
            (plan.draws.len(), owners)
        };
        let [far, near, tongue] = [0, 1, 2].map(Owner::Object);
        let all = owners(Alike::Objects, &moment, None);
        assert_eq!(all, (1, vec![near, tongue, far]));
        let material = owners(Alike::Material, &moment, None);
        assert_eq!(material, (2, vec![near, far, tongue]));
        let (calls, alone) = owners(Alike::Nothing, &moment, None);
        assert_eq!((calls, alone), (3, vec![near, tongue, far]));
        moment.tools[0].held = true;
        let held = owners(Alike::Objects, &moment, None);
        assert_eq!(held, (2, vec![Owner::Tool(0), near, tongue, far]));
        assert_eq!(owners(Alike::Objects, &moment, Some(0)), all);
    }
}
