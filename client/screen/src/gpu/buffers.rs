//! Buffers of a stage on the adapter.

use std::ops::Range;

use bytemuck::{Pod, cast_slice};
use wgpu::{Buffer, BufferUsages, Device, Queue};

use super::drawing::Work;
use crate::plan::{self, Plan};
use crate::stage::{Moving, Stage};

/// Vertices of a stage.
pub(super) struct Buffers {
    pub still: Buffer,
    pub moving: Buffer,
}

impl Buffers {
    pub fn new(device: &Device, queue: &Queue, stage: &Stage) -> Self {
        Self {
            still: filled(device, queue, "still", BufferUsages::VERTEX, &stage.still),
            moving: filled(device, queue, "moving", BufferUsages::VERTEX, &stage.moving),
        }
    }

    /// Writes the changed vertices.
    pub fn update(&self, queue: &Queue, moving: &[Moving], changed: &[Range<usize>]) {
        for range in changed {
            let offset = range.start * size_of::<Moving>();
            queue.write_buffer(
                &self.moving,
                offset as u64,
                cast_slice(&moving[range.clone()]),
            );
        }
    }
}

/// Corners of one pass in the order in which they are drawn.
pub(super) struct List {
    pub corners: Buffer,
    pub plan: Plan,
}

impl List {
    pub fn new(device: &Device, stage: &Stage) -> Self {
        let bytes = size_of_val(&stage.corners[..]) as u64;
        Self {
            corners: empty(device, "corners", BufferUsages::INDEX, bytes),
            plan: Plan::default(),
        }
    }

    /// Takes a plan. Corners in the order of the last plan are not written again.
    pub fn set(&mut self, queue: &Queue, stage: &Stage, plan: Plan) {
        if plan.chunks != self.plan.chunks && !plan.chunks.is_empty() {
            let corners = plan::corners(stage, &plan);
            queue.write_buffer(&self.corners, 0, cast_slice(&corners));
        }
        self.plan = plan;
    }

    /// Work with that of this list.
    pub fn add(work: Work, list: &Self) -> Work {
        let corners = list.plan.draws.iter().map(|draw| draw.corners.len());
        Work {
            draws: work.draws + list.plan.draws.len(),
            triangles: work.triangles + corners.sum::<usize>() / 3,
        }
    }
}

/// Buffer with values. An empty list gives a buffer of one block, because no adapter has empty buffers.
pub(super) fn filled<T: Pod>(
    device: &Device,
    queue: &Queue,
    label: &str,
    usage: BufferUsages,
    values: &[T],
) -> Buffer {
    let bytes: &[u8] = cast_slice(values);
    let buffer = empty(device, label, usage, bytes.len() as u64);
    if !bytes.is_empty() {
        queue.write_buffer(&buffer, 0, bytes);
    }
    buffer
}

/// Buffer without values that can be written.
pub(super) fn empty(device: &Device, label: &str, usage: BufferUsages, bytes: u64) -> Buffer {
    device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        size: bytes
            .max(super::uniforms::STRIDE)
            .next_multiple_of(wgpu::COPY_BUFFER_ALIGNMENT),
        usage: usage | BufferUsages::COPY_DST,
        mapped_at_creation: false,
    })
}
