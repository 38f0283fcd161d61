use sulcus_core::{MAX_TOOLS, ToolInput};
use sulcus_haptics::{HandSource, Shown};
use sulcus_proto::{PoseDatagram, WrenchDatagram};

use super::*;
use crate::device::{DeviceEvent, EventDevice};
use crate::device_loop::DeviceLoop;

const MS: u64 = 1_000_000;
const EPOCH: u32 = 7;

fn hello() -> ServerHello {
    ServerHello {
        program: String::new(),
        station: String::new(),
        epoch: EPOCH,
        resumed: false,
        plan: Default::default(),
        capabilities: 0,
        self_test: 0,
        tick_ns: MS,
        scene: String::new(),
        scene_hash: [0; 32],
        exercise: String::new(),
        exercise_text: String::new(),
        max_force_n: 3.3,
        max_torque_nm: 0.2,
        max_force_step_n: 0.5,
        max_torque_step_nm: 0.03,
        tools: Vec::new(),
    }
}

/// Arrival at `now_ns` of a wrench of 1 N on the first hand.
fn arrive(link: &mut SteppedLink, epoch: u32, sequence: u32, now_ns: u64) {
    let mut datagram = WrenchDatagram {
        epoch,
        sequence,
        tick: u64::from(sequence),
        ..WrenchDatagram::default()
    };
    datagram.tools[0].wrench.force[2] = 1.0;
    let bytes = datagram.to_bytes().expect("encoded");
    link.arrived(&bytes, now_ns, Duration::from_millis(2));
}

fn newest(link: &mut SteppedLink) -> Option<u32> {
    link.latest_wrench().map(|packet| packet.datagram.sequence)
}

/// Datagram of the newest pose, decoded.
fn sent(link: &mut SteppedLink) -> Option<PoseDatagram> {
    let bytes = link.pose_bytes()?;
    Some(PoseDatagram::from_bytes(&bytes).expect("decoded"))
}

#[test]
fn other_epochs_and_older_sequences_are_ignored() {
    let mut link = SteppedLink::new(hello());
    assert_eq!(newest(&mut link), None);
    arrive(&mut link, EPOCH + 1, 4, MS);
    assert_eq!(newest(&mut link), None);
    arrive(&mut link, EPOCH, 5, 2 * MS);
    arrive(&mut link, EPOCH, 4, 3 * MS);
    arrive(&mut link, EPOCH, 5, 4 * MS);
    link.arrived(b"no datagram", 5 * MS, Duration::ZERO);
    assert_eq!(newest(&mut link), Some(5));
    let stats = link.stats();
    assert_eq!((stats.foreign, stats.malformed), (1, 1));
    let counts = stats.wrenches;
    assert_eq!((counts.accepted, counts.late, counts.duplicate), (1, 1, 1));
    link.begin_epoch(EPOCH + 1);
    arrive(&mut link, EPOCH, 6, 6 * MS);
    assert_eq!(newest(&mut link), Some(5));
    arrive(&mut link, EPOCH + 1, 1, 7 * MS);
    assert_eq!(newest(&mut link), Some(1));
}

#[test]
fn the_gate_is_zero_forty_milliseconds_after_the_last_wrench() {
    let mut link = SteppedLink::new(hello());
    let mut last = 0;
    let mut gates = Vec::new();
    for ms in 1..=900 {
        if ms <= 800 {
            last = ms;
            arrive(&mut link, EPOCH, ms as u32, ms * MS);
        }
        gates.push((ms - last, link.force_gate(ms * MS)));
    }
    assert!(gates[600..819].iter().all(|&(_, gate)| gate == 1.0));
    let after = |age| gates.iter().find(|&&(a, _)| a == age).expect("stepped").1;
    assert!(after(19) == 1.0 && after(20) < 1.0 && after(38) > 0.0);
    assert!((40..=100).all(|age| after(age) == 0.0));
}

#[test]
fn a_pose_is_sent_once_and_the_newest_alone() {
    let mut link = SteppedLink::new(hello());
    assert_eq!(link.pose_bytes(), None);
    let mut pose = PosePacket::default();
    link.send_pose(&pose);
    pose.tools[0].buttons = 1;
    link.send_pose(&pose);
    let first = sent(&mut link).expect("sent");
    assert_eq!((first.epoch, first.sequence), (EPOCH, 0));
    assert_eq!(first.tools, pose.tools);
    assert_eq!(link.pose_bytes(), None);
    link.send_pose(&pose);
    assert_eq!(sent(&mut link).map(|datagram| datagram.sequence), Some(1));
    let stats = link.stats();
    assert_eq!((stats.poses_offered, stats.poses_sent), (3, 2));
}

#[test]
fn nothing_passes_without_a_connection_and_the_newest_pose_waits_for_the_return() {
    let mut link = SteppedLink::new(hello());
    link.leave();
    assert!(link.is_open() && link.is_returning());
    link.send_pose(&PosePacket::default());
    assert_eq!(link.pose_bytes(), None);
    arrive(&mut link, EPOCH, 1, MS);
    assert_eq!(newest(&mut link), None);
    link.come_back(EPOCH + 1);
    assert!(!link.is_returning());
    assert_eq!(sent(&mut link).map(|sent| sent.epoch), Some(EPOCH + 1));
    assert_eq!(link.stats().returns, 1);
    link.close();
    link.send_pose(&PosePacket::default());
    assert!(!link.is_open());
    assert_eq!(link.pose_bytes(), None);
}

/// Device without a hand, which keeps the force shown last, newtons.
#[derive(Default)]
struct Feeler {
    felt_n: f64,
}

impl HandSource for Feeler {
    fn name(&self) -> &str {
        "feeler"
    }

    fn exchange(&mut self, shown: &Shown) -> [ToolInput; MAX_TOOLS] {
        self.felt_n = shown.wrenches[0].force.z;
        [ToolInput::ABSENT; MAX_TOOLS]
    }
}

impl EventDevice for Feeler {
    fn events(&mut self) -> Vec<DeviceEvent> {
        let (kind, json) = ("felt", self.felt_n.to_string());
        vec![DeviceEvent { kind, json }]
    }
}

#[test]
fn the_loop_of_a_device_runs_on_it() {
    let mut link = SteppedLink::new(hello());
    let mut feeler = Feeler::default();
    let mut device_loop = DeviceLoop::new(&link, 0, 10_000, None);
    let mut felt = Vec::new();
    for ms in 1..=900 {
        if ms <= 800 {
            arrive(&mut link, EPOCH, ms as u32, ms * MS);
        }
        assert!(device_loop.goes_on(&feeler));
        assert_eq!(device_loop.next_ns(), ms * MS);
        device_loop.pass(&mut link, &mut feeler, ms * MS);
        assert!(sent(&mut link).is_some_and(|sent| sent.sequence == ms as u32 - 1));
        assert!(matches!(link.next_message(), Some(ClientMessage::Event(_))));
        felt.push(feeler.felt_n);
    }
    assert_eq!(felt[799], 1.0);
    assert!(felt[830] < 1.0);
    assert!(felt[839..].iter().all(|&force| force == 0.0));
    let steps = felt.windows(2).map(|pair| (pair[1] - pair[0]).abs());
    assert!(steps.fold(0.0, f64::max) < 0.1);
}
