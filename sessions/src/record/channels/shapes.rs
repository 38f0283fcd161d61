//! What the thread that ticks copies for the view channels, and when.

use sulcus_core::contact::Contact;
use sulcus_core::{Scene, Workspace};

use super::cadence::{Cadence, FRAMES_HZ};

/// Contacts that are copied of a tick at most; how many there were is counted.
const MAX_CONTACTS: usize = 128;

/// What a tick left: of awake tissue the configuration, and the contacts that bear load. Made beforehand with room for all
/// that one scene can put into it.
#[derive(Debug, PartialEq)]
pub struct Shapes {
    /// The tick.
    pub(super) tick: u64,
    /// Objects, and where their configuration ends in `numbers`.
    pub(super) awake: Vec<(usize, usize)>,
    /// Their configurations, one after the other.
    pub(super) numbers: Vec<f64>,
    /// The contacts, with their loads, newtons.
    pub(super) contacts: Vec<(Contact, f64)>,
    /// How many bore load, listed or not.
    pub(super) bearing: [u32; sulcus_core::MAX_TOOLS],
}

impl Shapes {
    /// Room for what `scene` can put into it.
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

    /// Another of the same size. (A clone has room for what is in it only.)
    pub fn like(&self) -> Self {
        Self {
            tick: 0,
            awake: Vec::with_capacity(self.awake.capacity()),
            numbers: Vec::with_capacity(self.numbers.capacity()),
            contacts: Vec::with_capacity(MAX_CONTACTS),
            bearing: [0; sulcus_core::MAX_TOOLS],
        }
    }

    /// The tick that it is of.
    pub fn tick(&self) -> u64 {
        self.tick
    }

    /// Each awake object and its configuration.
    pub(super) fn configurations(&self) -> impl Iterator<Item = (usize, &[f64])> {
        let begins = std::iter::once(0).chain(self.awake.iter().map(|(_, end)| *end));
        let ends = self.awake.iter();
        begins
            .zip(ends)
            .map(|(begin, (object, end))| (*object, &self.numbers[begin..*end]))
    }
}

/// Fills [`Shapes`] where they are due. For the thread that ticks: no allocation, no lock, a copy of a few kilobytes
/// every sixteenth tick.
#[derive(Clone, Debug)]
pub struct Sampler {
    cadence: Cadence,
    yielding: Vec<usize>,
}

impl Sampler {
    /// For a scene.
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

    /// Whether something is to be copied after this tick. Asked once for every tick.
    pub fn is_due(&mut self, tick: u64) -> bool {
        self.cadence.is_due(tick)
    }

    /// Copies what `tick` left in the workspace into `out`, which was made for the same scene.
    pub fn read(&self, tick: u64, workspace: &Workspace, out: &mut Shapes) {
        out.tick = tick;
        out.awake.clear();
        out.numbers.clear();
        out.contacts.clear();
        out.bearing = [0; sulcus_core::MAX_TOOLS];
        for &k in &self.yielding {
            let shape = workspace.shape_of(k);
            // Never more than there is room for, unless made for another scene; then it is left out.
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
