//! Guide of a pivot calibration: collects poses of a handle that stands still with its tip in the dimple.

use sulcus_core::math::{exp_rotation, log_rotation, norm};
use sulcus_core::{Pose, Vec3};

use super::pivot::{LEAST_POSES, Pivot, PivotError, pivot};

/// Number of samples over which a handle must stand still, 0.3 s at 1 kHz.
const STILL: usize = 300;
/// Largest motion of a handle that stands still, metres.
const STILL_M: f64 = 3e-4;
/// Largest turn of a handle that stands still, radians.
const STILL_RAD: f64 = 0.01;
/// Least turn between two poses, radians: 20 degrees.
const APART_RAD: f64 = 0.35;

/// Hint for the person.
#[derive(Clone, Debug, PartialEq)]
pub enum Hint {
    /// Turn the handle away from the poses taken so far, with the tip in the dimple.
    Turn,
    /// Hold the handle still.
    Still,
    /// A pose was taken: its number, from 1.
    Taken(usize),
}

/// Collection of poses. A pose is the mean over the time in which the handle stood still.
#[derive(Clone, Debug, Default)]
pub struct Guide {
    poses: Vec<Pose>,
    /// Pose at which the handle came to rest.
    rest: Option<Pose>,
    /// Sums over the rest: motion and turn from [`Guide::rest`], and their number.
    sums: (Vec3, Vec3, usize),
}

impl Guide {
    /// Creates a guide without a pose.
    pub fn new() -> Self {
        Self::default()
    }

    /// Accounts for a sample of the handle, `base_from_gimbal`.
    pub fn step(&mut self, pose: &Pose) -> Hint {
        let rest = *self.rest.get_or_insert(*pose);
        let way = pose.position - rest.position;
        let turn = log_rotation(&(pose.orientation * rest.orientation.inverse()));
        // In this form a NaN moves.
        let is_still = norm(&way) <= STILL_M && norm(&turn) <= STILL_RAD;
        if !is_still {
            self.rest = None;
            self.sums = (Vec3::zeros(), Vec3::zeros(), 0);
            return Hint::Still;
        }
        if !self.is_apart(pose) {
            return Hint::Turn;
        }
        let (ways, turns, count) = &mut self.sums;
        *ways += way;
        *turns += turn;
        *count += 1;
        if *count < STILL {
            return Hint::Still;
        }
        let share = 1.0 / *count as f64;
        self.poses.push(Pose::new(
            rest.position + *ways * share,
            exp_rotation(&(*turns * share)) * rest.orientation,
        ));
        self.sums = (Vec3::zeros(), Vec3::zeros(), 0);
        Hint::Taken(self.poses.len())
    }

    /// Poses so far.
    pub fn poses(&self) -> &[Pose] {
        &self.poses
    }

    /// Whether the number of poses is enough for a calibration.
    pub fn is_enough(&self) -> bool {
        self.poses.len() >= LEAST_POSES
    }

    /// Computes the tip. After an error the pose to repeat is removed, and the next one takes its place.
    ///
    /// # Errors
    /// That of [`pivot`].
    pub fn finish(&mut self) -> Result<Pivot, PivotError> {
        let result = pivot(&self.poses);
        if let Err(PivotError::Moved { number, .. } | PivotError::NotFinite { number }) = &result {
            self.poses.remove(number - 1);
        }
        result
    }

    fn is_apart(&self, pose: &Pose) -> bool {
        self.poses.iter().all(|taken| {
            norm(&log_rotation(
                &(pose.orientation * taken.orientation.inverse()),
            )) >= APART_RAD
        })
    }
}
