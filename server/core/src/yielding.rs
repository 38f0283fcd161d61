//! Tissue in a pass: its part of the problem, and where it goes under the answer.

use crate::Scene;
use crate::blend::Line;
use crate::contact::Contact;
use crate::math::{Vec3, fmax};
use crate::rows::runs;
use crate::tick::{Pass, Workspace};
use crate::tissue::{Gram, Site};

/// The tissue's part of the problem: compliance and the way from the free shape. False when
/// nothing touched yields.
pub(crate) fn fill_tissue(scene: &Scene, ws: &mut Workspace, first: usize) -> bool {
    let Pass {
        contacts,
        lines,
        rows,
        tissue,
        ..
    } = &mut ws.passes[first];
    let contacts = contacts.as_slice();
    let about = |line: &Line| &contacts[line.contact as usize];
    let touched = |c: &Contact| !scene.objects[usize::from(c.object)].tissue.is_rigid();
    if ws.yielding.is_empty() || !contacts.iter().any(touched) {
        *tissue = false;
        return false;
    }
    *tissue = true;
    let m = rows.len();
    ws.gram[..m * m].fill(0.0);
    for run in runs(lines, |line| about(line).object) {
        let k = usize::from(about(&lines[run.start]).object);
        let object = &scene.objects[k];
        if object.tissue.is_rigid() {
            continue;
        }
        let model = object.tissue.model();
        ws.sites.clear();
        for line in &lines[run.clone()] {
            ws.sites.push(Site {
                sphere: about(line).object_sphere,
                normal: line.normal,
            });
        }
        model.add_gram(
            &object.tree,
            &ws.sites,
            &mut Gram::new(&mut ws.gram, m, run.start),
        );
        // n . (u_k - u0): the rows are written at the present shape, the load acts on the free one.
        let free = &ws.free[ws.shape_at[k]..ws.shape_at[k + 1]];
        for (row, line) in rows[run.clone()].iter_mut().zip(&lines[run]) {
            let contact = about(line);
            let mut at_rest = [Vec3::zeros()];
            model.centres(&object.tree, free, &[contact.object_sphere], &mut at_rest);
            let now = ws.nodes[k][contact.object_sphere as usize].centre;
            row.bias += contact.normal.dot(&(now - at_rest[0]));
        }
    }
    true
}

/// Writes the configurations under the multipliers to `target`; returns the largest motion there.
pub(crate) fn yield_target(scene: &Scene, ws: &mut Workspace, first: usize) -> f64 {
    let mut motion = 0.0;
    for index in 0..ws.yielding.len() {
        let k = ws.yielding[index];
        let object = &scene.objects[k];
        let model = object.tissue.model();
        ws.sites.clear();
        ws.site_loads.clear();
        for (contact, load) in ws.passes[first].loaded() {
            if usize::from(contact.object) == k {
                ws.sites.push(Site {
                    sphere: contact.object_sphere,
                    normal: contact.normal,
                });
                ws.site_loads.push(load);
            }
        }
        let at = ws.shape_at[k]..ws.shape_at[k + 1];
        let (free, target) = (&ws.free[at.clone()], &mut ws.target[at.clone()]);
        model.apply(&object.tree, &ws.sites, &ws.site_loads, free, target);
        motion = fmax(motion, model.motion(&object.tree, &ws.shape[at], target));
    }
    motion
}
