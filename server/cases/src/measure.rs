//! One definition of every measure of a run.

use sulcus_core::math::{log_rotation, norm};
use sulcus_core::{
    MAX_TOOLS, Pose, Scene, TickInput, TickOutput, Vec3, Workspace, Wrench, output::status,
};

use crate::bearing::{Bearing, imbalance};
use crate::residual::FullQuery;
use crate::sway::Sway;

/// Fastest hand of the *slow force step*, m/s.
pub const SLOW: f64 = 0.2;

/// Seconds after which what a resting hand holds has settled.
const SETTLE_S: f64 = 1.0;

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
    /// Tool-ticks in which the tool was still on its way so that the force should not jump.
    pub settling: u64,
    /// Tool-ticks without a usable answer of the solver.
    pub solver_failed: u64,
    /// Tool-ticks with unusable input.
    pub bad_input: u64,
    /// Tool-ticks in which the tick itself met a number that is not finite, and sent nothing ([`status::FAULT`]).
    pub faults: u64,
    /// Ticks in which a number came out that is not finite: in a wrench, raw or sent, or a pose.
    pub not_finite: u64,
    /// *Residual*: deepest penetration over all leaf pairs on the final, deformed shapes of converged ticks,
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
    /// *Slow force step*: the same over ticks in which the hand went at [`SLOW`] at most, the tool's sphere that is farthest from its
    /// working point included, and the tool was not behind it, outside of first touch (the tool was loaded in the tick before, too): newtons.
    pub slow_force_step: f64,
    /// *Torque step*: largest change of the **raw** torque in a tick, about the tool's working point (about the
    /// device point a lateral force would count with its lever of 90 mm), newton metres.
    pub torque_step: f64,
    /// Largest raw force, newtons.
    pub max_raw_force: f64,
    /// Largest force sent to the hand, newtons.
    pub max_force: f64,
    /// Largest change of the force sent in a tick, newtons.
    pub sent_step: f64,
    /// *Energy*: most that the wrench sent had put out into the hand at any time, joules.
    pub energy: f64,
    /// *Work put in*: most that the hand had put in at any time, net of what it got back, joules.
    pub work_in: f64,
    /// *Imbalance*: largest difference between the sum of the contacts' loads, on teeth and tissue, and the
    /// raw wrench, relative to the sum of their magnitudes, over converged ticks with more than 0.01 N of
    /// them in which nothing was settling. Torques about the working point count with a lever of 1 mm.
    pub imbalance: f64,
    /// *Flips*: times that a pair of spheres bore load in two consecutive ticks and its normal turned by more
    /// than 90 degrees between them.
    pub flips: u64,
    /// *Indentation*: largest displacement of any leaf of a tissue from its rest, metres.
    pub indentation: f64,
    /// *Rebound*: energy that appears in a tissue after the last load on it has gone: largest later
    /// displacement of any leaf over that at letting go, squared (a spring's energy), minus one; 0 when it
    /// only ever comes back. Displacements under 10 um are rest.
    pub rebound: f64,
    /// *Unrest*: displacement of the leaf that is farthest from its rest in the last tick seen, metres.
    pub unrest: f64,
    /// *Drift*: farthest that the graphic tool's working point goes from where it was a second after the
    /// hand came to rest exactly, while it rests, metres.
    pub drift: f64,
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
    behind: [bool; MAX_TOOLS],
    second_differences: f64,
    second_difference_count: u64,
    put_out: f64,
    /// Ticks since each hand moved, and where the tool then came to be.
    resting: [(u64, Vec3); MAX_TOOLS],
    /// Length of a tick, seconds, and ticks in which a tool comes to rest.
    tick_s: f64,
    settle_ticks: u64,
    /// How far a tool reaches from its working point, metres: what a turn moves.
    reach: [f64; MAX_TOOLS],
    query: FullQuery,
    bearing: Bearing,
    sway: Sway,
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

impl ToolTrace {
    /// The raw wrench about the haptic tool's working point, where the coupling's spring is.
    fn about_working_point(&self, tool: &sulcus_core::Tool) -> Wrench {
        self.raw
            .moved(&-(self.haptic.orientation * tool.working_point))
    }
}

impl Observer {
    /// An observer for runs of `scene` at its own levels of detail.
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

    /// Takes one tick in; `ws` is the workspace as that tick left it.
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
            // A hand that was faster than the tool could follow has its motion's end in later ticks.
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
            // The wrench sent last tick acted while the hand moved to this tick's pose.
            let step = now.haptic.position - before.haptic.position;
            self.put_out += before.sent.force.dot(&step) + before.sent.torque.dot(&turn);
            m.energy = m.energy.max(self.put_out);
            m.work_in = m.work_in.max(-self.put_out);
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

fn is_finite(output: &TickOutput) -> bool {
    let numbers = output.tools.iter().flat_map(|tool| {
        let (sent, raw, pose) = (&tool.wrench, &tool.raw_wrench, &tool.graphic);
        let turned = pose.orientation.coords.xyz();
        let vectors = [sent.force, sent.torque, raw.force, raw.torque];
        vectors.into_iter().chain([pose.position, turned])
    });
    numbers.flat_map(|v| [v.x, v.y, v.z]).all(f64::is_finite)
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
    let raw = now.about_working_point(tool);
    let force = norm(&(spring.force - raw.force)) / norm(&raw.force);
    let torque =
        norm(&(spring.torque - raw.torque)) / norm(&raw.torque).max(norm(&raw.force) * 1e-3);
    force.max(torque)
}
