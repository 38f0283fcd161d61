//! Tools in the hands of a person at the window: mouse, keys, 3D mouse.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use sulcus_connection::device::EventDevice;
use sulcus_core::math::norm;
use sulcus_core::{MAX_TOOLS, Pose, RawPose, ToolInput};
use sulcus_haptics::{HandSource, Shown};
use sulcus_proto::TOOLS;
use sulcus_proto::control::ServerHello;
use sulcus_proto::datagram::WirePose;
use sulcus_screen::camera::Vector;
use sulcus_screen::hand::{
    Coupling, Felt, Guide, Hand, HandPose, Hands, HandsOnScreen, Limits, Scales, Shared,
};

/// Name of the device, for the log and the recording.
pub const NAME: &str = "mouse";
/// Largest force of a hand without feeling where an exercise prescribes none, newtons: that of retraction.
const FORCE_N: f64 = 1.0;
/// Largest torque, newton-metres.
const TORQUE_NM: f64 = 0.02;
/// Corners of the space around a mouth and its resting tools, mm.
const MOUTH_MM: [[f64; 3]; 2] = [[-60.0, -45.0, -30.0], [30.0, 45.0, 40.0]];
/// Room around it, mm.
const MARGIN_MM: f64 = 60.0;

/// Device of the person at the window. The device has finished when the window is closed.
pub struct OnScreen {
    hands: HandsOnScreen,
    closed: Arc<AtomicBool>,
}

impl OnScreen {
    /// Device for the tools of a session, with the hands that the window feeds. `force_n` bounds the force of a tool
    /// with marks; `None`: no prescription.
    pub fn new(
        hello: &ServerHello,
        force_n: Option<f64>,
        closed: Arc<AtomicBool>,
    ) -> (Self, Arc<Shared>) {
        let mut corners: Vec<Vector> = MOUTH_MM.map(Vector::from).to_vec();
        let parks = hello.tools.iter().map(|tool| tool.park.position);
        corners.extend(parks.map(|at| Vector::from(at.map(|x| f64::from(x) * 1e3))));
        let hand = |k: usize| {
            let tool = hello.tools.get(k)?;
            let tip = Vector::from(tool.tip.map(|x| f64::from(x) * 1e3));
            let limits = Limits::around(corners.iter().copied(), MARGIN_MM);
            Some(Hand::new(HandPose::of(&tool.park)?, tip, limits))
        };
        let shared = Arc::new(Shared::new(Hands::new(
            std::array::from_fn(hand),
            Scales::default(),
        )));
        let guide = |k: usize| {
            let tool = hello.tools.get(k);
            let coupling = Coupling {
                stiffness_n_per_m: tool.map_or(500.0, |tool| tool.stiffness_n_per_m),
                stiffness_nm_per_rad: tool.map_or(0.5, |tool| tool.stiffness_nm_per_rad),
            };
            // The first tool is the one that reads.
            let force_n = force_n.filter(|_| k == 0).unwrap_or(FORCE_N);
            Guide::new(force_n, TORQUE_NM, &coupling)
        };
        let period_s = hello.tick_ns as f64 / 1e9;
        let guides: [Guide; TOOLS] = std::array::from_fn(guide);
        let hands = HandsOnScreen::new(shared.clone(), guides, period_s);
        (Self { hands, closed }, shared)
    }
}

impl HandSource for OnScreen {
    fn name(&self) -> &str {
        NAME
    }

    fn exchange(&mut self, shown: &Shown) -> [ToolInput; MAX_TOOLS] {
        let felt = std::array::from_fn(|t| Felt {
            graphic: shown.graphics[t].as_ref().map(wire),
            force_n: norm(&shown.wrenches[t].force),
        });
        self.hands.period(&felt).map(|held| ToolInput {
            present: held.present,
            pose: RawPose {
                position: held.pose.position,
                orientation: held.pose.orientation,
            },
            ..ToolInput::ABSENT
        })
    }

    fn is_done(&self) -> bool {
        self.closed.load(Ordering::Acquire)
    }
}

impl EventDevice for OnScreen {}

/// Pose in the precision of the wire.
pub fn wire(pose: &Pose) -> WirePose {
    let RawPose {
        position,
        orientation,
    } = RawPose::from(pose);
    WirePose {
        position,
        orientation,
    }
}
