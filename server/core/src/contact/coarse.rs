//! Neighbour search for a tissue with spheres larger than the tool's: each sphere of the tissue descends the tool's
//! tree.
//!
//! Bounds of sibling families are loose where large overlapping spheres have moved. On a tongue, every sphere of a
//! mirror was tested against a third of all families, and a list took 110 us. The tool is rigid and its families keep
//! tight bounds, so the search uses the tool's tree.

use super::neighbours::ROUNDING;
use super::packs::{Felt, Packs};
use super::posed::{Lever, Posed, PosedTool, levers};
use crate::math::{Vec3, fmax};
use crate::scene::tool::Tool;
use crate::tree::{Node, Sphere};

/// Turn of the tool for which a list of a tissue's spheres is valid: largest Frobenius norm of the difference of two
/// rotation matrices. The norm is about 1.4 times the angle in radians.
pub(super) const TURN: f64 = 1.7e-2;

/// Families of a tool in the tool's frame, each sphere grown by its motion under a turn of [`TURN`].
#[derive(Debug)]
pub(super) struct CoarseSearch {
    /// Families in the tool's frame, metres.
    packs: Packs,
    /// Largest lever of a sphere of the tool, metres.
    longest: f64,
    /// Queue of the tool's families within reach of the current sphere, ascending.
    open: Vec<u32>,
}

/// Largest ratio of the number of the object's spheres to that of the tool's for a search sphere by sphere.
const MOST: f64 = 2.0;

/// Returns the number and the mean radius (metres) of the spheres that form the shape at `level`.
fn shape(nodes: &[Node], level: u8) -> (f64, f64) {
    let shape = nodes.iter().filter(|node| node.is_shape_at(level));
    let (count, sum) = shape.fold((0.0, 0.0), |(count, sum), node| {
        (count + 1.0, sum + node.contact_radius)
    });
    (count, sum / fmax(count, 1.0))
}

impl CoarseSearch {
    /// Creates the search for `tool` on an object with `nodes` in contact at `level`. Returns `None` if the object's
    /// spheres are smaller on average, or more than twice as numerous as the tool's.
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

    /// Calls `found` with the node of each sphere of the tool, ascending, within a gap of `reach` (metres) of `sphere`
    /// (world axes). A sphere slightly out of reach may be found too.
    ///
    /// The reach grows by `turn` (radians) times the longest lever, in addition to the growth by [`TURN`] of each
    /// sphere. The search stops when `found` returns false for lack of room. Returns the number of spheres tested, or
    /// `None` after such a stop.
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
        // A queue keeps the order of the tree, which is level by level.
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
