//! True gaps after a step: from the present centres of the spheres, not from the linearisation.

use crate::blend::Pair;
use crate::contact::{Contact, Distance, centre};
use crate::math::{Mat3, Vec3, fmin, norm};
use crate::rows::{lever, runs};
use crate::state::State;
use crate::tick::request::ToolOutcome;
use crate::tick::substep::Substep;
use crate::tick::workspace::Workspace;
use crate::{MAX_TOOLS, Scene};

/// Computes the smallest true gap of each tool after a step, metres, into `outcomes`, and returns the smallest of all;
/// infinite without a gap. `index` is that of the substep in `Workspace::substeps`. `gone` is an upper bound of the
/// tool's motion, plus that of the tissue, since the contact list.
///
/// The gaps are those between contact spheres. On a blended object the gaps are those of the surface, evaluated again
/// at the present poses, as far as under the prediction distance `d`.
pub(crate) fn true_gaps(
    scene: &Scene,
    state: &State,
    ws: &mut Workspace,
    index: usize,
    (d, gone): (Distance, Distance),
    outcomes: &mut [ToolOutcome; MAX_TOOLS],
) -> f64 {
    let Substep {
        contacts, groups, ..
    } = &ws.substeps[index];
    let contacts = contacts.as_slice();
    let rotations: [Mat3; MAX_TOOLS] = std::array::from_fn(|t| {
        let graphic = &state.tools[t].graphic;
        graphic.orientation.to_rotation_matrix().into_inner()
    });
    for run in runs(contacts, |contact| contact.object) {
        if scene.blend_of(usize::from(contacts[run.start].object)) > 0.0 {
            continue;
        }
        // Contacts of one sphere are adjacent and share its centre.
        let mut last = None;
        for contact in &contacts[run] {
            let object_centre = match last {
                Some((sphere, centre)) if sphere == contact.object_sphere => centre,
                _ => centre_of(scene, ws, contact),
            };
            last = Some((contact.object_sphere, object_centre));
            let least = &mut outcomes[usize::from(contact.tool)].min_gap;
            let rotation = &rotations[usize::from(contact.tool)];
            let gap = true_gap(scene, state, (contact, rotation), &object_centre);
            *least = fmin(*least, gap);
        }
    }
    ws.counts.gaps += contacts.len() as u64;
    let (blender, cores) = (&mut ws.blender, &ws.cores);
    // The nearest group goes first: its gap lets most of the others be skipped.
    let nearest = groups.nearest();
    let others = groups.all.iter().enumerate();
    let others = others.filter(|(k, _)| Some(*k) != nearest);
    let first = nearest.map(|k| &groups.all[k]);
    for group in first.into_iter().chain(others.map(|(_, group)| group)) {
        let (t, k) = (usize::from(group.tool), usize::from(group.object));
        let (object, blend) = (&scene.objects[k], scene.blend_of(k));
        let lever = lever(group, groups, contacts);
        let limit = fmin(outcomes[t].min_gap, d.at(lever));
        if group.is_clear_of(limit, blend, gone.at(lever)) {
            continue;
        }
        blender.begin();
        let (pose, rotation) = (&state.tools[t].graphic, &rotations[t]);
        for &index in groups.contacts(group) {
            let contact = &contacts[index as usize];
            let tool_node = &scene.tools[t].tree.nodes()[contact.tool_sphere as usize];
            let between = centre(rotation, pose, &tool_node.centre)
                - object.tree.nodes()[contact.object_sphere as usize].centre;
            let distance = norm(&between);
            let normal = if distance > 1e-12 {
                between / distance
            } else {
                Vec3::z()
            };
            let core = cores[k][contact.object_sphere as usize].radius;
            let gap = distance - tool_node.contact_radius - core;
            blender.push(Pair::new(index, gap, normal, distance));
        }
        let gap = blender.least(blend, limit);
        if gap < limit {
            outcomes[t].min_gap = gap;
        }
    }
    ws.counts.add_blending(blender.take_effort());
    outcomes
        .iter()
        .fold(f64::INFINITY, |least, tool| fmin(least, tool.min_gap))
}

/// Returns the centre of the object's sphere of a contact at the present shape, world axes, metres.
#[inline]
fn centre_of(scene: &Scene, ws: &Workspace, contact: &Contact) -> Vec3 {
    let k = usize::from(contact.object);
    match ws.slots[k] {
        None => scene.objects[k].tree.nodes()[contact.object_sphere as usize].centre,
        Some(slot) => ws.yielding[slot].centre(scene, contact.object_sphere),
    }
}

/// Returns the gap of the contact spheres of a pair at the present graphic pose, metres, from the centres, not from the
/// linearisation. `rotation` is the rotation matrix of the tool's pose; `object_centre` is that of [`centre_of`].
#[inline]
fn true_gap(
    scene: &Scene,
    state: &State,
    (contact, rotation): (&Contact, &Mat3),
    object_centre: &Vec3,
) -> f64 {
    let (t, k) = (usize::from(contact.tool), usize::from(contact.object));
    let (tool, object) = (&scene.tools[t], &scene.objects[k]);
    let tool_node = &tool.tree.nodes()[contact.tool_sphere as usize];
    let object_node = &object.tree.nodes()[contact.object_sphere as usize];
    let pose = &state.tools[t].graphic;
    let between = centre(rotation, pose, &tool_node.centre) - object_centre;
    norm(&between) - tool_node.contact_radius - object_node.contact_radius
}
