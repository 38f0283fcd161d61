//! Checks of the driver of the Touch: its configurations and serial lines.

use super::check::{Check, part, shown};
use super::config::{Config, Folder, read};
use super::dependencies;
use super::roots::Roots;
use super::sysfs::UsbDevice;

/// Checks of the driver; one check that is ok if neither a Touch nor OpenHaptics is there.
pub fn checks(roots: &Roots, devices: &[UsbDevice]) -> Vec<Check> {
    let touches: Vec<&UsbDevice> = devices
        .iter()
        .filter(|device| device.kind.library == Some("openhaptics"))
        .collect();
    let mut checks = Vec::new();
    if let Some(touch) = touches.first() {
        let (check, configs) = configurations(roots, touch);
        checks.push(check);
        checks.extend(channels(&touches, &configs));
    }
    checks.extend(dependencies::check(roots));
    if checks.is_empty() {
        checks.push(Check::fine(
            "driver",
            "no Touch is plugged in and OpenHaptics is not installed.",
        ));
    }
    checks
}

/// Check of the folder of the configurations, and the configurations.
fn configurations(roots: &Roots, touch: &UsbDevice) -> (Check, Vec<Config>) {
    const NAME: &str = "driver configuration";
    for folder in &roots.configs {
        match read(roots, folder) {
            Folder::Empty => {}
            Folder::Closed(path) => {
                let cure = if folder.iter().any(|name| name == ".3dsystems") {
                    r#"sudo chown -R "$USER""#
                } else {
                    "sudo chmod -R a+rX"
                };
                let message = format!(
                    "this user may not read {}: a setup tool under sudo writes files for root alone. Run: {cure} '{}'",
                    shown(&path),
                    shown(folder.parent().unwrap_or(folder))
                );
                return (Check::wrong(NAME, message), Vec::new());
            }
            Folder::Open(configs) => {
                let names: Vec<_> = configs
                    .iter()
                    .take(3)
                    .map(|config| format!("`{}`", part(&config.name)))
                    .collect();
                let message = format!(
                    "configurations: {} ({}) in {}.",
                    configs.len(),
                    part(&names.join(", ")),
                    shown(folder)
                );
                return (Check::fine(NAME, message), configs);
            }
        }
    }
    let message = format!(
        "{} is plugged in, but no folder has a configuration. Run the vendor's setup tool as this user, without sudo: \
         under sudo it writes into root's folder. Set GTDD_HOME if the folder is another one than ~/.3dsystems.",
        touch.label()
    );
    (Check::wrong(NAME, message), Vec::new())
}

/// Check of the serial lines against the configurations; `None` without a serial line or without configurations.
fn channels(touches: &[&UsbDevice], configs: &[Config]) -> Option<Check> {
    const NAME: &str = "driver channel";
    let present: Vec<u32> = touches.iter().flat_map(|touch| touch.channels()).collect();
    if present.is_empty() || configs.is_empty() {
        return None;
    }
    let used = |channel: u32| configs.iter().any(|config| config.channel == Some(channel));
    let stale = configs.iter().find(|config| {
        config
            .channel
            .is_some_and(|channel| !present.contains(&channel))
    });
    let unused = present.iter().copied().find(|&channel| !used(channel));
    let check = match (unused, stale) {
        (
            Some(channel),
            Some(Config {
                name,
                channel: Some(wrong),
            }),
        ) => Check::wrong(
            NAME,
            format!(
                "the Touch is at ttyACM{channel}, but configuration `{}` has Channel={wrong}. Set Channel={channel} in \
                 its file, or run the vendor's setup tool again: a new plug changes the number.",
                part(name)
            ),
        ),
        (Some(channel), _) => Check::wrong(
            NAME,
            format!(
                "the Touch is at ttyACM{channel}, but no configuration has Channel={channel}. Run the vendor's setup \
                 tool for this device."
            ),
        ),
        (None, Some(config)) => Check::fine(
            NAME,
            format!(
                "each Touch has a configuration. Configuration `{}` names a serial line that does not exist: it cannot \
                 be opened now.",
                part(&config.name)
            ),
        ),
        (None, None) => Check::fine(NAME, "each Touch has a configuration with its serial line."),
    };
    Some(check)
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::super::sysfs::known;
    use super::super::tree::{Tree, sound};
    use super::*;

    fn of(roots: &Roots) -> Vec<Check> {
        let checks = checks(roots, &known(&roots.usb));
        sound(&checks);
        checks
    }

    fn states(checks: &[Check]) -> Vec<(&str, bool)> {
        checks
            .iter()
            .map(|check| (check.name.as_str(), check.ok))
            .collect()
    }

    #[test]
    fn nothing_is_checked_without_touch_and_library() {
        let tree = Tree::new();
        tree.bus("2-1", 0x0403, 0xcb48, 0o666);
        assert_eq!(states(&of(&tree.roots())), [("driver", true)]);
    }

    #[test]
    fn a_touch_without_configuration_needs_the_setup_tool() {
        let tree = Tree::new();
        tree.touch("1-2", 0, 0o666);
        let checks = of(&tree.roots());
        assert_eq!(states(&checks), [("driver configuration", false)]);
        assert!(checks[0].message.contains("without sudo"));
    }

    #[test]
    fn configurations_for_root_alone_are_told() {
        let tree = Tree::new();
        tree.touch("1-2", 0, 0o666);
        tree.config("Default Device", 0);
        tree.mode("home/.3dsystems/config/Default Device.config", 0o600);
        let checks = of(&tree.roots());
        assert_eq!(states(&checks), [("driver configuration", false)]);
        assert!(checks[0].message.contains("for root alone"), "{checks:?}");
        assert!(checks[0].message.contains("chown"), "{checks:?}");
    }

    #[test]
    fn a_wrong_channel_names_both_numbers() {
        let tree = Tree::new();
        tree.touch("1-2", 1, 0o666);
        tree.config("Default Device", 0);
        let checks = of(&tree.roots());
        assert_eq!(
            states(&checks),
            [("driver configuration", true), ("driver channel", false)]
        );
        assert!(checks[1].message.contains("ttyACM1") && checks[1].message.contains("Channel=0"));
        assert!(checks[1].message.contains("`Default Device`"));
    }

    #[test]
    fn two_touches_need_two_configurations() {
        let tree = Tree::new();
        tree.touch("1-2", 0, 0o666);
        tree.touch("1-3", 1, 0o666);
        tree.config("Left", 0);
        let checks = of(&tree.roots());
        assert!(
            !checks[1].ok && checks[1].message.contains("no configuration has Channel=1"),
            "{checks:?}"
        );
        tree.config("Right", 1);
        assert!(of(&tree.roots())[1].ok);
        tree.config("Spare", 9);
        let checks = of(&tree.roots());
        assert!(
            checks[1].ok && checks[1].message.contains("`Spare`"),
            "{checks:?}"
        );
    }

    #[test]
    fn a_touch_hid_has_no_channel() {
        let tree = Tree::new();
        tree.raw("1-2", 0x2988, 0x0304, 0, 0o666);
        tree.config("Default Device", 7);
        assert_eq!(states(&of(&tree.roots())), [("driver configuration", true)]);
    }

    #[test]
    fn long_names_keep_the_remedy() {
        let tree = Tree::new();
        tree.touch("1-2", 1, 0o666);
        tree.config(&"n".repeat(200), 0);
        let checks = checks(&tree.roots(), &known(&tree.roots().usb));
        assert!(
            checks[1]
                .message
                .ends_with("a new plug changes the number."),
            "{checks:?}"
        );
        assert!(checks[1].message.contains("Set Channel=1 in"), "{checks:?}");
    }
}
