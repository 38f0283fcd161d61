//! Places of both tools in the mouth: each over a tooth of its own.

use sulcus_core::math::exp_rotation;
use sulcus_core::{Pose, Quat, Scene, Vec3};
use sulcus_haptics::Mapping;

use crate::messages::SEAT_HOUR;

/// Teeth under the tools of both slots.
const TEETH: [u8; 2] = [36, 46];
/// Way of each tool down to the first contact, metres.
const ABOVE: f64 = 8e-3;

/// Orientation of a tool whose handle points up at the device.
fn upright() -> Quat {
    Mapping::seat(SEAT_HOUR) * exp_rotation(&Vec3::new(-std::f64::consts::FRAC_PI_2, 0.0, 0.0))
}

/// Pose of the tool in `slot` [`ABOVE`] its tooth: its tip over the middle of the crown.
pub fn over_a_tooth(scene: &Scene, slot: usize) -> Pose {
    let tool = &scene.tools[slot];
    let tooth = scene
        .objects
        .iter()
        .find(|object| object.fdi == TEETH[slot]);
    let tooth = tooth.expect("a tooth under the tool");
    let spheres: Vec<_> = tooth
        .tree
        .shape_at(tooth.level)
        .map(|(_, node)| node)
        .collect();
    let middle = spheres.iter().map(|node| node.centre).sum::<Vec3>() / spheres.len() as f64;
    let mut pose = Pose::new(Vec3::zeros(), upright());
    pose.position = Vec3::new(middle.x, middle.y, 0.2) - pose.orientation * tool.tip;
    pose.position.z = 0.2;
    pose.position.z -= drop(scene, slot, &pose) - ABOVE;
    pose
}

/// Way down of the tool in `slot` at `pose` to its first contact, metres.
pub fn drop(scene: &Scene, slot: usize, pose: &Pose) -> f64 {
    let tool = &scene.tools[slot];
    let mut least = f64::INFINITY;
    for (_, own) in tool.tree.shape_at(tool.level) {
        let own_at = pose.transform(&own.centre);
        for object in &scene.objects {
            for (_, node) in object.tree.shape_at(object.level) {
                let reach = own.contact_radius + node.contact_radius;
                let aside = (own_at - node.centre).xy().norm();
                if aside < reach {
                    let apart = (reach * reach - aside * aside).sqrt();
                    least = least.min(own_at.z - node.centre.z - apart);
                }
            }
        }
    }
    least
}
