//! Directions of a tool, and the device pose that points the tool.

use sulcus_core::math::{Mat3, Quat};
use sulcus_core::{Pose, Tool, Vec3};

/// Tip and directions of a tool in its own frame.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ToolFrame {
    pub tip: Vec3,
    /// Unit columns: out of the tip, across it towards the handle, and their cross product.
    pub basis: Mat3,
}

impl ToolFrame {
    pub fn of(tool: &Tool) -> Self {
        let out = tool.tip_axis.normalize();
        let to_handle = -tool.tip;
        let across = to_handle - out * out.dot(&to_handle);
        // A straight tool has no side: any direction across the tip serves.
        let across = if across.norm() > 1e-6 {
            across.normalize()
        } else {
            // The unit vector of the smallest component is never parallel to the axis.
            let least = Vec3::ith(out.iamin(), 1.0);
            out.cross(&least).normalize()
        };
        Self {
            tip: tool.tip,
            basis: Mat3::from_columns(&[out, across, out.cross(&across)]),
        }
    }

    /// Basis in the world for a tool that points along the unit vector `pointing`, with its handle towards `side`.
    pub fn axes(&self, pointing: &Vec3, side: &Vec3) -> Mat3 {
        let across = (side - pointing * pointing.dot(side)).normalize();
        Mat3::from_columns(&[*pointing, across, pointing.cross(&across)])
    }

    /// Device pose (`world_from_tool`) with the tip at `tip`, pointing along `pointing`, with the handle towards
    /// `side`.
    pub fn at(&self, tip: &Vec3, pointing: &Vec3, side: &Vec3) -> Pose {
        let world = self.axes(pointing, side);
        let rotation = nalgebra_rotation(&(world * self.basis.transpose()));
        Pose::new(tip - rotation * self.tip, rotation)
    }
}

fn nalgebra_rotation(m: &Mat3) -> Quat {
    // Shepperd's method on the largest diagonal: no branch near a singularity.
    let trace = m[(0, 0)] + m[(1, 1)] + m[(2, 2)];
    let squares = [trace, m[(0, 0)], m[(1, 1)], m[(2, 2)]];
    let largest = (0..4).fold(
        0,
        |best, k| if squares[k] > squares[best] { k } else { best },
    );
    let (w, x, y, z) = match largest {
        0 => (
            1.0 + trace,
            m[(2, 1)] - m[(1, 2)],
            m[(0, 2)] - m[(2, 0)],
            m[(1, 0)] - m[(0, 1)],
        ),
        1 => (
            m[(2, 1)] - m[(1, 2)],
            1.0 + 2.0 * m[(0, 0)] - trace,
            m[(0, 1)] + m[(1, 0)],
            m[(0, 2)] + m[(2, 0)],
        ),
        2 => (
            m[(0, 2)] - m[(2, 0)],
            m[(0, 1)] + m[(1, 0)],
            1.0 + 2.0 * m[(1, 1)] - trace,
            m[(1, 2)] + m[(2, 1)],
        ),
        _ => (
            m[(1, 0)] - m[(0, 1)],
            m[(0, 2)] + m[(2, 0)],
            m[(1, 2)] + m[(2, 1)],
            1.0 + 2.0 * m[(2, 2)] - trace,
        ),
    };
    sulcus_core::math::normalised(w, x, y, z)
}

#[cfg(test)]
mod tests {
    use super::*;
    use sulcus_core::math::exp_rotation;

    #[test]
    fn any_rotation_matrix_becomes_its_quaternion() {
        for k in 0..200 {
            let w = Vec3::new(
                libm::sin(f64::from(k)),
                libm::cos(2.3 * f64::from(k)),
                libm::sin(0.7 * f64::from(k)),
            ) * 3.0;
            let q = exp_rotation(&w);
            let back = nalgebra_rotation(&q.to_rotation_matrix().into_inner());
            assert!(q.angle_to(&back) < 1e-7, "{w:?}");
        }
    }

    #[test]
    fn a_straight_tool_along_any_axis_gets_a_rotation() {
        for axis in [Vec3::x(), Vec3::y(), -Vec3::z()] {
            let tool = sulcus_core::Tool {
                name: "straight".into(),
                tree: sulcus_core::SphereTree::over_leaves(&[sulcus_core::Sphere {
                    centre: axis,
                    radius: 1.0,
                }])
                .expect("valid"),
                level: 0,
                working_point: axis,
                tip: axis,
                tip_axis: axis,
                stiffness_n_per_m: 500.0,
                stiffness_nm_per_rad: 0.5,
                park: Pose::identity(),
                bands: Vec::new(),
                mesh: sulcus_core::DisplayMesh::default(),
            };
            let pose = ToolFrame::of(&tool).at(&Vec3::zeros(), &-Vec3::z(), &Vec3::x());
            assert!(
                (pose.orientation * axis + Vec3::z()).norm() < 1e-12,
                "{axis:?}: {pose:?}"
            );
            assert!(
                pose.transform(&tool.tip).norm() < 1e-12,
                "{axis:?}: {pose:?}"
            );
        }
    }
}
