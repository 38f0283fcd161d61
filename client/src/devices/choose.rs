//! Choice of devices on the command line: `NAME[=left|right]`.
//!
//! A name is a serial number, `LIBRARY:SERIAL`, or the name of a library with one device.

use std::str::FromStr;

use anyhow::bail;
use sulcus_devices::{Found, State};

use super::settings::{Hand, Settings};

/// Beginning of a name that stands for a recording.
pub const PLAYBACK: &str = "playback:";

/// Name of a device on the command line, and its hand.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Named {
    /// Name.
    pub name: String,
    /// Hand; `None` for the stored hand.
    pub hand: Option<Hand>,
}

impl FromStr for Named {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let is_file = text.starts_with(PLAYBACK);
        let (name, hand) = match text.rsplit_once('=').filter(|_| !is_file) {
            None => (text, None),
            Some((name, hand)) => {
                let found = Hand::from_name(hand);
                let hand =
                    found.ok_or_else(|| format!("the hand is `{hand}`, expected left or right"))?;
                (name, Some(hand))
            }
        };
        if name.is_empty() {
            return Err("the name is empty, expected NAME or NAME=left or NAME=right".into());
        }
        Ok(Self {
            name: name.into(),
            hand,
        })
    }
}

/// Device that a person has chosen.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Chosen {
    /// Name of the back-end.
    pub library: &'static str,
    /// Serial number.
    pub serial: String,
    /// Hand; `None`: not given and not stored.
    pub hand: Option<Hand>,
}

/// Finds the devices of `named` among `found`. The stored hand applies where no hand is named.
///
/// # Errors
/// A name fits no device, several devices, or an unusable device; a device or a hand is named twice; more than two
/// devices are named.
pub fn choose(
    named: &[Named],
    found: &[Found],
    settings: &Settings,
) -> anyhow::Result<Vec<Chosen>> {
    if named.len() > 2 {
        bail!(
            "--device is given {} times, expected once or twice",
            named.len()
        );
    }
    let mut chosen: Vec<Chosen> = Vec::new();
    for named in named {
        let device = one(&named.name, found)?;
        let hand = named
            .hand
            .or(settings.of(device.library, &device.serial).hand);
        let one = Chosen {
            library: device.library,
            serial: device.serial.clone(),
            hand,
        };
        let is_same = |other: &Chosen| (other.library, &other.serial) == (one.library, &one.serial);
        if chosen.iter().any(is_same) {
            bail!(
                "device {}:{} is named twice, expected two devices",
                one.library,
                one.serial
            );
        }
        if let Some(hand) = hand
            && chosen.iter().any(|other| other.hand == Some(hand))
        {
            bail!(
                "both devices are those of the {} hand; name the hands, as in --device NAME=left --device NAME=right",
                hand.name()
            );
        }
        chosen.push(one);
    }
    // With one hand known, the other device is that of the other hand.
    if let [a, b] = chosen.as_mut_slice() {
        a.hand = a.hand.or(b.hand.map(Hand::other));
        b.hand = b.hand.or(a.hand.map(Hand::other));
    }
    Ok(chosen)
}

/// The device of a name.
fn one<'a>(name: &str, found: &'a [Found]) -> anyhow::Result<&'a Found> {
    let fits = |found: &&Found| {
        let full = format!("{}:{}", found.library, found.serial);
        found.serial == name || full == name || found.library == name
    };
    let fitting: Vec<&Found> = found.iter().filter(fits).collect();
    let devices: Vec<&Found> = fitting
        .iter()
        .copied()
        .filter(|f| !f.serial.is_empty())
        .collect();
    match (devices.as_slice(), fitting.first()) {
        ([device], _) => match device.state {
            State::Ready | State::Uncalibrated | State::Asleep => Ok(device),
            _ => bail!("device `{name}` cannot be used: {}", device.message),
        },
        ([], Some(library)) => bail!("`{name}` has no device: {}", library.message),
        ([], None) => bail!(
            "--device is `{name}`, expected `simulated` or one of {}; `sulcus-client devices` lists all",
            names(found)
        ),
        (several, _) => bail!(
            "`{name}` has {} devices, expected one of {}",
            several.len(),
            several
                .iter()
                .map(|found| format!("`{}:{}`", found.library, found.serial))
                .collect::<Vec<_>>()
                .join(", ")
        ),
    }
}

/// Names for a message.
fn names(found: &[Found]) -> String {
    let names: Vec<String> = found
        .iter()
        .map(|found| match found.serial.as_str() {
            "" => format!("`{}` (no device now)", found.library),
            serial => format!("`{}:{serial}`", found.library),
        })
        .collect();
    names.join(", ")
}

#[cfg(test)]
mod tests {
    use super::super::settings::DeviceSettings;
    use super::*;

    fn device(library: &'static str, serial: &str, state: State) -> Found {
        Found {
            model: "model".into(),
            serial: serial.into(),
            ..Found::nothing(library, state, "a remark")
        }
    }

    fn found() -> Vec<Found> {
        vec![
            device("haply", "049D", State::Ready),
            device("haply", "04A1", State::Ready),
            device("openhaptics", "Default Device", State::Ready),
            device("openhaptics", "Broken", State::InUse),
            Found::nothing("forcedimension", State::NoLibrary, "libdrd is absent"),
        ]
    }

    fn named(texts: &[&str]) -> Vec<Named> {
        texts
            .iter()
            .map(|text| text.parse().expect("a name"))
            .collect()
    }

    fn refused(texts: &[&str]) -> String {
        choose(&named(texts), &found(), &Settings::default())
            .expect_err("refused")
            .to_string()
    }

    #[test]
    fn a_name_is_a_serial_number_or_a_library_with_one_usable_device() {
        let chosen = |texts: &[&str]| {
            choose(&named(texts), &found(), &Settings::default())
                .expect("chosen")
                .iter()
                .map(|one| format!("{}:{} {:?}", one.library, one.serial, one.hand))
                .collect::<Vec<_>>()
        };
        assert_eq!(chosen(&["haply:049D"]), ["haply:049D None"]);
        assert_eq!(
            chosen(&["04A1=left", "049D"]),
            ["haply:04A1 Some(Left)", "haply:049D Some(Right)"]
        );
        assert_eq!(
            chosen(&["Default Device=right"]),
            ["openhaptics:Default Device Some(Right)"]
        );
    }

    #[test]
    fn a_wrong_name_says_what_there_is() {
        assert!(refused(&["haply"]).contains("`haply` has 2 devices"));
        assert!(refused(&["Broken"]).contains("cannot be used: a remark"));
        assert!(refused(&["forcedimension"]).contains("libdrd is absent"));
        assert!(refused(&["nothing"]).contains("`haply:049D`"));
        assert!(refused(&["049D", "haply:049D"]).contains("named twice"));
        assert!(refused(&["049D=left", "04A1=left"]).contains("left hand"));
        assert!(refused(&["049D", "04A1", "Broken"]).contains("3 times"));
        assert!(
            "049D=up"
                .parse::<Named>()
                .expect_err("refused")
                .contains("`up`")
        );
        assert!("=left".parse::<Named>().is_err());
    }

    #[test]
    fn the_stored_hand_applies_where_none_is_named() {
        let mut settings = Settings::default();
        settings.store(DeviceSettings {
            hand: Some(Hand::Left),
            ..DeviceSettings::new("haply", "049D")
        });
        let chosen = choose(&named(&["04A1", "049D"]), &found(), &settings).expect("chosen");
        assert_eq!(
            [chosen[0].hand, chosen[1].hand],
            [Some(Hand::Right), Some(Hand::Left)]
        );
    }
}
