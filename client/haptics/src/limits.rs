//! Limits of the wrench at the hand, as the server's hello states them.

use sulcus_core::math::{fmax, norm};
use sulcus_core::{Params, Vec3, Wrench};

/// Largest wrench that the server sends; limits of the magnitudes of force and torque.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Force, newtons.
    pub force_n: f64,
    /// Torque, newton-metres.
    pub torque_nm: f64,
}

/// Largest change of the displayed wrench per millisecond.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SlewLimits {
    /// Change of the force, newtons per millisecond.
    pub force_n_per_ms: f64,
    /// Change of the torque, newton-metres per millisecond.
    pub torque_nm_per_ms: f64,
}

impl From<&Params> for SlewLimits {
    fn from(params: &Params) -> Self {
        Self {
            force_n_per_ms: params.max_force_step,
            torque_nm_per_ms: params.max_torque_step,
        }
    }
}

/// Returns `sent`, clamped to `limits`, times `gate` (0 to 1). Returns zero if any component of the result is not
/// finite.
pub fn gated(sent: &Wrench, gate: f64, limits: &Limits) -> Wrench {
    let wrench = Wrench {
        force: clamped(&sent.force, limits.force_n) * gate,
        torque: clamped(&sent.torque, limits.torque_nm) * gate,
    };
    let finite = |v: &Vec3| v.iter().all(|x| x.is_finite());
    if finite(&wrench.force) && finite(&wrench.torque) {
        wrench
    } else {
        Wrench::ZERO
    }
}

/// Returns `v` with its length clamped to `most`, the direction unchanged. A limit that is negative or not a number
/// lets no force pass.
fn clamped(v: &Vec3, most: f64) -> Vec3 {
    let length = norm(v);
    // In this form a NaN is no limit to be within.
    if length <= most {
        *v
    } else {
        v * (fmax(most, 0.0) / length)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LIMITS: Limits = Limits {
        force_n: 3.0,
        torque_nm: 0.2,
    };

    fn sent(force: [f64; 3], torque: [f64; 3]) -> Wrench {
        Wrench {
            force: Vec3::from(force),
            torque: Vec3::from(torque),
        }
    }

    #[test]
    fn a_server_that_sends_a_meganewton_is_felt_at_its_own_limit() {
        let wrench = gated(&sent([0.0, -1e6, 0.0], [1e6, 0.0, 0.0]), 1.0, &LIMITS);
        assert!(norm(&(wrench.force - Vec3::new(0.0, -3.0, 0.0))) < 1e-12);
        assert!(norm(&(wrench.torque - Vec3::new(0.2, 0.0, 0.0))) < 1e-12);
        // The gate scales the clamped force, not the sent force.
        let half = gated(&sent([0.0, -1e6, 0.0], [0.0; 3]), 0.5, &LIMITS);
        assert!(norm(&(half.force - Vec3::new(0.0, -1.5, 0.0))) < 1e-12);
        // Values within the limits stay unchanged. Values that are not finite become zero.
        let plain = gated(&sent([1.0, 2.0, -2.0], [0.0, 0.125, 0.0]), 1.0, &LIMITS);
        assert_eq!(plain.force, Vec3::new(1.0, 2.0, -2.0));
        assert_eq!(plain.torque, Vec3::new(0.0, 0.125, 0.0));
        for bad in [f64::INFINITY, f64::NEG_INFINITY, f64::NAN] {
            for at in 0..6 {
                let mut all = [0.1; 6];
                all[at] = bad;
                let [a, b, c, d, e, f] = all;
                assert_eq!(
                    gated(&sent([a, b, c], [d, e, f]), 1.0, &LIMITS),
                    Wrench::ZERO
                );
            }
        }
    }
}
