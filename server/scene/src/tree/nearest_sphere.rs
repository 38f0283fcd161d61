//! Nearest surface of many spheres: a tree of boxes over their centres.

use sulcus_core::{Sphere, Vec3};

/// Spheres in a leaf box.
const LEAF: usize = 6;

/// Queries of `min_i (|p - c_i| - r_i)` and its sphere.
pub(crate) struct NearestSphere<'a> {
    spheres: &'a [Sphere],
    boxes: Vec<Box3>,
    order: Vec<u32>,
}

struct Box3 {
    low: Vec3,
    high: Vec3,
    /// Largest radius inside.
    radius: f64,
    /// Right child, or first place of a leaf; the left child follows its parent.
    next: u32,
    /// Spheres of a leaf, 0 for an inner box.
    count: u32,
}

impl Box3 {
    /// Returns a lower bound of the distance to the spheres inside.
    fn bound(&self, p: &Vec3) -> f64 {
        let mut squared = 0.0;
        for axis in 0..3 {
            let out = (self.low[axis] - p[axis])
                .max(p[axis] - self.high[axis])
                .max(0.0);
            squared += out * out;
        }
        squared.sqrt() - self.radius
    }
}

impl<'a> NearestSphere<'a> {
    pub fn new(spheres: &'a [Sphere]) -> Self {
        let mut order: Vec<u32> = (0..spheres.len() as u32).collect();
        let mut boxes = Vec::new();
        if !order.is_empty() {
            build(spheres, &mut order, 0, &mut boxes);
        }
        Self {
            spheres,
            boxes,
            order,
        }
    }

    /// Returns the distance to the nearest sphere's surface (negative inside) and the sphere's index. `guess` is a
    /// sphere that is probably near.
    pub fn nearest(&self, p: &Vec3, guess: Option<u32>) -> (f64, u32) {
        let apart = |k: u32| {
            let sphere = &self.spheres[k as usize];
            (p - sphere.centre).norm() - sphere.radius
        };
        let start = match guess {
            Some(k) => (apart(k), k),
            None => (f64::INFINITY, 0),
        };
        self.search(p, start, u32::MAX)
    }

    fn search(&self, p: &Vec3, start: (f64, u32), without: u32) -> (f64, u32) {
        let apart = |k: u32| {
            let sphere = &self.spheres[k as usize];
            (p - sphere.centre).norm() - sphere.radius
        };
        let mut best = start;
        let mut stack = [(0_u32, f64::NEG_INFINITY); 64];
        let mut top = usize::from(!self.boxes.is_empty());
        while top > 0 {
            top -= 1;
            let (index, bound) = stack[top];
            if bound > best.0 {
                continue;
            }
            let here = &self.boxes[index as usize];
            if here.count > 0 {
                for &k in &self.order[here.next as usize..(here.next + here.count) as usize] {
                    if k == without {
                        continue;
                    }
                    let found = apart(k);
                    // Ties go to the lower index, in any order of visits.
                    if found < best.0 || (found == best.0 && k < best.1) {
                        best = (found, k);
                    }
                }
                continue;
            }
            let (left, right) = (index + 1, here.next);
            let (l, r) = (
                self.boxes[left as usize].bound(p),
                self.boxes[right as usize].bound(p),
            );
            let (near, far) = if l <= r {
                ((left, l), (right, r))
            } else {
                ((right, r), (left, l))
            };
            stack[top] = far;
            stack[top + 1] = near;
            top += 2;
        }
        best
    }

    /// Returns the distance to the nearest surface of all spheres except `own`.
    pub fn nearest_but(&self, p: &Vec3, own: u32) -> f64 {
        self.search(p, (f64::INFINITY, 0), own).0
    }

    /// Returns the nearest of all spheres except `own`.
    pub fn nearest_other(&self, p: &Vec3, own: u32) -> u32 {
        self.search(p, (f64::INFINITY, 0), own).1
    }

    /// Returns whether `p` lies inside a sphere other than `own`.
    pub fn covered(&self, p: &Vec3, own: u32) -> bool {
        let mut stack = [0_u32; 64];
        let mut top = usize::from(!self.boxes.is_empty());
        while top > 0 {
            top -= 1;
            let here = &self.boxes[stack[top] as usize];
            if here.bound(p) >= 0.0 {
                continue;
            }
            if here.count == 0 {
                stack[top + 1] = stack[top] + 1;
                stack[top] = here.next;
                top += 2;
                continue;
            }
            for &k in &self.order[here.next as usize..(here.next + here.count) as usize] {
                let sphere = &self.spheres[k as usize];
                if k != own && (p - sphere.centre).norm_squared() < sphere.radius * sphere.radius {
                    return true;
                }
            }
        }
        false
    }
}

fn build(spheres: &[Sphere], order: &mut [u32], first: usize, boxes: &mut Vec<Box3>) {
    let (mut low, mut high) = (Vec3::repeat(f64::INFINITY), Vec3::repeat(f64::NEG_INFINITY));
    let mut radius = 0.0_f64;
    for &k in &*order {
        let sphere = &spheres[k as usize];
        low = low.zip_map(&sphere.centre, f64::min);
        high = high.zip_map(&sphere.centre, f64::max);
        radius = radius.max(sphere.radius);
    }
    let here = boxes.len();
    boxes.push(Box3 {
        low,
        high,
        radius,
        next: first as u32,
        count: order.len() as u32,
    });
    if order.len() <= LEAF {
        return;
    }
    let axis = (high - low).imax();
    let middle = order.len() / 2;
    order.select_nth_unstable_by(middle, |&a, &b| {
        spheres[a as usize].centre[axis]
            .total_cmp(&spheres[b as usize].centre[axis])
            .then(a.cmp(&b))
    });
    let (left, right) = order.split_at_mut(middle);
    build(spheres, left, first, boxes);
    boxes[here].next = boxes.len() as u32;
    boxes[here].count = 0;
    build(spheres, right, first + middle, boxes);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    #[test]
    fn agrees_with_looking_at_every_sphere() {
        let mut random = Random::new(5);
        let spheres: Vec<Sphere> = (0..500)
            .map(|_| Sphere {
                centre: Vec3::from_fn(|_, _| random.between(-1.0, 1.0)),
                radius: random.between(0.01, 0.3),
            })
            .collect();
        let index = NearestSphere::new(&spheres);
        for _ in 0..2000 {
            let p = Vec3::from_fn(|_, _| random.between(-1.5, 1.5));
            let mut best = (f64::INFINITY, 0);
            let mut inside = 0;
            for (k, s) in spheres.iter().enumerate() {
                let d = (p - s.centre).norm() - s.radius;
                inside += u32::from(d < 0.0);
                if d < best.0 {
                    best = (d, k as u32);
                }
            }
            assert_eq!(index.nearest(&p, None), best);
            assert_eq!(index.nearest(&p, Some(17)), best);
            assert_eq!(index.covered(&p, u32::MAX), inside > 0);
            assert_eq!(index.covered(&p, best.1), inside > 1);
        }
    }
}
