//! Stand-in of the simulation: a wall, a coupling, and a link with a delay.

use std::collections::VecDeque;
use std::sync::Arc;

use crate::camera::Vector;
use crate::hand::pose::Turn;
use crate::hand::{
    Coupling, Felt, Guide, Hand, HandPose, Hands, HandsOnScreen, Limits, Motion, Scales, Shared,
};

/// Stiffness of the coupling, N/m.
pub const STIFFNESS: f64 = 500.0;
/// Largest force of the exercise, newtons.
pub const LIMIT_N: f64 = 0.25;
/// Tip in the tool's frame, mm.
pub const TIP: [f64; 3] = [0.0, -8.0, 90.0];

/// Device before a wall. The tip starts at the origin; the tissue fills all places beyond `wall` along y.
pub struct Bench {
    pub shared: Arc<Shared>,
    pub device: HandsOnScreen,
    pub wall: f64,
    /// Answers of the simulation on their way.
    pub link: VecDeque<Felt>,
    /// Answer that the device has.
    pub felt: Felt,
    pub last: Option<Vector>,
    /// Largest step of the tip in a period, mm.
    pub most_step: f64,
    /// Largest force of the coupling, newtons.
    pub most_force: f64,
    /// Force of the coupling, newtons.
    pub force: f64,
}

impl Bench {
    /// Bench with the wall at `wall` mm, a delay of `delay` periods of 1 ms.
    pub fn new(wall: f64, delay: usize) -> Self {
        let tip = Vector::from(TIP);
        let home = HandPose::with_point_at(&tip, &Vector::zeros(), Turn::identity());
        let hand = Hand::new(home, tip, Limits::around([Vector::zeros()], 60.0));
        let mut hands = Hands::new([Some(hand), None], Scales::default());
        hands.set_open(false);
        let coupling = Coupling {
            stiffness_n_per_m: STIFFNESS,
            stiffness_nm_per_rad: 0.5,
        };
        let guide = Guide::new(LIMIT_N, 0.005, &coupling);
        let shared = Arc::new(Shared::new(hands));
        Self {
            device: HandsOnScreen::new(Arc::clone(&shared), [guide; 2], 1e-3),
            shared,
            wall,
            link: vec![Felt::NOTHING; delay].into(),
            felt: Felt::NOTHING,
            last: None,
            most_step: 0.0,
            most_force: 0.0,
            force: 0.0,
        }
    }

    /// Period of device, link and simulation. Returns the place of the tip, mm.
    pub fn period(&mut self) -> Vector {
        let [held, other] = self.device.period(&[self.felt, Felt::NOTHING]);
        assert!(held.present && !other.present);
        let pose = HandPose::of(&held.pose).expect("a pose");
        let tip = pose.point(&Vector::from(TIP));
        let step = self.last.map_or(0.0, |last| (tip - last).norm());
        self.most_step = self.most_step.max(step);
        self.last = Some(tip);
        let mut outside = tip;
        outside.y = outside.y.min(self.wall);
        self.force = (tip - outside).norm() * 1e-3 * STIFFNESS;
        self.most_force = self.most_force.max(self.force);
        let graphic = HandPose::with_point_at(&Vector::from(TIP), &outside, pose.orientation);
        self.link.push_back(Felt {
            graphic: Some(graphic.wire()),
            force_n: self.force,
        });
        self.felt = self.link.pop_front().unwrap_or(Felt::NOTHING);
        tip
    }

    /// Time in seconds with a mouse of 125 Hz that moves the tip by `speed` mm/s along y. Returns the tip's place, mm.
    pub fn push(&mut self, seconds: f64, speed: f64) -> Vector {
        self.glide(seconds, [speed, 0.0])
    }

    /// The same with speeds along y and z, to the right and upwards for a person before the patient.
    pub fn glide(&mut self, seconds: f64, speeds: [f64; 2]) -> Vector {
        let mut tip = Vector::zeros();
        for k in 0..(seconds * 1000.0) as usize {
            if k % 8 == 0 {
                // 0.025 mm for a count.
                let [right, up] = speeds.map(|speed| speed * 0.008 / 0.025);
                self.shared
                    .feed(|hands| hands.apply(&Motion::shift(right, up, 0.0)));
            }
            tip = self.period();
        }
        tip
    }
}
