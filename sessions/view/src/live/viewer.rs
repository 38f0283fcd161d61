//! Files of the web viewer, for a server that links no Rerun.

use std::io::Write;

use flate2::Compression;
use flate2::write::GzEncoder;
use re_web_viewer_server::WebViewerData;
use sulcus_proto::live::{self, Kind, PipeError, ViewerFile};

use super::LiveError;
use crate::viewer::version;

/// Names of the files.
pub const VIEWER_FILES: [&str; 2] = ["re_viewer.js", "re_viewer_bg.wasm"];

/// Writes the viewer's files as messages, compressed. The viewer's own page is no part of them: it has scripts of other
/// origins.
///
/// # Errors
/// The output is closed, or the program was built without the files.
pub fn write_viewer(mut output: impl Write) -> Result<(), LiveError> {
    let data = WebViewerData::load(None).map_err(|error| LiveError::Viewer(error.to_string()))?;
    for (name, content) in VIEWER_FILES
        .into_iter()
        .zip([data.viewer_js(), data.viewer_wasm()])
    {
        let failed = |error: std::io::Error| LiveError::Viewer(error.to_string());
        let mut gzip = GzEncoder::new(Vec::new(), Compression::new(6));
        gzip.write_all(content).map_err(failed)?;
        let file = ViewerFile {
            version: version(),
            name: name.to_owned(),
            gzip: gzip.finish().map_err(failed)?,
        };
        let bytes = file.to_bytes().map_err(PipeError::from);
        let bytes = bytes.map_err(LiveError::Output)?;
        live::write(&mut output, Kind::File, &bytes).map_err(LiveError::Output)?;
    }
    Ok(())
}
