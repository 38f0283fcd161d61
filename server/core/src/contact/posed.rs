//! Tool at a pose: its spheres in world axes, computed on demand, and their levers.

use super::{Contact, centre};
use crate::math::{Mat3, Pose, Vec3, norm};
use crate::tree::{Node, Sphere};

/// Sphere tree of a tool at a pose.
#[derive(Clone, Copy, Debug)]
pub struct PosedTool<'a> {
    /// Nodes of the tree in the tool's frame, metres.
    pub nodes: &'a [Node],
    /// Pose of the tool, `world_from_tool`.
    pub pose: &'a Pose,
    /// Level of the tree in contact.
    pub level: u8,
    /// Working point in the tool's frame, metres.
    pub working_point: &'a Vec3,
    /// Tool slot.
    pub slot: u8,
}

/// Spheres of a tool in world axes, computed on demand.
#[derive(Debug)]
pub(super) struct Posed {
    /// Rotation matrix of the pose, `world_from_tool`.
    pub rotation: Mat3,
    /// Origin of the tool's frame, world axes, metres.
    pub position: Vec3,
    /// Working point, world axes, metres.
    pub working_point: Vec3,
    /// Centre of each node, world axes, metres; valid where the stamp is `pass`.
    centres: Vec<Vec3>,
    /// Number of the pass in which each centre was computed; 0 for none.
    stamps: Vec<u32>,
    /// Number of the present pass, one for each [`Posed::begin`]; 0 before the first.
    pass: u32,
}

impl Posed {
    /// Allocates space for a tool with `nodes` nodes.
    pub fn with_capacity(nodes: usize) -> Self {
        Self {
            rotation: Mat3::identity(),
            position: Vec3::zeros(),
            working_point: Vec3::zeros(),
            centres: vec![Vec3::zeros(); nodes],
            stamps: vec![0; nodes],
            pass: 0,
        }
    }

    /// Starts the queries of one tool at one pose.
    pub fn begin(&mut self, tool: &PosedTool<'_>) {
        self.rotation = tool.pose.orientation.to_rotation_matrix().into_inner();
        self.position = tool.pose.position;
        self.working_point = centre(&self.rotation, tool.pose, tool.working_point);
        self.pass = self.pass.wrapping_add(1);
        if self.pass == 0 {
            self.stamps.fill(0);
            self.pass = 1;
        }
    }

    /// Returns the centre of a node of the tool at the pose of the last [`Posed::begin`], world axes, metres.
    ///
    /// Always inlined: a result returned through memory piece by piece stalls a read of the whole.
    #[inline(always)]
    pub fn centre_of(&mut self, tool: &PosedTool<'_>, node: u32) -> Vec3 {
        let at = node as usize;
        if self.stamps[at] == self.pass {
            return self.centres[at];
        }
        let centre = centre(&self.rotation, tool.pose, &tool.nodes[at].centre);
        self.stamps[at] = self.pass;
        self.centres[at] = centre;
        centre
    }

    /// Returns the contact of two spheres if their gap is under `d` (metres). `object` is the object's index, and `o`
    /// the node of its sphere `sphere` in world axes. `t` is the tool's node, with the centre `at` in world axes. All
    /// methods of contact prediction decide here.
    #[inline(always)]
    pub fn contact(
        &self,
        tool: &PosedTool<'_>,
        (object, o, sphere): (u16, u32, &Sphere),
        (t, at): (u32, &Vec3),
        d: f64,
    ) -> Option<Contact> {
        let between = at - sphere.centre;
        let reach = tool.nodes[t as usize].contact_radius + sphere.radius;
        let squared = between.dot(&between);
        if squared >= (reach + d) * (reach + d) {
            return None;
        }
        let distance = squared.sqrt();
        // Concentric spheres have no normal; z is an arbitrary choice.
        let normal = if distance > 1e-12 {
            between / distance
        } else {
            Vec3::z()
        };
        Some(Contact {
            tool: tool.slot,
            object,
            object_sphere: o,
            tool_sphere: t,
            normal,
            gap: distance - reach,
            arm: at - self.working_point,
        })
    }
}

/// Distances of a tool's node from the working point, metres. Scalar levers, without direction.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lever {
    /// Distance of the node's own centre, metres.
    pub own: f64,
    /// Upper bound of the distances of all centres below the node, metres.
    pub below: f64,
}

impl Lever {
    /// Returns `own` for a node that is the shape, `below` for a node that stands for its descendants, metres.
    #[inline]
    pub fn of(&self, is_shape: bool) -> f64 {
        if is_shape { self.own } else { self.below }
    }
}

/// Returns the levers of all nodes of a tool, in the order of the nodes.
pub(super) fn levers(tool: &crate::scene::tool::Tool) -> Vec<Lever> {
    let lever = |node: &Node| {
        let own = norm(&(node.centre - tool.working_point));
        Lever {
            own,
            below: own + node.bound_radius,
        }
    };
    tool.tree.nodes().iter().map(lever).collect()
}

/// Returns the culling radius about the node's centre, metres: the contact radius of a shape node, the bound radius of
/// an inner node.
#[inline]
pub(crate) fn reach_of(node: &Node, is_shape: bool) -> f64 {
    if is_shape {
        node.contact_radius
    } else {
        node.bound_radius
    }
}
