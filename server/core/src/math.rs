//! Fixed-size vectors, rotations and wrenches with bit-identical results on every build.
//!
//! Below the API only `+ - * /`, IEEE square root and `libm` are used. Excluded are the platform's `sin`, fused
//! multiply-add, and `f64::max`, whose treatment of `-0.0` differs between debug and release.

use serde::{Deserialize, Serialize};

/// Three-vector; the unit (metres, newtons) follows from the name.
pub type Vec3 = nalgebra::Vector3<f64>;
/// 3x3 matrix; the unit follows from the name.
pub type Mat3 = nalgebra::Matrix3<f64>;
/// Unit quaternion: a rotation.
pub type Quat = nalgebra::UnitQuaternion<f64>;

/// Returns the larger of two numbers; the first when they compare equal or either is NaN.
#[inline]
pub fn fmax(a: f64, b: f64) -> f64 {
    if b > a { b } else { a }
}

/// Returns the smaller of two numbers; the first when they compare equal or either is NaN.
#[inline]
pub fn fmin(a: f64, b: f64) -> f64 {
    if b < a { b } else { a }
}

/// Returns `x` clamped to `[low, high]`; NaN stays NaN.
#[inline]
pub fn fclamp(x: f64, low: f64, high: f64) -> f64 {
    fmin(fmax(x, low), high)
}

/// Returns the Euclidean length of `v`, in the unit of `v`. Uses only the IEEE square root, so the bits are the same on
/// every platform.
#[inline]
pub fn norm(v: &Vec3) -> f64 {
    v.dot(v).sqrt()
}

/// Rigid transform `a_from_b`: rotation, then translation.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Pose {
    /// Position of b's origin in a, metres.
    pub position: Vec3,
    /// Rotation of b's axes into a.
    pub orientation: Quat,
}

impl Pose {
    /// Returns the identity transform.
    pub fn identity() -> Self {
        Self {
            position: Vec3::zeros(),
            orientation: Quat::identity(),
        }
    }

    /// Creates a pose from position and orientation.
    pub fn new(position: Vec3, orientation: Quat) -> Self {
        Self {
            position,
            orientation,
        }
    }

    /// Transforms a point from b to a.
    #[inline]
    pub fn transform(&self, point: &Vec3) -> Vec3 {
        self.position + self.orientation * point
    }

    /// Transforms a point from a to b.
    #[inline]
    pub fn inverse_transform(&self, point: &Vec3) -> Vec3 {
        self.orientation.inverse() * (point - self.position)
    }
}

/// Force and torque about a given point, both in given axes: world unless stated otherwise.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Wrench {
    /// Force, newtons.
    pub force: Vec3,
    /// Torque, newton-metres.
    pub torque: Vec3,
}

impl Wrench {
    /// Zero force and torque.
    pub const ZERO: Wrench = Wrench {
        force: Vec3::new(0.0, 0.0, 0.0),
        torque: Vec3::new(0.0, 0.0, 0.0),
    };

    /// Returns the same load about another point: `lever = old_point - new_point`, metres, in the axes of the wrench.
    #[inline]
    pub fn moved(&self, lever: &Vec3) -> Wrench {
        Wrench {
            force: self.force,
            torque: self.torque + lever.cross(&self.force),
        }
    }
}

/// Smallest argument of [`exp_of_loss`], and smallest argument that [`exp_of_libm`] computes itself.
const MOST_LOSS: f64 = -700.0;

/// Returns `exp(x)` for `x` in `[-700, 0]`, with a relative error of at most 4e-16; `x` outside is clamped.
///
/// The code has no branch and no division, so that several calls run in parallel, unlike `libm::exp`. The method is
/// Cody and Waite's reduction by ln 2, then Taylor's series up to half of ln 2. Its remainder is under 5e-18.
#[inline]
pub fn exp_of_loss(x: f64) -> f64 {
    // Adding this number leaves the nearest integer in the lowest bits.
    const INTEGER: f64 = 6_755_399_441_055_744.0;
    // The upper part ends in zeros: its product with an integer of up to 11 bits is exact.
    const LN_2_UPPER: f64 = 0.693_147_180_369_123_8;
    const LN_2_LOWER: f64 = 1.908_214_929_270_587_7e-10;
    // 1 / k! for k from 13 down.
    const SERIES: [f64; 14] = [
        1.0 / 6_227_020_800.0,
        1.0 / 479_001_600.0,
        1.0 / 39_916_800.0,
        1.0 / 3_628_800.0,
        1.0 / 362_880.0,
        1.0 / 40_320.0,
        1.0 / 5_040.0,
        1.0 / 720.0,
        1.0 / 120.0,
        1.0 / 24.0,
        1.0 / 6.0,
        0.5,
        1.0,
        1.0,
    ];
    let x = fclamp(x, MOST_LOSS, 0.0);
    let shifted = x * std::f64::consts::LOG2_E + INTEGER;
    let power = shifted - INTEGER;
    let rest = (x - power * LN_2_UPPER) - power * LN_2_LOWER;
    let value = SERIES[1..]
        .iter()
        .fold(SERIES[0], |sum, next| sum * rest + next);
    // Multiply by 2^power.
    f64::from_bits(value.to_bits().wrapping_add(shifted.to_bits() << 52))
}

/// Returns `exp(x)` with the bits of `libm::exp`.
///
/// For `x` in `[-700, 0]` the sums are those of libm (FreeBSD's `e_exp.c`), with selections instead of branches.
/// Successive values overlap in the processor, which halves the time for a large matrix.
#[inline]
pub fn exp_of_libm(x: f64) -> f64 {
    // Adding this number leaves the nearest integer in the lowest bits.
    const INTEGER: f64 = 6_755_399_441_055_744.0;
    const LN_2_UPPER: f64 = 0.693_147_180_369_123_8;
    const LN_2_LOWER: f64 = 1.908_214_929_270_587_7e-10;
    // Largest magnitudes with the high words 0x3fd62e42 (half of ln 2) and 0x3e300000 (2^-28): libm compares high
    // words.
    const HALF_LN_2: f64 = f64::from_bits(0x3fd6_2e42_ffff_ffff);
    const TINY: f64 = f64::from_bits(0x3e30_0000_ffff_ffff);
    const P: [f64; 5] = [
        f64::from_bits(0x3fc5_5555_5555_553e),
        f64::from_bits(0xbf66_c16c_16be_bd93),
        f64::from_bits(0x3f11_566a_af25_de2c),
        f64::from_bits(0xbebb_bd41_c5d2_6bf1),
        f64::from_bits(0x3e66_3769_72be_a4d0),
    ];
    if !(MOST_LOSS..=0.0).contains(&x) {
        return libm::exp(x);
    }
    // Power of two: `x / ln 2 - 1/2`, truncated towards zero.
    let wanted = x * std::f64::consts::LOG2_E - 0.5;
    let nearest = (wanted + INTEGER) - INTEGER;
    let cut = nearest + if nearest < wanted { 1.0 } else { 0.0 };
    let power = if x < -HALF_LN_2 { cut } else { 0.0 };
    let upper = x - power * LN_2_UPPER;
    let lower = power * LN_2_LOWER;
    let r = upper - lower;
    let rr = r * r;
    let c = r - rr * (P[0] + rr * (P[1] + rr * (P[2] + rr * (P[3] + rr * P[4]))));
    let value = 1.0 + (r * c / (2.0 - c) - lower + upper);
    let value = if x < -TINY { value } else { 1.0 + x };
    let shifted = power + INTEGER;
    f64::from_bits(value.to_bits().wrapping_add(shifted.to_bits() << 52))
}

/// Returns the rotation by the rotation vector `w` (axis times angle, radians).
pub fn exp_rotation(w: &Vec3) -> Quat {
    let angle_squared = w.dot(w);
    // Below 1e-4 rad the series is exact to double precision and has no 0/0.
    let (scalar, scale) = if angle_squared < 1e-8 {
        (
            1.0 - angle_squared * 0.125,
            0.5 - angle_squared * (1.0 / 48.0),
        )
    } else {
        let angle = angle_squared.sqrt();
        (libm::cos(0.5 * angle), libm::sin(0.5 * angle) / angle)
    };
    normalised(scalar, w.x * scale, w.y * scale, w.z * scale)
}

/// Returns the rotation vector of `q` (axis times angle, radians), with the angle in `[0, pi]`.
pub fn log_rotation(q: &Quat) -> Vec3 {
    // q and -q are the same rotation; use the shorter one.
    let sign = if q.w < 0.0 { -1.0 } else { 1.0 };
    let vector = Vec3::new(q.i * sign, q.j * sign, q.k * sign);
    let scalar = q.w * sign;
    let sine = norm(&vector);
    if sine < 1e-10 {
        return vector * 2.0;
    }
    vector * (2.0 * libm::atan2(sine, scalar) / sine)
}

/// Returns the quaternion `w + xi + yj + zk` of the four numbers, scaled to unit length. The numbers must be
/// approximately of unit length.
pub fn normalised(w: f64, i: f64, j: f64, k: f64) -> Quat {
    let inverse = 1.0 / (w * w + i * i + j * j + k * k).sqrt();
    Quat::new_unchecked(nalgebra::Quaternion::new(
        w * inverse,
        i * inverse,
        j * inverse,
        k * inverse,
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_exponential_of_a_loss_is_that_of_libm_to_the_last_digits() {
        let mut worst = 0.0;
        for k in 0..=2_000_000 {
            let t = f64::from(k) / 2e6;
            // Dense about zero, and up to the limit.
            for x in [-t, -30.0 * t * t, -700.0 * t] {
                let (found, wanted) = (exp_of_loss(x), libm::exp(x));
                worst = fmax(worst, (found / wanted - 1.0).abs());
            }
        }
        assert!(worst <= 4e-16, "{worst:e}");
        assert_eq!(exp_of_loss(0.0), 1.0);
        assert_eq!(exp_of_loss(-0.0), 1.0);
        assert_eq!(exp_of_loss(3.0), 1.0);
        assert_eq!(exp_of_loss(f64::NEG_INFINITY), exp_of_loss(-700.0));
        assert!(exp_of_loss(-700.0) > 0.0);
    }

    #[test]
    fn the_exponential_of_libm_without_branches_is_libms_to_the_last_bit() {
        let same = |x: f64| assert_eq!(exp_of_libm(x).to_bits(), libm::exp(x).to_bits(), "{x:e}");
        for k in 0..=1_000_000 {
            let t = f64::from(k) / 1e6;
            for x in [-t, -2.1 * t * t, -30.0 * t * t, -700.0 * t, -1e-7 * t] {
                same(x);
            }
        }
        // Arguments at which libm changes its sums, and at which the power of two changes.
        let ln_2 = std::f64::consts::LN_2;
        let edges = (1..2000)
            .map(|n| 0.5 * f64::from(n) * ln_2)
            .take_while(|x| *x < 700.0);
        let words =
            [0x3fd6_2e42_u64, 0x3ff0_a2b2, 0x3e30_0000].map(|word| f64::from_bits(word << 32));
        for edge in edges
            .chain(words)
            .chain(words.map(|x| f64::from_bits(x.to_bits() + (1 << 32))))
        {
            for step in 0..2000 {
                same(-f64::from_bits(edge.to_bits() + step - 1000));
            }
        }
        for x in [
            0.0,
            -0.0,
            -f64::MIN_POSITIVE,
            -1e-300,
            -700.0,
            -720.0,
            -1e9,
            1.0,
            f64::NAN,
        ] {
            same(x);
        }
    }

    #[test]
    fn log_undoes_exp_below_pi() {
        for scale in [1e-12, 1e-6, 9.9e-5, 1.1e-4, 0.3, 1.5, 3.1] {
            let w = Vec3::new(0.3, -0.8, 0.52).normalize() * scale;
            let back = log_rotation(&exp_rotation(&w));
            assert!(
                norm(&(back - w)) < 1e-14 + 1e-12 * scale,
                "{scale}: {back:?}"
            );
        }
    }

    #[test]
    fn exp_is_the_rotation_that_rodrigues_names() {
        let axis = Vec3::new(1.0, 2.0, -0.5).normalize();
        let (angle, p) = (0.7, Vec3::new(0.2, -0.4, 0.9));
        let rodrigues = p * libm::cos(angle)
            + axis.cross(&p) * libm::sin(angle)
            + axis * (axis.dot(&p) * (1.0 - libm::cos(angle)));
        assert!(norm(&(exp_rotation(&(axis * angle)) * p - rodrigues)) < 1e-15);
    }

    #[test]
    fn a_wrench_moved_there_and_back_is_the_same_load() {
        let w = Wrench {
            force: Vec3::new(1.0, 2.0, 3.0),
            torque: Vec3::new(0.1, 0.0, -0.2),
        };
        let lever = Vec3::new(0.01, -0.02, 0.09);
        let back = w.moved(&lever).moved(&-lever);
        assert!(norm(&(back.torque - w.torque)) < 1e-15);
    }
}
