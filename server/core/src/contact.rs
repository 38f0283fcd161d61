//! Contact prediction (the paper's CCP, section 3.2): tree against tree, with the graphic tool's
//! spheres grown by `d`.
//!
//! Every pair of contact spheres closer than `d` becomes a [`Contact`]; as long as no sphere moves
//! more than `d` before the next pass, no pair outside the list can touch. The tick's trust
//! region keeps that promise, which makes this a continuous collision detection.

use crate::math::{Mat3, Pose, Vec3};
use crate::tree::Node;

/// A pair of contact spheres close enough to touch before the next pass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// Tool slot.
    pub tool: u8,
    /// Index of the object.
    pub object: u16,
    /// Node of the object's tree.
    pub object_sphere: u32,
    /// Node of the tool's tree.
    pub tool_sphere: u32,
    /// Unit normal from the object's sphere to the tool's, world axes.
    pub normal: Vec3,
    /// True gap between the two spheres at the pose of the pass, metres; negative is penetration.
    pub gap: f64,
    /// Centre of the tool's sphere minus the tool's working point, world axes, metres.
    pub arm: Vec3,
}

impl Contact {
    /// Order of the rows: by object, object sphere, tool, tool sphere.
    #[inline]
    pub fn key(&self) -> (u16, u32, u8, u32) {
        (self.object, self.object_sphere, self.tool, self.tool_sphere)
    }
}

/// The contacts of one pass, at most `limit` of them: a number of its own, not a `Vec`'s capacity,
/// which an allocator may round up.
#[derive(Debug)]
pub struct ContactList {
    contacts: Vec<Contact>,
    limit: usize,
    overflow: Overflow,
}

/// What happens to a contact that finds the list full.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Overflow {
    /// The query ends: the caller asks again with a smaller distance.
    Stop,
    /// The contact with the largest gap makes room, if it is larger.
    KeepSmallestGaps,
}

impl ContactList {
    /// An empty list with room for `most` contacts in any query.
    pub fn with_capacity(most: usize) -> Self {
        Self {
            contacts: Vec::with_capacity(most),
            limit: most,
            overflow: Overflow::Stop,
        }
    }

    /// Empties the list for a query of at most `limit` contacts.
    pub fn begin(&mut self, limit: usize, overflow: Overflow) {
        self.contacts.clear();
        (self.limit, self.overflow) = (limit, overflow);
    }

    /// What was found, in no particular order until [`ContactList::sort`].
    #[inline]
    pub fn as_slice(&self) -> &[Contact] {
        &self.contacts
    }

    /// Sorts by [`Contact::key`].
    pub fn sort(&mut self) {
        self.contacts.sort_unstable_by_key(Contact::key);
    }

    fn push(&mut self, contact: Contact) -> Result<(), ContactsFull> {
        if self.contacts.len() < self.limit {
            self.contacts.push(contact);
            if self.overflow == Overflow::KeepSmallestGaps && self.contacts.len() == self.limit {
                for at in (0..self.limit / 2).rev() {
                    self.sift_down(at);
                }
            }
            return Ok(());
        }
        match self.overflow {
            Overflow::Stop => Err(ContactsFull),
            Overflow::KeepSmallestGaps => {
                if self
                    .contacts
                    .first()
                    .is_some_and(|worst| outranks(worst, &contact))
                {
                    self.contacts[0] = contact;
                    self.sift_down(0);
                }
                Ok(())
            }
        }
    }

    /// Restores the heap (largest gap first) below `at`.
    fn sift_down(&mut self, mut at: usize) {
        loop {
            let mut largest = at;
            for child in [2 * at + 1, 2 * at + 2] {
                if child < self.contacts.len()
                    && outranks(&self.contacts[child], &self.contacts[largest])
                {
                    largest = child;
                }
            }
            if largest == at {
                return;
            }
            self.contacts.swap(at, largest);
            at = largest;
        }
    }
}

/// Whether `a` goes before `b` does when room is short: larger gap, then larger key, so that the
/// choice does not depend on the order of the query.
fn outranks(a: &Contact, b: &Contact) -> bool {
    a.gap > b.gap || (a.gap == b.gap && a.key() > b.key())
}

/// A tree at a pose: what one side of a query needs.
#[derive(Clone, Copy, Debug)]
pub struct PosedTool<'a> {
    /// Nodes in the tool's frame.
    pub nodes: &'a [Node],
    /// `world_from_tool`.
    pub pose: &'a Pose,
    /// Level in contact.
    pub level: u8,
    /// Working point in the tool's frame.
    pub working_point: &'a Vec3,
    /// Tool slot.
    pub slot: u8,
}

/// Traversal scratch; nothing in it outlives a query of one tool.
#[derive(Debug)]
pub struct Predictor {
    /// World centres of tool nodes, filled as they are needed.
    centres: Vec<Vec3>,
    /// Pass in which the centre was filled.
    stamps: Vec<u32>,
    pass: u32,
    stack: Vec<(u32, u32)>,
}

/// The deepest stack: a pop pushes at most eight pairs, seven remain per level of either tree.
const STACK: usize = 7 * 2 * (crate::tree::MAX_LEVEL as usize + 1) + 8;

/// The list of contacts is full: what it holds is not all.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ContactsFull;

impl Predictor {
    /// Scratch for tools of at most `tool_nodes` nodes.
    pub fn new(tool_nodes: usize) -> Self {
        Self {
            centres: vec![Vec3::zeros(); tool_nodes],
            stamps: vec![0; tool_nodes],
            pass: 0,
            stack: Vec::with_capacity(STACK),
        }
    }

    /// Begins the queries of one tool at one pose.
    pub fn begin(&mut self) {
        self.pass = self.pass.wrapping_add(1);
        if self.pass == 0 {
            self.stamps.fill(0);
            self.pass = 1;
        }
    }

    /// Appends every pair of contact spheres of `tool` and `object` (nodes in world axes)
    /// with a gap under `d` to `out`.
    ///
    /// # Errors
    /// When `out` is full and [`Overflow::Stop`] holds; it then has an arbitrary part.
    pub fn predict(
        &mut self,
        tool: &PosedTool<'_>,
        object: (u16, &[Node], u8),
        d: f64,
        out: &mut ContactList,
    ) -> Result<(), ContactsFull> {
        let (object_index, objects, object_level) = object;
        let rotation = tool.pose.orientation.to_rotation_matrix().into_inner();
        let working_point = centre(&rotation, tool.pose, tool.working_point);
        self.stack.clear();
        self.stack.push((0, 0));
        while let Some((t, o)) = self.stack.pop() {
            let (tool_node, object_node) = (&tool.nodes[t as usize], &objects[o as usize]);
            let at = self.centre_of(t, tool_node, &rotation, tool.pose);
            let between = at - object_node.centre;
            let (tool_is_shape, object_is_shape) = (
                tool_node.is_shape_at(tool.level),
                object_node.is_shape_at(object_level),
            );
            if tool_is_shape && object_is_shape {
                let reach = tool_node.contact_radius + object_node.contact_radius;
                let squared = between.dot(&between);
                if squared >= (reach + d) * (reach + d) {
                    continue;
                }
                let distance = squared.sqrt();
                // Concentric spheres have no normal: any direction is as good, take up.
                let normal = if distance > 1e-12 {
                    between / distance
                } else {
                    Vec3::z()
                };
                out.push(Contact {
                    tool: tool.slot,
                    object: object_index,
                    object_sphere: o,
                    tool_sphere: t,
                    normal,
                    gap: distance - reach,
                    arm: at - working_point,
                })?;
                continue;
            }
            // Open the larger of the two that can be opened.
            let open_tool = !tool_is_shape
                && (object_is_shape || tool_node.bound_radius > object_node.bound_radius);
            if open_tool {
                let radius = reach_of(object_node, object_is_shape) + d;
                for child in
                    tool_node.first_child..tool_node.first_child + u32::from(tool_node.children)
                {
                    let node = &tool.nodes[child as usize];
                    let between =
                        self.centre_of(child, node, &rotation, tool.pose) - object_node.centre;
                    let reach = reach_of(node, node.is_shape_at(tool.level)) + radius;
                    if between.dot(&between) < reach * reach {
                        self.stack.push((child, o));
                    }
                }
            } else {
                let radius = reach_of(tool_node, tool_is_shape) + d;
                for child in object_node.first_child
                    ..object_node.first_child + u32::from(object_node.children)
                {
                    let node = &objects[child as usize];
                    let between = at - node.centre;
                    let reach = reach_of(node, node.is_shape_at(object_level)) + radius;
                    if between.dot(&between) < reach * reach {
                        self.stack.push((t, child));
                    }
                }
            }
        }
        Ok(())
    }

    #[inline]
    fn centre_of(&mut self, index: u32, node: &Node, rotation: &Mat3, pose: &Pose) -> Vec3 {
        let at = index as usize;
        if self.stamps[at] != self.pass {
            self.stamps[at] = self.pass;
            self.centres[at] = centre(rotation, pose, &node.centre);
        }
        self.centres[at]
    }
}

/// What culling must allow for: a shape node only itself, an inner node all below it.
#[inline]
fn reach_of(node: &Node, is_shape: bool) -> f64 {
    if is_shape {
        node.contact_radius
    } else {
        node.bound_radius
    }
}

/// World position of a point of the tool.
#[inline]
pub(crate) fn centre(rotation: &Mat3, pose: &Pose, point: &Vec3) -> Vec3 {
    pose.position + rotation * point
}
