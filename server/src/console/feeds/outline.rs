//! Shapes of a mouth and of tools for the flat picture.

use sulcus_console::house::{Outlines, ToolOutline, ToothOutline};
use sulcus_proto::display::{DisplayMesh, DisplayScene, DisplayTool, Kind};

/// Number of directions in which the outermost point of a tooth is looked for. An outline is exact to some 2 % of the
/// tooth's width.
const DIRECTIONS: usize = 128;
/// Length of the working end that is drawn apart from the shaft, metres.
const END_M: f32 = 0.012;
/// Number of points on the rim of a mirror.
const RIM: usize = 24;

/// Shapes of a scene.
pub(super) fn of(scene: &DisplayScene, begun: u64) -> Outlines {
    let directions = directions();
    let objects = || scene.objects.iter();
    let teeth = objects().filter(|object| object.kind == Kind::Tooth && !object.mesh.is_empty());
    let tooth = |fdi: u8, mesh: &DisplayMesh| {
        let margin = objects().find(|object| object.kind == Kind::Gingiva && object.fdi == fdi);
        ToothOutline {
            fdi,
            points: outermost(mesh, &directions),
            margin: margin.map_or_else(Vec::new, |gingiva| gingiva.sites.clone()),
        }
    };
    Outlines {
        begun,
        tick_s: scene.tick_ns as f64 * 1e-9,
        tools: scene.tools.iter().map(tool).collect(),
        teeth: teeth
            .map(|object| tooth(object.fdi, &object.mesh))
            .collect(),
    }
}

/// Directions spread evenly over a sphere: a spiral by the golden angle.
fn directions() -> Vec<[f32; 3]> {
    let golden = std::f64::consts::PI * (3.0 - f64::sqrt(5.0));
    let direction = |k: usize| {
        let z = 1.0 - (2 * k + 1) as f64 / DIRECTIONS as f64;
        let (across, turn) = (f64::sqrt(1.0 - z * z), golden * k as f64);
        [across * turn.cos(), across * turn.sin(), z].map(|x| x as f32)
    };
    (0..DIRECTIONS).map(direction).collect()
}

/// Outermost vertices of a mesh, each once.
fn outermost(mesh: &DisplayMesh, directions: &[[f32; 3]]) -> Vec<[f32; 3]> {
    let vertices: Vec<[f32; 3]> = mesh.vertices().collect();
    let far = |direction: &[f32; 3]| {
        let reach = |v: &[f32; 3]| dot(v, direction);
        let numbered = vertices.iter().enumerate();
        let most = numbered.max_by(|(_, a), (_, b)| reach(a).total_cmp(&reach(b)));
        most.map(|(k, _)| k)
    };
    let mut chosen: Vec<usize> = directions.iter().filter_map(far).collect();
    chosen.sort_unstable();
    chosen.dedup();
    chosen.into_iter().map(|k| vertices[k]).collect()
}

fn tool(tool: &DisplayTool) -> ToolOutline {
    let end: [f32; 3] = std::array::from_fn(|k| tool.tip[k] - END_M * tool.tip_axis[k]);
    let rim = tool.glass.as_ref().map_or_else(Vec::new, |glass| {
        let n = glass.normal;
        // Any direction across the normal.
        let other = if n[0].abs() < 0.9 {
            [1.0, 0.0, 0.0]
        } else {
            [0.0, 1.0, 0.0]
        };
        let a = unit(cross(n, other));
        let b = cross(n, a);
        let point = |k: usize| {
            let (sin, cos) = (std::f32::consts::TAU * k as f32 / RIM as f32).sin_cos();
            std::array::from_fn(|k| glass.centre[k] + glass.radius * (cos * a[k] + sin * b[k]))
        };
        (0..RIM).map(point).collect()
    });
    ToolOutline {
        name: tool.name.clone(),
        line: vec![[0.0; 3], end, tool.tip],
        rim,
    }
}

fn dot(a: &[f32; 3], b: &[f32; 3]) -> f32 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn cross(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    std::array::from_fn(|k| {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        a[i] * b[j] - a[j] * b[i]
    })
}

fn unit(v: [f32; 3]) -> [f32; 3] {
    let length = dot(&v, &v).sqrt();
    v.map(|x| if length > 0.0 { x / length } else { 0.0 })
}

#[cfg(test)]
mod tests {
    use sulcus_proto::datagram::WirePose;
    use sulcus_proto::display::{DisplayGlass, DisplayObject};

    use super::*;

    fn object(kind: Kind, fdi: u8, sites: Vec<[f32; 3]>) -> DisplayObject {
        // A cube with a point in its middle.
        let corner = |k: u32| {
            let side = |bit: u32| if k & bit == 0 { -0.004 } else { 0.004 };
            [side(1), side(2), side(4)]
        };
        let mut vertices: Vec<[f32; 3]> = (0..8).map(corner).collect();
        vertices.push([0.0; 3]);
        DisplayObject {
            kind,
            fdi,
            mesh: DisplayMesh::new(&vertices, &[[0, 1, 2]], [255; 4], &[]).expect("a mesh"),
            skin: None,
            sites,
        }
    }

    #[test]
    fn an_outline_has_the_outermost_points_and_the_margin_of_its_own_tooth() {
        let margin = vec![[0.001, 0.0, 0.0]; 6];
        let mirror = DisplayTool {
            name: "mirror".into(),
            mesh: object(Kind::Other, 0, vec![]).mesh,
            bands: vec![],
            glass: Some(DisplayGlass {
                centre: [0.0, 0.0, -0.1],
                normal: [0.0, 0.0, -1.0],
                radius: 0.012,
            }),
            tip: [0.0, 0.0, -0.1],
            tip_axis: [0.0, 0.0, -1.0],
            park: WirePose::IDENTITY,
        };
        let scene = DisplayScene {
            tick_ns: 1_000_000,
            tools: vec![mirror],
            objects: vec![
                object(Kind::Tooth, 36, vec![]),
                object(Kind::Gingiva, 36, margin.clone()),
                object(Kind::Tongue, 0, vec![]),
                object(Kind::Tooth, 37, vec![]),
            ],
        };
        let found = of(&scene, 3);
        assert_eq!(
            (found.begun, found.tick_s, found.teeth.len()),
            (3, 0.001, 2)
        );
        assert_eq!(
            found.teeth[0].points.len(),
            8,
            "the middle is no outermost point"
        );
        assert_eq!(
            (&found.teeth[0].margin, found.teeth[1].margin.len()),
            (&margin, 0)
        );
        let tool = &found.tools[0];
        assert_eq!((tool.line.len(), tool.rim.len()), (3, RIM));
        for point in &tool.rim {
            let across = (point[0] * point[0] + point[1] * point[1]).sqrt();
            assert!(
                (across - 0.012).abs() < 1e-6 && (point[2] + 0.1).abs() < 1e-6,
                "{point:?}"
            );
        }
    }
}
