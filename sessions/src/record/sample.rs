//! Exact device sample: a pose that a tick used, and the wrench that the hand felt when the device measured the pose.
//!
//! The wrench that a station sends is one thing, and the wrench that a hand feels is another: the client's gates, its
//! passivity controller and the device's own limits are between the two. Every pose therefore brings back the displayed
//! wrench. A recording keeps it for each pose that a tick used, once.

use sulcus_core::MAX_TOOLS;

use crate::record::channels::own_types::v1;

/// Pose of one tool as its device measured it, without the place, which is in the row's input.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DeviceSample {
    /// Number of the pose, wrapping at 2^32.
    pub sequence: u32,
    /// Time of the measurement, nanoseconds of the client's monotonic clock.
    pub device_time_ns: u64,
    /// Time from the arrival of the pose at the station to the beginning of the tick, microseconds.
    pub age_us: u32,
    /// Displayed wrench: force (N), torque (N m), world axes, about the device point.
    pub displayed: [f32; 6],
}

/// Samples of a tick, by slot of the tool. None: the tick used no new pose of that tool.
pub type DeviceSamples = [Option<DeviceSample>; MAX_TOOLS];

/// Number with one form for all zeros and one for all NaN. Other encoders of protobuf may change these bits.
fn plain(x: f32) -> f32 {
    if x.is_nan() { f32::NAN } else { x + 0.0 }
}

impl DeviceSample {
    /// Length of [`DeviceSample::to_bytes`].
    pub const BYTES: usize = 1 + 4 + 8 + 4 + 6 * 4;

    /// Whether every number of the displayed wrench is finite.
    pub fn is_finite(&self) -> bool {
        self.displayed.iter().all(|x| x.is_finite())
    }

    /// Magnitude of the displayed force, newtons.
    pub fn force_n(&self) -> f64 {
        let [x, y, z, ..] = self.displayed.map(f64::from);
        (x * x + y * y + z * z).sqrt()
    }

    /// Bytes that chain and signatures cover, in the layout of `proto/sulcus/v1/exact_row.proto`.
    pub fn to_bytes(&self, tool: u8) -> [u8; Self::BYTES] {
        let mut bytes = [0; Self::BYTES];
        bytes[0] = tool;
        bytes[1..5].copy_from_slice(&self.sequence.to_le_bytes());
        bytes[5..13].copy_from_slice(&self.device_time_ns.to_le_bytes());
        bytes[13..17].copy_from_slice(&self.age_us.to_le_bytes());
        for (x, slot) in self.displayed.iter().zip(bytes[17..].chunks_exact_mut(4)) {
            slot.copy_from_slice(&plain(*x).to_bits().to_le_bytes());
        }
        bytes
    }

    /// Protobuf message of this sample of a tool. The numbers of a wrench stand together, as in the row that has sent
    /// the wrench: measured on two hands, a minute of samples compresses to 2.0 MB, and to 3.6 MB with a field for
    /// each.
    pub(crate) fn to_message(self, tool: usize) -> v1::DeviceSample {
        let [fx, fy, fz, tx, ty, tz] = self.displayed.map(plain);
        v1::DeviceSample {
            tool: tool as u32,
            sequence: self.sequence,
            device_time_ns: self.device_time_ns,
            age_us: self.age_us,
            force_n: vec![fx, fy, fz],
            torque_nm: vec![tx, ty, tz],
        }
    }

    /// Slot and sample of a protobuf message; `None` for a slot that no tool has, or another number of numbers.
    pub(crate) fn from_message(said: &v1::DeviceSample) -> Option<(usize, Self)> {
        let tool = usize::try_from(said.tool).ok();
        let tool = tool.filter(|tool| *tool < MAX_TOOLS)?;
        let [fx, fy, fz]: [f32; 3] = said.force_n[..].try_into().ok()?;
        let [tx, ty, tz]: [f32; 3] = said.torque_nm[..].try_into().ok()?;
        let sample = Self {
            sequence: said.sequence,
            device_time_ns: said.device_time_ns,
            age_us: said.age_us,
            displayed: [fx, fy, fz, tx, ty, tz].map(plain),
        };
        Some((tool, sample))
    }
}

/// Filter that leaves out a pose that an earlier tick has used.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct OnlyNew([Option<(u32, u64)>; MAX_TOOLS]);

impl OnlyNew {
    /// Samples of the poses that no earlier tick has used. A pose has a number and a time of its own.
    pub fn of(&mut self, used: &DeviceSamples) -> DeviceSamples {
        std::array::from_fn(|t| {
            let sample = used[t]?;
            let pose = Some((sample.sequence, sample.device_time_ns));
            (std::mem::replace(&mut self.0[t], pose) != pose).then_some(sample)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use prost::Message as _;

    proptest! {
        #[test]
        fn a_sample_survives_its_message_with_the_bytes_that_are_signed(
            (sequence, time, age) in any::<(u32, u64, u32)>(),
            bits in any::<[u32; 6]>(),
            tool in 0..MAX_TOOLS,
        ) {
            let displayed = bits.map(f32::from_bits);
            let sample = DeviceSample { sequence, device_time_ns: time, age_us: age, displayed };
            let said = sample.to_message(tool).encode_to_vec();
            let said = v1::DeviceSample::decode(&said[..]).expect("a message");
            let (of, back) = DeviceSample::from_message(&said).expect("a sample");
            prop_assert_eq!(of, tool);
            prop_assert_eq!(back.to_bytes(1), sample.to_bytes(1));
        }
    }

    #[test]
    fn zeros_and_nans_have_one_form_and_an_unknown_slot_is_no_sample() {
        let of = |x: f32| DeviceSample {
            displayed: [x; 6],
            ..DeviceSample::default()
        };
        assert_eq!(of(-0.0).to_bytes(0), of(0.0).to_bytes(0));
        assert_eq!(of(-f32::NAN).to_bytes(0), of(f32::NAN).to_bytes(0));
        assert!(!of(f32::NAN).is_finite() && of(1.0).is_finite());
        let said = of(1.0).to_message(MAX_TOOLS);
        assert!(DeviceSample::from_message(&said).is_none());
        let mut said = of(1.0).to_message(0);
        assert!(DeviceSample::from_message(&said).is_some());
        said.force_n.push(0.0);
        assert!(DeviceSample::from_message(&said).is_none());
    }

    #[test]
    fn a_pose_that_two_ticks_use_is_written_once() {
        let at = |sequence, device_time_ns| {
            let sample = DeviceSample {
                sequence,
                device_time_ns,
                ..DeviceSample::default()
            };
            [Some(sample), None]
        };
        let mut new = OnlyNew::default();
        assert_eq!(new.of(&at(1, 5)), at(1, 5));
        assert_eq!(new.of(&at(1, 5)), [None; 2]);
        assert_eq!(new.of(&[None; 2]), [None; 2]);
        assert_eq!(new.of(&at(1, 5)), [None; 2]);
        // A number that has wrapped, or begins anew behind a gap, is another pose.
        assert_eq!(new.of(&at(1, 6)), at(1, 6));
    }
}
