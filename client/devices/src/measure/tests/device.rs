//! Simulated device with known figures: three axes with mass, drag, Coulomb friction, weight, quantisation and latency.

use std::collections::VecDeque;

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use sulcus_core::{Pose, Quat, Vec3};
use sulcus_haptics::HandPort;

/// Known figures of a device.
#[derive(Clone, Debug)]
pub struct Truth {
    pub period_ns: u64,
    /// Latency in periods.
    pub late: usize,
    pub mass: f64,
    pub drag: f64,
    pub friction: f64,
    pub bias: Vec3,
    pub step: f64,
    /// Force at the motor by the force asked for.
    pub gain: f64,
}

/// Impedance of a hand, and its place.
#[derive(Clone, Copy, Debug)]
pub struct Hand {
    pub stiffness: f64,
    pub damping: f64,
    pub mass: f64,
    pub place: Vec3,
}

impl Hand {
    pub fn light(place: Vec3) -> Self {
        Self {
            stiffness: 120.0,
            damping: 1.0,
            mass: 0.01,
            place,
        }
    }

    pub fn firm(place: Vec3) -> Self {
        Self {
            stiffness: 500.0,
            damping: 4.0,
            mass: 0.04,
            place,
        }
    }
}

/// Stiffness and damping of a scale.
const SCALE: (f64, f64) = (4000.0, 15.0);
/// Number of steps of the integration in a period of 1 ms.
const FINE: u64 = 16;

/// Plant alone: what the force does to the handle.
#[derive(Clone, Debug)]
pub struct Plant {
    pub truth: Truth,
    pub x: Vec3,
    pub v: Vec3,
    pub hand: Option<Hand>,
    /// Height of a scale under the tip.
    pub scale: Option<f64>,
}

impl Plant {
    pub fn new(truth: &Truth) -> Self {
        Self {
            truth: truth.clone(),
            x: Vec3::zeros(),
            v: Vec3::zeros(),
            hand: None,
            scale: None,
        }
    }

    /// Moves the handle for `ns` under `force` of the motors.
    pub fn go(&mut self, force: &Vec3, ns: u64) {
        let steps = (FINE * ns / 1_000_000).max(4);
        let dt = ns as f64 * 1e-9 / steps as f64;
        for _ in 0..steps {
            for axis in 0..3 {
                let (x, v) = (self.x[axis], self.v[axis]);
                // The bias is the force that holds the handle: the weight has the other sign.
                let mut sum = force[axis] * self.truth.gain - self.truth.bias[axis];
                sum -= self.truth.drag * v;
                let mut mass = self.truth.mass;
                if let Some(hand) = self.hand {
                    sum += hand.stiffness * (hand.place[axis] - x) - hand.damping * v;
                    mass += hand.mass;
                }
                if axis == 1 {
                    sum += self.on_scale();
                } else if self.scale.is_some() {
                    // The tip sticks to the scale.
                    sum -= 200.0 * v;
                }
                let free = v + dt * sum / mass;
                let held = dt * self.truth.friction / mass;
                let next = if free.abs() <= held {
                    0.0
                } else {
                    free - held * free.signum()
                };
                self.v[axis] = next;
                self.x[axis] += dt * next;
            }
        }
    }

    /// Force of the scale upwards.
    pub fn on_scale(&self) -> f64 {
        let Some(height) = self.scale.filter(|height| self.x.y < *height) else {
            return 0.0;
        };
        ((height - self.x.y) * SCALE.0 - self.v.y * SCALE.1).max(0.0)
    }

    /// Measured position.
    pub fn read(&self) -> Vec3 {
        self.x
            .map(|x| (x / self.truth.step).round() * self.truth.step)
    }
}

/// Device behind a door.
pub struct Simulated {
    pub plant: Plant,
    pub port: HandPort,
    pub now_ns: u64,
    pub buttons: u16,
    pub most_n: f64,
    sent: VecDeque<Vec3>,
}

impl Simulated {
    pub fn new(truth: &Truth, port: HandPort) -> Self {
        Self {
            plant: Plant::new(truth),
            port,
            now_ns: 5_000_000_000,
            buttons: 0,
            most_n: 0.0,
            sent: VecDeque::from(vec![Vec3::zeros(); truth.late]),
        }
    }

    /// Performs a period.
    pub fn period(&mut self) {
        self.now_ns += self.plant.truth.period_ns;
        let pose = Pose::new(self.plant.read(), Quat::identity());
        let force = self
            .port
            .exchange(self.now_ns, Ok(&pose), self.buttons)
            .force;
        self.most_n = self.most_n.max(force.norm());
        self.sent.push_back(force);
        let acting = self.sent.pop_front().expect("a force");
        self.plant.go(&acting, self.plant.truth.period_ns);
    }
}

/// Device of a seed.
pub fn truth(seed: u64) -> Truth {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut unit = || (rng.next_u64() >> 11) as f64 / (1_u64 << 53) as f64;
    let period_ns = [1_000_000, 1_000_000, 1_000_000, 500_000, 250_000][(unit() * 5.0) as usize];
    Truth {
        period_ns,
        late: (unit() * 6.99) as usize,
        mass: 0.04 + 0.2 * unit(),
        drag: 1.0 + 4.0 * unit(),
        friction: 0.015 + 0.1 * unit(),
        bias: Vec3::new(0.1 * unit() - 0.05, 0.25 * unit(), 0.1 * unit() - 0.05),
        step: 0.005e-3 * (12.0_f64).powf(unit()),
        gain: 1.0,
    }
}

/// Largest stable stiffness of the device in `hand`, N/m, by bisection.
///
/// The loop reads a position, and the motors act on it one period of the loop and the latency later. A stiffness is
/// stable if the force is quiet between 0.5 and 1.5 s after a push.
pub fn stiffest(truth: &Truth, hand: &Hand) -> f64 {
    // Above the first stiffness that shakes, friction may hold some again: the bracket comes from below.
    let mut high: f64 = 20.0;
    while high < 8000.0 && !shakes(truth, hand, high) {
        high *= 1.1;
    }
    let mut low = high / 1.1;
    while high / low > 1.02 {
        let middle = (low * high).sqrt();
        if shakes(truth, hand, middle) {
            high = middle;
        } else {
            low = middle;
        }
    }
    low
}

fn shakes(truth: &Truth, hand: &Hand, stiffness: f64) -> bool {
    const LOAD: f64 = 0.4;
    let mut plant = Plant::new(truth);
    let lift = (truth.bias.y - LOAD) / hand.stiffness;
    plant.hand = Some(Hand {
        place: Vec3::new(0.0, lift, 0.0),
        ..*hand
    });
    let floor = LOAD / stiffness;
    let per_loop = 1_000_000 / truth.period_ns;
    let mut queue = VecDeque::from(vec![LOAD; truth.late]);
    let (mut wanted, mut shown, mut sum, mut square) = (LOAD, LOAD, 0.0, 0.0);
    for ms in 0..1500 {
        let mut seen = 0.0;
        for _ in 0..per_loop {
            seen = ((floor - plant.read().y) * stiffness).clamp(0.0, 1.0);
            // The door lets 0.5 N pass in a millisecond.
            let change = 0.5 * truth.period_ns as f64 * 1e-6;
            shown += (wanted - shown).clamp(-change, change);
            queue.push_back(shown);
            let force = queue.pop_front().expect("a force");
            plant.go(&Vec3::new(0.0, force, 0.0), truth.period_ns);
        }
        // The loop reads the newest sample after the last period, and the next period takes its order.
        wanted = match ms {
            0..15 => 1.0,
            15..30 => 0.0,
            _ => seen,
        };
        if ms >= 500 {
            sum += seen;
            square += seen * seen;
        }
    }
    let mean = sum / 1000.0;
    (square / 1000.0 - mean * mean).sqrt() > 0.05
}
