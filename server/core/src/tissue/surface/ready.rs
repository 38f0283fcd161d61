//! Surface compliance in a tick.

use super::data::{SurfaceCompliance, SurfaceSkin};
use super::stress::quadratic_stress;
use crate::math::{Mat3, Vec3, fmax};
use crate::tissue::{Gram, Hands, Site, SiteLoad, Tissue, all_zero, largest_difference};
use crate::tree::SphereTree;

/// Threshold of displacement below which the free configuration is set to rest, metres.
const AT_REST: f64 = 1e-8;
/// Frobenius norm of a cell's displacement gradient at which the large-displacement term has its maximum. A series of
/// second order has no meaning at such gradients.
const LARGEST: f64 = 0.7;

/// Largest number of spheres for which the compliance between any two is stored (15 MB); level 3 has 512.
const KEPT: usize = 640;
/// Marker in `Ready::slots` of a node that cannot be touched.
const NONE: u32 = u32::MAX;

/// [`SurfaceCompliance`] prepared for ticks. A configuration is the displacement of the moving masters, metres, x, y, z
/// in turn.
///
/// Tables are in single precision, and so are sums over them before their addition to a displacement. An instruction
/// then handles twice as many numbers. The error is a ten-millionth of the change in a tick, far below the contact
/// compliance.
#[derive(Debug)]
pub(in crate::tissue) struct Ready {
    rest: Vec<Vec3>,
    skin: Vec<SurfaceSkin>,
    poisson: f64,
    /// Count of numbers in a configuration: three for each moving master.
    len: usize,
    /// Fraction of a linear displacement that is left after a tick without load.
    kept: f64,
    /// Displacement of all moving masters at the end of the tick for a unit load on each touchable sphere, `W_i S dt /
    /// (tau + dt)`, m/N. Each sphere has three rows, for loads along x, y and z.
    compliance: Vec<f32>,
    /// Index of each node of the tree among the touchable spheres, or `NONE`.
    slots: Vec<u32>,
    /// Compliance `W_i S W_j' dt / (tau + dt)` between any two touchable spheres, m/N, row by row. Empty if there are
    /// more than `KEPT` spheres.
    blocks: Vec<[f32; 9]>,
    /// Number of touchable spheres: those of the contact level.
    touchable: usize,
    /// Displacement gradients of all cells for a unit force on each coordinate of the moving masters, `R_e' / V_e dt /
    /// (tau + dt)`, 1/N. Each coordinate has a row, with nine numbers for each cell.
    gradients: Vec<f32>,
    /// Displacement `R_e` times `SurfaceParams::large`, metres for a stress in units of Young's modulus.
    ///
    /// Each cell has nine rows, one for each component of the stress. A row has x, y and z of every moving master.
    response: Vec<f32>,
    /// The large-displacement term in this tick, metres: x, y and z of each moving master.
    term: Vec<f32>,
    /// Scratch of the commit: force on each moving master, world axes, newtons.
    forces: Vec<Vec3>,
    /// Scratch of the commit: whether each moving master bears a force.
    loaded: Vec<bool>,
    /// Scratch for the change of a configuration or of the gradients.
    change: Vec<f32>,
}

/// Returns the displacement of the sphere with the carriers `skin`, in the unit of `moved`. `moved` has the
/// displacements of the moving masters, x, y, z in turn.
#[inline]
fn carried<T: Copy + Into<f64>>(skin: &SurfaceSkin, moved: &[T]) -> Vec3 {
    let mut sum = Vec3::zeros();
    for (&master, weight) in skin.masters.iter().zip(skin.weights) {
        let u = &moved[3 * usize::from(master)..][..3];
        sum += Vec3::new(u[0].into(), u[1].into(), u[2].into()) * weight;
    }
    sum
}

/// Adds three rows of a table to `sum`, each times its factor.
#[inline]
fn add_rows(sum: &mut [f32], table: &[f32], by: [f32; 3]) {
    let n = sum.len();
    let (x, rest) = table.split_at(n);
    let (y, z) = rest.split_at(n);
    for (((sum, x), y), z) in sum.iter_mut().zip(x).zip(y).zip(z) {
        *sum += x * by[0] + y * by[1] + z * by[2];
    }
}

impl Ready {
    /// Prepares `model` for contact at `level` and ticks of `tick_s` seconds. The model must have passed its validation
    /// against `rest`.
    pub fn new(model: &SurfaceCompliance, rest: &SphereTree, level: u8, tick_s: f64) -> Self {
        let (params, masters) = (&model.params, model.masters.moving());
        let n = 3 * masters;
        let new = tick_s / (params.relaxation + tick_s);
        let mut slots = vec![NONE; rest.nodes().len()];
        let mut compliance = Vec::new();
        for (slot, (node, _)) in rest.shape_at(level).enumerate() {
            slots[node as usize] = slot as u32;
            let skin = &model.skin[node as usize];
            for axis in 0..3 {
                compliance.extend((0..n).map(|number| {
                    let carriers = skin.masters.iter().zip(skin.weights);
                    let sum = carriers.fold(0.0, |sum, (&master, weight)| {
                        sum + weight * model.entry(3 * usize::from(master) + axis, number)
                    });
                    (sum * (new / params.young)) as f32
                }));
            }
        }
        let touchable: Vec<u32> = rest.shape_at(level).map(|(node, _)| node).collect();
        let mut blocks = Vec::new();
        if touchable.len() <= KEPT {
            for rows in compliance.chunks_exact(3 * n) {
                blocks.extend(touchable.iter().map(|node| {
                    let mut block = [0.0; 9];
                    for (k, entry) in block.iter_mut().enumerate() {
                        let row = &rows[k / 3 * n..(k / 3 + 1) * n];
                        *entry = carried(&model.skin[*node as usize], row)[k % 3] as f32;
                    }
                    block
                }));
            }
        }
        let cells = model.cells.volumes.len();
        let response = |k: usize| f64::from(model.cells.response[k]);
        let gradients = (0..n * 9 * cells).map(|k| {
            let (number, gradient) = (k / (9 * cells), k % (9 * cells));
            let by = new / params.young / model.cells.volumes[gradient / 9];
            (response(gradient * n + number) * by) as f32
        });
        Self {
            rest: rest.nodes().iter().map(|node| node.centre).collect(),
            skin: model.skin.clone(),
            poisson: params.poisson,
            len: n,
            kept: params.relaxation / (params.relaxation + tick_s),
            compliance,
            slots,
            blocks,
            touchable: touchable.len(),
            gradients: gradients.collect(),
            // Young's modulus cancels: `quadratic_stress` is relative to it, and the response is for 1 Pa.
            response: (0..9 * n * cells)
                .map(|k| (response(k) * params.large) as f32)
                .collect(),
            term: vec![0.0; n],
            forces: vec![Vec3::zeros(); masters],
            loaded: vec![false; masters],
            change: vec![0.0; n.max(9 * cells)],
        }
    }

    /// Drops the stored blocks, as with more than `KEPT` spheres.
    #[cfg(test)]
    pub fn without_blocks(mut self) -> Self {
        self.blocks.clear();
        self
    }

    /// Computes the large-displacement term, metres, from the displacement gradients of the cells, nine numbers each.
    fn write_term(&mut self, gradients: &[f64]) {
        self.term.fill(0.0);
        let cells = self.response.chunks_exact(9 * self.len);
        for (g, rows) in gradients.as_chunks::<9>().0.iter().zip(cells) {
            let size = g.iter().fold(0.0, |sum, x| sum + x * x);
            if size == 0.0 {
                continue;
            }
            // The term is quadratic for small gradients and bounded for large gradients.
            let beyond = size / (LARGEST * LARGEST);
            let stress = quadratic_stress(&Mat3::from_row_slice(g), self.poisson);
            let stress = stress / -(1.0 + beyond * beyond);
            for (k, rows) in rows.chunks_exact(3 * self.len).enumerate() {
                let by = [0, 1, 2].map(|column| stress[(k, column)] as f32);
                add_rows(&mut self.term, rows, by);
            }
        }
    }

    /// Adds to `sum` the displacement of all moving masters (metres) for a load of `by` newtons along the normal of
    /// `site`.
    fn add_column(&self, site: &Site, by: f64, sum: &mut [f32]) {
        let slot = self.slots[site.sphere as usize];
        // Only nodes of the contact level have a slot, and only they are touched.
        if slot != NONE {
            let first = 3 * slot as usize * self.len;
            let rows = &self.compliance[first..first + 3 * self.len];
            let n = &site.normal;
            add_rows(sum, rows, [n.x, n.y, n.z].map(|x| (x * by) as f32));
        }
    }
}

impl Tissue for Ready {
    fn shape_len(&self) -> usize {
        self.len
    }

    fn free_step(
        &mut self,
        state: &[f64],
        _: &Hands<'_>,
        shape: &mut [f64],
        free: &mut [f64],
    ) -> bool {
        let (whole, rest) = state.split_at(self.len);
        let (linear, gradients) = rest.split_at(self.len);
        shape.copy_from_slice(whole);
        if all_zero(state) {
            free.fill(0.0);
            self.term.fill(0.0);
            return true;
        }
        self.write_term(gradients);
        let mut most = 0.0;
        for ((free, linear), term) in free.iter_mut().zip(linear).zip(&self.term) {
            *free = self.kept * linear + f64::from(*term);
            most = fmax(most, free.abs());
        }
        // Exponential decay alone would never reach the rest.
        if most < AT_REST {
            free.fill(0.0);
            self.term.fill(0.0);
        }
        false
    }

    fn centres(&self, shape: &[f64], ids: &[u32], out: &mut [Vec3]) {
        for (id, centre) in ids.iter().zip(out) {
            *centre = self.rest[*id as usize] + carried(&self.skin[*id as usize], shape);
        }
    }

    fn add_gram(&mut self, sites: &[Site], gram: &mut Gram<'_>) {
        let mut column = std::mem::take(&mut self.change);
        for (i, row) in sites.iter().enumerate() {
            let column = &mut column[..self.len];
            let slot = self.slots[row.sphere as usize] as usize;
            // Every touched node has a slot.
            let blocks = self.blocks.chunks_exact(self.touchable.max(1)).nth(slot);
            if blocks.is_none() {
                column.fill(0.0);
                self.add_column(row, 1.0, column);
            }
            // Rows of one sphere are adjacent and share the sphere's displacement.
            let mut next = 0;
            while let Some(first) = sites[..=i].get(next) {
                let slot = self.slots[first.sphere as usize] as usize;
                let moved = match blocks.and_then(|blocks| blocks.get(slot)) {
                    Some(block) => {
                        let along = |axis: usize| {
                            let c = |k: usize| f64::from(block[3 * k + axis]);
                            row.normal.x * c(0) + row.normal.y * c(1) + row.normal.z * c(2)
                        };
                        Vec3::new(along(0), along(1), along(2))
                    }
                    None => carried(&self.skin[first.sphere as usize], column),
                };
                let rest = sites[next..=i].iter();
                for site in rest.take_while(|site| site.sphere == first.sphere) {
                    let entry = moved.dot(&site.normal);
                    gram.add(i, next, entry);
                    if i != next {
                        gram.add(next, i, entry);
                    }
                    next += 1;
                }
            }
        }
        self.change = column;
    }

    fn apply(&mut self, sites: &[Site], lambda: &[f64], free: &[f64], shape: &mut [f64]) {
        let mut moved = std::mem::take(&mut self.change);
        let change = &mut moved[..self.len];
        change.fill(0.0);
        for (site, load) in sites.iter().zip(lambda).filter(|(_, load)| **load != 0.0) {
            self.add_column(site, -load, change);
        }
        for ((shape, free), change) in shape.iter_mut().zip(free).zip(change) {
            *shape = free + f64::from(*change);
        }
        self.change = moved;
    }

    fn motion(&self, from: &[f64], to: &[f64]) -> f64 {
        // A sphere moves by a mean of its carriers' motions, so the farthest of its carriers is a bound.
        largest_difference(from, to)
    }

    fn commit(
        &mut self,
        shape: &[f64],
        loads: Option<&[SiteLoad]>,
        _: &Hands<'_>,
        state: &mut [f64],
    ) {
        let (whole, rest) = state.split_at_mut(self.len);
        let (linear, gradients) = rest.split_at_mut(self.len);
        whole.copy_from_slice(shape);
        for ((linear, now), term) in linear.iter_mut().zip(shape).zip(&self.term) {
            *linear = now - f64::from(*term);
        }
        let Some(loads) = loads else { return };
        gradients.iter_mut().for_each(|g| *g *= self.kept);
        if loads.is_empty() {
            if shape.iter().all(|x| *x == 0.0) {
                state.fill(0.0);
            }
            return;
        }
        let Self {
            skin,
            forces,
            loaded,
            change,
            ..
        } = self;
        for load in loads {
            let skin = &skin[load.sphere as usize];
            for (&master, weight) in skin.masters.iter().zip(skin.weights) {
                let force = &mut forces[usize::from(master)];
                if weight > 0.0 {
                    loaded[usize::from(master)] = true;
                    *force += load.force * weight;
                }
            }
        }
        let change = &mut change[..gradients.len()];
        change.fill(0.0);
        for (master, loaded) in loaded.iter_mut().enumerate() {
            if !std::mem::take(loaded) {
                continue;
            }
            let first = 3 * master * change.len();
            let force = std::mem::take(&mut forces[master]);
            let by = [force.x, force.y, force.z].map(|x| x as f32);
            let rows = &self.gradients[first..first + 3 * change.len()];
            add_rows(change, rows, by);
        }
        for (g, change) in gradients.iter_mut().zip(change) {
            *g += f64::from(*change);
        }
    }
}
