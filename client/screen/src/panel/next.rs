//! Next step of the student, in plain sentences that a teacher would speak.

use super::state::{Help, Rating, Status, Tour};
use super::words::decimal;
use crate::readings::Stop;
use crate::strings::{Strings, fill};

/// Next step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Next {
    /// The session is paused.
    Wait,
    /// The tour has ended.
    End,
    /// The probe goes to a stop.
    GoTo(Stop),
    /// The tip is in a pocket and touches nothing; the stop.
    SlideDown(Stop),
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
            _ if help.depth_mm.is_some() => Self::SlideDown(stop),
            _ => Self::GoTo(stop),
        })
    }

    /// Sentences of the step.
    pub fn sentence(&self, strings: &Strings) -> String {
        let words = &strings.steps;
        let newtons = |n: f64| decimal(n, 2, strings);
        let place = |at: Stop| {
            let site = strings.sites[at.site.number()];
            fill(words.place, &[&at.tooth.to_string(), site])
        };
        match *self {
            Self::Wait => words.wait.into(),
            Self::End => words.ended.into(),
            Self::GoTo(at) => fill(words.go_to, &[&place(at)]),
            Self::SlideDown(at) => fill(words.slide_down, &[&place(at)]),
            Self::PressMore([low, high]) => {
                fill(words.press_more, &[&newtons(low), &newtons(high)])
            }
            Self::Read => words.read.into(),
            Self::PressLess(high) => fill(words.press_less, &[&newtons(high)]),
            Self::Confirm(Some(at)) => fill(words.confirm, &[&place(at)]),
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
            "Place the tip at 36, buccal. Let it slide down until you feel the floor.",
        );
        begins(
            said(&readings, &status, 0.1),
            "Press a little more on the floor, to between 0.20 and 0.25 newtons.",
        );
        begins(
            said(&readings, &status, 0.21),
            "This force is right. Read the band at the margin",
        );
        readings.press(Key::Digit(4));
        begins(
            said(&readings, &status, 0.21),
            "Confirm the depth. The next site is 36, mesiobuccal.",
        );
        begins(
            said(&readings, &status, 0.4),
            "This is too heavy. Ease off below 0.25 newtons.",
        );
        readings.press(Key::Next);
        readings.press(Key::Digit(4));
        begins(
            said(&readings, &status, 0.0),
            "Confirm the depth. This was the last site.",
        );
        readings.press(Key::Next);
        begins(said(&readings, &status, 0.0), "All sites are read.");
        status.paused_by_station = true;
        begins(said(&readings, &status, 0.4), "The session is paused.");
        assert_eq!(Next::of(None, &Help::default(), &Status::default()), None);
    }

    #[test]
    fn a_tip_in_the_pocket_is_led_down_and_every_step_is_whole_sentences() {
        let at = Stop {
            tooth: 36,
            site: Site::DistoBuccal,
        };
        let tour = Tour::of(&Readings::new(vec![at]), None);
        let help = Help {
            depth_mm: Some(1.2),
            ..Help::default()
        };
        let next = Next::of(Some(&tour), &help, &Status::default());
        assert_eq!(next, Some(Next::SlideDown(at)));
        for next in [
            Next::Wait,
            Next::End,
            Next::GoTo(at),
            Next::SlideDown(at),
            Next::PressMore([0.2, 0.25]),
            Next::Read,
            Next::PressLess(0.25),
            Next::Confirm(Some(at)),
            Next::Confirm(None),
        ] {
            let text = next.sentence(&ENGLISH);
            assert!(
                text.ends_with('.') && !text.contains(['{', ':', '(']),
                "{text}"
            );
            for sentence in text.split_inclusive(". ") {
                let first = sentence.chars().next().expect("a letter");
                assert!(first.is_uppercase(), "{text}");
                assert!(sentence.split_whitespace().count() <= 16, "{text}");
            }
        }
    }
}
