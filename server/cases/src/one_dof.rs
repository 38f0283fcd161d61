//! The paper's benchmark with one degree of freedom (sections 4.4 and 8.1, Fig. 7, Table 1): a sphere on a spring and a
//! tool that presses it along the same line.
//!
//! Three methods on the same numbers: *as printed* (explicit Euler under a penalty load, Eq. 5, then the
//! tool against the sphere where it has gone), the same with *implicit* Euler (what is cured by the
//! integrator alone), and *coupled* (compliance inside the optimisation, the default of [`sulcus_core`]). All places are
//! surfaces: 0 is the sphere's at rest, positive is pressed in. The paper does not give `k_s` in its text, so several
//! stand in the table.

use std::fmt;

/// Length of a tick, seconds: the paper's.
const TICK_S: f64 = 1e-3;
use sulcus_core::tissue::printed::stability::largest_time_step;

/// Who computes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// As printed: explicit Euler, penalty load, tool afterwards.
    Printed,
    /// The same loads, implicit Euler.
    Implicit,
    /// Compliance inside the optimisation.
    Coupled,
}

impl Method {
    /// All, in the order of the table.
    pub const ALL: [Method; 3] = [Method::Printed, Method::Implicit, Method::Coupled];
}

impl fmt::Display for Method {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Method::Printed => "as printed",
            Method::Implicit => "implicit",
            Method::Coupled => "coupled",
        })
    }
}

/// Numbers of the benchmark, SI units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OneDof {
    /// Mass of the sphere, kg.
    pub mass: f64,
    /// Damping ratio of the sphere in contact.
    pub damping_ratio: f64,
    /// Coupling stiffness `k_c`, N/m.
    pub coupling: f64,
    /// Penalty stiffness `k_p`, N/m.
    pub penalty: f64,
    /// Spring `k_s`, N/m.
    pub spring: f64,
    /// Contact prediction's `d`, metres.
    pub contact_distance: f64,
}

impl OneDof {
    /// Table 1's numbers with a spring of `k_s` N/m.
    pub fn with_spring(spring: f64) -> Self {
        Self {
            mass: 0.02,
            damping_ratio: 0.5,
            coupling: 200.0,
            penalty: 5.0,
            spring,
            contact_distance: 5e-4,
        }
    }

    /// `k_s + k_p`, N/m.
    pub fn stiffness(&self) -> f64 {
        self.spring + self.penalty
    }

    /// `b_c`, N s/m.
    pub fn damping(&self) -> f64 {
        2.0 * self.damping_ratio * (self.stiffness() * self.mass).sqrt()
    }

    /// Largest stable time step of the printed method by Eq. 9, seconds.
    pub fn predicted_limit(&self) -> f64 {
        largest_time_step(self.stiffness(), self.damping(), self.mass)
    }

    /// The same, found by running it in lasting contact: to a thousandth, seconds.
    pub fn measured_limit(&self) -> f64 {
        let (mut low, mut high) = (0.25 * self.predicted_limit(), 4.0 * self.predicted_limit());
        while high > 1.001 * low {
            let middle = 0.5 * (low + high);
            if self.grows(middle) {
                high = middle;
            } else {
                low = middle;
            }
        }
        0.5 * (low + high)
    }

    /// Whether an oscillation about the equilibrium grows at steps of `dt`.
    pub fn grows(&self, dt: f64) -> bool {
        // Deep enough that contact is never lost while it is judged.
        let haptic = 1.0;
        let rest = self.penalty * haptic / self.stiffness();
        let mut contact = Contact {
            place: rest * (1.0 - 1e-6),
            velocity: 0.0,
            tool: rest * (1.0 - 1e-6),
        };
        let (mut early, mut late) = (0.0_f64, 0.0_f64);
        for step in 0..20_000 {
            contact.step(self, Method::Printed, haptic, dt);
            let away = (contact.place - rest).abs() / rest;
            if away > 1e-2 {
                return true;
            }
            match step {
                8_000..10_000 => early = early.max(away),
                18_000.. => late = late.max(away),
                _ => {}
            }
        }
        // Rounding keeps a rest of every oscillation alive.
        late > early && late > 1e-12
    }

    /// Runs a contact: from 5 mm off at `speed` m/s to `depth` metres inside, then three seconds' rest.
    pub fn press(&self, method: Method, speed: f64, depth: f64) -> Press {
        let mut contact = Contact {
            place: 0.0,
            velocity: 0.0,
            tool: -5e-3,
        };
        let (mut found, mut last, mut before) = (Press::default(), 0.0, -5e-3);
        let way = ((depth + 5e-3) / speed / TICK_S).ceil() as u32;
        for tick in 0..way + 3000 {
            let haptic = (-5e-3 + speed * TICK_S * f64::from(tick)).min(depth);
            let tissue_force = contact.step(self, method, haptic, TICK_S);
            let force = self.coupling * (haptic - contact.tool);
            let step = (force - last).abs() - self.coupling * (haptic - before).abs();
            found.force_step = found.force_step.max(step);
            found.largest_force = found.largest_force.max(force);
            (last, before) = (force, haptic);
            (found.depth, found.device_force, found.tissue_force) =
                (contact.place, force, tissue_force);
        }
        found
    }
}

/// How a contact went; N, metres.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Press {
    /// Where the sphere is held in the end.
    pub depth: f64,
    /// Force on the hand in the end.
    pub device_force: f64,
    /// Force on the tissue in the end.
    pub tissue_force: f64,
    /// Largest force on the hand.
    pub largest_force: f64,
    /// Largest change of it in a tick beyond `k_c |dx_h|`, as everywhere ([`crate::measure`]).
    pub force_step: f64,
}

/// Sphere and tool between two steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// Surface of the sphere, metres.
    pub place: f64,
    /// Its velocity, m/s.
    pub velocity: f64,
    /// Surface of the graphic tool, metres.
    pub tool: f64,
}

impl Contact {
    /// One step of `dt` seconds with the haptic tool at `haptic` metres; the force on the tissue, newtons.
    pub fn step(&mut self, numbers: &OneDof, method: Method, haptic: f64, dt: f64) -> f64 {
        let (k, b, m) = (numbers.spring, numbers.damping(), numbers.mass);
        let (x, v) = (self.place, self.velocity);
        // Section 4.2: a pair by contact prediction, and the haptic tool in contact with what was.
        let pair = x - self.tool < numbers.contact_distance && haptic > x;
        let penalty = if pair { numbers.penalty } else { 0.0 };
        let force;
        match method {
            Method::Printed => {
                force = penalty * (haptic - self.tool);
                self.velocity = v + dt / m * (force - k * x - b * v);
                self.place = x + dt * v;
                self.tool = haptic.min(self.place);
            }
            Method::Implicit => {
                let lever = m / dt + b + (k + penalty) * dt;
                self.velocity = (m / dt * v + penalty * haptic - (k + penalty) * x) / lever;
                self.place = x + dt * self.velocity;
                self.tool = haptic.min(self.place);
                force = penalty * (haptic - self.place);
            }
            Method::Coupled => {
                let compliance = 1.0 / (m / (dt * dt) + b / dt + k);
                let free = compliance * (m / (dt * dt) * (x + dt * v) + b / dt * x);
                force = ((haptic - free) / (1.0 / numbers.coupling + compliance)).max(0.0);
                self.place = free + compliance * force;
                self.velocity = (self.place - x) / dt;
                self.tool = haptic - force / numbers.coupling;
            }
        }
        force
    }
}

/// Springs of the table, N/m: from a fifth of `k_p` to near the limit at a millisecond.
pub const SPRINGS: [f64; 6] = [1.0, 5.0, 50.0, 500.0, 5000.0, 19_000.0];
/// Speeds of slow and fast contact, m/s.
pub const SPEEDS: [f64; 2] = [0.01, 0.5];
/// How deep the hand goes, metres.
pub const DEPTH: f64 = 0.01;

/// One spring of the table.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// Its numbers.
    pub numbers: OneDof,
    /// Largest stable step as predicted and as measured, seconds.
    pub limits: (f64, f64),
    /// Contacts by method, then by speed.
    pub presses: Vec<(Method, [Press; 2])>,
}

/// The benchmark.
#[derive(Clone, Debug, PartialEq)]
pub struct Table(pub Vec<Row>);

impl Table {
    /// Runs it.
    pub fn run() -> Self {
        Self(
            SPRINGS
                .map(|spring| {
                    let numbers = OneDof::with_spring(spring);
                    let pressed =
                        |method| (method, SPEEDS.map(|v| numbers.press(method, v, DEPTH)));
                    Row {
                        numbers,
                        limits: (numbers.predicted_limit(), numbers.measured_limit()),
                        presses: Method::ALL.map(pressed).to_vec(),
                    }
                })
                .to_vec(),
        )
    }
}

impl fmt::Display for Table {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "1 degree of freedom: m 20 g, damping ratio 0.5, k_c 200 N/m, k_p 5 N/m, hand to 10 mm; force step slow (10 mm/s) | fast (500 mm/s)"
        )?;
        writeln!(
            f,
            "{:>8} {:>22}  {:10} {:>9} {:>9} {:>9} {:>19}",
            "k_s N/m",
            "largest step ms (run)",
            "method",
            "depth mm",
            "device N",
            "tissue N",
            "force step N"
        )?;
        for row in &self.0 {
            for (method, [slow, fast]) in &row.presses {
                writeln!(
                    f,
                    "{:8} {:>11.3} ({:>8.3})  {method:10} {:9.3} {:9.3} {:9.3} {:9.4} | {:7.4}",
                    row.numbers.spring,
                    row.limits.0 * 1e3,
                    row.limits.1 * 1e3,
                    slow.depth * 1e3,
                    slow.device_force,
                    slow.tissue_force,
                    slow.force_step,
                    fast.force_step,
                )?;
            }
        }
        Ok(())
    }
}
