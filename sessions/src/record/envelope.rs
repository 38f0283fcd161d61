//! Protobuf message around the bytes of an exact message. With it every stock decoder reads every channel.
//!
//! `sulcus.v1.ExactRow`, `ExactState`, `ExactStatement` and `ExactEvent` have one field, number 1, of type `bytes`.
//! Chain and signatures cover the inner bytes, because protobuf has many encodings of one message. A tool that writes a
//! file anew may choose another encoding.

use prost::encoding::{
    DecodeContext, WireType, decode_key, decode_varint, encode_key, encode_varint, skip_field,
};

/// Number of the field that holds the inner bytes, in all four messages.
const FIELD: u32 = 1;

/// Encodes the message around `inner` into `outer`. The former content of `outer` is dropped.
pub(crate) fn seal(inner: &[u8], outer: &mut Vec<u8>) {
    outer.clear();
    encode_key(FIELD, WireType::LengthDelimited, outer);
    encode_varint(inner.len() as u64, outer);
    outer.extend_from_slice(inner);
}

/// Inner bytes of any valid encoding of the message, borrowed; `None` for bytes that are no protobuf message.
///
/// The rules of protobuf hold: unknown fields are skipped, the last of several fields counts, an absent field is empty.
pub(crate) fn open(mut outer: &[u8]) -> Option<&[u8]> {
    let mut inner: &[u8] = &[];
    while !outer.is_empty() {
        let (field, wire) = decode_key(&mut outer).ok()?;
        if (field, wire) == (FIELD, WireType::LengthDelimited) {
            let length = usize::try_from(decode_varint(&mut outer).ok()?).ok()?;
            (inner, outer) = outer.split_at_checked(length)?;
        } else {
            skip_field(wire, field, &mut outer, DecodeContext::default()).ok()?;
        }
    }
    Some(inner)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::channels::v1::ExactRow;
    use proptest::prelude::*;
    use prost::Message as _;

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

    proptest! {
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
