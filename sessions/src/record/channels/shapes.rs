//! Copies of tissue shapes and contacts, made in the thread that ticks.

use sulcus_core::contact::Contact;
use sulcus_core::{Scene, Workspace};

use super::cadence::{Cadence, FRAMES_HZ};

/// Largest number of copied contacts of a tick. All contacts are counted.
const MAX_CONTACTS: usize = 128;

/// Copy of a tick's shapes: the configuration of awake tissues, and the contacts under load. The memory for one scene
/// is allocated beforehand.
#[derive(Debug, PartialEq)]
pub struct Shapes {
    /// Tick of the copy.
    pub(super) tick: u64,
    /// Awake objects, each with the end of its configuration in `numbers`.
    pub(super) awake: Vec<(usize, usize)>,
    /// Configurations, one after the other.
    pub(super) numbers: Vec<f64>,
    /// Contacts with their loads, newtons.
    pub(super) contacts: Vec<(Contact, f64)>,
    /// Number of contacts under load of each tool, also those that are not copied.
    pub(super) bearing: [u32; sulcus_core::MAX_TOOLS],
}

impl Shapes {
    /// Empty copy with memory for `scene`.
    pub fn new(scene: &Scene) -> Self {
        let workspace = Workspace::new(scene);
        let numbers = (0..scene.objects.len()).map(|k| workspace.shape_of(k).len());
        Self {
            tick: 0,
            awake: Vec::with_capacity(scene.objects.len()),
            numbers: Vec::with_capacity(numbers.sum()),
            contacts: Vec::with_capacity(MAX_CONTACTS),
            bearing: [0; sulcus_core::MAX_TOOLS],
        }
    }

    /// Empty copy with the same memory. A clone would have memory only for its content.
    pub fn like(&self) -> Self {
        Self {
            tick: 0,
            awake: Vec::with_capacity(self.awake.capacity()),
            numbers: Vec::with_capacity(self.numbers.capacity()),
            contacts: Vec::with_capacity(MAX_CONTACTS),
            bearing: [0; sulcus_core::MAX_TOOLS],
        }
    }

    /// Tick of the copy.
    pub fn tick(&self) -> u64 {
        self.tick
    }

    /// Awake objects with their configurations.
    pub(super) fn configurations(&self) -> impl Iterator<Item = (usize, &[f64])> {
        let begins = std::iter::once(0).chain(self.awake.iter().map(|(_, end)| *end));
        let ends = self.awake.iter();
        begins
            .zip(ends)
            .map(|(begin, (object, end))| (*object, &self.numbers[begin..*end]))
    }
}

/// Copier of shapes on due ticks, for the thread that ticks. No allocation, no lock; a few kilobytes every sixteenth
/// tick.
#[derive(Clone, Debug)]
pub struct Sampler {
    cadence: Cadence,
    yielding: Vec<usize>,
}

impl Sampler {
    /// Copier for a scene.
    pub fn new(scene: &Scene) -> Self {
        let objects = scene.objects.iter().enumerate();
        Self {
            cadence: Cadence::new(FRAMES_HZ, scene.tick_s()),
            yielding: objects
                .filter(|(_, object)| !object.tissue.is_rigid())
                .map(|(k, _)| k)
                .collect(),
        }
    }

    /// Whether a copy is due after this tick. Must be called once for every tick.
    pub fn is_due(&mut self, tick: u64) -> bool {
        self.cadence.is_due(tick)
    }

    /// Copies the shapes that `tick` left in the workspace into `out`, which was made for the same scene.
    pub fn read(&self, tick: u64, workspace: &Workspace, out: &mut Shapes) {
        out.tick = tick;
        out.awake.clear();
        out.numbers.clear();
        out.contacts.clear();
        out.bearing = [0; sulcus_core::MAX_TOOLS];
        for &k in &self.yielding {
            let shape = workspace.shape_of(k);
            // Shapes of another scene may exceed the memory. Such a shape is left out.
            let room = out.numbers.capacity() - out.numbers.len();
            if workspace.is_awake(k)
                && shape.len() <= room
                && out.awake.len() < out.awake.capacity()
            {
                out.numbers.extend_from_slice(shape);
                out.awake.push((k, out.numbers.len()));
            }
        }
        for (contact, load) in workspace.contacts() {
            if load > 0.0 {
                out.bearing[usize::from(contact.tool)] += 1;
                if out.contacts.len() < MAX_CONTACTS {
                    out.contacts.push((*contact, load));
                }
            }
        }
    }
}
