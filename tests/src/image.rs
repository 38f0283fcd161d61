//! Image of the server, built by `docker/build-image` from the programs of the tests, and unpacked: its programs run in it.

use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;

use crate::Program;

/// User of the image and its group.
pub const USER: u32 = 10001;

/// Variable with the archive of an image that was built before.
const GIVEN: &str = "SULCUS_IMAGE";

/// Mounts a folder of the machine, devices and processes into the root of an image, in a space of its own, and becomes a
/// program in it as the image's user. Arguments: root, folder, program and its arguments.
const ENTER: &str = r#"
root=$1 folder=$2; shift 2
mkdir -p "$root$folder" "$root/proc" "$root/dev"
mount --bind "$folder" "$root$folder"
mount --rbind /proc "$root/proc"
mount --rbind /dev "$root/dev"
exec unshare --root "$root" --wd "$folder" --setgid 10001 --setuid 10001 "$@"
"#;

/// An unpacked image.
#[derive(Debug)]
pub struct Image {
    folder: tempfile::TempDir,
    root: PathBuf,
    /// Output of the builder; empty for a given image.
    pub printed: String,
}

impl Image {
    /// Builds and unpacks the image with the console, or unpacks the archive that `SULCUS_IMAGE` names.
    ///
    /// # Errors
    /// This machine has not what the builder needs: root, `mmdebstrap`, `buildah`, the packages of Debian.
    pub fn new() -> Result<Self, String> {
        let folder = tempfile::tempdir().map_err(|error| error.to_string())?;
        let out = folder.path().join("out");
        let mut printed = String::new();
        let archive = match std::env::var_os(GIVEN) {
            Some(archive) => PathBuf::from(archive),
            None => {
                let builder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docker/build-image");
                let mut build = Command::new(builder);
                build
                    .args(["--console", "--program"])
                    .arg(Program::Server.path())
                    .arg("--out")
                    .arg(&out);
                printed = told(&mut build)?;
                out.join("sulcus-server.oci.tar")
            }
        };
        let from = format!("oci-archive:{}", archive.display());
        let container = told(buildah(&folder).args(["from", "--pull-never", &from]))?;
        let root = told(buildah(&folder).args(["mount", container.trim()]))?;
        Ok(Self {
            root: PathBuf::from(root.trim()),
            folder,
            printed,
        })
    }

    /// Settings with which the image starts: user, entry point, command, volumes.
    ///
    /// # Panics
    /// The image has no settings.
    pub fn settings(&self) -> Value {
        let mut list = buildah(&self.folder);
        let container = told(list.args(["containers", "--quiet"])).expect("a container");
        let mut inspect = buildah(&self.folder);
        let found = told(inspect.args(["inspect", container.trim()])).expect("settings");
        let found: Value = serde_json::from_str(&found).expect("JSON");
        found["OCIv1"]["config"].clone()
    }

    /// Root of the unpacked image.
    pub fn root(&self) -> &Path {
        &self.root
    }

    /// Path in the image of a program of the workspace; `None`: the image does not have it.
    pub fn path(&self, program: &Path) -> Option<PathBuf> {
        let inside = Path::new("/usr/local/bin").join(program.file_name()?);
        let outside = self.root.join(inside.strip_prefix("/").ok()?);
        outside.is_file().then_some(inside)
    }

    /// Command that becomes a program of the image, in a folder of the machine.
    pub fn command(&self, inside: &Path, folder: &Path) -> Command {
        let mut command = Command::new("unshare");
        command
            .args(["--mount", "--", "sh", "-euc", ENTER, "sh"])
            .arg(&self.root)
            .arg(folder)
            .arg(inside);
        command
    }
}

/// The builder of images, with a storage of its own.
fn buildah(folder: &tempfile::TempDir) -> Command {
    let mut command = Command::new("buildah");
    command
        .args(["--storage-driver", "vfs", "--root"])
        .arg(folder.path().join("store"))
        .arg("--runroot")
        .arg(folder.path().join("run"));
    command
}

/// Standard output of a program that succeeds; else its error.
fn told(command: &mut Command) -> Result<String, String> {
    let name = command.get_program().to_string_lossy().into_owned();
    let output = command
        .output()
        .map_err(|error| format!("{name}: {error}"))?;
    if !output.status.success() {
        let error = String::from_utf8_lossy(&output.stderr).into_owned();
        return Err(format!("{name}: {}", error.trim()));
    }
    String::from_utf8(output.stdout).map_err(|error| format!("{name}: {error}"))
}
