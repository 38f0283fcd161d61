//! A union of balls for queries about points: a tree of boxes over the centres.

use sulcus_core::math::{fmax, fmin};
use sulcus_core::{Sphere, Vec3};

/// Balls in a leaf.
const LEAF: usize = 4;

/// Balls that are tested for covering a whole cell. Deep in a fine tree a point is in hundreds of balls.
const TRIES: usize = 16;

/// The union of the spheres of one level.
pub(super) struct Union {
    /// In the order of the leaves; no two are equal.
    spheres: Vec<Sphere>,
    parts: Vec<Part>,
}

/// Cover by other balls.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Cover {
    /// The point is not covered.
    Nothing,
    /// The point is covered, but none of the first balls covers its whole surroundings.
    Point,
    /// The whole surroundings are covered.
    Whole,
}

/// A box around centres.
struct Part {
    low: Vec3,
    high: Vec3,
    /// Largest radius.
    reach: f64,
    /// Right child, or first ball of a leaf; the left child follows its parent.
    next: u32,
    /// Balls of a leaf, 0 for an inner part.
    count: u32,
}

impl Union {
    pub(super) fn new(spheres: &[Sphere]) -> Self {
        let mut spheres = spheres.to_vec();
        // Of two equal balls each would hide the other, and neither would count as exposed.
        let key = |s: &Sphere| [s.centre.x, s.centre.y, s.centre.z, s.radius].map(f64::to_bits);
        spheres.sort_unstable_by_key(key);
        spheres.dedup_by_key(|s| key(s));
        let mut parts = Vec::new();
        if !spheres.is_empty() {
            build(&mut spheres, 0, &mut parts);
        }
        Self { spheres, parts }
    }

    pub(super) fn spheres(&self) -> &[Sphere] {
        &self.spheres
    }

    /// Returns `min_i(|p - c_i| - r_i)`, metres.
    ///
    /// Outside of the union it is the distance. Inside it is minus the depth in the ball in which `p` is deepest.
    pub(super) fn signed(&self, p: &Vec3) -> f64 {
        self.nearest(p).0
    }

    /// Returns the same, and the number of its ball.
    pub(super) fn nearest(&self, p: &Vec3) -> (f64, usize) {
        let (mut best, mut which) = (f64::INFINITY, 0);
        let mut stack = [(0_u32, f64::NEG_INFINITY); 64];
        let mut top = usize::from(!self.parts.is_empty());
        while top > 0 {
            top -= 1;
            let (index, bound) = stack[top];
            if bound >= best {
                continue;
            }
            let part = &self.parts[index as usize];
            if part.count > 0 {
                let first = part.next as usize;
                for k in first..first + part.count as usize {
                    let s = &self.spheres[k];
                    let off = (p - s.centre).norm() - s.radius;
                    if off < best {
                        (best, which) = (off, k);
                    }
                }
                continue;
            }
            let (left, right) = (index + 1, part.next);
            let (bl, br) = (
                self.parts[left as usize].bound(p),
                self.parts[right as usize].bound(p),
            );
            let (near, far) = if bl <= br {
                ((left, bl), (right, br))
            } else {
                ((right, br), (left, bl))
            };
            stack[top] = far;
            stack[top + 1] = near;
            top += 2;
        }
        (best, which)
    }

    /// Returns the cover of a point `p` on ball `own`, and of its surroundings, by other balls.
    ///
    /// `whole` returns whether a ball that covers `p` also covers the surroundings.
    pub(super) fn cover(&self, p: &Vec3, own: usize, whole: impl Fn(&Sphere) -> bool) -> Cover {
        let mut tried = 0;
        let mut stack = [0_u32; 64];
        let mut top = usize::from(!self.parts.is_empty());
        while top > 0 {
            top -= 1;
            let index = stack[top];
            let part = &self.parts[index as usize];
            if part.count == 0 {
                let (left, right) = (index + 1, part.next);
                let (bl, br) = (
                    self.parts[left as usize].bound(p),
                    self.parts[right as usize].bound(p),
                );
                // The ball with the greater possible depth is last on the stack, and is examined first.
                let (first, second) = if bl <= br {
                    ((left, bl), (right, br))
                } else {
                    ((right, br), (left, bl))
                };
                for (child, bound) in [second, first] {
                    if bound < 0.0 {
                        stack[top] = child;
                        top += 1;
                    }
                }
                continue;
            }
            let first = part.next as usize;
            for k in first..first + part.count as usize {
                let s = &self.spheres[k];
                if k != own && (p - s.centre).norm() < s.radius {
                    if whole(s) {
                        return Cover::Whole;
                    }
                    tried += 1;
                    if tried == TRIES {
                        return Cover::Point;
                    }
                }
            }
        }
        if tried > 0 {
            Cover::Point
        } else {
            Cover::Nothing
        }
    }

    /// Returns an upper bound of the depth of a disc's points in balls: the largest `r_i - |p - c_i|` over points `p`
    /// of the disc, at least `floor`.
    pub(super) fn deepest_on_disc(
        &self,
        centre: &Vec3,
        normal: &Vec3,
        radius: f64,
        floor: f64,
    ) -> f64 {
        let mut best = floor;
        let mut stack = [0_u32; 64];
        let mut top = usize::from(!self.parts.is_empty());
        while top > 0 {
            top -= 1;
            let index = stack[top];
            let part = &self.parts[index as usize];
            if radius - part.bound(centre) <= best {
                continue;
            }
            if part.count == 0 {
                stack[top] = part.next;
                stack[top + 1] = index + 1;
                top += 2;
                continue;
            }
            let first = part.next as usize;
            for s in &self.spheres[first..first + part.count as usize] {
                let off = s.centre - centre;
                let height = off.dot(normal);
                let across = fmax(off.norm_squared() - height * height, 0.0).sqrt();
                let beside = fmax(across - radius, 0.0);
                let distance = (height * height + beside * beside).sqrt();
                best = fmax(best, s.radius - distance);
            }
        }
        best
    }
}

impl Part {
    /// Returns a lower bound over the balls of the part.
    fn bound(&self, p: &Vec3) -> f64 {
        let mut sum = 0.0;
        for axis in 0..3 {
            let out = fmax(
                fmax(self.low[axis] - p[axis], p[axis] - self.high[axis]),
                0.0,
            );
            sum += out * out;
        }
        sum.sqrt() - self.reach
    }
}

fn build(spheres: &mut [Sphere], first: usize, parts: &mut Vec<Part>) {
    let (mut low, mut high) = (Vec3::repeat(f64::INFINITY), Vec3::repeat(f64::NEG_INFINITY));
    let mut reach = f64::NEG_INFINITY;
    for s in spheres.iter() {
        low = low.zip_map(&s.centre, fmin);
        high = high.zip_map(&s.centre, fmax);
        reach = fmax(reach, s.radius);
    }
    let here = parts.len();
    parts.push(Part {
        low,
        high,
        reach,
        next: first as u32,
        count: spheres.len() as u32,
    });
    if spheres.len() <= LEAF {
        return;
    }
    let axis = (high - low).imax();
    spheres.sort_by(|a, b| a.centre[axis].total_cmp(&b.centre[axis]));
    let middle = spheres.len() / 2;
    let (left, right) = spheres.split_at_mut(middle);
    build(left, first, parts);
    parts[here].next = parts.len() as u32;
    parts[here].count = 0;
    build(right, first + middle, parts);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    #[test]
    fn agrees_with_looking_at_every_ball() {
        let mut random = Random::new(11);
        let mut point = |size: f64| Vec3::from_fn(|_, _| random.between(-size, size));
        let balls: Vec<Sphere> = (0..300)
            .map(|k| Sphere {
                centre: point(1.0),
                radius: 0.05 + 0.0005 * f64::from(k),
            })
            .collect();
        let union = Union::new(&[&balls[..], &balls[..10]].concat());
        assert_eq!(union.spheres().len(), 300, "equal balls count once");
        let all = |p: &Vec3, without: Option<usize>| {
            let off = |(k, s): (usize, &Sphere)| {
                (Some(k) != without).then(|| (p - s.centre).norm() - s.radius)
            };
            let balls = union.spheres().iter().enumerate();
            balls.filter_map(off).fold(f64::INFINITY, fmin)
        };
        for k in 0..2000 {
            let p = point(1.5);
            assert_eq!(union.signed(&p), all(&p, None));
            let own = k % 300;
            let reach = 0.001 * k as f64;
            let holds = |s: &Sphere| (p - s.centre).norm() + reach < s.radius;
            let others = union.spheres().iter().enumerate();
            let expected = if others.filter(|&(k, _)| k != own).any(|(_, s)| holds(s)) {
                Cover::Whole
            } else if all(&p, Some(own)) < 0.0 {
                Cover::Point
            } else {
                Cover::Nothing
            };
            let found = union.cover(&p, own, holds);
            assert_eq!(found == Cover::Nothing, expected == Cover::Nothing);
            // A wrong answer may only be `Point`, never a larger cover.
            assert!(found == expected || found == Cover::Point, "{found:?}");
        }
        for k in 0..200 {
            let (p, normal) = (point(1.5), point(1.0).normalize());
            let radius = 0.002 * f64::from(k);
            let bound = union.deepest_on_disc(&p, &normal, radius, -9.0);
            // The bound is attained in the middle, and exceeded nowhere.
            assert!(bound >= -union.signed(&p) && bound <= radius - union.signed(&p) + 1e-12);
            for _ in 0..50 {
                let across = point(1.0);
                let across = (across - normal * across.dot(&normal)).normalize() * radius;
                assert!(-union.signed(&(p + across)) <= bound + 1e-12);
            }
        }
        assert_eq!(Union::new(&[]).signed(&Vec3::zeros()), f64::INFINITY);
    }
}
