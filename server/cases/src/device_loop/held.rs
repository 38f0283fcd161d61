//! A device in a hand behind its door, on its own clock.

use std::collections::VecDeque;
use std::time::Duration;

use sulcus_core::math::{exp_rotation, log_rotation, norm};
use sulcus_core::{Pose, Scene, Tool, Vec3, Wrench};
use sulcus_haptics::door::{Door, DoorRules, Guard, Wanted};
use sulcus_haptics::freshness::Silence;
use sulcus_haptics::interlock::Stage;
use sulcus_haptics::{Limits, Mapping, SlewLimits};

use super::Setup;
use super::figures::Dynamics;
use super::plant::{Plant, STEPS};

/// Hour of the dental clock at which the person sits. The axes of base and world differ.
const SEAT_HOUR: f64 = 10.5;
/// Time for which a hand holds its device still, before a case begins, nanoseconds: the button is pressed, and the rise
/// of the force ends.
pub(super) const READY_NS: u64 = 700_000_000;

/// Device of one hand.
#[derive(Clone, Debug)]
pub(super) struct Held {
    plant: Plant,
    door: Door,
    mapping: Mapping,
    wanted: Wanted,
    /// Largest force of the door, newtons.
    most_n: f64,
    period_ns: u64,
    latency_ns: u64,
    /// Wrenches on the way to the motors, with the times at which they act, world axes.
    driven: VecDeque<(u64, Wrench)>,
    felt: Wrench,
    target: Pose,
}

impl Held {
    /// A device at rest at `start`, the hand's target, behind an open door at `now_ns`. A button was pressed while the
    /// tool was free.
    pub(super) fn ready(
        setup: &Setup<'_>,
        dynamics: Dynamics,
        (scene, tool): (&Scene, &Tool),
        start: Pose,
        now_ns: u64,
    ) -> Self {
        let mapping = Mapping {
            world_from_base: Mapping::seat(SEAT_HOUR),
            origin: tool.park.position,
            scale: 1.0,
            gimbal_from_tool: Pose::identity(),
        };
        let rules = rules(setup, &dynamics, scene, mapping.clone());
        let mut held = Self {
            plant: Plant::new(dynamics, start),
            most_n: rules.limits.force_n,
            door: Door::new(rules),
            mapping,
            wanted: Wanted::NOTHING,
            period_ns: (dynamics.period_s * 1e9) as u64,
            latency_ns: (dynamics.latency_s * 1e9) as u64,
            driven: VecDeque::new(),
            felt: Wrench::ZERO,
            target: start,
        };
        let mut at_ns = now_ns.saturating_sub(READY_NS);
        let pressed_from = at_ns + 20_000_000;
        while at_ns < now_ns {
            held.hears(&Wrench::ZERO, at_ns);
            let pressed = (pressed_from..pressed_from + 50_000_000).contains(&at_ns);
            held.exchange(at_ns, u16::from(pressed));
            at_ns += held.period_ns;
        }
        held
    }

    /// Takes a wrench of the link, which arrived at `now_ns`.
    pub(super) fn hears(&mut self, wrench: &Wrench, now_ns: u64) {
        self.wanted = Wanted {
            wrench: *wrench,
            heard_ns: Some(now_ns),
            ..self.wanted
        };
        self.door.order(&self.wanted);
    }

    /// Performs a period of the door at `now_ns`, and returns the displayed force, base axes.
    pub(super) fn exchange(&mut self, now_ns: u64, buttons: u16) -> Vec3 {
        let measured = self.plant.measured(&self.mapping.world_from_base);
        let displayed = self
            .door
            .exchange(now_ns, Ok(&in_base(&self.mapping, &measured)), buttons);
        let acts_ns = now_ns + self.latency_ns;
        self.driven
            .push_back((acts_ns, self.door.displayed_in_world()));
        displayed.force
    }

    /// Moves hand and device through the period of the device from `now_ns` on, towards `target` at its end.
    pub(super) fn moves(&mut self, now_ns: u64, target: &Pose) {
        let period_s = self.period_ns as f64 * 1e-9;
        let turn = log_rotation(&(target.orientation * self.target.orientation.inverse()));
        let way = target.position - self.target.position;
        let meant = (way / period_s, turn / period_s);
        let dt = period_s / f64::from(STEPS);
        for k in 0..STEPS {
            let at_ns = now_ns + self.period_ns * u64::from(k) / u64::from(STEPS);
            while let Some((acts_ns, wrench)) = self.driven.front()
                && *acts_ns <= at_ns
            {
                self.felt = *wrench;
                self.driven.pop_front();
            }
            let share = f64::from(k + 1) / f64::from(STEPS);
            let facing = exp_rotation(&(turn * share)) * self.target.orientation;
            let towards = Pose::new(self.target.position + way * share, facing);
            self.plant.step(dt, &towards, &meant, &self.felt);
        }
        self.target = *target;
    }

    /// Pose of the tool as the door reports it; `None` before a valid pose.
    pub(super) fn tool(&self) -> Option<Pose> {
        self.door.tool()
    }

    /// True pose of the handle.
    pub(super) fn handle(&self) -> Pose {
        self.plant.handle()
    }

    /// Displayed wrench about the device point, world axes.
    pub(super) fn displayed(&self) -> Wrench {
        self.door.displayed_in_world()
    }

    /// Magnitude of the newest force of the link, within the limits of the door, newtons.
    pub(super) fn sent_n(&self) -> f64 {
        norm(&self.wanted.wrench.force).min(self.most_n)
    }

    /// Whether the door passes the whole force.
    pub(super) fn is_live(&self) -> bool {
        self.door.stage() == Stage::Live
    }

    /// Largest net energy put out since a contact began, joules.
    pub(super) fn energy(&self) -> f64 {
        self.door.energy().most_out
    }

    /// Number of periods in which the passivity controller acted.
    pub(super) fn acted(&self) -> u64 {
        self.door.energy().acted
    }

    /// Number of periods in which the continuous limit reduced the force.
    pub(super) fn limited(&self) -> u64 {
        self.door.counts().limited
    }
}

/// Rules of the door, as those of a client without settings of the person.
fn rules(setup: &Setup<'_>, dynamics: &Dynamics, scene: &Scene, mapping: Mapping) -> DoorRules {
    let model = setup.model;
    let torque_nm = match &model.peak_torque_mnm {
        Some(peak) if model.has_torque() => peak.value * 1e-3,
        _ => 0.0,
    };
    let limits = Limits {
        force_n: scene.params.max_force.min(model.peak_force_n.value),
        torque_nm: scene.params.max_torque.min(torque_nm),
    };
    let period = Duration::from_secs_f64(dynamics.period_s);
    let guard = Guard {
        mapping,
        has_torque: model.has_torque(),
        silence: Silence::DEVICE,
        blend_ns: Guard::blend(period, Duration::from_nanos(scene.params.tick_ns())),
        force: model.force_limit(),
        torque: model.torque_limit(),
        clutch: 0,
    };
    let own = || model.passivity(dynamics.period_s, scene.tick_s());
    let passivity = setup.passivity.unwrap_or_else(own);
    DoorRules::guarded(limits, SlewLimits::from(&scene.params), passivity, guard)
}

/// Pose of the handle in base axes for a tool at `tool`, `world_from_tool`, whose origin is the centre of the gimbal.
fn in_base(mapping: &Mapping, tool: &Pose) -> Pose {
    let back = mapping.world_from_base.inverse();
    Pose::new(
        back * (tool.position - mapping.origin),
        back * tool.orientation,
    )
}
