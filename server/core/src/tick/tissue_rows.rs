//! Tissue in the problem of a substep: its part of the rows, and its targets under the multipliers.

use crate::blend::ContactRow;
use crate::math::{Vec3, fmax};
use crate::rows::runs;
use crate::tick::substep::Substep;
use crate::tick::yielding::Yielding;
use crate::tissue::{Gram, Site};
use crate::work::Counts;

/// Fills in the tissue's part of the problem: the compliance, and the displacement from the free shape in the biases.
/// `slots` has the index in `tissues` of each object of the scene; `sites` is scratch; `counts` gets the work. Returns
/// false when no touched object yields.
pub(crate) fn fill_tissue(
    substep: &mut Substep,
    tissues: &mut [Yielding],
    slots: &[Option<usize>],
    (sites, counts): (&mut Vec<Site>, &mut Counts),
) -> bool {
    let Substep {
        contacts,
        contact_rows,
        rows,
        tissue,
        gram,
        ..
    } = substep;
    let contacts = contacts.as_slice();
    let about = |row: &ContactRow| &contacts[row.contact as usize];
    let slot_of = |object: u16| slots[usize::from(object)];
    let mut touched = runs(contacts, |contact| contact.object);
    *tissue = touched.any(|run| slot_of(contacts[run.start].object).is_some());
    if !*tissue {
        return false;
    }
    let m = rows.len();
    gram[..m * m].fill(0.0);
    for run in runs(contact_rows, |row| about(row).object) {
        let Some(slot) = slot_of(about(&contact_rows[run.start]).object) else {
            continue;
        };
        let yielding = &mut tissues[slot];
        sites.clear();
        sites.extend(
            contact_rows[run.clone()]
                .iter()
                .map(|row| about(row).site()),
        );
        counts.tissue += yielding.effort().pair * (run.len() * run.len()) as u64;
        yielding
            .model
            .add_gram(sites, &mut Gram::new(gram, m, run.start));
        if yielding.still {
            // The present shape is the free shape: no bias to add.
            continue;
        }
        // n . (u_k - u0): the rows are written at the present shape, the load acts on the free shape.
        let mut last = (None, Vec3::zeros());
        for (problem_row, row) in rows[run.clone()].iter_mut().zip(&contact_rows[run]) {
            let contact = about(row);
            // Rows of one sphere are adjacent, so its displacement is cached.
            if last.0 != Some(contact.object_sphere) {
                let mut centre = [Vec3::zeros(); 2];
                let [now, free] = &mut centre;
                let (id, model) = ([contact.object_sphere], &yielding.model);
                model.centres(&yielding.shape, &id, std::slice::from_mut(now));
                model.centres(&yielding.free, &id, std::slice::from_mut(free));
                last = (Some(contact.object_sphere), *now - *free);
            }
            problem_row.bias += contact.normal.dot(&last.1);
        }
    }
    true
}

/// Computes the configurations of the substep's tissues under the multipliers. `sites` and `loads` are scratch;
/// `counts` gets the work. Returns the largest motion of a sphere to its target, metres.
pub(crate) fn aim_tissues(
    substep: &Substep,
    tissues: &mut [Yielding],
    (sites, loads): (&mut Vec<Site>, &mut Vec<f64>),
    counts: &mut Counts,
) -> f64 {
    let mut motion = 0.0;
    for &slot in &substep.tissues {
        let yielding = &mut tissues[slot];
        let object = yielding.object;
        sites.clear();
        loads.clear();
        // Contacts are sorted by object.
        let contacts = substep.contacts.as_slice();
        let begin = contacts.partition_point(|contact| usize::from(contact.object) < object);
        let ours = contacts.iter().zip(&substep.shares).skip(begin);
        for (contact, load) in ours.take_while(|ours| usize::from(ours.0.object) == object) {
            sites.push(contact.site());
            loads.push(*load);
        }
        let (effort, loaded) = (yielding.effort(), loads.iter().filter(|load| **load > 0.0));
        counts.tissue += effort.apply + effort.load * loaded.count() as u64;
        motion = fmax(motion, yielding.aim(sites, loads));
    }
    motion
}
