//! What each row of a pass is about: a contact, or on a blended object a place of its surface; and how such
//! a surface bends there.

pub(crate) mod metric;

use std::ops::Range;

use crate::Scene;
use crate::blend::{ContactRow, Group, Groups, Pair, Written, hollowness};
use crate::contact::{Contact, Distance};
use crate::math::{Vec3, fmin, norm};
use crate::rows::metric::Metric;
use crate::tick::substep::Substep;
use crate::tick::workspace::Workspace;

/// Blended gap up to which a surface is taken to be touched, metres.
const TOUCHING: f64 = 2e-6;
/// Share of the coupling's stiffness under which the bend of a surface is too little to matter.
const LEAST_BEND: f64 = 0.1;

/// Ranges of what is sorted by object that are about one object.
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

/// Sorts the contacts with blended objects by what is summed together; to be done once for a list of contacts.
pub(crate) fn group_contacts(scene: &Scene, ws: &mut Workspace, index: usize) {
    let Substep {
        contacts, groups, ..
    } = &mut ws.substeps[index];
    groups.clear();
    let contacts = contacts.as_slice();
    for run in runs(contacts, |contact| contact.object) {
        let k = usize::from(contacts[run.start].object);
        if scene.blend_of(k) > 0.0 {
            let cores = &ws.cores[k];
            groups.add(contacts, run, |contact| {
                contact.gap + cores[contact.object_sphere as usize].inset
            });
        }
    }
}

/// Writes what each row within `d` is about: a contact, or on a blended object a seed with its members. In the
/// order of the contacts' objects; tool sphere by tool sphere on a blended one. Returns the share of `d` within which every tool
/// sphere had room for all of its rows, 1 as a rule. The list of contacts reaches farther than `d` where that was `narrowed` since.
pub(crate) fn write_rows(
    scene: &Scene,
    ws: &mut Workspace,
    index: usize,
    (d, narrowed): (Distance, bool),
) -> f64 {
    let Substep {
        contacts,
        contact_rows,
        members,
        groups,
        ..
    } = &mut ws.substeps[index];
    let blender = &mut ws.blender;
    contact_rows.clear();
    members.clear();
    let (mut share, mut next) = (1.0, 0);
    let contacts = contacts.as_slice();
    for run in runs(contacts, |contact| contact.object) {
        let k = usize::from(contacts[run.start].object);
        let blend = scene.blend_of(k);
        if blend == 0.0 {
            // (What the list holds beyond `d` is left out where `d` has become shorter since.)
            let near = |index: &usize| {
                let contact = &contacts[*index];
                !narrowed || contact.gap <= d.at(norm(&contact.arm))
            };
            let hard = run.filter(near);
            contact_rows.extend(hard.map(|index| ContactRow::hard(index, &contacts[index])));
            continue;
        }
        let nodes = scene.objects[k].tree.nodes();
        // The list's gap is that of the contact spheres.
        let inset = |contact: &Contact| ws.cores[k][contact.object_sphere as usize].inset;
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

/// Leaves out the rows with the largest gaps until `most` are left; false when all were kept.
pub(crate) fn keep_smallest_gaps(ws: &mut Workspace, index: usize, most: usize) -> bool {
    let contact_rows = &mut ws.substeps[index].contact_rows;
    if contact_rows.len() <= most {
        return false;
    }
    ws.gaps.clear();
    ws.gaps.extend(contact_rows.iter().map(|row| row.gap));
    let (below, limit, _) = ws.gaps.select_nth_unstable_by(most, f64::total_cmp);
    let limit = *limit;
    // Of those as far as the first that has no room, the first ones stay.
    let mut room = most - below.iter().filter(|gap| **gap < limit).count();
    contact_rows.retain(|row| {
        let tie = row.gap == limit && room > 0;
        room -= usize::from(tie);
        row.gap < limit || tie
    });
    true
}

/// Lever of a group's tool sphere about the working point, metres.
pub(crate) fn lever(group: &Group, groups: &Groups, contacts: &[Contact]) -> f64 {
    let first = groups.contacts(group)[0];
    norm(&contacts[first as usize].arm)
}

/// Adds to the metric of tool `t` how the surfaces that it presses on bend inwards, times the press. In
/// a groove rounder than the press is deep, passes that know only the slope turn to and fro for ever; with
/// the bend they are Newton's and settle in two or three. Changes the way, not where it ends.
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
    // Each row counts the whole press: where several share it that is too much, and steps are shorter than they
    // might be; shared out evenly it was too little in a groove, and ticks there did not converge.
    for row in substep.contact_rows.iter().filter(touching) {
        let contact = &contacts[row.contact as usize];
        let press = -stiffness * row.normal.dot(stretch);
        let first = row.first as usize;
        let members = &substep.members[first..first + row.members as usize];
        let blend = scene.blend_of(usize::from(contact.object));
        // No bend is sharper than that of two opposite normals.
        if press / blend < LEAST_BEND * stiffness {
            continue;
        }
        let hollow = hollowness(row, members, contacts, blend) * press;
        if hollow.trace() > LEAST_BEND * stiffness {
            metric.add(&hollow, &contact.arm);
        }
    }
}
