//! Messages of Foxglove's types from the simulation's data.

use std::borrow::Cow;

use foxglove::messages::packed_element_field::NumericType;
use foxglove::messages::{
    FrameTransform, Log, PackedElementField, PointCloud, Pose as FoxglovePose, PoseInFrame,
    Quaternion, Timestamp, Vector3,
};
use foxglove::{Encode, bytes::Bytes};
use sulcus_core::Pose;

use super::topics::WORLD;
use crate::record::message::Level;
use crate::record::schema::Schema;

/// Schema of a type of Foxglove.
pub(crate) fn schema_of<T: Encode>(name: &'static str) -> Schema {
    let data = match T::get_schema().map(|schema| schema.data) {
        Some(Cow::Borrowed(data)) => data,
        // All of Foxglove's schemas are constants. The tests read every schema back.
        _ => &[],
    };
    Schema { name, data }
}

/// Timestamp from nanoseconds since the Unix epoch; saturates in the year 2106.
pub(super) fn timestamp(unix_ns: u64) -> Option<Timestamp> {
    let seconds = u32::try_from(unix_ns / 1_000_000_000).ok();
    let nanoseconds = (unix_ns % 1_000_000_000) as u32;
    let at = seconds.and_then(|seconds| Timestamp::new_checked(seconds, nanoseconds));
    Some(at.unwrap_or(Timestamp::MAX))
}

/// Number rounded to f32. Further digits are not visible and do not compress.
fn short(x: f64) -> f64 {
    f64::from(x as f32)
}

fn place(pose: &Pose) -> Vector3 {
    let p = &pose.position;
    Vector3 {
        x: short(p.x),
        y: short(p.y),
        z: short(p.z),
    }
}

fn turn(pose: &Pose) -> Quaternion {
    let q = &pose.orientation;
    Quaternion {
        x: short(q.i),
        y: short(q.j),
        z: short(q.k),
        w: short(q.w),
    }
}

/// Pose in the frame of the world.
pub(super) fn pose_in_world(unix_ns: u64, pose: &Pose) -> PoseInFrame {
    PoseInFrame {
        timestamp: timestamp(unix_ns),
        frame_id: WORLD.to_owned(),
        pose: Some(FoxglovePose {
            position: Some(place(pose)),
            orientation: Some(turn(pose)),
        }),
    }
}

/// Transform of the frame `child`, at `world_from_child`.
pub(super) fn transform(unix_ns: u64, child: &str, pose: &Pose) -> FrameTransform {
    FrameTransform {
        timestamp: timestamp(unix_ns),
        parent_frame_id: WORLD.to_owned(),
        child_frame_id: child.to_owned(),
        translation: Some(place(pose)),
        rotation: Some(turn(pose)),
    }
}

/// Point cloud of f32 numbers. `fields` names the numbers of a point; the first three are x, y and z in metres.
pub(super) fn cloud(unix_ns: u64, frame: &str, fields: &[&str], data: Vec<u8>) -> PointCloud {
    let field = |(k, name): (usize, &&str)| PackedElementField {
        name: (*name).to_owned(),
        offset: 4 * k as u32,
        r#type: NumericType::Float32 as i32,
    };
    PointCloud {
        timestamp: timestamp(unix_ns),
        frame_id: frame.to_owned(),
        pose: Some(FoxglovePose {
            position: Some(Vector3::default()),
            orientation: Some(Quaternion {
                w: 1.0,
                ..Quaternion::default()
            }),
        }),
        point_stride: 4 * fields.len() as u32,
        fields: fields.iter().enumerate().map(field).collect(),
        data: Bytes::from(data),
    }
}

/// Line of the log for viewers.
pub(crate) fn log(unix_ns: u64, level: Level, text: &str) -> Log {
    use foxglove::messages::log::Level as Theirs;
    let level = match level {
        Level::Info => Theirs::Info,
        Level::Warning => Theirs::Warning,
        Level::Error => Theirs::Error,
    };
    Log {
        timestamp: timestamp(unix_ns),
        level: level as i32,
        message: text.to_owned(),
        name: "sulcus".to_owned(),
        file: String::new(),
        line: 0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_split_and_never_overflow() {
        assert_eq!(
            timestamp(1_795_241_730_123_456_789),
            Timestamp::new_checked(1_795_241_730, 123_456_789)
        );
        assert_eq!(timestamp(u64::MAX), Some(Timestamp::MAX));
    }
}
