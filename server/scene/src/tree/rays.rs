//! Parallel rays through a union of balls, and the volume of the union along them.
//!
//! Rays are cut exactly; only the two directions across them are sampled.
//!
//! Users: the check of a built tree against its mesh (`tree::filled`), and the volumes of a report
//! (`error::columns`).

use sulcus_core::math::{fmax, fmin};
use sulcus_core::{Sphere, Vec3};

use crate::parallel;

/// A stretch of a ray.
pub(crate) type Span = (f64, f64);

/// Places of the rays.
pub(crate) struct Grid {
    /// The axes across the rays, then that of the rays.
    pub(crate) axes: [usize; 3],
    pub(crate) low: Vec3,
    /// Distance between rays, metres.
    pub(crate) step: f64,
    pub(crate) size: [usize; 2],
}

impl Grid {
    /// Returns about `count` rays along the longest side of a box; fewer if balls would be cut more than `most_cuts`
    /// times.
    pub(crate) fn new(
        low: Vec3,
        high: Vec3,
        spheres: &[Sphere],
        count: usize,
        most_cuts: f64,
    ) -> Self {
        let sides = high - low;
        let w = sides.imax();
        let axes = [(w + 1) % 3, (w + 2) % 3, w];
        // In a deep tree of large overlapping balls every ray would be cut thousands of times.
        let discs: f64 = spheres
            .iter()
            .map(|s| std::f64::consts::PI * s.radius * s.radius)
            .sum();
        let step = fmax(
            sides[axes[0]] * sides[axes[1]] / count as f64,
            discs / most_cuts,
        )
        .sqrt();
        let size = [0, 1].map(|k| (sides[axes[k]] / step).ceil().max(1.0) as usize);
        Self {
            axes,
            low,
            step,
            size,
        }
    }

    /// Returns the numbers of the balls that the rays of each row may meet.
    pub(crate) fn rows(&self, spheres: &[Sphere]) -> Vec<Vec<u32>> {
        let v = self.axes[1];
        bucketed(
            self.size[1],
            spheres.iter().map(|s| {
                let c = s.centre[v];
                (self.first(c - s.radius, 1), self.first(c + s.radius, 1))
            }),
        )
    }

    /// Returns the number of the first ray at or behind a coordinate, along the first or second axis across the rays.
    pub(crate) fn first(&self, x: f64, across: usize) -> usize {
        let low = self.low[self.axes[across]];
        ((x - low) / self.step - 0.5).ceil().max(0.0) as usize
    }

    /// Returns the coordinate of the rays of a row.
    pub(crate) fn row(&self, row: usize) -> f64 {
        self.low[self.axes[1]] + (row as f64 + 0.5) * self.step
    }

    /// Returns the stretches of the rays of the row at `y` inside balls, unsorted.
    pub(crate) fn through(&self, spheres: &[Sphere], balls: &[u32], y: f64) -> Vec<Vec<Span>> {
        let [u, v, w] = self.axes;
        let mut inside: Vec<Vec<Span>> = vec![Vec::new(); self.size[0]];
        for &k in balls {
            let s = &spheres[k as usize];
            let off = y - s.centre[v];
            let square = s.radius * s.radius - off * off;
            if square <= 0.0 {
                continue;
            }
            let (reach, middle) = (square.sqrt(), s.centre[u]);
            let (from, to) = (self.first(middle - reach, 0), self.first(middle + reach, 0));
            for (column, spans) in inside.iter_mut().enumerate().take(to).skip(from) {
                let x = self.low[u] + (column as f64 + 0.5) * self.step - middle;
                let half = fmax(square - x * x, 0.0).sqrt();
                spans.push((s.centre[w] - half, s.centre[w] + half));
            }
        }
        inside
    }
}

/// Returns the volume of a union of balls, cubic metres, along about `count` rays.
pub(crate) fn union_volume(spheres: &[Sphere], count: usize, most_cuts: f64) -> f64 {
    let (mut low, mut high) = (Vec3::repeat(f64::INFINITY), Vec3::repeat(f64::NEG_INFINITY));
    for s in spheres {
        low = low.zip_map(&s.centre.map(|x| x - s.radius), fmin);
        high = high.zip_map(&s.centre.map(|x| x + s.radius), fmax);
    }
    if spheres.is_empty() {
        return 0.0;
    }
    let grid = Grid::new(low, high, spheres, count, most_cuts);
    let balls = grid.rows(spheres);
    let rows = parallel::map(grid.size[1], |row| {
        let rays = grid.through(spheres, &balls[row], grid.row(row));
        rays.into_iter()
            .map(|spans| length(&merged(spans)))
            .sum::<f64>()
    });
    rows.iter().sum::<f64>() * grid.step * grid.step
}

/// Returns for each row the numbers of the items whose range of rows `[from, to)` contains it.
pub(crate) fn bucketed(rows: usize, ranges: impl Iterator<Item = (usize, usize)>) -> Vec<Vec<u32>> {
    let mut buckets = vec![Vec::new(); rows];
    for (k, (from, to)) in ranges.enumerate() {
        for bucket in buckets.iter_mut().take(to).skip(from) {
            bucket.push(k as u32);
        }
    }
    buckets
}

/// Joins stretches that touch or overlap.
pub(crate) fn merged(mut spans: Vec<Span>) -> Vec<Span> {
    spans.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut merged: Vec<Span> = Vec::with_capacity(spans.len());
    for span in spans {
        match merged.last_mut() {
            Some(last) if span.0 <= last.1 => last.1 = fmax(last.1, span.1),
            _ => merged.push(span),
        }
    }
    merged
}

pub(crate) fn length(spans: &[Span]) -> f64 {
    spans.iter().map(|span| span.1 - span.0).sum()
}
