//! Readings during a session, from a keyboard or a pedal, while both hands work.
//!
//! A tour is an ordered list of sites. Keys fill in the findings of the present site ([`Key`]). [`Key::Next`] confirms
//! the findings as an [`Entry`], an event of the recording with the form of a typed line. A wrong key changes nothing
//! and costs nothing. No function reads a clock.
//!
//! A confirmed entry is in the recording for good. After an undo the site is confirmed anew, and the later entry
//! counts, as for a person who corrects a called number.

mod answer;
mod entry;
mod foot;
mod key;
pub mod number;
pub mod pedal;
mod place;
mod site;
mod switch;
#[cfg(test)]
mod tests;

pub use answer::{Field, Heard, Wrong};
pub use entry::{
    Draft, Entry, MOST_ABOVE_MM, MOST_DEPTH_MM, MOST_FURCATION, MOST_RECESSION_MM, READING_CALLED,
};
pub use foot::{Foot, PedalUse};
pub use key::Key;
pub use pedal::{Pedal, PedalRule};
pub use place::Place;
pub use site::{Site, Stop};
pub use switch::{MouseSwitch, Switch};

/// Largest number of keys that can be taken back. Chosen: ten keys at each site of a whole mouth.
const MOST_UNDONE: usize = 2000;

/// Part of the state that a key changes and an undo restores.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Step {
    position: usize,
    field: Field,
    /// Findings at `position`.
    draft: Draft,
}

/// Readings of a tour.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Readings {
    tour: Vec<Stop>,
    /// Findings of each stop.
    drafts: Vec<Draft>,
    position: usize,
    field: Field,
    /// States before the last keys, oldest first.
    before: Vec<Step>,
    /// Last entry of each confirmed site, oldest first.
    sent: Vec<Entry>,
}

impl Readings {
    /// Readings at the start of a tour.
    pub fn new(tour: Vec<Stop>) -> Self {
        Self {
            drafts: vec![Draft::default(); tour.len()],
            tour,
            position: 0,
            field: Field::Depth,
            before: Vec::new(),
            sent: Vec::new(),
        }
    }

    /// Present stop, which a screen highlights; `None` at the end of the tour.
    pub fn stop(&self) -> Option<Stop> {
        self.tour.get(self.position).copied()
    }

    /// Stop after the present one.
    pub fn following(&self) -> Option<Stop> {
        self.tour.get(self.position + 1).copied()
    }

    /// Findings at the present stop; empty at the end of the tour.
    pub fn draft(&self) -> Draft {
        self.drafts.get(self.position).copied().unwrap_or_default()
    }

    /// Finding that takes the next digit.
    pub fn field(&self) -> Field {
        self.field
    }

    /// Number of the present stop from 0 on, and number of all stops.
    pub fn progress(&self) -> (usize, usize) {
        (self.position, self.tour.len())
    }

    /// Last entry of each confirmed site, in the order of confirmation.
    pub fn entries(&self) -> impl Iterator<Item = &Entry> {
        self.sent.iter()
    }

    /// Last entry at `stop`; `None` before the first confirmation.
    pub fn entry(&self, stop: Stop) -> Option<&Entry> {
        self.sent.iter().find(|entry| entry.stop == stop)
    }

    /// Takes in a key.
    pub fn press(&mut self, key: Key) -> Heard {
        if key == Key::Undo {
            return self.undo();
        }
        let step = Step {
            position: self.position,
            field: self.field,
            draft: self.draft(),
        };
        match self.change(key) {
            Ok(entry) => {
                if self.before.len() == MOST_UNDONE {
                    self.before.remove(0);
                }
                self.before.push(step);
                entry.map_or(Heard::Taken, Heard::Confirmed)
            }
            Err(wrong) => Heard::Wrong(wrong),
        }
    }

    fn undo(&mut self) -> Heard {
        let Some(step) = self.before.pop() else {
            return Heard::Wrong(Wrong::NothingToUndo);
        };
        (self.position, self.field) = (step.position, step.field);
        if let Some(draft) = self.drafts.get_mut(self.position) {
            *draft = step.draft;
        }
        Heard::Taken
    }

    /// Changes the state by `key`, or leaves it entirely as it was.
    fn change(&mut self, key: Key) -> Result<Option<Entry>, Wrong> {
        if key == Key::Back {
            self.position = self.position.checked_sub(1).ok_or(Wrong::AtStart)?;
            self.field = Field::Depth;
            return Ok(None);
        }
        let (Some(stop), Some(draft)) = (self.stop(), self.drafts.get_mut(self.position)) else {
            return Err(Wrong::Ended);
        };
        match key {
            Key::Digit(digit) => self.field = digit_at(draft, self.field, digit)?,
            Key::Minus => match self.field {
                Field::Recession { above, mm: None } => {
                    let above = !above;
                    self.field = Field::Recession { above, mm: None };
                }
                _ => return Err(Wrong::SignOutOfPlace),
            },
            Key::Depth => {
                draft.depth_mm = None;
                self.field = Field::Depth;
            }
            Key::Count(mm) => {
                let mm = Some(mm).filter(|mm| *mm <= MOST_DEPTH_MM);
                draft.depth_mm = Some(mm.ok_or(Wrong::OutOfRange)?);
                self.field = Field::Depth;
            }
            Key::Bleeding => {
                draft.bleeding = match draft.bleeding {
                    None => Some(true),
                    Some(true) => Some(false),
                    Some(false) => None,
                }
            }
            Key::Suppuration => draft.suppuration = !draft.suppuration,
            Key::Recession => {
                draft.recession_mm = None;
                let (above, mm) = (false, None);
                self.field = Field::Recession { above, mm };
            }
            Key::Furcation if stop.site.is_proximal() => return Err(Wrong::Proximal),
            Key::Furcation => {
                draft.furcation = None;
                self.field = Field::Furcation;
            }
            Key::Next => return self.confirm(stop),
            Key::Undo | Key::Back => {}
        }
        Ok(None)
    }

    fn confirm(&mut self, stop: Stop) -> Result<Option<Entry>, Wrong> {
        let draft = self.draft();
        let said = draft.at(stop);
        if said.is_none() && !draft.is_empty() {
            return Err(Wrong::NoDepth);
        }
        self.position += 1;
        self.field = Field::Depth;
        let earlier = self.entry(stop);
        let entry = said.map(|said| said.after(earlier));
        // The same findings again are no new event.
        let Some(entry) = entry.filter(|entry| earlier != Some(entry)) else {
            return Ok(None);
        };
        self.sent.retain(|earlier| earlier.stop != stop);
        self.sent.push(entry);
        Ok(Some(entry))
    }
}

/// Enters a digit into the findings, and returns the field of the next digit.
fn digit_at(draft: &mut Draft, field: Field, digit: u8) -> Result<Field, Wrong> {
    match field {
        Field::Depth => {
            let mm =
                number::typed(draft.depth_mm, digit, MOST_DEPTH_MM).ok_or(Wrong::OutOfRange)?;
            draft.depth_mm = Some(mm);
            Ok(Field::Depth)
        }
        Field::Recession { above, mm } => {
            let most = if above {
                MOST_ABOVE_MM
            } else {
                MOST_RECESSION_MM
            };
            let mm = number::typed(mm, digit, most).ok_or(Wrong::OutOfRange)?;
            let below = i8::try_from(mm).map_err(|_| Wrong::OutOfRange)?;
            draft.recession_mm = Some(if above { -below } else { below });
            Ok(Field::Recession {
                above,
                mm: Some(mm),
            })
        }
        Field::Furcation if digit <= MOST_FURCATION => {
            draft.furcation = Some(digit);
            Ok(Field::Depth)
        }
        Field::Furcation => Err(Wrong::OutOfRange),
    }
}
