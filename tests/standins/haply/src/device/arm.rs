//! Arm at run time: commands that hold, watchdog, and the hand that the force acts on.

use super::config::Config;
use super::motion::{Motion, norm};
use super::options::{ArmOptions, ArmStatus};
use crate::Vector;

/// Longest step of the integration of a held hand, in ns.
const STEP_NS: u64 = 250_000;

/// A command of one connection that holds.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Claim {
    /// Connection.
    pub(crate) connection: u64,
    /// Force in N; zero where the command is of another mode.
    pub(crate) force: Vector,
    /// True for a command of a position.
    pub(crate) position: bool,
    /// Time of the message.
    pub(crate) at_ns: u64,
}

/// Limits and factors on the forces of every arm.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Forces {
    /// Factor on every force.
    pub(crate) scale: f64,
    /// Greatest displayed force, in N.
    pub(crate) peak_n: f64,
    /// Time without a command after which an arm goes idle.
    pub(crate) watchdog_ns: u64,
}

/// An arm as it is now.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ArmView {
    /// Position that a reply would report, in m.
    pub position: Vector,
    /// Velocity that a reply would report, in m/s.
    pub velocity: Vector,
    /// Force that the arm displays, in N.
    pub displayed: Vector,
    /// True where no command holds.
    pub idle: bool,
}

/// Arm at run time.
#[derive(Debug)]
pub(crate) struct Arm {
    pub(crate) id: String,
    pub(crate) config: Config,
    pub(crate) status: ArmStatus,
    pub(crate) connected: bool,
    /// Count of connections of the device; a link that knows an older one gets the config again.
    pub(crate) generation: u64,
    pub(crate) braked: bool,
    pub(crate) second: Vector,
    pub(crate) transform: Option<String>,
    options: ArmOptions,
    motion: Motion,
    start_ns: u64,
    now_ns: u64,
    position: Vector,
    velocity: Vector,
    claims: Vec<Claim>,
    last_command_ns: u64,
}

impl Arm {
    /// Arm at its start.
    pub(crate) fn new(options: &ArmOptions, now_ns: u64) -> Self {
        let mut arm = Self {
            id: options.id.clone(),
            config: Config::of_arm(options),
            status: options.status,
            connected: options.connected,
            generation: 1,
            braked: false,
            second: [0.0; 3],
            transform: None,
            options: options.clone(),
            motion: options.motion.clone(),
            start_ns: now_ns,
            now_ns,
            position: [0.0; 3],
            velocity: [0.0; 3],
            claims: Vec::new(),
            last_command_ns: now_ns,
        };
        (arm.position, arm.velocity) = arm.motion.sample(0.0);
        arm
    }

    /// Another motion of the hand; its time starts now.
    pub(crate) fn set_motion(&mut self, motion: Motion, now_ns: u64) {
        self.motion = motion;
        self.start_ns = now_ns;
        self.now_ns = now_ns;
        (self.position, self.velocity) = self.motion.sample(0.0);
    }

    /// Commands of one connection in a message; true where the arm was idle before.
    pub(crate) fn claim(&mut self, claim: Claim) -> bool {
        let idle = self.claims.is_empty();
        self.claims
            .retain(|held| held.connection != claim.connection);
        self.claims.push(claim);
        self.last_command_ns = claim.at_ns;
        idle
    }

    /// The message of a connection had no command for the arm; true where the arm goes idle by it.
    pub(crate) fn release(&mut self, connection: u64) -> bool {
        let before = self.claims.len();
        self.claims.retain(|held| held.connection != connection);
        before > 0 && self.claims.is_empty()
    }

    /// Moves the arm to a time; the time at which its watchdog made it idle, where that happened.
    pub(crate) fn advance(&mut self, now_ns: u64, forces: Forces) -> Option<u64> {
        let mut idle = None;
        while let Some(oldest) = self.claims.iter().map(|held| held.at_ns).min() {
            let deadline = oldest + forces.watchdog_ns;
            if deadline > now_ns {
                break;
            }
            self.move_to(deadline, forces);
            self.claims.retain(|held| held.at_ns > oldest);
            if self.claims.is_empty() {
                idle = Some(deadline);
            }
        }
        self.move_to(now_ns, forces);
        idle
    }

    /// Force that the arm displays, in N.
    pub(crate) fn force(&self, forces: Forces) -> Vector {
        if !self.connected || !self.status.power_supply || self.braked {
            return [0.0; 3];
        }
        let mut sum = self.second;
        for held in &self.claims {
            for (total, part) in sum.iter_mut().zip(held.force) {
                *total += part;
            }
        }
        let factor = forces.scale * self.config.torque_factor();
        let scaled = sum.map(|part| part * factor);
        let length = norm(scaled);
        if length > forces.peak_n {
            scaled.map(|part| part * forces.peak_n / length)
        } else {
            scaled
        }
    }

    /// Time of the last command.
    pub(crate) fn last_command_ns(&self) -> u64 {
        self.last_command_ns
    }

    /// Name of the control mode.
    pub(crate) fn mode(&self) -> &'static str {
        match self.claims.last() {
            None => "idle",
            Some(held) if held.position => "position",
            Some(_) => "force",
        }
    }

    /// Reported position in m and velocity in m/s.
    pub(crate) fn pose(&self) -> (Vector, Vector) {
        let step = self.options.mechanics.position_step_m;
        (self.position.map(|x| round(x, step)), self.velocity)
    }

    /// The arm as it is now.
    pub(crate) fn view(&self, forces: Forces) -> ArmView {
        let (position, velocity) = self.pose();
        ArmView {
            position,
            velocity,
            displayed: self.force(forces),
            idle: self.claims.is_empty(),
        }
    }

    fn move_to(&mut self, now_ns: u64, forces: Forces) {
        let Motion::Held {
            mass_kg,
            stiffness_n_per_m,
            damping_n_s_per_m,
            ..
        } = self.motion
        else {
            self.now_ns = self.now_ns.max(now_ns);
            let t_s = seconds(self.now_ns - self.start_ns);
            (self.position, self.velocity) = self.motion.sample(t_s);
            return;
        };
        let own = self.options.mechanics;
        let mass = (mass_kg + own.mass_kg).max(1e-3);
        let force = self.force(forces).map(|part| round(part, own.force_step_n));
        while self.now_ns < now_ns {
            let step_ns = STEP_NS.min(now_ns - self.now_ns);
            self.now_ns += step_ns;
            let step_s = seconds(step_ns);
            let (anchor, anchor_velocity) =
                self.motion.sample(seconds(self.now_ns - self.start_ns));
            // The damping enters implicitly: a stiff grip stays stable at any step.
            let damping = damping_n_s_per_m + own.damping_n_s_per_m;
            for i in 0..3 {
                let push = force[i]
                    + stiffness_n_per_m * (anchor[i] - self.position[i])
                    + damping_n_s_per_m * anchor_velocity[i];
                self.velocity[i] =
                    (self.velocity[i] + push * step_s / mass) / (1.0 + damping * step_s / mass);
                self.position[i] += self.velocity[i] * step_s;
            }
        }
    }
}

fn seconds(ns: u64) -> f64 {
    ns as f64 * 1e-9
}

fn round(value: f64, step: f64) -> f64 {
    if step > 0.0 {
        (value / step).round() * step
    } else {
        value
    }
}
