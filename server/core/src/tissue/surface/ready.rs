//! A surface compliance in a tick.

use super::data::{SURFACE_CARRIERS, SurfaceCompliance, SurfaceSkin};
use super::stress::quadratic_stress;
use crate::TICK_S;
use crate::math::{Mat3, Vec3, fmax};
use crate::tissue::{Gram, Hands, Site, SiteLoad, Tissue, largest_difference};
use crate::tree::SphereTree;

/// Displacement under which what nothing loads is at rest, metres.
const AT_REST: f64 = 1e-8;
/// Size of a displacement gradient at which the large-displacement term no longer grows: there a series that ends with the second
/// order has long lost its meaning.
const LARGEST: f64 = 0.7;
/// Masters that carry no touched sphere.
const NOWHERE: u16 = u16::MAX;

/// A [`SurfaceCompliance`] made ready. A configuration is the displacement of the masters, x, y, z in turn.
#[derive(Debug)]
pub(in crate::tissue) struct Ready {
    rest: Vec<Vec3>,
    skin: Vec<SurfaceSkin>,
    poisson: f64,
    /// Numbers of a configuration.
    len: usize,
    /// Share of a displacement that is left after a tick without load.
    kept: f64,
    /// `S dt / (tau + dt)`, m/N, row by row.
    compliance: Vec<f64>,
    /// `R_e' / V_e dt / (tau + dt)`, 1/N: nine rows for each cell.
    gradients: Vec<f64>,
    /// `R_e` times Young's modulus and share of the term, metres: nine rows for each cell.
    response: Vec<f64>,
    /// The large-displacement term in this tick, metres.
    term: Vec<f64>,
    /// Masters that carry a touched sphere, and for each master its place among them.
    touched: Vec<u16>,
    places: Vec<u16>,
    /// How each touched master moves along x, y, z for a unit load along one row.
    moved: Vec<Vec3>,
    /// Force on each touched master.
    forces: Vec<Vec3>,
}

impl Ready {
    /// `model` must have passed its check against `rest`.
    pub fn new(model: &SurfaceCompliance, rest: &SphereTree) -> Self {
        let (params, masters) = (&model.params, usize::from(model.masters));
        let n = 3 * masters;
        let new = TICK_S / (params.relaxation + TICK_S);
        let compliance = (0..n * n)
            .map(|k| model.entry(k / n, k % n) * (new / params.young))
            .collect();
        let cells = model.cells.volumes.len();
        let response = |k: usize| f64::from(model.cells.response[k]);
        let gradients = (0..9 * n * cells)
            .map(|k| response(k) * (new / params.young / model.cells.volumes[k / (9 * n)]))
            .collect();
        Self {
            rest: rest.nodes().iter().map(|node| node.centre).collect(),
            skin: model.skin.clone(),
            poisson: params.poisson,
            len: n,
            kept: params.relaxation / (params.relaxation + TICK_S),
            compliance,
            gradients,
            // Stress over Young's modulus, times Young's modulus, over Young's modulus.
            response: (0..9 * n * cells)
                .map(|k| response(k) * params.large)
                .collect(),
            term: vec![0.0; n],
            touched: Vec::with_capacity(masters),
            places: vec![NOWHERE; masters],
            moved: vec![Vec3::zeros(); masters],
            forces: vec![Vec3::zeros(); masters],
        }
    }

    /// The large-displacement term at gradients of the cells.
    fn write_term(&mut self, gradients: &[f64]) {
        self.term.fill(0.0);
        for (g, rows) in gradients
            .as_chunks::<9>()
            .0
            .iter()
            .zip(self.response.chunks_exact(9 * self.len))
        {
            let size = g.iter().fold(0.0, |sum, x| sum + x * x);
            if size == 0.0 {
                continue;
            }
            let g = Mat3::from_row_slice(g);
            // Quadratic while it is small, and bounded.
            let beyond = size / (LARGEST * LARGEST);
            let stress = quadratic_stress(&g, self.poisson) / (1.0 + beyond * beyond);
            for (k, row) in rows.chunks_exact(self.len).enumerate() {
                let by = stress[(k / 3, k % 3)];
                for (term, response) in self.term.iter_mut().zip(row) {
                    *term -= by * response;
                }
            }
        }
    }

    /// Displacement of a node of the tree.
    #[inline]
    fn displacement(&self, shape: &[f64], node: u32) -> Vec3 {
        let skin = &self.skin[node as usize];
        let mut sum = Vec3::zeros();
        for c in 0..SURFACE_CARRIERS {
            let at = 3 * usize::from(skin.masters[c]);
            let u = &shape[at..at + 3];
            sum += Vec3::new(u[0], u[1], u[2]) * skin.weights[c];
        }
        sum
    }

    /// Lists the masters that carry the `spheres`.
    fn touch(&mut self, spheres: impl Iterator<Item = u32>) {
        self.touched.clear();
        for sphere in spheres {
            let skin = &self.skin[sphere as usize];
            for (&master, weight) in skin.masters.iter().zip(skin.weights) {
                let place = &mut self.places[usize::from(master)];
                if *place == NOWHERE && weight > 0.0 {
                    *place = self.touched.len() as u16;
                    self.touched.push(master);
                }
            }
        }
        self.forces[..self.touched.len()].fill(Vec3::zeros());
    }

    fn forget(&mut self) {
        for &master in &self.touched {
            self.places[usize::from(master)] = NOWHERE;
        }
    }

    /// Adds a force on a sphere to those on the touched masters.
    fn add_force(&mut self, sphere: u32, force: &Vec3) {
        let skin = &self.skin[sphere as usize];
        for (&master, weight) in skin.masters.iter().zip(skin.weights) {
            if weight > 0.0 {
                let place = usize::from(self.places[usize::from(master)]);
                self.forces[place] += force * weight;
            }
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
        // Two zeros differ in their sign alone.
        if state
            .iter()
            .fold(0, |bits, x| bits | (x.to_bits() & !(1 << 63)))
            == 0
        {
            free.fill(0.0);
            self.term.fill(0.0);
            return true;
        }
        self.write_term(gradients);
        let mut most = 0.0;
        for ((free, linear), term) in free.iter_mut().zip(linear).zip(&self.term) {
            *free = self.kept * linear + term;
            most = fmax(most, free.abs());
        }
        // No number of ticks would bring it all the way back.
        if most < AT_REST {
            free.fill(0.0);
            self.term.fill(0.0);
        }
        false
    }

    fn centres(&self, shape: &[f64], ids: &[u32], out: &mut [Vec3]) {
        for (id, centre) in ids.iter().zip(out) {
            *centre = self.rest[*id as usize] + self.displacement(shape, *id);
        }
    }

    fn add_gram(&mut self, sites: &[Site], gram: &mut Gram<'_>) {
        self.touch(sites.iter().map(|site| site.sphere));
        for (i, a) in sites.iter().enumerate() {
            // How the touched masters move for a unit load along this row.
            let count = self.touched.len();
            self.moved[..count].fill(Vec3::zeros());
            let skin = &self.skin[a.sphere as usize];
            for (&master, weight) in skin.masters.iter().zip(skin.weights) {
                if weight == 0.0 {
                    continue;
                }
                let load = a.normal * weight;
                let first = 3 * usize::from(master) * self.len;
                let (x, rest) = self.compliance[first..first + 3 * self.len].split_at(self.len);
                let (y, z) = rest.split_at(self.len);
                for (moved, &other) in self.moved.iter_mut().zip(&self.touched) {
                    let at = 3 * usize::from(other);
                    let (x, y, z) = (&x[at..at + 3], &y[at..at + 3], &z[at..at + 3]);
                    *moved += Vec3::new(
                        x[0] * load.x + y[0] * load.y + z[0] * load.z,
                        x[1] * load.x + y[1] * load.y + z[1] * load.z,
                        x[2] * load.x + y[2] * load.y + z[2] * load.z,
                    );
                }
            }
            for (j, b) in sites[..=i].iter().enumerate() {
                let skin = &self.skin[b.sphere as usize];
                let mut moved = Vec3::zeros();
                for (&master, weight) in skin.masters.iter().zip(skin.weights) {
                    if weight > 0.0 {
                        moved += self.moved[usize::from(self.places[usize::from(master)])] * weight;
                    }
                }
                let entry = moved.dot(&b.normal);
                gram.add(i, j, entry);
                if i != j {
                    gram.add(j, i, entry);
                }
            }
        }
        self.forget();
    }

    fn apply(&mut self, sites: &[Site], lambda: &[f64], free: &[f64], shape: &mut [f64]) {
        shape.copy_from_slice(free);
        let loaded = || sites.iter().zip(lambda).filter(|(_, load)| **load != 0.0);
        self.touch(loaded().map(|(site, _)| site.sphere));
        for (site, load) in loaded() {
            self.add_force(site.sphere, &(site.normal * -load));
        }
        for (force, &master) in self.forces.iter().zip(&self.touched) {
            let first = 3 * usize::from(master) * self.len;
            let rows = &self.compliance[first..first + 3 * self.len];
            let (x, rest) = rows.split_at(self.len);
            let (y, z) = rest.split_at(self.len);
            for (((moved, x), y), z) in shape.iter_mut().zip(x).zip(y).zip(z) {
                *moved += x * force.x + y * force.y + z * force.z;
            }
        }
        self.forget();
    }

    fn motion(&self, from: &[f64], to: &[f64]) -> f64 {
        // Spheres move by means of their carriers' motion, so none moves farther than the farthest of those.
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
            *linear = now - term;
        }
        let Some(loads) = loads else { return };
        gradients.iter_mut().for_each(|g| *g *= self.kept);
        if loads.is_empty() {
            if shape.iter().all(|x| *x == 0.0) {
                state.fill(0.0);
            }
            return;
        }
        self.touch(loads.iter().map(|load| load.sphere));
        for load in loads {
            self.add_force(load.sphere, &load.force);
        }
        for (g, row) in gradients
            .iter_mut()
            .zip(self.gradients.chunks_exact(self.len))
        {
            for (force, &master) in self.forces.iter().zip(&self.touched) {
                let at = 3 * usize::from(master);
                let row = &row[at..at + 3];
                *g += row[0] * force.x + row[1] * force.y + row[2] * force.z;
            }
        }
        self.forget();
    }
}
