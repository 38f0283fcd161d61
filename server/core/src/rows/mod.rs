//! Contact rows of a substep, and the curvature of the blended surfaces under load. A row is a hard contact, or a seed
//! on a blended object.

pub(crate) mod metric;

use std::ops::Range;

use crate::Scene;
use crate::blend::{Blender, ContactRow, Core, Group, Groups, Pair, Written, hollowness};
use crate::contact::{Contact, Distance};
use crate::math::{Vec3, fmin, norm};
use crate::rows::metric::Metric;
use crate::tick::substep::Substep;

/// Blended gap up to which a blended surface counts as touched, metres.
const TOUCHING: f64 = 2e-6;
/// Share of the coupling's translational stiffness under which the stiffness of a hollow surface (hollowness times
/// press) is ignored.
const LEAST_BEND: f64 = 0.1;

/// Returns the index ranges of items of the same object, in a list sorted by object. `object` returns the object's
/// index of an item.
pub(crate) fn runs<T>(
    items: &[T],
    object: impl Fn(&T) -> u16,
) -> impl Iterator<Item = Range<usize>> {
    let mut next = 0;
    std::iter::from_fn(move || {
        let first = next;
        let this = object(items.get(first)?);
        next = first
            + items[first..]
                .iter()
                .take_while(|item| object(item) == this)
                .count();
        Some(first..next)
    })
}

/// Groups the contacts of the substep with blended objects by tool sphere and object. `cores` has the cores of each
/// object's nodes, by object and node. Runs once per contact list.
pub(crate) fn group_contacts(scene: &Scene, substep: &mut Substep, cores: &[Vec<Core>]) {
    let Substep {
        contacts, groups, ..
    } = substep;
    groups.clear();
    let contacts = contacts.as_slice();
    for run in runs(contacts, |contact| contact.object) {
        let k = usize::from(contacts[run.start].object);
        if scene.blend_of(k) > 0.0 {
            let cores = &cores[k];
            groups.add(contacts, run, |contact| {
                contact.gap + cores[contact.object_sphere as usize].inset
            });
        }
    }
}

/// Writes the contact rows within the prediction distance `d`: hard contacts, and seeds with their members on blended
/// objects. The rows are in the order of the contacts' objects, and on a blended object grouped by tool sphere.
///
/// `cores` has the cores of each object's nodes. `narrowed` means that `d` is shorter than the distance of the contact
/// list. Returns the share of `d` within which the rows of every tool sphere fit, normally 1; 0 if not even the
/// smallest distance fits.
pub(crate) fn write_rows(
    scene: &Scene,
    substep: &mut Substep,
    (cores, blender): (&[Vec<Core>], &mut Blender),
    (d, narrowed): (Distance, bool),
) -> f64 {
    let Substep {
        contacts,
        contact_rows,
        members,
        groups,
        ..
    } = substep;
    contact_rows.clear();
    members.clear();
    let (mut share, mut next) = (1.0, 0);
    let contacts = contacts.as_slice();
    for run in runs(contacts, |contact| contact.object) {
        let k = usize::from(contacts[run.start].object);
        let blend = scene.blend_of(k);
        if blend == 0.0 {
            // The list holds contacts beyond `d` if `d` was shortened: skip them.
            let near = |index: &usize| {
                let contact = &contacts[*index];
                !narrowed || contact.gap <= d.at(norm(&contact.arm))
            };
            let hard = run.filter(near);
            contact_rows.extend(hard.map(|index| ContactRow::hard(index, &contacts[index])));
            continue;
        }
        let nodes = scene.objects[k].tree.nodes();
        // The gap in the contact list is that of the contact spheres, not of the cores.
        let inset = |contact: &Contact| cores[k][contact.object_sphere as usize].inset;
        let begun = next;
        next += groups.all[begun..].partition_point(|group| usize::from(group.object) == k);
        for at in begun..next {
            let group = &groups.all[at];
            let d = d.at(lever(group, groups, contacts));
            if group.is_clear_of(d, blend, 0.0) {
                continue;
            }
            blender.begin();
            for &index in groups.contacts(group) {
                let contact = &contacts[index as usize];
                let tool = &scene.tools[usize::from(contact.tool)].tree;
                let distance = contact.gap
                    + nodes[contact.object_sphere as usize].contact_radius
                    + tool.nodes()[contact.tool_sphere as usize].contact_radius;
                let gap = contact.gap + inset(contact);
                blender.push(Pair::new(index, gap, contact.normal, distance));
            }
            let mut written = Written {
                contact_rows: &mut *contact_rows,
                members: &mut *members,
            };
            let (room, least) = blender.rows(blend, d, &mut written);
            share = fmin(share, room / d);
            groups.all[at].least = least;
        }
    }
    share
}

/// Drops the rows with the largest gaps until `most` rows are left, in unchanged order. `gaps` is scratch. Returns
/// false when no row was dropped.
pub(crate) fn keep_smallest_gaps(
    contact_rows: &mut Vec<ContactRow>,
    gaps: &mut Vec<f64>,
    most: usize,
) -> bool {
    if contact_rows.len() <= most {
        return false;
    }
    gaps.clear();
    gaps.extend(contact_rows.iter().map(|row| row.gap));
    let (below, limit, _) = gaps.select_nth_unstable_by(most, f64::total_cmp);
    let limit = *limit;
    // Of the rows with exactly the limiting gap, the first ones stay.
    let mut room = most - below.iter().filter(|gap| **gap < limit).count();
    contact_rows.retain(|row| {
        let tie = row.gap == limit && room > 0;
        room -= usize::from(tie);
        row.gap < limit || tie
    });
    true
}

/// Returns the distance of a group's tool sphere from the working point, metres.
pub(crate) fn lever(group: &Group, groups: &Groups, contacts: &[Contact]) -> f64 {
    let first = groups.contacts(group)[0];
    norm(&contacts[first as usize].arm)
}

/// Adds to the metric of tool `t` the stiffness of the touched hollow surfaces: hollowness (1/m) times press (newtons).
/// The press of a row is the coupling force along its normal. `stretch` leads from the graphic to the haptic working
/// point, world axes, metres.
///
/// In a groove with a radius smaller than the depth of the press, substeps that know only the slope oscillate without
/// end. With the curvature they are Newton steps and converge in two or three. The curvature changes the path, not its
/// end.
pub(crate) fn bend(
    scene: &Scene,
    substep: &Substep,
    t: usize,
    stretch: &Vec3,
    metric: &mut Metric,
) {
    let contacts = substep.contacts.as_slice();
    let stiffness = scene.tools[t].stiffness_n_per_m;
    let touching = |row: &&ContactRow| {
        let contact = &contacts[row.contact as usize];
        row.members > 0
            && usize::from(contact.tool) == t
            && row.gap <= TOUCHING
            && row.normal.dot(stretch) < 0.0
    };
    // Each row counts the whole press. Where several rows share the press, the steps are shorter than necessary. Shared
    // out evenly, the curvature was too small in a groove, and ticks there did not converge.
    for row in substep.contact_rows.iter().filter(touching) {
        let contact = &contacts[row.contact as usize];
        let press = -stiffness * row.normal.dot(stretch);
        let first = row.first as usize;
        let members = &substep.members[first..first + row.members as usize];
        let blend = scene.blend_of(usize::from(contact.object));
        // No curvature is larger than that of two opposite normals.
        if press / blend < LEAST_BEND * stiffness {
            continue;
        }
        let hollow = hollowness(row, members, contacts, blend) * press;
        if hollow.trace() > LEAST_BEND * stiffness {
            metric.add(&hollow, &contact.arm);
        }
    }
}
