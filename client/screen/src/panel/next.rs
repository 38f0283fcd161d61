//! Next step of the student, as one sentence that a teacher would speak.

use super::state::{Help, Rating, Status, Tour};
use super::words::{decimal, stop};
use crate::readings::Stop;
use crate::strings::{Strings, fill};

/// Next step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Next {
    /// The session is paused.
    Wait,
    /// The tour has ended.
    End,
    /// The probe goes to a stop; its least and greatest force, newtons, if prescribed.
    GoTo(Stop, Option<[f64; 2]>),
    /// The force is too light: least and greatest force, newtons.
    PressMore([f64; 2]),
    /// The force is right, and the depth is not entered yet.
    Read,
    /// The force is too heavy: greatest force, newtons.
    PressLess(f64),
    /// The depth is entered; the stop after the present one.
    Confirm(Option<Stop>),
}

impl Next {
    /// Next step; `None` without a tour. A heavy force comes before all else but a pause.
    pub fn of(tour: Option<&Tour>, help: &Help, status: &Status) -> Option<Self> {
        let tool = help.tools.iter().find(|tool| tool.zone_n.is_some());
        let zone = tool.and_then(|tool| tool.zone_n);
        let rated = tool.and_then(|tool| tool.rating()).zip(zone);
        if status.is_paused() {
            return Some(Self::Wait);
        }
        if let Some((Rating::Heavy, [_, high])) = rated {
            return Some(Self::PressLess(high));
        }
        let tour = tour?;
        let Some(stop) = tour.stop else {
            return Some(Self::End);
        };
        if tour.draft.depth_mm.is_some() {
            return Some(Self::Confirm(tour.following));
        }
        Some(match rated {
            Some((Rating::Light, zone)) => Self::PressMore(zone),
            Some((Rating::Right, _)) => Self::Read,
            _ => Self::GoTo(stop, zone),
        })
    }

    /// Sentence of the step.
    pub fn sentence(&self, strings: &Strings) -> String {
        let words = &strings.steps;
        let newtons = |n: f64| decimal(n, 2, strings);
        match *self {
            Self::Wait => words.wait.into(),
            Self::End => words.ended.into(),
            Self::GoTo(at, None) => fill(words.go_to_free, &[&stop(at, strings)]),
            Self::GoTo(at, Some([low, high])) => fill(
                words.go_to,
                &[&stop(at, strings), &newtons(low), &newtons(high)],
            ),
            Self::PressMore([low, high]) => {
                fill(words.press_more, &[&newtons(low), &newtons(high)])
            }
            Self::Read => words.read.into(),
            Self::PressLess(high) => fill(words.press_less, &[&newtons(high)]),
            Self::Confirm(Some(at)) => fill(words.confirm, &[&stop(at, strings)]),
            Self::Confirm(None) => words.confirm_last.into(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::state::ToolForce;
    use super::*;
    use crate::readings::{Key, Readings, Site};
    use crate::strings::ENGLISH;

    #[test]
    fn the_teacher_follows_the_hand_and_the_keys() {
        let at = |site| Stop { tooth: 36, site };
        let mut readings = Readings::new(vec![at(Site::Buccal), at(Site::MesioBuccal)]);
        let mut status = Status::default();
        let said = |readings: &Readings, status: &Status, force_n| {
            let zone_n = Some([0.2, 0.25]);
            let probe = ToolForce {
                force_n,
                zone_n,
                ..ToolForce::default()
            };
            let mirror = ToolForce {
                force_n: 3.0,
                ..ToolForce::default()
            };
            let help = Help {
                tools: vec![mirror, probe],
                ..Help::default()
            };
            let tour = Tour::of(readings, None);
            let next = Next::of(Some(&tour), &help, status).expect("a tour");
            next.sentence(&ENGLISH)
        };
        let begins = |text: String, start: &str| assert!(text.starts_with(start), "{text}");
        begins(
            said(&readings, &status, 0.0),
            "Tooth 36 buccal: walk the probe",
        );
        begins(
            said(&readings, &status, 0.1),
            "A little more: 0.20 to 0.25 N",
        );
        begins(said(&readings, &status, 0.21), "Good. Hold, read");
        readings.press(Key::Digit(4));
        begins(
            said(&readings, &status, 0.21),
            "Next key: Tooth 36 mesiobuccal",
        );
        begins(
            said(&readings, &status, 0.4),
            "Too heavy. Ease off below 0.25 N",
        );
        readings.press(Key::Next);
        readings.press(Key::Digit(4));
        begins(said(&readings, &status, 0.0), "Next key: end");
        readings.press(Key::Next);
        begins(said(&readings, &status, 0.0), "All sites");
        status.paused_by_station = true;
        begins(said(&readings, &status, 0.4), "Paused");
        assert_eq!(Next::of(None, &Help::default(), &Status::default()), None);
    }
}
