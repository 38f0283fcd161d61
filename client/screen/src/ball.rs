//! Balls around parts: a pass leaves out the parts that it cannot show. The reflection in a glass shows few of them.

use nalgebra::{Matrix4, Vector4};

use crate::camera::{Matrix, Vector};
use crate::stage::Moving;

/// Share by which a ball is larger than its part: places are rounded to single precision.
const MARGIN: f64 = 1.001;

/// Ball around the vertices of a part, in the axes of its vertices.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Ball {
    /// Middle, mm.
    centre: Vector,
    /// Radius, mm.
    radius: f64,
}

impl Ball {
    /// Ball about the middle of the box of vertices; a ball without extent for none.
    pub fn around<'a>(moving: impl IntoIterator<Item = &'a Moving, IntoIter: Clone>) -> Self {
        let moving = moving.into_iter();
        let places = || moving.clone().map(|v| Vector::from(v.at.map(f64::from)));
        let first = places().next().unwrap_or_default();
        let (low, high) = places().fold((first, first), |(low, high), at| {
            (low.inf(&at), high.sup(&at))
        });
        let centre = (low + high) * 0.5;
        let radius = places().map(|at| (at - centre).norm()).fold(0.0, f64::max);
        Self {
            centre,
            radius: radius * MARGIN,
        }
    }

    /// Distance of the nearest point from the eye along the view, mm. `world` places the part, `clip` is clip space from
    /// world.
    pub fn depth(&self, world: &Matrix4<f32>, clip: &Matrix) -> f64 {
        let centre = (world.cast::<f64>() * self.centre.push(1.0)).xyz();
        clip.row(3).transpose().dot(&centre.push(1.0)) - self.radius
    }

    /// Whether any point of the ball may lie in a picture. `world` places the part, `clip` is clip space from world.
    pub fn is_seen(&self, world: &Matrix4<f32>, clip: &Matrix) -> bool {
        let centre = (world.cast::<f64>() * self.centre.push(1.0))
            .xyz()
            .push(1.0);
        let row = |k: usize| Vector4::from(clip.row(k).transpose());
        let (x, y, z, w) = (row(0), row(1), row(2), row(3));
        // Points in the picture have -w <= x <= w, -w <= y <= w and 0 <= z <= w.
        let sides = [w + x, w - x, w + y, w - y, z, w - z];
        let is_outside = |side: &Vector4<f64>| side.dot(&centre) < -self.radius * side.xyz().norm();
        !sides.iter().any(is_outside)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::Camera;

    fn ball(at: [f32; 3], radius: f32) -> Ball {
        let ends = [-radius, radius].map(|off| Moving {
            at: [at[0] + off, at[1], at[2]],
            ..Moving::default()
        });
        Ball::around(&ends)
    }

    #[test]
    fn a_ball_is_left_out_when_no_point_of_it_lies_in_the_picture() {
        // The picture is 84 mm high and 126 mm wide at the target.
        let (eye, target) = (Vector::new(420.0, 0.0, 0.0), Vector::zeros());
        let height = 2.0 * (42.0f64 / 420.0).atan().to_degrees();
        let clip = Camera::looking(eye, target, Vector::z(), height, 1.5);
        let clip = clip.pass().matrix();
        let is_seen = |at, radius| ball(at, radius).is_seen(&Matrix4::identity(), &clip);
        assert!(is_seen([0.0; 3], 1.0));
        for (side, border) in [([0.0, 1.0, 0.0], 63.0), ([0.0, 0.0, 1.0], 42.0)] {
            for sign in [-1.0, 1.0] {
                let at = |far: f32| side.map(|x: f32| x * sign * (border + far));
                // The sides of the picture lean by less than 10 degrees.
                assert!(is_seen(at(4.8), 5.0) && !is_seen(at(5.3), 5.0), "{side:?}");
            }
        }
        assert!(!is_seen([430.0, 0.0, 0.0], 5.0), "behind the eye");
        assert!(!is_seen([-1200.0, 0.0, 0.0], 5.0), "beyond the far plane");
        let moved = Matrix4::new_translation(&nalgebra::Vector3::new(0.0, 200.0, 0.0));
        assert!(!ball([0.0; 3], 5.0).is_seen(&moved, &clip));
        assert!(ball([0.0, -200.0, 0.0], 5.0).is_seen(&moved, &clip));
    }

    #[test]
    fn a_ball_holds_its_vertices_and_follows_none() {
        let all: Vec<Moving> = (0..50)
            .map(|k| Moving {
                at: [(k as f32).sin() * 9.0, (k as f32).cos() * 4.0, k as f32],
                ..Moving::default()
            })
            .collect();
        let ball = Ball::around(&all);
        let away = |v: &Moving| (Vector::from(v.at.map(f64::from)) - ball.centre).norm();
        let farthest = all.iter().map(away).fold(0.0, f64::max);
        assert!(farthest < ball.radius && ball.radius < 1.01 * farthest);
        assert_eq!(Ball::around(&[] as &[Moving]).radius, 0.0);
    }
}
