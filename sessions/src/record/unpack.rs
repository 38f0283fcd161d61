//! Messages in a piece of a recording. A piece is a chunk, or a stretch of records outside of chunks.

use std::collections::BTreeMap;

use mcap::records::op;

use crate::record::format::Layout;
use crate::record::message::{Message, Topic};
use crate::record::viewers::Summing;
use crate::record::walk;

/// Topic and layout of each exact channel by its number; `None` for a channel for viewers.
pub(crate) type Topics = BTreeMap<u16, Option<(Topic, Layout)>>;

/// Exact messages of a piece. Adds the declared channels to `topics`, and the messages for viewers to `viewed`.
pub(crate) fn unpack(
    piece: &[u8],
    topics: &mut Topics,
    mut viewed: Option<&mut Summing>,
) -> Result<Vec<Message>, String> {
    let mut messages = Vec::new();
    walk::visit(piece, |opcode, body| {
        match opcode {
            op::SCHEMA => {
                let (id, name, encoding, data) =
                    walk::schema(body).ok_or("a schema's record is incomplete")?;
                if let Some(viewed) = &mut viewed {
                    viewed.schema(id, name, encoding, data);
                }
            }
            op::CHANNEL => {
                let topic = declare(body, topics)?;
                if let Some(viewed) = viewed.as_mut().filter(|_| topic.is_none())
                    && let Some((id, schema, name, encoding)) = walk::channel(body)
                {
                    viewed.channel(id, schema, name, encoding);
                }
            }
            op::MESSAGE => {
                let (id, times, bytes) =
                    walk::message(body).ok_or("a message's record is incomplete")?;
                let topic = topics
                    .get(&id)
                    .ok_or_else(|| format!("a message names channel {id}, which does not exist"))?;
                if let Some((topic, layout)) = *topic {
                    messages.push(exact(topic, layout, times[0], bytes)?);
                } else if let Some(viewed) = &mut viewed {
                    viewed.message(id, times, bytes);
                }
            }
            _ => {}
        }
        Ok(())
    })?;
    Ok(messages)
}

/// Adds the declaration of a channel; topic of an exact channel.
pub(crate) fn declare(body: &[u8], topics: &mut Topics) -> Result<Option<Topic>, String> {
    let (id, _, name, encoding) = walk::channel(body).ok_or("a channel's record is incomplete")?;
    let topic = Topic::from_name(name);
    let of = match topic {
        None => None,
        Some(topic) => Some((
            topic,
            topic.layout(encoding).ok_or_else(|| {
                format!(
                    "channel {name} has encoding `{}`, expected `{}`",
                    encoding.escape_debug(),
                    topic.encoding(Layout::Protobuf)
                )
            })?,
        )),
    };
    if topics.insert(id, of).is_some_and(|before| before != of) {
        return Err(format!("channel {id} has two different declarations"));
    }
    Ok(topic)
}

/// Decodes an exact message.
pub(crate) fn exact(
    topic: Topic,
    layout: Layout,
    log_time: u64,
    bytes: &[u8],
) -> Result<Message, String> {
    let message = Message::decode(topic, layout, bytes)
        .ok_or_else(|| format!("a message of {} cannot be decoded", topic.name()))?;
    if matches!(&message, Message::Row(row) if row.time_unix_ns != log_time) {
        return Err("the time of a row differs from the time of its message".to_owned());
    }
    Ok(message)
}
