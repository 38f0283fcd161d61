//! The making of a list of neighbours of a tissue whose spheres are larger than the tool's: which spheres of the tool
//! come within reach of each of the tissue's.
//!
//! The balls about families of large overlapping spheres that have moved say next to nothing: on a tongue every sphere
//! of a mirror was tested against a third of all families, and a list took 110 us. The tool is rigid, and its
//! families keep their tight bounds, so here each of the tissue's spheres goes down the tool's tree.

use super::neighbours::ROUNDING;
use super::packs::{Felt, Packs};
use super::posed::{Lever, Posed, PosedTool, levers};
use crate::math::{Vec3, fmax};
use crate::scene::tool::Tool;
use crate::tree::{Node, Sphere};

/// Turn of the tool that a list of soft spheres allows for: largest Frobenius norm of a difference of rotation matrices.
pub(super) const TURN: f64 = 1.7e-2;

/// A tool's families, in its own frame, each sphere grown by how far a turn of [`TURN`] can move it.
#[derive(Debug)]
pub(super) struct CoarseSearch {
    packs: Packs,
    /// Largest lever of a sphere of the tool, metres.
    longest: f64,
    /// Families of the tool that come within reach of the present sphere, ascending.
    open: Vec<u32>,
}

/// Most spheres of an object, for each of the tool's, to be searched for one by one.
const MOST: f64 = 2.0;

/// Number and mean radius (metres) of the spheres that are the shape at `level`.
fn shape(nodes: &[Node], level: u8) -> (f64, f64) {
    let shape = nodes.iter().filter(|node| node.is_shape_at(level));
    let (count, sum) = shape.fold((0.0, 0.0), |(count, sum), node| {
        (count + 1.0, sum + node.contact_radius)
    });
    (count, sum / fmax(count, 1.0))
}

impl CoarseSearch {
    /// For `tool` on an object, where that one's spheres are the larger ones, and not many more.
    pub fn new(tool: &Tool, (nodes, level): (&[Node], u8)) -> Option<Self> {
        let own = tool.tree.nodes();
        let ((count, radius), (own_count, own_radius)) =
            (shape(nodes, level), shape(own, tool.level));
        if own_radius > radius || count > MOST * own_count {
            return None;
        }
        let levers = levers(tool);
        let grown: Vec<Node> = own
            .iter()
            .zip(&levers)
            .map(|(node, lever)| Node {
                contact_radius: node.contact_radius + TURN * lever.own,
                bound_radius: node.bound_radius + TURN * lever.below,
                ..*node
            })
            .collect();
        let packs = Packs::new(&grown);
        Some(Self {
            longest: levers
                .iter()
                .fold(0.0, |most, lever: &Lever| fmax(most, lever.own)),
            open: Vec::with_capacity(packs.families.len()),
            packs,
        })
    }

    /// Calls `found` with each sphere of the tool, ascending, that is closer to `sphere` (world axes) than `reach` and the turn
    /// `turn` of the longest lever, beside the turn that all are grown by; until it says that there is no more room.
    /// Returns how many spheres were tested, none where the room was not enough.
    pub fn run(
        &mut self,
        (tool, posed): (&PosedTool<'_>, &Posed),
        sphere: &Sphere,
        (reach, turn): (f64, f64),
        mut found: impl FnMut(u32) -> bool,
    ) -> Option<u64> {
        let Self {
            packs,
            longest,
            open,
        } = self;
        let from: Vec3 = posed.rotation.tr_mul(&(sphere.centre - posed.position));
        let reach = fmax(0.0, reach) + turn * *longest + ROUNDING;
        let felt = Felt::new(&(from - packs.origin), sphere.radius + reach);
        let mut tested = 0;
        open.clear();
        open.push(0);
        let mut next = 0;
        // The tree's order is level by level, and so is that of a queue.
        while let Some(&p) = open.get(next) {
            next += 1;
            let family = &packs.families[p as usize];
            let (shapes, parents) = family.shapes_and_parents(tool.level);
            if shapes != 0 {
                tested += 8;
                let mut near = shapes & packs.shapes[p as usize].within(felt);
                while near != 0 {
                    if !found(family.first + near.trailing_zeros()) {
                        return None;
                    }
                    near &= near - 1;
                }
            }
            if parents != 0 {
                tested += 8;
                let mut near = parents & packs.bounds[p as usize].within(felt);
                while near != 0 {
                    open.push(family.first_pack + near.trailing_zeros());
                    near &= near - 1;
                }
            }
        }
        Some(tested)
    }
}
