//! Rays against all triangles of a scene at an instant, without a grid and without the renderer's own geometry.

use nalgebra::{Point2, UnitQuaternion};
use sulcus_proto::display::{DisplayMesh, DisplayScene, STEP_M};
use sulcus_screen::moment::Moment;
use sulcus_screen::stage::Owner;

use crate::common::Eye;
use crate::shapes::V;

/// Part that a pixel shows.
pub type Hit = Option<Owner>;

/// Triangles in world axes, mm.
pub struct Caster {
    triangles: Vec<(Owner, [V; 3])>,
    /// Slot, middle, normal and radius of each held glass.
    glasses: Vec<(u8, V, V, f64)>,
}

/// End of a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct End {
    pub hit: Hit,
    /// Place of the end, mm; infinite without a hit.
    pub at: V,
    /// Whether the ray was reflected.
    pub is_reflected: bool,
}

impl Caster {
    pub fn new(scene: &DisplayScene, moment: &Moment) -> Self {
        let mut caster = Self {
            triangles: Vec::new(),
            glasses: Vec::new(),
        };
        for (k, object) in (0u16..).zip(&scene.objects) {
            let mut places: Vec<V> = object.mesh.vertices().map(mm).collect();
            let moved = moment.moved.iter().find(|moved| moved.object == k);
            if let (Some(moved), Some(skin)) = (moved, &object.skin) {
                for (v, place) in places.iter_mut().enumerate() {
                    for (handle, weight) in skin.carriers(v) {
                        let found = moved.handles.iter().find(|one| one.handle == handle);
                        let by = found.map_or([0; 3], |one| one.by).map(f64::from);
                        *place += V::from(by) * (f64::from(STEP_M) * 1e3 * f64::from(weight));
                    }
                }
            }
            caster.push(Owner::Object(k), &object.mesh, &places);
        }
        for ((slot, tool), at) in (0u8..).zip(&scene.tools).zip(&moment.tools) {
            if !at.held {
                continue;
            }
            let turn: UnitQuaternion<f64> = at.orientation.cast();
            let world = |v: V| turn * v + at.position.cast::<f64>();
            let places: Vec<V> = tool.mesh.vertices().map(|at| world(mm(at))).collect();
            caster.push(Owner::Tool(slot), &tool.mesh, &places);
            if let Some(glass) = tool.glass {
                let normal = turn * V::from(glass.normal.map(f64::from));
                let radius = f64::from(glass.radius) * 1e3;
                caster
                    .glasses
                    .push((slot, world(mm(glass.centre)), normal, radius));
            }
        }
        caster
    }

    fn push(&mut self, owner: Owner, mesh: &DisplayMesh, places: &[V]) {
        let corners = |t: [u32; 3]| (owner, t.map(|v| places[v as usize]));
        self.triangles.extend(mesh.triangles().map(corners));
    }

    /// End of the ray through a place of the picture, in pixels.
    pub fn end(&self, eye: &Eye, at: Point2<f64>) -> End {
        let (from, along) = (eye.eye, eye.through(at));
        let mesh = self.nearest(&from, &along, None);
        // The face of the mirror's mesh lies under the glass.
        let before = mesh.map_or(f64::INFINITY, |(_, far)| far + 1e-2);
        let glass = self
            .glasses
            .iter()
            .find_map(|(slot, centre, normal, radius)| {
                let slope = along.dot(normal);
                let far = (centre - from).dot(normal) / slope;
                let on = from + along * far;
                let is_hit = slope < 0.0 && far < before && (on - centre).norm() <= *radius;
                is_hit.then_some((*slot, on, along - normal * (2.0 * slope)))
            });
        let (from, along, nearest, is_reflected) = match glass {
            Some((slot, on, turned)) => (on, turned, self.nearest(&on, &turned, Some(slot)), true),
            None => (from, along, mesh, false),
        };
        let far = nearest.map_or(f64::INFINITY, |(_, far)| far);
        End {
            hit: nearest.map(|(hit, _)| hit),
            at: from + along * far,
            is_reflected,
        }
    }

    /// Nearest triangle along a ray, and its distance, without a tool.
    fn nearest(&self, from: &V, along: &V, without: Option<u8>) -> Option<(Owner, f64)> {
        let skipped = without.map(Owner::Tool);
        let mut best: Option<(Owner, f64)> = None;
        for (owner, triangle) in &self.triangles {
            if Some(*owner) == skipped {
                continue;
            }
            let far = crossed(from, along, triangle);
            if let Some(far) = far.filter(|far| best.is_none_or(|(_, nearest)| *far < nearest)) {
                best = Some((*owner, far));
            }
        }
        best
    }

    /// Whether any ray within a pixel of a place ends at a part.
    pub fn is_near(&self, eye: &Eye, at: Point2<f64>, hit: Hit) -> bool {
        let steps = [-1.0, -0.5, 0.0, 0.5, 1.0];
        let around = steps
            .iter()
            .flat_map(|x| steps.map(|y| nalgebra::Vector2::new(*x, y)));
        around
            .into_iter()
            .any(|by| self.end(eye, at + by).hit == hit)
    }
}

/// Distance along a ray to a triangle (Moeller and Trumbore, 1997).
fn crossed(from: &V, along: &V, [a, b, c]: &[V; 3]) -> Option<f64> {
    let (u_edge, v_edge) = (b - a, c - a);
    let p = along.cross(&v_edge);
    let size = u_edge.dot(&p);
    if size.abs() < 1e-14 {
        return None;
    }
    let start = from - a;
    let u = start.dot(&p) / size;
    let q = start.cross(&u_edge);
    let v = along.dot(&q) / size;
    let far = v_edge.dot(&q) / size;
    (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && far > 1e-6).then_some(far)
}

fn mm(at: [f32; 3]) -> V {
    V::from(at.map(|x| f64::from(x) * 1e3))
}
