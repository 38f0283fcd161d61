//! Figures of the closed loop of a hand and a device: those of the model file, their variation, and those that neither
//! the model file nor `notes/devices.md` holds.

use sulcus_haptics::DeviceModel;

/// Figure that no model file holds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Assumed {
    /// Name of the figure.
    pub name: &'static str,
    /// Value in `unit`.
    pub value: f64,
    /// Unit of the value.
    pub unit: &'static str,
    /// Trust in the value: `guess` where no source states it.
    pub source: &'static str,
    /// Origin of the value.
    pub from: &'static str,
}

const fn guess(name: &'static str, value: f64, unit: &'static str, from: &'static str) -> Assumed {
    Assumed {
        name,
        value,
        unit,
        source: "guess",
        from,
    }
}

/// Moment of inertia of the handle about the gimbal.
pub const INERTIA: Assumed = guess(
    "moment of inertia of the handle",
    2e-5,
    "kg m2",
    "rod of 20 g and 110 mm about its end, rounded down: a light handle swings first",
);
/// Viscous damping of the gimbal of a device without torque axes.
pub const SPIN_DAMPING: Assumed = guess(
    "damping of the gimbal without motors",
    2e-4,
    "N m s/rad",
    "a twentieth of the Premium 6DOF's figure: bearings without motors",
);
/// Coulomb friction of the gimbal.
pub const SPIN_FRICTION: Assumed = guess(
    "friction of the gimbal",
    1e-3,
    "N m",
    "chosen here without a measurement: 0.02 N at 50 mm",
);
/// Smallest measured rotation of the handle.
pub const SPIN_RESOLUTION: Assumed = guess(
    "resolution of the rotation",
    5e-4,
    "rad",
    "one part in 12 600 of a turn, chosen here without a measurement",
);
/// Stiffness of a light grip.
pub const LIGHT_GRIP: Assumed = guess(
    "stiffness of a light grip",
    100.0,
    "N/m",
    "a third of the simulated operator's grip",
);
/// Damping of a light grip.
pub const LIGHT_GRIP_DAMPING: Assumed = guess(
    "damping of a light grip",
    1.0,
    "N s/m",
    "a quarter of the simulated operator's grip",
);
/// Stiffness of a firm grip.
pub const FIRM_GRIP: Assumed = guess(
    "stiffness of a firm grip",
    900.0,
    "N/m",
    "three times the simulated operator's grip",
);
/// Damping of a firm grip.
pub const FIRM_GRIP_DAMPING: Assumed = guess(
    "damping of a firm grip",
    8.0,
    "N s/m",
    "twice the simulated operator's grip",
);
/// Lever that turns a grip in translation into a grip in rotation.
pub const GRIP_LEVER: Assumed = guess(
    "lever of the grip in rotation",
    0.04,
    "m",
    "lever of the passivity controller: half of the distance between the fingers and the rest of the handle",
);

/// All figures that no model file holds.
pub const ASSUMED: [Assumed; 9] = [
    INERTIA,
    SPIN_DAMPING,
    SPIN_FRICTION,
    SPIN_RESOLUTION,
    LIGHT_GRIP,
    LIGHT_GRIP_DAMPING,
    FIRM_GRIP,
    FIRM_GRIP_DAMPING,
    GRIP_LEVER,
];

/// Grip of the hand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Grip {
    /// Two fingers hold the handle loosely.
    Light,
    /// The whole hand holds the handle.
    Firm,
}

impl Grip {
    /// Stiffness, N/m, and damping, N s/m.
    fn of(self) -> (f64, f64) {
        match self {
            Self::Light => (LIGHT_GRIP.value, LIGHT_GRIP_DAMPING.value),
            Self::Firm => (FIRM_GRIP.value, FIRM_GRIP_DAMPING.value),
        }
    }
}

/// Share by which a figure of the model file is wrong.
pub const SPREAD: f64 = 0.3;

/// Factors of the figures of the model file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Variation {
    /// Factor of the apparent mass and of the moment of inertia.
    pub mass: f64,
    /// Factor of the viscous damping.
    pub damping: f64,
    /// Factor of the latency of the driver.
    pub latency: f64,
    /// Factor of the Coulomb friction.
    pub friction: f64,
}

impl Variation {
    /// Figures as in the model file.
    pub const NOMINAL: Self = Self {
        mass: 1.0,
        damping: 1.0,
        latency: 1.0,
        friction: 1.0,
    };
    /// Worst corner by the formula of the coupling: a light, slow device without damping and friction.
    pub const WORST: Self = Self::corner(0b0100);
    /// Number of corners.
    pub const CORNERS: u32 = 16;

    /// Corner of the four figures: bits 0 to 3 raise mass, damping, latency and friction by [`SPREAD`], a cleared bit
    /// lowers the figure.
    pub const fn corner(bits: u32) -> Self {
        const fn factor(bits: u32, at: u32) -> f64 {
            if bits >> at & 1 == 1 {
                1.0 + SPREAD
            } else {
                1.0 - SPREAD
            }
        }
        Self {
            mass: factor(bits, 0),
            damping: factor(bits, 1),
            latency: factor(bits, 2),
            friction: factor(bits, 3),
        }
    }
}

/// Dynamics of a device in a hand, SI units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dynamics {
    /// Period of the device, s.
    pub period_s: f64,
    /// Latency of the driver, s.
    pub latency_s: f64,
    /// Apparent mass, kg.
    pub mass: f64,
    /// Moment of inertia about the gimbal, kg m2.
    pub inertia: f64,
    /// Viscous damping, N s/m.
    pub damping: f64,
    /// Viscous damping in rotation, N m s/rad.
    pub spin_damping: f64,
    /// Coulomb friction, N.
    pub friction: f64,
    /// Coulomb friction in rotation, N m.
    pub spin_friction: f64,
    /// Smallest measured step, m.
    pub resolution: f64,
    /// Smallest measured rotation, rad.
    pub spin_resolution: f64,
    /// Stiffness of the grip, N/m.
    pub grip: f64,
    /// Damping of the grip, N s/m.
    pub grip_damping: f64,
}

impl Dynamics {
    /// Dynamics of a device of `model` with other figures by `variation`, held by `grip`.
    pub fn of(model: &DeviceModel, variation: &Variation, grip: Grip) -> Self {
        let (grip, grip_damping) = grip.of();
        let turning = model.turning_damping_nm_s_per_rad.as_ref();
        let spin_damping = turning.map_or(SPIN_DAMPING.value, |figure| figure.value);
        Self {
            period_s: 1.0 / model.rate_hz.value,
            latency_s: model.latency_ms.value * 1e-3 * variation.latency,
            mass: model.mass_g.value * 1e-3 * variation.mass,
            inertia: INERTIA.value * variation.mass,
            damping: model.damping_n_s_per_m.value * variation.damping,
            spin_damping: spin_damping * variation.damping,
            friction: model.friction_n.value * variation.friction,
            spin_friction: SPIN_FRICTION.value * variation.friction,
            resolution: model.resolution_mm.value * 1e-3,
            spin_resolution: SPIN_RESOLUTION.value,
            grip,
            grip_damping,
        }
    }
}
