//! The shaft of a tool as beads, the teeth as balls, and the test whether the shaft clears the teeth.

use sulcus_core::math::Mat3;
use sulcus_core::{Scene, Tool, Vec3};

use crate::frame::ToolFrame;

/// Length of the tool from its tip that must clear the teeth, metres.
const LENGTH: f64 = 25e-3;
/// Required room between tool and teeth, metres: at the tip, which touches, and from [`FREE`] on.
const ROOM: [f64; 2] = [-0.08e-3, 0.13e-3];
/// Length of tool for one bead, metres.
const PIECE: f64 = 0.6e-3;
/// Distance from the tip beyond which the shaft must not touch teeth, metres.
const FREE: f64 = 3e-3;

/// A ball around a piece of the tool, relative to the tip in the axes of [`ToolFrame`].
#[derive(Clone, Copy, Debug)]
struct Bead {
    at: Vec3,
    /// Radius with the required room, metres.
    reach: f64,
}

/// Beads of a tool, farthest from the tip first, because these hit most often.
#[derive(Clone, Debug)]
pub(crate) struct Shaft {
    beads: Vec<Bead>,
    /// Largest extent of the beads along the third axis of [`ToolFrame`], metres.
    thick: f64,
}

impl Shaft {
    pub fn of(tool: &Tool, frame: &ToolFrame) -> Self {
        let mut balls: Vec<(Vec3, f64)> = tool
            .tree
            .shape_at(tool.level)
            .map(|(_, node)| {
                let at = frame.basis.transpose() * (node.centre - tool.tip);
                (at, node.contact_radius)
            })
            .filter(|(at, _)| at.norm() < LENGTH)
            .collect();
        balls.sort_by(|a, b| b.0.norm().total_cmp(&a.0.norm()));
        // Balls at equal distance from the tip become one bead around them.
        let piece = |a: &(Vec3, f64), b: &(Vec3, f64)| {
            (a.0.norm() / PIECE).floor() == (b.0.norm() / PIECE).floor()
        };
        let bead = |balls: &[(Vec3, f64)]| {
            let middle = balls.iter().fold(Vec3::zeros(), |sum, (at, _)| sum + at);
            let at = middle / balls.len() as f64;
            let reaches = balls.iter().map(|(ball, radius)| {
                // The next piece along the tool has its own bead.
                let mut off = ball - at;
                off.x = 0.0;
                off.norm() + radius
            });
            let share = (-at.x / FREE).clamp(0.0, 1.0);
            let room = ROOM[0] + (ROOM[1] - ROOM[0]) * share;
            Bead {
                at,
                reach: reaches.fold(0.0, f64::max) + room,
            }
        };
        let beads: Vec<Bead> = balls.chunk_by(piece).map(bead).collect();
        let thick = beads.iter().map(|bead| bead.at.z.abs() + bead.reach);
        Self {
            thick: thick.fold(0.0, f64::max),
            beads,
        }
    }
}

/// Teeth near a place as balls: centre, world, and radius, metres.
#[derive(Clone, Debug)]
pub(crate) struct Obstacles(Vec<(Vec3, f64)>);

impl Obstacles {
    /// Spheres of all rigid objects of `scene` that a tool with its tip within `reach` metres of `middle` can touch.
    pub fn near(scene: &Scene, middle: &Vec3, reach: f64) -> Self {
        let rigid = scene
            .objects
            .iter()
            .filter(|object| object.tissue.is_rigid());
        let balls = rigid.flat_map(|object| {
            object
                .tree
                .shape_at(object.level)
                .map(|(_, node)| (node.centre, node.contact_radius))
        });
        let near =
            |(centre, radius): &(Vec3, f64)| (centre - middle).norm() < reach + LENGTH + radius;
        Self(balls.filter(near).collect())
    }

    /// Obstacles that a tool with its tip at `tip` and its shaft towards `axis` can touch.
    pub fn above(&self, tip: &Vec3, axis: &Vec3) -> Self {
        let above = |(centre, radius): &&(Vec3, f64)| {
            let from = centre - tip;
            let (up, distance) = (from.dot(axis), from.norm());
            // The shaft never leans by more than about 50 degrees.
            distance < LENGTH + radius + 2e-3 && up > 0.6 * distance - 1.3 * radius - 2e-3
        };
        Self(self.0.iter().filter(above).copied().collect())
    }

    /// Whether the shaft clears all obstacles with its tip at `tip` and its axes along the columns of `axes`. `less`
    /// reduces the required room, metres. A hit obstacle is tested first in the next call.
    pub fn passes(&mut self, shaft: &Shaft, tip: &Vec3, axes: &Mat3, less: f64) -> bool {
        let hit = self.0.iter().position(|(centre, radius)| {
            let from = centre - tip;
            if from.dot(&axes.column(2)).abs() > shaft.thick + radius {
                return false;
            }
            let from = axes.transpose() * from;
            shaft.beads.iter().any(|bead| {
                let reach = radius + bead.reach - less;
                (from - bead.at).norm_squared() < reach * reach
            })
        });
        if let Some(hit) = hit {
            self.0.swap(0, hit);
        }
        hit.is_none()
    }
}
