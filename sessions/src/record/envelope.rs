//! Protobuf message around the bytes of an exact message. With it every stock decoder reads every channel.
//!
//! `sulcus.v1.ExactRow`, `ExactState`, `ExactStatement` and `ExactEvent` have a field, number 1, of type `bytes`.
//! `ExactRow` has the samples of devices beside it, field 2. Chain and signatures cover the inner bytes, because
//! protobuf has many encodings of one message. A tool that writes a file anew may choose another encoding.

use prost::Message as _;
use prost::encoding::{
    DecodeContext, WireType, decode_key, decode_varint, encode_key, encode_varint, skip_field,
};

use crate::record::channels::own_types::v1;
use crate::record::row::Row;
use crate::record::sample::DeviceSample;

/// Number of the field that holds the inner bytes, in all four messages.
const FIELD: u32 = 1;
/// Number of the field of the devices' samples in the message around a row.
const SAMPLES: u32 = 2;

/// Encodes the message around `inner` into `outer`. The former content of `outer` is dropped.
pub(crate) fn seal(inner: &[u8], outer: &mut Vec<u8>) {
    outer.clear();
    encode_key(FIELD, WireType::LengthDelimited, outer);
    encode_varint(inner.len() as u64, outer);
    outer.extend_from_slice(inner);
}

/// Encodes the message around a row into `outer`, as by [`seal`], with the samples of its devices.
pub(crate) fn seal_row(row: &Row, outer: &mut Vec<u8>) {
    seal(&row.to_bytes(), outer);
    for (tool, sample) in row.device.iter().enumerate() {
        if let Some(sample) = sample {
            prost::encoding::message::encode(SAMPLES, &sample.to_message(tool), outer);
        }
    }
}

/// Inner bytes of any valid encoding of the message, borrowed; `None` for bytes that are no protobuf message.
///
/// The rules of protobuf hold: unknown fields are skipped, the last of several fields counts, an absent field is empty.
pub(crate) fn open(outer: &[u8]) -> Option<&[u8]> {
    let mut inner: &[u8] = &[];
    fields(outer, |field, bytes| {
        if field == FIELD {
            inner = bytes;
        }
        Some(())
    })?;
    Some(inner)
}

/// Row of any valid encoding of the message around it, with the samples of its devices; `None` for other bytes, and for
/// a second sample of a slot.
pub(crate) fn open_row(outer: &[u8]) -> Option<Row> {
    let mut row = Row::from_bytes(open(outer)?)?;
    fields(outer, |field, bytes| {
        if field == SAMPLES {
            let said = v1::DeviceSample::decode(bytes).ok()?;
            let (tool, sample) = DeviceSample::from_message(&said)?;
            if row.device[tool].replace(sample).is_some() {
                return None;
            }
        }
        Some(())
    })?;
    Some(row)
}

/// Calls `visit` with number and bytes of every field of bytes; `None` if the bytes are no protobuf message, or if
/// `visit` gives none.
fn fields<'a>(
    mut outer: &'a [u8],
    mut visit: impl FnMut(u32, &'a [u8]) -> Option<()>,
) -> Option<()> {
    while !outer.is_empty() {
        let (field, wire) = decode_key(&mut outer).ok()?;
        if wire == WireType::LengthDelimited {
            let length = usize::try_from(decode_varint(&mut outer).ok()?).ok()?;
            let (bytes, rest) = outer.split_at_checked(length)?;
            outer = rest;
            visit(field, bytes)?;
        } else {
            skip_field(wire, field, &mut outer, DecodeContext::default()).ok()?;
        }
    }
    Some(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::channels::v1::ExactRow;
    use proptest::prelude::*;

    #[test]
    fn other_encodings_of_the_same_message_open_to_the_same_bytes() {
        let plain = [0x0a, 3, 7, 8, 9];
        assert_eq!(open(&plain), Some(&[7, 8, 9][..]));
        for outer in [
            // A length and a key with more bytes than necessary.
            &[0x0a, 0x83, 0x80, 0x00, 7, 8, 9][..],
            &[0x8a, 0x00, 3, 7, 8, 9],
            // Unknown fields of every wire type: varint, 64 bits, bytes, group, 32 bits.
            &[0x10, 5, 0x0a, 3, 7, 8, 9],
            &[0x0a, 3, 7, 8, 9, 0x19, 1, 2, 3, 4, 5, 6, 7, 8],
            &[0x22, 2, 1, 1, 0x0a, 3, 7, 8, 9],
            &[0x2b, 0x10, 1, 0x2c, 0x0a, 3, 7, 8, 9],
            &[0x0a, 3, 7, 8, 9, 0x35, 1, 2, 3, 4],
            // The field twice: the last one counts.
            &[0x0a, 1, 1, 0x0a, 3, 7, 8, 9],
        ] {
            assert_eq!(open(outer), Some(&[7, 8, 9][..]), "{outer:?}");
        }
        assert_eq!(open(&[]), Some(&[][..]));
        for no_message in [&[0x0a, 4, 7, 8, 9][..], &[0x0a], &[0x2b], &[0x07, 1], &[0]] {
            assert_eq!(open(no_message), None, "{no_message:?}");
        }
    }

    /// Row of zeros of tick 7, with a sample of the second tool.
    fn row() -> Row {
        let mut bytes = [0; Row::BYTES];
        bytes[0] = 7;
        let sample = DeviceSample {
            sequence: 3,
            device_time_ns: 1 << 40,
            age_us: 250,
            displayed: [0.5, -0.25, 0.0, 0.0, 0.01, 0.0],
        };
        let row = Row::from_bytes(&bytes).expect("a row");
        row.with_device([None, Some(sample)])
    }

    #[test]
    fn a_row_opens_with_its_samples_and_each_slot_has_one() {
        let (row, mut outer) = (row(), Vec::new());
        seal_row(&row, &mut outer);
        assert_eq!(open_row(&outer), Some(row));
        assert_eq!(open(&outer), Some(&row.to_bytes()[..]));
        let said = ExactRow::decode(&outer[..]).expect("a message");
        assert_eq!((said.samples.len(), said.samples[0].tool), (1, 1));
        let with = |change: fn(&mut ExactRow)| {
            let mut said = said.clone();
            change(&mut said);
            open_row(&said.encode_to_vec())
        };
        assert_eq!(with(|_| {}), Some(row));
        assert_eq!(with(|said| said.samples[0].torque_nm.clear()), None);
        assert_eq!(with(|said| said.samples[0].tool = 2), None);
        assert_eq!(with(|said| said.samples.extend(said.samples.clone())), None);
        let (mut plain, mut covered) = (Vec::new(), Vec::new());
        row.chained(&mut covered);
        row.with_device([None; 2]).chained(&mut plain);
        assert_eq!(plain, row.to_bytes());
        assert_eq!(covered.len(), plain.len() + DeviceSample::BYTES);
    }

    proptest! {
        #[test]
        fn any_bytes_are_a_row_or_none(mut outer in proptest::collection::vec(any::<u8>(), 0..60)) {
            let _ = open_row(&outer);
            // A valid row, with any bytes behind it.
            let mut sealed = Vec::new();
            seal_row(&row(), &mut sealed);
            sealed.append(&mut outer);
            let _ = open_row(&sealed);
        }

        #[test]
        fn prost_reads_what_is_sealed(inner in proptest::collection::vec(any::<u8>(), 0..400)) {
            let mut outer = vec![1, 2, 3];
            seal(&inner, &mut outer);
            prop_assert_eq!(open(&outer), Some(&inner[..]));
            prop_assert_eq!(ExactRow::decode(&outer[..]).expect("a message").row, inner);
        }

        #[test]
        fn any_bytes_open_as_prost_decodes_them(outer in proptest::collection::vec(any::<u8>(), 0..60)) {
            match ExactRow::decode(&outer[..]) {
                Ok(message) => prop_assert_eq!(open(&outer), Some(&message.row[..])),
                // Field 1 of another wire type is an unknown field to other readers, and an error to prost.
                Err(_) => { let _ = open(&outer); }
            }
        }
    }
}
