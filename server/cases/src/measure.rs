//! Measures of a run, each with its one definition.

use sulcus_core::math::{log_rotation, norm};
use sulcus_core::{
    MAX_TOOLS, Pose, Scene, TickInput, TickOutput, Vec3, Workspace, Wrench, output::status,
};

use crate::bearing::{Bearing, imbalance};
use crate::residual::FullQuery;
use crate::sway::Sway;

/// Fastest hand of the *slow force step*, m/s.
pub const SLOW: f64 = 0.2;

/// Time after which a tool in a resting hand has settled, seconds.
const SETTLE_S: f64 = 1.0;

/// Measures of a run, SI units. A *tool-tick* is one tick of one tool.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Measures {
    /// Number of ticks observed.
    pub ticks: u64,
    /// Number of ticks in which a tool bore load.
    pub contact_ticks: u64,
    /// Number of tool-ticks of arrival: from the appearance of a tool to its first converged tick without
    /// [`status::SETTLING`], while the graphic tool travels to the hand.
    ///
    /// Exhaustion, settling, imbalance, coupling error, jump, drift, steps of raw force and torque, buzz and energy
    /// begin after the arrival. All other measures include it.
    pub arrival: u64,
    /// Number of tool-ticks whose substeps ran out.
    pub exhausted: u64,
    /// Number of tool-ticks in which the limit of a force step delayed the tool.
    pub settling: u64,
    /// Number of tool-ticks without a usable answer of the solver.
    pub solver_failed: u64,
    /// Number of tool-ticks with unusable input.
    pub bad_input: u64,
    /// Number of tool-ticks in which the tick met a number that is not finite and sent nothing: [`status::FAULT`].
    pub faults: u64,
    /// Number of ticks with an output that is not finite: in a raw or sent wrench, or in a pose.
    pub not_finite: u64,
    /// *Residual*: deepest penetration over all pairs of leaves on the final, deformed shapes of converged ticks,
    /// metres.
    ///
    /// A full query that shares nothing with the tick measures it. For a blended object, see [`sulcus_core::blend`],
    /// the blended surface and the cores are both measured, and the deeper penetration counts.
    pub residual: f64,
    /// The residual of ticks that did not converge, metres.
    pub exhausted_residual: f64,
    /// *Jump*: largest translation of the graphic tool's working point in a tick beyond that of the hand's, metres.
    pub jump: f64,
    /// *Buzz*: mean length of the second difference of the raw force over tool-ticks under load, newtons.
    pub buzz: f64,
    /// *Force step*: largest change of the **raw** force in a tick beyond `k_t |dq_h|`, newtons.
    pub force_step: f64,
    /// *Slow force step*: largest change of the **raw** force in a tick beyond `k_t` times the hand's motion, newtons.
    ///
    /// The motion is that of the tool's sphere that is farthest from the working point. Only ticks with a motion of at
    /// most [`SLOW`] count, with a load in the tick before, and without a tool that still follows a faster hand.
    pub slow_force_step: f64,
    /// *Torque step*: largest change of the **raw** torque in a tick, about the tool's working point, newton metres.
    /// About the device point a lateral force would count with its lever of 90 mm.
    pub torque_step: f64,
    /// Largest raw force, newtons.
    pub max_raw_force: f64,
    /// Largest force sent to the hand, newtons.
    pub max_force: f64,
    /// Largest change of the force sent in a tick, newtons.
    pub sent_step: f64,
    /// *Energy*: largest net work of the sent wrench on the hands up to any tick, joules.
    pub energy: f64,
    /// *Work put in*: largest net work of the hands up to any tick, joules.
    pub work_in: f64,
    /// *Imbalance*: largest difference between the sum of the contacts' loads and the raw wrench, relative to the sum
    /// of the loads' magnitudes.
    ///
    /// Only converged tool-ticks without settling and with more than 0.01 N count. A torque about the working point
    /// counts with a lever of 1 mm.
    pub imbalance: f64,
    /// *Flips*: number of loaded pairs of spheres whose normal turned by more than 90 degrees from one tick to the
    /// next.
    pub flips: u64,
    /// *Indentation*: largest displacement of any leaf of a tissue from its rest, metres.
    pub indentation: f64,
    /// *Rebound*: largest energy gain of a tissue after the end of its last load, relative.
    ///
    /// The gain is the square of the ratio of a later displacement to that at the end of the load, minus one. A tissue
    /// that only returns has 0. Displacements below 10 um count as rest.
    pub rebound: f64,
    /// *Unrest*: largest displacement of any leaf from its rest in the last observed tick, metres.
    pub unrest: f64,
    /// *Drift*: largest distance of the graphic tool's working point from its position a second after the hand came to
    /// rest exactly, while the hand rests, metres.
    pub drift: f64,
    /// *Coupling error*: largest relative difference between the raw wrench and `G log(q_h q_g^-1)`, over converged
    /// tool-ticks with more than 0.05 N, without settling and without a saturated twist.
    pub coupling_error: f64,
}

/// Observer of a run, tick by tick.
#[derive(Clone, Debug)]
pub struct Observer {
    measures: Measures,
    last: Option<[ToolTrace; MAX_TOOLS]>,
    /// Last change of the raw force, newtons; `None` before the second tick of a contact.
    last_force_change: [Option<Vec3>; MAX_TOOLS],
    arriving: [bool; MAX_TOOLS],
    behind: [bool; MAX_TOOLS],
    second_differences: f64,
    second_difference_count: u64,
    put_out: f64,
    /// Number of ticks since each hand moved, and the settled position of its tool, metres.
    resting: [(u64, Vec3); MAX_TOOLS],
    /// Length of a tick, seconds.
    tick_s: f64,
    /// Number of ticks in which a tool settles.
    settle_ticks: u64,
    /// Largest distance of a tool's spheres from its working point, metres.
    reach: [f64; MAX_TOOLS],
    query: FullQuery,
    bearing: Bearing,
    sway: Sway,
    /// Number of ticks from one full query to the next; 1: every tick. Residual, indentation, rebound and unrest are
    /// measured in these ticks only.
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

impl ToolTrace {
    /// Raw wrench about the haptic tool's working point, at which the coupling's spring acts.
    fn about_working_point(&self, tool: &sulcus_core::Tool) -> Wrench {
        self.raw
            .moved(&-(self.haptic.orientation * tool.working_point))
    }
}

impl Observer {
    /// An observer for a run of `scene` at its own levels of detail.
    pub fn new(scene: &Scene) -> Self {
        Self {
            measures: Measures::default(),
            last: None,
            last_force_change: [None; MAX_TOOLS],
            arriving: [true; MAX_TOOLS],
            behind: [false; MAX_TOOLS],
            second_differences: 0.0,
            second_difference_count: 0,
            put_out: 0.0,
            resting: [(0, Vec3::zeros()); MAX_TOOLS],
            tick_s: scene.tick_s(),
            settle_ticks: scene.params.ticks_in(SETTLE_S),
            reach: std::array::from_fn(|t| {
                let tool = scene.tools.get(t);
                tool.map_or(0.0, |tool| tool.tree.lever_from(&tool.working_point))
            }),
            query: FullQuery::new(scene),
            bearing: Bearing::default(),
            sway: Sway::new(scene),
            residual_every: 1,
        }
    }

    /// Takes one tick; `ws` is the workspace after that tick.
    pub fn observe(
        &mut self,
        scene: &Scene,
        input: &TickInput,
        output: &TickOutput,
        ws: &Workspace,
    ) {
        let m = &mut self.measures;
        m.ticks += 1;
        let looks = m.ticks.is_multiple_of(self.residual_every);
        if looks {
            self.query.deform(ws);
            self.sway.observe(self.query.solids(), ws);
            m.indentation = self.sway.indentation;
            m.rebound = self.sway.rebound;
            m.unrest = self.sway.now;
        }
        m.not_finite += u64::from(!is_finite(output));
        m.flips += self.bearing.flips(ws);
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
            m.faults += u64::from(out.status & status::FAULT != 0);
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
            if looks {
                let depth = self.query.deepest(t, &now.graphic);
                if out.converged {
                    m.residual = m.residual.max(depth);
                } else {
                    m.exhausted_residual = m.exhausted_residual.max(depth);
                }
            }
            let settled = out.converged && out.status & status::SETTLING == 0;
            self.arriving[t] &= !settled;
            if self.arriving[t] {
                m.arrival += 1;
                continue;
            }
            now.arrived = true;
            let now = &*now;
            m.exhausted += u64::from(out.status & status::EXHAUSTED != 0);
            let tool = &scene.tools[t];
            if settled && out.status & status::SOLVER_FAILED == 0 {
                m.imbalance = m
                    .imbalance
                    .max(imbalance(ws, t, &now.about_working_point(tool)));
            }
            if settled && norm(&now.raw.force) > 0.05 && out.status & status::TWIST_SATURATED == 0 {
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
            let at = now.graphic.transform(&tool.working_point);
            let (rest, place) = &mut self.resting[t];
            *rest = if now.haptic == before.haptic {
                *rest + 1
            } else {
                0
            };
            if *rest <= self.settle_ticks {
                *place = at;
            }
            m.drift = m.drift.max(norm(&(at - *place)));
            let change = now.raw.force - before.raw.force;
            m.force_step = m
                .force_step
                .max(norm(&change) - tool.stiffness_n_per_m * hand);
            let turn =
                log_rotation(&(now.haptic.orientation * before.haptic.orientation.inverse()));
            let farthest = hand + self.reach[t] * norm(&turn);
            m.settling += u64::from(out.status & status::SETTLING != 0);
            // A tool that follows a faster hand finishes the motion in later ticks.
            let was_behind = self.behind[t];
            let behind = &mut self.behind[t];
            let fast = farthest > SLOW * self.tick_s && out.status & status::SETTLING != 0;
            *behind |= fast || out.status & status::EXHAUSTED != 0;
            *behind &= !settled;
            let ends = was_behind || *behind;
            if farthest <= SLOW * self.tick_s && !ends && norm(&before.raw.force) > 0.0 {
                m.slow_force_step = m
                    .slow_force_step
                    .max(norm(&change) - tool.stiffness_n_per_m * farthest);
            }
            let torque = |trace: &ToolTrace| trace.about_working_point(tool).torque;
            m.torque_step = m.torque_step.max(norm(&(torque(now) - torque(&before))));
            let loaded = out.active > 0 || norm(&before.raw.force) > 0.0;
            if let Some(last) = self.last_force_change[t].filter(|_| loaded) {
                self.second_differences += norm(&(change - last));
                self.second_difference_count += 1;
            }
            self.last_force_change[t] = Some(change);
            // The wrench of the last tick acted while the hand moved to the pose of this tick.
            let step = now.haptic.position - before.haptic.position;
            self.put_out += before.sent.force.dot(&step) + before.sent.torque.dot(&turn);
            m.energy = m.energy.max(self.put_out);
            m.work_in = m.work_in.max(-self.put_out);
        }
        m.contact_ticks += u64::from(in_contact);
        self.last = Some(trace);
    }

    /// Measures so far.
    pub fn measures(&self) -> Measures {
        Measures {
            buzz: self.second_differences / self.second_difference_count.max(1) as f64,
            ..self.measures
        }
    }
}

fn is_finite(output: &TickOutput) -> bool {
    let numbers = output.tools.iter().flat_map(|tool| {
        let (sent, raw, pose) = (&tool.wrench, &tool.raw_wrench, &tool.graphic);
        let turned = pose.orientation.coords.xyz();
        let vectors = [sent.force, sent.torque, raw.force, raw.torque];
        vectors.into_iter().chain([pose.position, turned])
    });
    numbers.flat_map(|v| [v.x, v.y, v.z]).all(f64::is_finite)
}

/// Relative difference between `G log(q_h q_g^-1)` and the raw wrench, both at the working point.
///
/// The force is relative to the raw force. The torque is relative to the raw torque, or to the raw force at a lever of
/// a millimetre if that is larger. The larger of both results counts.
fn coupling_error(tool: &sulcus_core::Tool, now: &ToolTrace) -> f64 {
    let stretch =
        now.graphic.transform(&tool.working_point) - now.haptic.transform(&tool.working_point);
    let twist = log_rotation(&(now.graphic.orientation * now.haptic.orientation.inverse()));
    let spring = Wrench {
        force: stretch * tool.stiffness_n_per_m,
        torque: twist * tool.stiffness_nm_per_rad,
    };
    let raw = now.about_working_point(tool);
    let force = norm(&(spring.force - raw.force)) / norm(&raw.force);
    let torque =
        norm(&(spring.torque - raw.torque)) / norm(&raw.torque).max(norm(&raw.force) * 1e-3);
    force.max(torque)
}
