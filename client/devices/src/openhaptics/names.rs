//! Names of devices: the library has no call that lists them, so the setup program's files are read.

use std::path::{Path, PathBuf};

/// Name by which a person asks for the device that the library opens without a name.
pub const DEFAULT: &str = "default";

/// Names of the default device in older libraries, which refuse the empty name.
pub const DEFAULT_NAMES: [&str; 2] = ["Default PHANToM", "Default Device"];

/// Largest file that is read, bytes.
const MOST_BYTES: u64 = 1 << 16;

/// Configuration of a device, of a file `NAME.config`.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Config {
    /// Name of the device, with which the library opens it.
    pub name: String,
    /// Model; empty if the file tells none.
    pub model: String,
    /// Serial number; empty if the file tells none.
    pub serial: String,
}

/// Directories of the setup program's files, in the order of their search.
pub fn directories() -> Vec<PathBuf> {
    let variable = |name| {
        std::env::var_os(name)
            .filter(|value| !value.is_empty())
            .map(PathBuf::from)
    };
    if let Some(home) = variable("GTDD_HOME") {
        return vec![home.join("config"), home];
    }
    let own = variable("HOME").or_else(|| variable("USERPROFILE"));
    let own = own.map(|home| home.join(".3dsystems").join("config"));
    let system = PathBuf::from("/usr/share/3DSystems/config");
    own.into_iter().chain([system]).collect()
}

/// Configurations of all directories, by name. A name in two directories counts once.
pub fn configs(directories: &[PathBuf]) -> Vec<Config> {
    let mut found: Vec<Config> = Vec::new();
    for directory in directories {
        let Ok(entries) = std::fs::read_dir(directory) else {
            continue;
        };
        let paths = entries.flatten().map(|entry| entry.path());
        for config in paths.filter_map(|path| read(&path)) {
            if !found.iter().any(|other| other.name == config.name) {
                found.push(config);
            }
        }
    }
    found.sort_by(|a, b| a.name.cmp(&b.name));
    found
}

fn read(path: &Path) -> Option<Config> {
    let is_config = path
        .extension()
        .is_some_and(|end| end.eq_ignore_ascii_case("config"));
    let name = path.file_stem()?.to_str().filter(|_| is_config)?;
    let is_short = path.metadata().ok()?.len() <= MOST_BYTES;
    let bytes = if is_short {
        std::fs::read(path).ok()?
    } else {
        Vec::new()
    };
    Some(parse(name, &String::from_utf8_lossy(&bytes)))
}

/// Reads `Key=value` lines of a configuration.
fn parse(name: &str, text: &str) -> Config {
    let value = |key: &str| {
        let of = |line: &str| {
            let (found, value) = line.split_once('=')?;
            found
                .trim()
                .eq_ignore_ascii_case(key)
                .then(|| value.trim().trim_matches('"').to_owned())
        };
        text.lines().find_map(of).unwrap_or_default()
    };
    Config {
        name: name.to_owned(),
        model: value("ModelType"),
        serial: value("DeviceSerialNumber"),
    }
}

/// Names to try for `wanted`, a name or a serial number, in the order of their trial: `None` is the default device.
///
/// A name wins over a serial number. The second list holds devices whose serial number the files do not tell.
pub fn candidates(wanted: &str, configs: &[Config]) -> (Vec<Option<String>>, Vec<Option<String>>) {
    let named = |config: &&Config| config.name == wanted;
    let by_serial = |config: &&Config| !config.serial.is_empty() && config.serial == wanted;
    if let Some(config) = configs
        .iter()
        .find(named)
        .or_else(|| configs.iter().find(by_serial))
    {
        return (vec![Some(config.name.clone())], Vec::new());
    }
    let defaults = [None]
        .into_iter()
        .chain(DEFAULT_NAMES.map(|name| Some(name.to_owned())));
    if wanted == DEFAULT {
        return (defaults.collect(), Vec::new());
    }
    let unknown = configs.iter().filter(|config| config.serial.is_empty());
    let unknown: Vec<_> = unknown.map(|config| Some(config.name.clone())).collect();
    if DEFAULT_NAMES.contains(&wanted) {
        return (vec![Some(wanted.to_owned())], Vec::new());
    }
    let unknown = if configs.is_empty() {
        vec![None]
    } else {
        unknown
    };
    (Vec::new(), unknown)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn config(name: &str, serial: &str) -> Config {
        Config {
            name: name.into(),
            model: String::new(),
            serial: serial.into(),
        }
    }

    #[test]
    fn files_of_the_setup_program_are_read() {
        let home = tempfile::tempdir().expect("directory");
        let text = "ModelType=OMNI\r\n CardType = USB\nDeviceSerialNumber= 31000123 \n";
        std::fs::write(home.path().join("Left Device.config"), text).expect("file");
        std::fs::write(home.path().join("Right.CONFIG"), [0xFF, 0x3D, 0x00]).expect("file");
        std::fs::write(home.path().join("notes.txt"), "ModelType=OMNI").expect("file");
        let found = configs(&[
            home.path().into(),
            home.path().join("none"),
            home.path().into(),
        ]);
        let left = Config {
            model: "OMNI".into(),
            ..config("Left Device", "31000123")
        };
        assert_eq!(found, [left, config("Right", "")]);
    }

    #[test]
    fn a_device_is_found_by_name_or_serial_number() {
        let all = [config("Left", "17"), config("17", "4"), config("Other", "")];
        assert_eq!(candidates("Left", &all).0, [Some("Left".into())]);
        assert_eq!(candidates("17", &all).0, [Some("17".into())]);
        assert_eq!(candidates("4", &all).0, [Some("17".into())]);
        assert_eq!(candidates("99", &all), (vec![], vec![Some("Other".into())]));
        assert_eq!(candidates("99", &[]), (vec![], vec![None]));
        assert_eq!(candidates(DEFAULT, &all).0[0], None);
        assert_eq!(candidates(DEFAULT, &all).0.len(), 3);
    }

    proptest::proptest! {
        #[test]
        fn no_text_of_a_file_panics(text in "\\PC*", tail in "(ModelType|DeviceSerialNumber)?=?\\PC{0,20}") {
            parse("name", &format!("{text}\n{tail}"));
        }
    }
}
