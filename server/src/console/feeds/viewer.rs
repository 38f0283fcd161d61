//! Files of the viewer, from the program that holds them.

use std::io::BufReader;
use std::path::Path;
use std::process::{Child, Command, Stdio};

use sulcus_console::house::Viewer;
use sulcus_proto::live::{self, Kind, ViewerFile};

use super::PROGRAM;
use super::drawing::idle;

/// Asks the program for its files. It compresses them first, which takes some seconds.
pub(super) fn read(program: &Path) -> Result<Viewer, String> {
    let failed = |why: String| format!("{PROGRAM} gives no viewer: {why}");
    let mut child = Command::new(program)
        .arg("viewer")
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .spawn()
        .map_err(|error| failed(error.to_string()))?;
    idle(&child);
    let found = files(&mut child).map_err(failed);
    // After an error the program may still write.
    let _ = child.kill();
    let _ = child.wait();
    found
}

fn files(child: &mut Child) -> Result<Viewer, String> {
    let mut viewer = Viewer::default();
    let pipe = child.stdout.take().ok_or("it has no standard output")?;
    let mut pipe = BufReader::new(pipe);
    while let Some((kind, body)) = live::read(&mut pipe).map_err(|error| error.to_string())? {
        if kind != Kind::File {
            return Err(format!(
                "it sends a message of kind {kind:?}, expected a file"
            ));
        }
        let file = ViewerFile::from_bytes(&body).map_err(|error| error.to_string())?;
        viewer.version = file.version;
        viewer.files.insert(file.name, file.gzip.into());
    }
    if viewer.files.is_empty() {
        return Err("it sends no files".into());
    }
    Ok(viewer)
}
