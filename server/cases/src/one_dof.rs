//! The paper's benchmark with one degree of freedom (sections 4.4 and 8.1, Fig. 7, Table 1): a sphere on a spring, and
//! a tool that presses it along the same line.
//!
//! Three methods compute the same numbers:
//! - *as printed*: explicit Euler under a penalty load, Eq. 5, then the tool against the moved sphere
//! - *implicit*: the same loads with implicit Euler, which shows the effect of the integrator alone
//! - *coupled*: compliance inside the optimisation, the default of [`sulcus_core`]
//!
//! All positions are those of surfaces: 0 is the sphere's surface at rest, positive is inward. The paper's text does
//! not give `k_s`, so the table has several values.

use std::fmt;

/// Length of a tick in the paper, seconds.
const TICK_S: f64 = 1e-3;
use sulcus_core::tissue::printed::stability::largest_time_step;

/// Method of the computation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// The printed method: explicit Euler under the penalty load, then the tool.
    Printed,
    /// The printed loads with implicit Euler.
    Implicit,
    /// Compliance inside the optimisation.
    Coupled,
}

impl Method {
    /// All methods, in the order of the table.
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

/// Parameters of the benchmark, SI units.
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
    /// Distance `d` of the contact prediction, metres.
    pub contact_distance: f64,
}

impl OneDof {
    /// Parameters of Table 1 with a spring `k_s` of `spring` N/m.
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

    /// Stiffness in contact, `k_s + k_p`, N/m.
    pub fn stiffness(&self) -> f64 {
        self.spring + self.penalty
    }

    /// Damping in contact, `b_c`, N s/m.
    pub fn damping(&self) -> f64 {
        2.0 * self.damping_ratio * (self.stiffness() * self.mass).sqrt()
    }

    /// Largest stable time step of the printed method by Eq. 9, seconds.
    pub fn predicted_limit(&self) -> f64 {
        largest_time_step(self.stiffness(), self.damping(), self.mass)
    }

    /// Largest stable time step of the printed method in permanent contact, measured to a thousandth, seconds.
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

    /// Whether an oscillation of the printed method about the equilibrium grows at steps of `dt` seconds.
    pub fn grows(&self, dt: f64) -> bool {
        // The depth excludes a loss of contact.
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
        // Rounding keeps a small oscillation in every run.
        late > early && late > 1e-12
    }

    /// Runs a contact: the haptic tool moves from 5 mm outside to `depth` metres inside at `speed` m/s, then rests for
    /// three seconds.
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

/// Result of a contact.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Press {
    /// Position of the sphere's surface at the end, metres.
    pub depth: f64,
    /// Force on the hand at the end, newtons.
    pub device_force: f64,
    /// Force on the tissue at the end, newtons.
    pub tissue_force: f64,
    /// Largest force on the hand, newtons.
    pub largest_force: f64,
    /// Largest change of the hand's force in a tick beyond `k_c |dx_h|`, newtons, as in [`crate::measure`].
    pub force_step: f64,
}

/// State of sphere and tool between two steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// Position of the sphere's surface, metres.
    pub place: f64,
    /// Velocity of the sphere, m/s.
    pub velocity: f64,
    /// Position of the graphic tool's surface, metres.
    pub tool: f64,
}

impl Contact {
    /// Advances by `dt` seconds with the haptic tool at `haptic` metres. Returns the force on the tissue, newtons.
    pub fn step(&mut self, numbers: &OneDof, method: Method, haptic: f64, dt: f64) -> f64 {
        let (k, b, m) = (numbers.spring, numbers.damping(), numbers.mass);
        let (x, v) = (self.place, self.velocity);
        // Section 4.2: a pair needs the contact prediction, and the haptic tool inside the sphere of the last step.
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

/// Springs of the table, N/m: from a fifth of `k_p` to near the stability limit at a step of a millisecond.
pub const SPRINGS: [f64; 6] = [1.0, 5.0, 50.0, 500.0, 5000.0, 19_000.0];
/// Speeds of slow and fast contact, m/s.
pub const SPEEDS: [f64; 2] = [0.01, 0.5];
/// Depth of the hand, metres.
pub const DEPTH: f64 = 0.01;

/// Results for one spring of the table.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// Parameters with this spring.
    pub numbers: OneDof,
    /// Largest stable step, predicted and measured, seconds.
    pub limits: (f64, f64),
    /// Contacts by method, then by speed in the order of [`SPEEDS`].
    pub presses: Vec<(Method, [Press; 2])>,
}

/// Results of the benchmark.
#[derive(Clone, Debug, PartialEq)]
pub struct Table(pub Vec<Row>);

impl Table {
    /// Runs the benchmark.
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
