//! The part of a tool that has to pass between the teeth, and the teeth that it has to pass.

use sulcus_core::math::Mat3;
use sulcus_core::{Scene, Tool, Vec3};

use crate::frame::ToolFrame;

/// Length of the tool, from its tip, that is kept clear, metres.
const LENGTH: f64 = 25e-3;
/// Room between tool and teeth, metres: at the tip, which is meant to touch, and from [`FREE`] on.
const ROOM: [f64; 2] = [-0.08e-3, 0.13e-3];
/// Length of tool that one bead stands for, metres.
const PIECE: f64 = 0.6e-3;
/// Distance from the tip from which on the shaft is to be free of the teeth, metres.
const FREE: f64 = 3e-3;

/// A ball of the tool, seen from its tip in the axes of [`ToolFrame`].
#[derive(Clone, Copy, Debug)]
struct Bead {
    at: Vec3,
    /// Its radius and the room that it wants.
    reach: f64,
}

/// The beads of a tool, farthest from the tip first: they are what hits.
#[derive(Clone, Debug)]
pub(crate) struct Shaft {
    beads: Vec<Bead>,
    /// Half thickness of the plane in which the tool lies: no bead reaches farther to the third axis.
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
        // Balls as far from the tip as each other become one bead around them.
        let piece = |a: &(Vec3, f64), b: &(Vec3, f64)| {
            (a.0.norm() / PIECE).floor() == (b.0.norm() / PIECE).floor()
        };
        let bead = |balls: &[(Vec3, f64)]| {
            let middle = balls.iter().fold(Vec3::zeros(), |sum, (at, _)| sum + at);
            let at = middle / balls.len() as f64;
            let reaches = balls.iter().map(|(ball, radius)| {
                // Along the tool the next piece has its own bead.
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

/// Teeth near a place, as balls.
#[derive(Clone, Debug)]
pub(crate) struct Obstacles(Vec<(Vec3, f64)>);

impl Obstacles {
    /// All rigid spheres of `scene` that a tool whose tip is within `reach` of `middle` may meet.
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

    /// Those that a tool with its tip at `tip` and its shaft above it (towards `axis`) may meet.
    pub fn above(&self, tip: &Vec3, axis: &Vec3) -> Self {
        let above = |(centre, radius): &&(Vec3, f64)| {
            let from = centre - tip;
            let (up, distance) = (from.dot(axis), from.norm());
            // The shaft never leans more than about 50 degrees.
            distance < LENGTH + radius + 2e-3 && up > 0.6 * distance - 1.3 * radius - 2e-3
        };
        Self(self.0.iter().filter(above).copied().collect())
    }

    /// Whether the shaft passes with its tip at `tip` and its axes along the columns of `axes`, with `less` room than it
    /// wants, metres. A ball that was hit is looked at first next time.
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
