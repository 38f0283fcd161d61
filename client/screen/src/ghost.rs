//! Ghost of a recorded tool: a see-through figure over the picture, which hides neither the tool nor the tooth.
//!
//! Stations along the tool's handle axis have the mean place and the radius of the mesh there. Each station becomes a
//! translucent square of the tool's width.

use crate::camera::{PassCamera, Vector};
use crate::moment::ToolAt;
use crate::panel::Primitive;
use sulcus_proto::display::DisplayTool;

/// Length of a station along the handle axis, mm.
const STATION_MM: f32 = 0.5;
/// Length of the tool from the tip on that is drawn, mm.
const LENGTH_MM: f32 = 120.0;
/// Smallest and largest edge of a square at scale 1, pixels.
const EDGE: [f32; 2] = [2.0, 60.0];
/// Sky blue of the palette of Okabe and Ito, see-through.
const FILL: [u8; 4] = [86, 180, 233, 110];

/// Station of a tool in its own frame.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Station {
    /// Mean place of the mesh, mm.
    at: Vector,
    /// Radius about that place, mm.
    radius: f64,
}

/// Ghost of one tool.
#[derive(Clone, Debug, Default)]
pub struct Ghost {
    stations: Vec<Station>,
}

impl Ghost {
    /// Ghost of a tool of a scene.
    pub fn of(tool: &DisplayTool) -> Self {
        let mm = |v: &[f32; 3]| v.map(|x| x * 1e3);
        let tip = mm(&tool.tip)[2];
        let count = (LENGTH_MM / STATION_MM) as usize;
        let mut bins: Vec<Vec<[f32; 3]>> = vec![Vec::new(); count];
        for vertex in tool.mesh.vertices() {
            let at = mm(&vertex);
            let bin = ((at[2] - tip).max(0.0) / STATION_MM) as usize;
            if let Some(bin) = bins.get_mut(bin) {
                bin.push(at);
            }
        }
        let filled = bins.into_iter().filter(|bin| !bin.is_empty());
        Self {
            stations: filled.map(|bin| station(&bin)).collect(),
        }
    }

    /// Squares of the ghost at a pose, in a window of `size` pixels. A ghost behind the camera has none.
    pub fn draw(
        &self,
        pass: &PassCamera,
        at: &ToolAt,
        size: [u32; 2],
        scale: f32,
    ) -> Vec<Primitive> {
        let [width, height] = size.map(|n| n as f32);
        let world = at.matrix().cast::<f64>();
        let pixels = |point: &Vector| {
            let seen = pass.seen(point)?;
            let (x, y) = (seen.x as f32, seen.y as f32);
            Some([(0.5 + 0.5 * x) * width, (0.5 - 0.5 * y) * height])
        };
        let place = |point: &Vector| world.transform_point(&(*point).into()).coords;
        let mut list: Vec<Primitive> = Vec::new();
        let mut last: Option<[f32; 2]> = None;
        for station in &self.stations {
            let centre = place(&station.at);
            // The width of the tool at this depth, along the picture's edge that shows it longer.
            let beside =
                [Vector::x(), Vector::y(), Vector::z()].map(|axis| centre + axis * station.radius);
            let Some([x, y]) = pixels(&centre) else {
                continue;
            };
            let reach = |point: &Vector| pixels(point).map_or(0.0, |[a, b]| (a - x).hypot(b - y));
            let half = beside.iter().map(reach).fold(0.0, f32::max);
            let edge = (2.0 * half).clamp(EDGE[0] * scale, EDGE[1] * scale);
            // Squares that overlap would add up to a solid figure.
            let apart = last.is_none_or(|[a, b]| (a - x).abs().max((b - y).abs()) >= edge);
            if apart {
                last = Some([x, y]);
                list.push(Primitive::Rect {
                    min: [x - 0.5 * edge, y - 0.5 * edge],
                    max: [x + 0.5 * edge, y + 0.5 * edge],
                    rgba: FILL,
                });
            }
        }
        list.retain(|square| {
            let [min, max] = square.bounds();
            max[0] > 0.0 && max[1] > 0.0 && min[0] < width && min[1] < height
        });
        list
    }
}

fn station(bin: &[[f32; 3]]) -> Station {
    let sum = bin.iter().fold([0.0_f64; 3], |sum, at| {
        std::array::from_fn(|k| sum[k] + f64::from(at[k]))
    });
    let middle = Vector::from(sum) / bin.len() as f64;
    let away = |at: &[f32; 3]| {
        let [x, y, _] = at.map(f64::from);
        (x - middle.x).hypot(y - middle.y)
    };
    Station {
        at: middle,
        radius: bin.iter().map(away).fold(0.0, f64::max),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::Camera;
    use sulcus_proto::datagram::WirePose;
    use sulcus_proto::display::{DisplayMesh, DisplayTool};

    /// A rod of 1 mm radius along z, 80 mm long, the tip at the lower end.
    fn rod() -> DisplayTool {
        let ring = |z: f32| {
            (0..12).map(move |k| {
                let (sin, cos) = (k as f32 * std::f32::consts::TAU / 12.0).sin_cos();
                [cos * 1e-3, sin * 1e-3, z]
            })
        };
        let vertices: Vec<[f32; 3]> = (0..=160)
            .flat_map(|k| ring(k as f32 * 0.5e-3 - 0.08))
            .collect();
        DisplayTool {
            name: "rod".into(),
            mesh: DisplayMesh::new(&vertices, &[], [255; 4], &[]).expect("a mesh"),
            bands: Vec::new(),
            glass: None,
            tip: [0.0, 0.0, -0.08],
            tip_axis: [0.0, 0.0, -1.0],
            park: WirePose::IDENTITY,
        }
    }

    #[test]
    fn the_figure_follows_the_tool_and_never_becomes_solid() {
        let camera = Camera::looking(
            Vector::new(300.0, 0.0, -40.0),
            Vector::new(0.0, 0.0, -40.0),
            Vector::z(),
            20.0,
            1.6,
        );
        let ghost = Ghost::of(&rod());
        let draw = |pose: &WirePose| {
            ghost.draw(&camera.pass(), &ToolAt::new(true, pose), [1280, 800], 1.0)
        };
        let list = draw(&WirePose::IDENTITY);
        assert!(list.len() > 20, "{}", list.len());
        let boxes: Vec<_> = list.iter().map(Primitive::bounds).collect();
        for (k, [a, b]) in boxes.iter().enumerate() {
            // The rod is in the middle of the picture, 80 of its 106 mm high, about 15 pixels wide.
            assert!(a[0] > 620.0 && b[0] < 660.0, "{a:?} {b:?}");
            let overlaps = |[c, d]: &[[f32; 2]; 2]| {
                a[0] < d[0] - 0.01 && c[0] < b[0] - 0.01 && a[1] < d[1] - 0.01 && c[1] < b[1] - 0.01
            };
            assert!(!boxes[k + 1..].iter().any(overlaps), "{k}");
        }
        let top = boxes.iter().map(|[a, _]| a[1]).fold(f32::MAX, f32::min);
        let bottom = boxes.iter().map(|[_, b]| b[1]).fold(0.0, f32::max);
        assert!((500.0..700.0).contains(&(bottom - top)), "{top} {bottom}");
        let aside = WirePose {
            position: [0.0, 1.0, 0.0],
            ..WirePose::IDENTITY
        };
        assert!(draw(&aside).is_empty());
    }
}
