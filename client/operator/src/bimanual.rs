//! The `bimanual` exercise: the mirror holds the tongue aside at the probed tooth while the probe makes its tour.
//!
//! The probe waits until the tongue is held. Before the tour continues on the other side of the mouth, the probe waits
//! outside the pocket until the mirror has changed sides. Both handles leave the mouth at the front, the mirror's over
//! the tongue and the probe's over the teeth of its side.

use sulcus_core::{MAX_TOOLS, Pose, Scene, Vec3};

use crate::pocket_path::NoPocket;
use crate::retraction::{NoTongue, Retraction, RetractionParams};
use crate::script::{Call, Felt, Script};
use crate::tour::Tour;
use crate::tour_params::{TourParams, Visit};
use crate::travel::Travel;

/// Error of a scene without a part of the exercise.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NoExercise {
    /// The part of the probe.
    #[error(transparent)]
    Pocket(#[from] NoPocket),
    /// The part of the mirror.
    #[error(transparent)]
    Tongue(#[from] NoTongue),
}

/// Script of the `bimanual` exercise.
#[derive(Clone, Debug)]
pub struct Bimanual {
    tour: Tour,
    /// Script of the mirror for each side in the order of the tour.
    mirrors: Vec<(Side, Retraction)>,
    /// Index of the present side.
    turn: usize,
    /// Path of the mirror from one side to the other, while it changes sides.
    passage: Option<Travel>,
    /// Share of the tour after which the mirror lets the tongue go; 1: at the end.
    until: f64,
    /// Time at which both hands are out of the mouth, seconds.
    ends: f64,
    time: f64,
    /// Length of a tick, seconds.
    dt: f64,
}

/// Side of the mouth.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Side {
    Left,
    Right,
}

impl Side {
    fn of(fdi: u8) -> Self {
        if matches!(fdi / 10, 2 | 3) {
            Side::Left
        } else {
            Side::Right
        }
    }
}

impl Bimanual {
    /// Script for `tour` with the tongue held for the share `until` of the tour, 0 to 1.
    ///
    /// # Errors
    /// The scene lacks a tooth of the tour, its gingiva, a tongue or a mirror.
    pub fn new(
        scene: &Scene,
        tour: &[Visit],
        params: TourParams,
        mirror: RetractionParams,
        until: f64,
    ) -> Result<Self, NoExercise> {
        let probe = Tour::new(scene, tour, params)?;
        let tour_ends = params.duration;
        let same = |a: &Visit, b: &Visit| Side::of(a.tooth) == Side::of(b.tooth);
        let mirrors = tour.chunk_by(same).map(|visits| {
            let origins = visits
                .iter()
                .filter_map(|visit| probe.origin_of(visit.tooth));
            let middle = origins.clone().sum::<Vec3>() / origins.count().max(1) as f64;
            let params = RetractionParams {
                duration: f64::INFINITY,
                hold: f64::INFINITY,
                times: 1,
                work: Some(middle),
                ..mirror
            };
            Ok((Side::of(visits[0].tooth), Retraction::new(scene, params)?))
        });
        let mirrors = mirrors.collect::<Result<_, NoTongue>>()?;
        Ok(Self {
            tour: probe,
            mirrors,
            turn: 0,
            passage: None,
            until,
            ends: tour_ends,
            time: 0.0,
            dt: scene.tick_s(),
        })
    }

    /// Target pose of the mirror by the script of the present side.
    fn mirror(&self) -> Option<Pose> {
        let mirror = &self.mirrors[self.turn].1;
        mirror.targets(0.0)[mirror.slot()]
    }

    /// Whether the mirror holds the tongue aside.
    pub fn holds(&self) -> bool {
        self.mirrors[self.turn].1.holds()
    }
}

impl Script for Bimanual {
    fn feel(&mut self, felt: &Felt) {
        self.time += self.dt;
        if let Some(passage) = &mut self.passage {
            if passage.step(self.dt) {
                self.passage = None;
            }
            return;
        }
        let (side, mirror) = &mut self.mirrors[self.turn];
        mirror.feel(felt);
        let given_up = self.tour.progress() >= self.until;
        if self.time >= self.ends - TIDY {
            self.tour.break_off();
        }
        let changes =
            self.tour.is_outside() && self.tour.tooth().is_none_or(|t| Side::of(t) != *side);
        if changes || given_up {
            mirror.let_go();
        }
        if changes && mirror.is_done() && self.turn + 1 < self.mirrors.len() && !self.tour.is_done()
        {
            let before = self.mirror();
            self.turn += 1;
            self.passage = before.zip(self.mirror()).map(|(from, to)| {
                let over =
                    |pose: &Pose| Pose::new(pose.position + Vec3::z() * OVER, pose.orientation);
                let mut passage = Travel::at(from);
                passage.then(over(&from), SPEED);
                passage.then(over(&to), SPEED);
                passage.then(to, SPEED);
                passage
            });
            return;
        }
        if given_up
            || self.tour.tooth().is_none()
            || mirror_ready(&self.mirrors[self.turn], &self.tour)
        {
            self.tour.feel(felt);
        }
    }

    fn targets(&self, t: f64) -> [Option<Pose>; MAX_TOOLS] {
        let mut targets = self.tour.targets(t);
        let mirror = &self.mirrors[self.turn].1;
        targets[mirror.slot()] = self.passage.as_ref().map(Travel::pose).or(self.mirror());
        targets
    }

    fn duration_s(&self) -> f64 {
        let most = self.tour.duration_s() + CHANGE * self.mirrors.len() as f64;
        most.min(self.ends)
    }

    fn calls(&mut self) -> Vec<Call> {
        self.tour.calls()
    }

    fn is_done(&self) -> bool {
        self.tour.is_done() && self.mirrors[self.turn].1.is_done()
    }
}

/// Time for the probe, then the mirror, to leave the mouth, seconds.
const TIDY: f64 = 4.0;
/// Height of the mirror above its targets during the change of sides, metres.
const OVER: f64 = 12e-3;
/// Speed of the mirror during the change of sides, m/s.
const SPEED: f64 = 60e-3;
/// Longest time to hold the tongue aside and to let it go, seconds.
const CHANGE: f64 = 15.0;

/// Whether the probe may continue: the mirror holds the tongue on the side of the tour's present tooth.
fn mirror_ready((side, mirror): &(Side, Retraction), tour: &Tour) -> bool {
    mirror.holds() && tour.tooth().is_some_and(|tooth| Side::of(tooth) == *side)
}
