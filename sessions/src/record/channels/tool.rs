//! Messages of one tool's channels.

use std::cmp::Ordering;

use sulcus_core::contact::Contact;
use sulcus_core::math::norm;
use sulcus_core::output::status;
use sulcus_core::{Scene, Tool, ToolOutput, Vec3};

use super::own_types::v1::{self, Contacts, Pocket, ToolMetrics, Wrench};
use super::own_types::vector;
use super::shapes::Shapes;
use crate::record::occurrence::zone_name;

/// Largest number of listed contacts of one tool. The contacts with the largest loads are listed.
const LISTED: usize = 32;

/// Whether a hand holds the tool.
pub(crate) fn is_held(output: &ToolOutput) -> bool {
    output.status & status::ABSENT == 0
}

pub(super) fn wrench(tick: u64, output: &ToolOutput, peak_force_n: f64) -> Wrench {
    Wrench {
        tick,
        force_n: vector(&output.wrench.force),
        torque_nm: vector(&output.wrench.torque),
        raw_force_n: vector(&output.raw_wrench.force),
        raw_torque_nm: vector(&output.raw_wrench.torque),
        peak_force_n: peak_force_n as f32,
    }
}

pub(super) fn metrics(scene: &Scene, tick: u64, output: &ToolOutput) -> ToolMetrics {
    let pocket = output.pocket.map(|reading| Pocket {
        object: name_of(scene, reading.object),
        around_deg: reading.around.to_degrees() as f32,
        depth_mm: (reading.depth * 1e3) as f32,
        floor_force_n: reading.floor_force as f32,
        zone: zone_name(reading.zone).to_owned(),
    });
    let apart = output.graphic.position - output.haptic.position;
    ToolMetrics {
        tick,
        status: u32::from(output.status),
        substeps: u32::from(output.substeps),
        rows: u32::from(output.rows),
        active: u32::from(output.active),
        converged: output.converged,
        min_gap_um: output
            .min_gap
            .is_finite()
            .then_some((output.min_gap * 1e6) as f32),
        held_back_mm: (norm(&apart) * 1e3) as f32,
        pocket,
    }
}

/// Contacts of the tool in slot `t`.
pub(super) fn contacts(scene: &Scene, t: usize, output: &ToolOutput, shapes: &Shapes) -> Contacts {
    let tool = &scene.tools[t];
    let working_point = output.graphic.transform(&tool.working_point);
    let of_tool = shapes.contacts.iter();
    let mut ours: Vec<&(Contact, f64)> = of_tool
        .filter(|(contact, _)| usize::from(contact.tool) == t)
        .collect();
    // The sort is stable, so equal loads stay in the order of the rows.
    ours.sort_by(|a, b| b.1.partial_cmp(&a.1).unwrap_or(Ordering::Equal));
    ours.truncate(LISTED);
    let contact = |(contact, load): &&(Contact, f64)| v1::Contact {
        object: name_of(scene, contact.object),
        position_m: vector(&place(tool, &working_point, contact)),
        normal: vector(&contact.normal),
        load_n: *load as f32,
        gap_um: (contact.gap * 1e6) as f32,
    };
    Contacts {
        tick: shapes.tick,
        bearing: shapes.bearing[t],
        contacts: ours.iter().map(contact).collect(),
    }
}

/// Point of the tool's sphere that is nearest to the object's sphere, world axes, metres.
fn place(tool: &Tool, working_point: &Vec3, contact: &Contact) -> Vec3 {
    let node = tool.tree.nodes().get(contact.tool_sphere as usize);
    let radius = node.map_or(0.0, |node| node.contact_radius);
    working_point + contact.arm - contact.normal * radius
}

fn name_of(scene: &Scene, object: u16) -> String {
    let object = scene.objects.get(usize::from(object));
    object.map_or_else(String::new, |object| object.name.clone())
}
