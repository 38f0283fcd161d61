//! One definition of every measure of a run.

use sulcus_core::blend::compatibility;
use sulcus_core::math::{log_rotation, norm};
use sulcus_core::{
    MAX_TOOLS, Node, Pose, Scene, TickInput, TickOutput, Vec3, Wrench, output::status,
};

/// What a run amounts to. SI units.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Measures {
    /// Ticks observed.
    pub ticks: u64,
    /// Ticks in which a tool bore load.
    pub contact_ticks: u64,
    /// Tool-ticks of arrival: from (re)entry to the first converged tick, while the graphic tool
    /// travels to the hand. They count in the residual, not in what follows.
    pub arrival: u64,
    /// Tool-ticks whose substeps ran out.
    pub exhausted: u64,
    /// Tool-ticks without a usable answer of the solver.
    pub solver_failed: u64,
    /// Tool-ticks with unusable input.
    pub bad_input: u64,
    /// *Residual*: deepest penetration over all leaf pairs on the final shapes of converged ticks,
    /// metres, by a full query that shares nothing with the tick's. Where an object's spheres are blended
    /// ([`sulcus_core::blend`]) it is that of the blended surface, of whatever seed and with all spheres in
    /// the sum, or of the cores, whichever is deeper.
    pub residual: f64,
    /// The same over exhausted ticks.
    pub exhausted_residual: f64,
    /// *Jump*: largest translation of the graphic tool's working point in a tick beyond the hand's, metres.
    pub jump: f64,
    /// *Buzz*: mean length of the second difference of the raw force over ticks under load, newtons per
    /// tick.
    pub buzz: f64,
    /// *Force step*: largest change of the **raw** force in a tick beyond `k_t |dq_h|`, newtons.
    pub force_step: f64,
    /// Largest raw force, newtons.
    pub max_raw_force: f64,
    /// Largest force sent to the hand, newtons.
    pub max_force: f64,
    /// Largest change of the force sent in a tick, newtons.
    pub sent_step: f64,
    /// *Energy*: most that the wrench sent had put out into the hand at any time, joules.
    pub energy: f64,
    /// Largest difference between the raw wrench and `G log(q_h q_g^-1)`, relative, over converged
    /// ticks in contact with more than 0.05 N.
    pub coupling_error: f64,
}

/// Observes a run tick by tick.
#[derive(Clone, Debug)]
pub struct Observer {
    measures: Measures,
    last: Option<[ToolTrace; MAX_TOOLS]>,
    /// Second differences need three ticks.
    last_force_change: [Option<Vec3>; MAX_TOOLS],
    arriving: [bool; MAX_TOOLS],
    second_differences: f64,
    second_difference_count: u64,
    put_out: f64,
    tool_leaves: Vec<Vec<Node>>,
    solids: Vec<Solid>,
    placed: Vec<(Vec3, f64)>,
    /// Every how many ticks the full query runs (1: always).
    pub residual_every: u64,
}

#[derive(Clone, Copy, Debug)]
struct ToolTrace {
    present: bool,
    arrived: bool,
    haptic: Pose,
    graphic: Pose,
    raw: Wrench,
    sent: Wrench,
}

impl Observer {
    /// An observer for runs of `scene` at its own levels of detail.
    pub fn new(scene: &Scene) -> Self {
        let leaves = |tree: &sulcus_core::SphereTree, level| {
            tree.shape_at(level).map(|(_, node)| *node).collect()
        };
        Self {
            measures: Measures::default(),
            last: None,
            last_force_change: [None; MAX_TOOLS],
            arriving: [true; MAX_TOOLS],
            second_differences: 0.0,
            second_difference_count: 0,
            put_out: 0.0,
            tool_leaves: scene
                .tools
                .iter()
                .map(|tool| leaves(&tool.tree, tool.level))
                .collect(),
            solids: (0..scene.objects.len())
                .map(|k| Solid::new(scene, k))
                .collect(),
            placed: Vec::new(),
            residual_every: 1,
        }
    }

    /// Takes one tick in.
    pub fn observe(&mut self, scene: &Scene, input: &TickInput, output: &TickOutput) {
        let m = &mut self.measures;
        m.ticks += 1;
        let mut in_contact = false;
        let mut trace: [ToolTrace; MAX_TOOLS] = std::array::from_fn(|t| ToolTrace {
            present: output.tools[t].status & status::ABSENT == 0,
            arrived: false,
            haptic: output.tools[t].haptic,
            graphic: output.tools[t].graphic,
            raw: output.tools[t].raw_wrench,
            sent: output.tools[t].wrench,
        });
        for t in 0..scene.tools.len() {
            let (out, now) = (&output.tools[t], &mut trace[t]);
            m.bad_input += u64::from(out.status & status::BAD_INPUT != 0);
            m.solver_failed += u64::from(out.status & status::SOLVER_FAILED != 0);
            in_contact |= out.active > 0;
            m.max_raw_force = m.max_raw_force.max(norm(&out.raw_wrench.force));
            m.max_force = m.max_force.max(norm(&out.wrench.force));
            if let Some(last) = &self.last {
                m.sent_step = m
                    .sent_step
                    .max(norm(&(now.sent.force - last[t].sent.force)));
            }
            if !now.present || !input.tools[t].present {
                self.last_force_change[t] = None;
                self.arriving[t] = true;
                continue;
            }
            if m.ticks.is_multiple_of(self.residual_every) {
                let depth = deepest(
                    &self.tool_leaves[t],
                    &now.graphic,
                    &self.solids,
                    &mut self.placed,
                );
                if out.converged {
                    m.residual = m.residual.max(depth);
                } else {
                    m.exhausted_residual = m.exhausted_residual.max(depth);
                }
            }
            self.arriving[t] &= !out.converged;
            if self.arriving[t] {
                m.arrival += 1;
                continue;
            }
            now.arrived = true;
            let now = &*now;
            m.exhausted += u64::from(out.status & status::EXHAUSTED != 0);
            let tool = &scene.tools[t];
            if out.converged
                && norm(&now.raw.force) > 0.05
                && out.status & status::TWIST_SATURATED == 0
            {
                m.coupling_error = m.coupling_error.max(coupling_error(tool, now));
            }
            let Some(before) = self
                .last
                .map(|last| last[t])
                .filter(|before| before.present && before.arrived)
            else {
                continue;
            };
            let moved = |pose: fn(&ToolTrace) -> &Pose| {
                pose(now).transform(&tool.working_point)
                    - pose(&before).transform(&tool.working_point)
            };
            let (hand, graphic) = (norm(&moved(|t| &t.haptic)), norm(&moved(|t| &t.graphic)));
            m.jump = m.jump.max(graphic - hand);
            let change = now.raw.force - before.raw.force;
            m.force_step = m
                .force_step
                .max(norm(&change) - tool.stiffness_n_per_m * hand);
            let loaded = out.active > 0 || norm(&before.raw.force) > 0.0;
            if let Some(last) = self.last_force_change[t].filter(|_| loaded) {
                self.second_differences += norm(&(change - last));
                self.second_difference_count += 1;
            }
            self.last_force_change[t] = Some(change);
            // The wrench sent last tick acted while the hand moved to this tick's pose.
            let turn =
                log_rotation(&(now.haptic.orientation * before.haptic.orientation.inverse()));
            let step = now.haptic.position - before.haptic.position;
            self.put_out += before.sent.force.dot(&step) + before.sent.torque.dot(&turn);
            m.energy = m.energy.max(self.put_out);
        }
        m.contact_ticks += u64::from(in_contact);
        self.last = Some(trace);
    }

    /// The measures so far.
    pub fn measures(&self) -> Measures {
        Measures {
            buzz: self.second_differences / self.second_difference_count.max(1) as f64,
            ..self.measures
        }
    }
}

/// `G log(q_h q_g^-1)` against the raw wrench, both at the working point: the force relative to the force, the
/// torque to the torque there or to the force at a lever of a millimetre, whichever is larger.
fn coupling_error(tool: &sulcus_core::Tool, now: &ToolTrace) -> f64 {
    let stretch =
        now.graphic.transform(&tool.working_point) - now.haptic.transform(&tool.working_point);
    let twist = log_rotation(&(now.graphic.orientation * now.haptic.orientation.inverse()));
    let spring = Wrench {
        force: stretch * tool.stiffness_n_per_m,
        torque: twist * tool.stiffness_nm_per_rad,
    };
    let raw = now
        .raw
        .moved(&-(now.haptic.orientation * tool.working_point));
    let force = norm(&(spring.force - raw.force)) / norm(&raw.force);
    let torque =
        norm(&(spring.torque - raw.torque)) / norm(&raw.torque).max(norm(&raw.force) * 1e-3);
    force.max(torque)
}

/// The leaves of an object at the level in use.
#[derive(Clone, Debug)]
struct Solid {
    /// Centre and radius: the core's, where the spheres are blended.
    leaves: Vec<(Vec3, f64)>,
    /// Blend length, metres; 0 where they are hard.
    blend: f64,
    /// Box of the leaves.
    low: Vec3,
    high: Vec3,
}

/// Blend lengths beyond which a sphere weighs under a ten-thousandth of a millionth.
const FAR: f64 = 23.0;

impl Solid {
    fn new(scene: &Scene, k: usize) -> Self {
        let (object, blend) = (&scene.objects[k], scene.blend_of(k));
        let radius = |id, node: &Node| {
            if blend > 0.0 {
                object.tree.core_radius(id, object.level)
            } else {
                node.contact_radius
            }
        };
        let leaves = object.tree.shape_at(object.level);
        let leaves: Vec<_> = leaves
            .map(|(id, node)| (node.centre, radius(id, node)))
            .collect();
        let (low, high) = box_of(&leaves);
        Self {
            leaves,
            blend,
            low,
            high,
        }
    }

    /// Depth of a ball below the blended surface, metres; 0 or less outside of it.
    fn blended_depth(&self, centre: &Vec3, radius: f64) -> f64 {
        let margin = radius + FAR * self.blend;
        if (0..3).any(|k| centre[k] + margin < self.low[k] || centre[k] - margin > self.high[k]) {
            return 0.0;
        }
        let seen: Vec<(f64, f64, Vec3)> = self
            .leaves
            .iter()
            .filter(|(c, r)| (centre - c).norm_squared() < (r + margin) * (r + margin))
            .map(|(c, r)| {
                let distance = (centre - c).norm();
                (distance - r - radius, distance, (centre - c) / distance)
            })
            .collect();
        let least = seen.iter().fold(f64::INFINITY, |least, s| least.min(s.0));
        if least - self.blend * (seen.len() as f64).ln() >= 0.0 {
            return 0.0;
        }
        seen.iter()
            .map(|(own, distance, normal)| {
                let sum: f64 = seen
                    .iter()
                    .map(|(gap, other, n)| {
                        let cosine = normal.dot(n);
                        let nearer = distance.min(*other);
                        let shared = compatibility(cosine, nearer, gap - own, self.blend);
                        shared * ((least - gap) / self.blend).exp()
                    })
                    .sum();
                self.blend * sum.ln() - least
            })
            .fold(0.0, f64::max)
    }
}

/// Box around balls.
fn box_of(balls: &[(Vec3, f64)]) -> (Vec3, Vec3) {
    let huge = Vec3::repeat(f64::INFINITY);
    let (mut low, mut high) = (huge, -huge);
    for (centre, radius) in balls {
        low = low.zip_map(&(centre - Vec3::repeat(*radius)), f64::min);
        high = high.zip_map(&(centre + Vec3::repeat(*radius)), f64::max);
    }
    (low, high)
}

/// Deepest overlap of any tool leaf with any object, metres; 0 when none. Looks at every pair
/// whose boxes meet: no tree, no prediction distance.
fn deepest(tool: &[Node], pose: &Pose, solids: &[Solid], placed: &mut Vec<(Vec3, f64)>) -> f64 {
    placed.clear();
    placed.extend(
        tool.iter()
            .map(|node| (pose.transform(&node.centre), node.contact_radius)),
    );
    let (low, high) = box_of(placed);
    let mut depth: f64 = 0.0;
    for solid in solids {
        for (c, r) in &solid.leaves {
            if (0..3).any(|k| c[k] + r < low[k] || c[k] - r > high[k]) {
                continue;
            }
            for (centre, radius) in placed.iter() {
                let reach = r + radius;
                let between = centre - c;
                let squared = between.norm_squared();
                if squared < reach * reach {
                    depth = depth.max(reach - squared.sqrt());
                }
            }
        }
        if solid.blend > 0.0 {
            for (centre, radius) in placed.iter() {
                depth = depth.max(solid.blended_depth(centre, *radius));
            }
        }
    }
    depth
}
