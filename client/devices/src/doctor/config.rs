//! Configurations of the Touch, as the vendor's setup tool writes them: lines of `key=value`.

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

use super::roots::{Right, Roots};

/// Most bytes of a configuration that are read.
const LONGEST: u64 = 65536;

/// Configuration of one device.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Config {
    /// Name of the device for the library: the file's name without `.config`.
    pub name: String,
    /// Number of the serial line: `ttyACM0` is 0. `None` for a device without a serial line.
    pub channel: Option<u32>,
}

/// Folder of configurations.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Folder {
    /// No folder, or a folder without a configuration.
    Empty,
    /// This user may not read the folder or the file.
    Closed(PathBuf),
    /// Configurations, in the order of their names.
    Open(Vec<Config>),
}

/// Reads the configurations of a folder.
pub fn read(roots: &Roots, folder: &Path) -> Folder {
    match std::fs::metadata(folder) {
        Err(error) if error.kind() == std::io::ErrorKind::PermissionDenied => {
            return Folder::Closed(folder.to_owned());
        }
        Err(_) => return Folder::Empty,
        Ok(_) if !(roots.allowed)(folder, Right::Read) => return Folder::Closed(folder.to_owned()),
        Ok(_) => {}
    }
    let mut paths: Vec<PathBuf> = std::fs::read_dir(folder)
        .into_iter()
        .flatten()
        .filter_map(|entry| Some(entry.ok()?.path()))
        .filter(|path| path.extension().is_some_and(|ending| ending == "config") && path.is_file())
        .collect();
    paths.sort();
    let mut configs = Vec::new();
    for path in paths {
        let mut bytes = Vec::new();
        let read = (roots.allowed)(&path, Right::Read)
            && File::open(&path)
                .is_ok_and(|file| file.take(LONGEST).read_to_end(&mut bytes).is_ok());
        if !read {
            return Folder::Closed(path);
        }
        configs.push(Config {
            name: path
                .file_stem()
                .unwrap_or_default()
                .to_string_lossy()
                .into_owned(),
            channel: channel(&String::from_utf8_lossy(&bytes)),
        });
    }
    if configs.is_empty() {
        Folder::Empty
    } else {
        Folder::Open(configs)
    }
}

/// Number of the serial line in the text of a configuration. A card that is not USB has no serial line.
fn channel(text: &str) -> Option<u32> {
    let value = |wanted: &str| {
        text.lines().find_map(|line| {
            let (key, value) = line.split_once('=')?;
            key.trim()
                .eq_ignore_ascii_case(wanted)
                .then(|| value.trim())
        })
    };
    if value("CardType").is_some_and(|card| !card.eq_ignore_ascii_case("USB")) {
        return None;
    }
    let channel = value("Channel")?;
    let channel = channel.strip_prefix("/dev/").unwrap_or(channel);
    channel
        .strip_prefix("ttyACM")
        .unwrap_or(channel)
        .parse()
        .ok()
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use proptest::prelude::*;

    use super::super::tree::Tree;
    use super::*;

    #[test]
    fn channels_are_read_in_each_form() {
        assert_eq!(
            channel("ModelType=OMNI\r\nCardType=USB\r\nChannel=2\r\n"),
            Some(2)
        );
        assert_eq!(channel("Channel = /dev/ttyACM11"), Some(11));
        assert_eq!(channel("CardType=ETHERNET\nChannel=2"), None);
        assert_eq!(channel("CardType=USB\nChannel="), None);
        assert_eq!(channel(""), None);
    }

    #[test]
    fn a_folder_is_empty_open_or_closed() {
        let tree = Tree::new();
        let (roots, name) = (tree.roots(), "home/.3dsystems/config");
        let folder = tree.path(name);
        assert_eq!(read(&roots, &folder), Folder::Empty);
        tree.folder(name);
        tree.file(&format!("{name}/notes.txt"), "Channel=1");
        assert_eq!(read(&roots, &folder), Folder::Empty);
        tree.config("Right", 1);
        tree.config("Left", 0);
        let config = |name: &str, channel| Config {
            name: name.into(),
            channel: Some(channel),
        };
        assert_eq!(
            read(&roots, &folder),
            Folder::Open(vec![config("Left", 0), config("Right", 1)])
        );
        tree.mode(&format!("{name}/Right.config"), 0o600);
        assert_eq!(
            read(&roots, &folder),
            Folder::Closed(folder.join("Right.config"))
        );
        tree.mode(name, 0o700);
        assert_eq!(read(&roots, &folder), Folder::Closed(folder));
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        #[test]
        fn garbage_is_a_configuration_without_a_channel_or_with_one(
            bytes in proptest::collection::vec(any::<u8>(), 0..300),
            key in "(Channel|CardType)= ?",
        ) {
            let tree = Tree::new();
            tree.file("share/config/Garbage.config", [key.as_bytes(), &bytes].concat());
            let Folder::Open(configs) = read(&tree.roots(), &tree.path("share/config")) else {
                return Err(TestCaseError::fail("the file can be read"));
            };
            prop_assert_eq!(configs.len(), 1);
        }

        #[test]
        fn any_text_can_be_parsed(text in any::<String>(), lines in 0usize..4) {
            channel(&format!("Channel={text}\n").repeat(lines));
        }

        #[test]
        fn a_number_survives(number in any::<u32>()) {
            prop_assert_eq!(channel(&format!("CardType=usb\nChannel={number}\n")), Some(number));
        }
    }
}
