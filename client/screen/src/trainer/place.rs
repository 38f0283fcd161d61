//! A probe in a pocket of the drawn mouth, for the picture of a task.

use nalgebra::{Unit, UnitQuaternion, Vector3};
use sulcus_proto::display::{DisplayObject, DisplayScene, Kind};

use super::Task;
use crate::moment::Moment;
use crate::readings::Site;
use crate::stage::MM;
use crate::views::along;

/// Distance of the probe's middle line from the margin, mm. The drawn gap is closed: the front of the probe lies at the
/// margin.
const BESIDE_MM: f32 = -0.1;
/// Lean of the probe away from the crown, degrees: the crown bulges over the margin.
const LEAN_DEG: f32 = 18.0;

/// Instant of a task: the probe of the scene stands at a buccal margin, with the task's length below the margin.
/// `number` chooses the tooth. `None`: the scene has no probe or no gingiva with sites.
pub fn moment(scene: &DisplayScene, task: Task, number: usize) -> Option<Moment> {
    let is_gingiva = |one: &&DisplayObject| one.kind == Kind::Gingiva && !one.sites.is_empty();
    let gingivae: Vec<&DisplayObject> = scene.objects.iter().filter(is_gingiva).collect();
    // A step that has no common factor with fourteen or with seven teeth shows all of them.
    let gingiva = gingivae.get((5 * number + 3) % gingivae.len().max(1))?;
    let slot = scene.tools.iter().position(|tool| !tool.bands.is_empty())?;
    let tool = &scene.tools[slot];
    let site = |site: Site| Vector3::from(gingiva.sites[site.number()]) * MM;
    let axis = along(scene, gingiva.fdi).map_or(Vector3::z(), |axis| axis.cast::<f32>());
    let out = site(Site::Buccal) - site(Site::Lingual);
    let out = (out - axis * out.dot(&axis)).try_normalize(1e-6)?;
    // Up along the probe, leaning away from the crown.
    let lean = LEAN_DEG.to_radians();
    let up = axis * lean.cos() + out * lean.sin();
    let upright = UnitQuaternion::rotation_between(&Vector3::from(tool.tip_axis), &-up)?;
    // The handle stands on the side of the cheek.
    let across = |v: Vector3<f32>| v - up * v.dot(&up);
    let (handle, wanted) = (across(upright * -Vector3::from(tool.tip)), across(out));
    let turn = handle.cross(&wanted).dot(&up).atan2(handle.dot(&wanted));
    let orientation = UnitQuaternion::from_axis_angle(&Unit::new_normalize(up), turn) * upright;
    let at_margin = site(Site::Buccal) + out * BESIDE_MM;
    let tip = at_margin - up * (task.depth_m() * MM);
    let mut moment = Moment::rest(scene);
    moment.tools[slot].held = true;
    moment.tools[slot].orientation = orientation;
    moment.tools[slot].position = tip - orientation * (Vector3::from(tool.tip) * MM);
    Some(moment)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::depth::by_bands;
    use sulcus_proto::datagram::WirePose;
    use sulcus_proto::display::{DisplayBand, DisplayMesh, DisplayTool};

    #[test]
    fn the_bands_show_the_length_of_the_task_at_every_tooth() {
        let mesh = || DisplayMesh::new(&[[0.0; 3]], &[], [255; 4], &[]).expect("a mesh");
        let gingiva = |k: u8| {
            let turn = f32::from(k);
            let out = Vector3::new(turn.cos(), turn.sin(), 0.0);
            let site = |side: f32| (out * (0.03 + 0.005 * side)).into();
            DisplayObject {
                kind: Kind::Gingiva,
                fdi: 31 + k,
                mesh: mesh(),
                skin: None,
                sites: vec![
                    site(1.0),
                    site(1.0),
                    site(1.0),
                    site(-1.0),
                    site(-1.0),
                    site(-1.0),
                ],
            }
        };
        let scene = DisplayScene {
            tick_ns: 1_000_000,
            tools: vec![DisplayTool {
                name: "probe".into(),
                mesh: mesh(),
                bands: vec![DisplayBand {
                    from: 0.0,
                    to: 0.015,
                    dark: false,
                }],
                glass: None,
                tip: [0.003, 0.0, -0.09],
                tip_axis: [0.643, 0.0, -0.766],
                park: WirePose::IDENTITY,
            }],
            objects: (0..7).map(gingiva).collect(),
        };
        for number in 0..7 {
            let task = Task {
                tenths: 23 + 11 * number as u16,
            };
            let moment = moment(&scene, task, number).expect("a place");
            let shown = by_bands(&scene, &moment).expect("a depth");
            assert!(
                (shown * 10.0 - f64::from(task.tenths)).abs() < 1.1,
                "{shown} {task:?}"
            );
            // The handle is above the teeth, and on the side of the cheek.
            let device = moment.tools[0].position;
            let tooth = Vector3::from(scene.objects[(5 * number + 3) % 7].sites[1]) * MM;
            let beyond = device.xy().norm() - tooth.xy().norm();
            assert!(device.z > 30.0 && beyond > 30.0, "{device}");
        }
    }
}
