//! Readings of whole tours, and of any sequence of keys.

use super::*;
use proptest::prelude::*;

fn tour() -> Vec<Stop> {
    let sites = [Site::DistoBuccal, Site::Buccal, Site::MesioBuccal];
    sites.map(|site| Stop { tooth: 36, site }).to_vec()
}

/// Entries of typed characters, and the readings behind them.
fn typed(text: &str) -> (Vec<Entry>, Readings) {
    let mut readings = Readings::new(tour());
    let keys = text.chars().filter_map(Key::from_char);
    let heard = keys.map(|key| readings.press(key));
    let confirmed = heard.filter_map(|heard| match heard {
        Heard::Confirmed(entry) => Some(entry),
        _ => None,
    });
    (confirmed.collect(), readings)
}

fn jsons(text: &str) -> Vec<String> {
    typed(text).0.iter().map(Entry::json).collect()
}

#[test]
fn a_tour_is_typed_as_it_is_called() {
    assert_eq!(
        jsons("5b\r3f1r-1\r12sn"),
        [
            r#"{"bleeding":true,"depth_mm":5,"site":"distobuccal","tooth":36}"#,
            r#"{"depth_mm":3,"furcation":1,"recession_mm":-1,"site":"buccal","tooth":36}"#,
            r#"{"depth_mm":12,"site":"mesiobuccal","suppuration":true,"tooth":36}"#,
        ]
    );
    let (_, readings) = typed("5\r3\r12\r");
    assert_eq!((readings.stop(), readings.progress()), (None, (3, 3)));
    assert_eq!(readings.entries().count(), 3);
}

#[test]
fn the_present_site_is_the_one_that_the_screen_shows() {
    let (_, readings) = typed("5\r");
    assert_eq!(readings.stop(), Some(tour()[1]));
    assert_eq!(readings.following(), Some(tour()[2]));
    assert_eq!(readings.draft(), Draft::default());
    assert_eq!(
        readings.entry(tour()[0]).map(|entry| entry.depth_mm),
        Some(5)
    );
}

#[test]
fn wrong_keys_change_nothing() {
    for (text, key, wrong) in [
        ("2", Key::Digit(5), Wrong::OutOfRange),
        ("3", Key::Minus, Wrong::SignOutOfPlace),
        ("r1", Key::Minus, Wrong::SignOutOfPlace),
        ("r-1", Key::Digit(1), Wrong::OutOfRange),
        ("3", Key::Furcation, Wrong::Proximal),
        ("\r3f", Key::Digit(4), Wrong::OutOfRange),
        ("b", Key::Next, Wrong::NoDepth),
        ("", Key::Undo, Wrong::NothingToUndo),
        ("", Key::Back, Wrong::AtStart),
        ("", Key::Digit(10), Wrong::OutOfRange),
        ("4", Key::Count(21), Wrong::OutOfRange),
        ("\r\r\r", Key::Digit(4), Wrong::Ended),
        ("\r\r\r", Key::Next, Wrong::Ended),
    ] {
        let (_, mut readings) = typed(text);
        let before = readings.clone();
        assert_eq!(readings.press(key), Heard::Wrong(wrong), "{text} {key:?}");
        assert_eq!(readings, before, "{text} {key:?}");
    }
}

#[test]
fn a_corrected_site_is_sent_again_and_an_unchanged_one_is_not() {
    assert_eq!(
        jsons("5b\ruu4\r"),
        [
            r#"{"bleeding":true,"depth_mm":5,"site":"distobuccal","tooth":36}"#,
            // Without the word, a reader of the log would keep the bleeding.
            r#"{"bleeding":false,"depth_mm":5,"site":"distobuccal","tooth":36}"#,
        ],
        "4 is no second digit of 5"
    );
    assert_eq!(jsons("5\r<\r").len(), 1);
    let (entries, _) = typed("5\r<p4\r");
    assert_eq!(
        entries
            .iter()
            .map(|entry| entry.depth_mm)
            .collect::<Vec<_>>(),
        [5, 4]
    );
    let (entries, _) = typed("5\ruu6\r");
    assert_eq!(
        entries
            .iter()
            .map(|entry| entry.depth_mm)
            .collect::<Vec<_>>(),
        [5, 6]
    );
}

#[test]
fn bleeding_has_three_answers() {
    let answers = ["3\r", "3b\r", "3bb\r", "3bbb\r"].map(|text| typed(text).0[0].bleeding);
    assert_eq!(answers, [None, Some(true), Some(false), None]);
}

#[test]
fn a_pedal_alone_finishes_a_tour() {
    let (mut pedal, mut readings, mut now) =
        (Pedal::new(PedalRule::alone()), Readings::new(tour()), 0);
    let mut depths = Vec::new();
    for depth in [3, 12, 5] {
        let presses = std::iter::repeat_n(100, depth).chain([800]);
        for held in presses {
            pedal.down(now);
            pedal.up(now + held);
            now += held + 100;
        }
        now += 1000;
        for key in pedal.wait(now) {
            if let Heard::Confirmed(entry) = readings.press(key) {
                depths.push(usize::from(entry.depth_mm));
            }
        }
    }
    assert_eq!(depths, [3, 12, 5]);
    assert_eq!(readings.stop(), None);
}

fn any_key() -> impl Strategy<Value = Key> {
    prop_oneof![
        6 => any::<u8>().prop_map(|n| Key::Digit(n % 12)),
        1 => any::<u8>().prop_map(Key::Count),
        4 => Just(Key::Next),
        2 => Just(Key::Undo),
        1 => Just(Key::Back),
        1 => Just(Key::Depth),
        1 => Just(Key::Minus),
        1 => Just(Key::Bleeding),
        1 => Just(Key::Suppuration),
        2 => Just(Key::Recession),
        2 => Just(Key::Furcation),
    ]
}

proptest! {
    #[test]
    fn any_keys_give_entries_in_range_and_every_key_can_be_taken_back(
        keys in proptest::collection::vec(any_key(), 0..200),
    ) {
        let mut readings = Readings::new(tour());
        for key in keys {
            let before = readings.clone();
            let heard = readings.press(key);
            match heard {
                Heard::Wrong(_) => prop_assert_eq!(&readings, &before),
                Heard::Taken | Heard::Confirmed(_) if key != Key::Undo => {
                    let mut back = readings.clone();
                    prop_assert_eq!(back.press(Key::Undo), Heard::Taken);
                    // A confirmed entry stays in the recording.
                    back.sent = before.sent.clone();
                    prop_assert_eq!(&back, &before);
                }
                _ => {}
            }
            if let Heard::Confirmed(entry) = heard {
                prop_assert!(entry.depth_mm <= 20);
                prop_assert!(entry.recession_mm.is_none_or(|mm| (-10..=20).contains(&mm)));
                prop_assert!(entry.furcation.is_none_or(|grade| grade <= 3 && !entry.stop.site.is_proximal()));
                prop_assert!(tour().contains(&entry.stop));
                prop_assert_eq!(readings.entry(entry.stop), Some(&entry));
            }
        }
    }

    #[test]
    fn every_entry_in_range_can_be_typed(
        k in 0usize..3, depth_mm in 0u8..=20, recession_mm in proptest::option::of(-10i8..=20),
        bleeding in proptest::option::of(any::<bool>()), furcation in proptest::option::of(0u8..=3),
        pus in any::<bool>(),
    ) {
        let stop = tour()[k];
        let furcation = furcation.filter(|_| !stop.site.is_proximal());
        let suppuration = pus.then_some(true);
        let entry = Entry { stop, depth_mm, recession_mm, bleeding, furcation, suppuration };
        let mut text = "\r".repeat(k) + &depth_mm.to_string();
        if let Some(mm) = recession_mm {
            text += &format!("r{mm}");
        }
        if let Some(grade) = furcation {
            text += &format!("f{grade}");
        }
        text += match bleeding { None => "", Some(true) => "b", Some(false) => "bb" };
        text += if pus { "s\r" } else { "\r" };
        prop_assert_eq!(typed(&text).0, [entry]);
    }
}
