//! Resources that a machine may lack.

use std::io::Write as _;
use std::path::{Path, PathBuf};

/// Environment variable with the required resources, a list with commas.
const REQUIRE: &str = "SULCUS_REQUIRE";

/// A resource beyond the Rust toolchain.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Resource {
    /// Real meshes and finite-element references, the folder `../shared/data` beside the checkout.
    Data,
    /// Python 3 with virtual environments, and its package index.
    Python,
    /// A browser and its driver.
    Browser,
    /// A graphics adapter, in hardware or software.
    Adapter,
    /// The program `curl`.
    Curl,
    /// The program `systemd-analyze`.
    Systemd,
    /// Root, `mmdebstrap` and `buildah`, for images and whole machines.
    Image,
}

impl Resource {
    /// All resources, in the order of messages.
    pub const ALL: [Self; 7] = [
        Self::Data,
        Self::Python,
        Self::Browser,
        Self::Adapter,
        Self::Curl,
        Self::Systemd,
        Self::Image,
    ];

    /// Name in `SULCUS_REQUIRE`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Data => "data",
            Self::Python => "python",
            Self::Browser => "browser",
            Self::Adapter => "adapter",
            Self::Curl => "curl",
            Self::Systemd => "systemd",
            Self::Image => "image",
        }
    }

    /// Returns a found value. A missing resource is reported on the terminal and gives `None`.
    ///
    /// # Panics
    /// `SULCUS_REQUIRE` names the missing resource, or holds an unknown name.
    pub fn or_skip<T>(self, found: Result<T, String>) -> Option<T> {
        let listed = std::env::var(REQUIRE).unwrap_or_default();
        let required = required(&listed).unwrap_or_else(|message| panic!("{message}"));
        match found {
            Ok(found) => Some(found),
            Err(why) if required.contains(&self) => {
                panic!(
                    "{REQUIRE} names `{}`, which is missing here: {why}",
                    self.name()
                )
            }
            Err(why) => {
                // The harness captures `eprintln!` of passing tests, but not this handle.
                let _ = writeln!(
                    std::io::stderr(),
                    "SKIPPED {}: no {} here: {why}",
                    crate::test_name(),
                    self.name()
                );
                None
            }
        }
    }

    /// Returns the canonical path of a file or folder. A missing one is a missing resource, as in [`Self::or_skip`].
    ///
    /// # Panics
    /// The file or folder is missing and required, as in [`Self::or_skip`].
    pub fn path_or_skip(self, path: &Path) -> Option<PathBuf> {
        let found = path
            .canonicalize()
            .map_err(|error| format!("{}: {error}", path.display()));
        self.or_skip(found)
    }
}

/// Resources of a list with commas; the error is a message with the accepted names.
fn required(listed: &str) -> Result<Vec<Resource>, String> {
    let names = listed.split(',').map(str::trim);
    let names = names.filter(|name| !name.is_empty());
    let resource = |name: &str| {
        let found = Resource::ALL
            .into_iter()
            .find(|resource| resource.name() == name);
        found.ok_or_else(|| {
            let known = Resource::ALL.map(Resource::name).join(", ");
            format!("{REQUIRE} names `{name}`, expected some of: {known}")
        })
    };
    names.map(resource).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_list_with_commas_names_resources_and_a_mistyped_name_is_refused() {
        assert_eq!(required(""), Ok(vec![]));
        assert_eq!(
            required("python, data,"),
            Ok(vec![Resource::Python, Resource::Data])
        );
        let told = required("data,pyton").expect_err("mistyped");
        assert!(
            told.contains("`pyton`") && told.contains("python"),
            "{told}"
        );
    }
}
