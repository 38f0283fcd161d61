//! Everything that names rerun; nothing else does.
//!
//! [`write_tree`] writes a sphere tree and its errors as a file for the Rerun viewer, [`ReviewFile`] a recorded session.
//! Both take plain data: this crate knows nothing of scenes, ticks and recordings. Rerun takes minutes to compile, so
//! whoever uses this crate does so behind a feature.
//!
//! # Looking at a file
//! `pip install rerun-sdk==0.36.3` brings the viewer of the right version ([`viewer_version`]), and `rerun FILE` opens a file.
//! `rerun rrd stats FILE` and `rerun rrd verify FILE` say what is in it; [`count_rows`] decodes all of it.
//!
//! A picture without a window (on a machine without a graphics card: Mesa's software Vulkan, Debian's
//! `mesa-vulkan-drivers`) is made by `picture.py` beside this crate's manifest:
//!
//! ```text
//! sulcus-sessions review SESSION.mcap --to 24 --slider end --out part.rrd --no-open
//! python sessions/view/picture.py part.rrd part.png
//! ```

mod layout;
mod read;
mod review;
mod tree;
mod viewer;

pub use read::{Rows, count_rows};
pub use review::{
    Arrow, Eye, FramePicture, Label, Lane, MeshPicture, Moment, Numbers, PartKind, PartPicture,
    ReviewFile, ReviewPicture, Slider, Standing, ToolPicture, ToolStanding, Weight,
};
pub use tree::{LevelPicture, TreePicture, write_tree};
pub use viewer::{NoViewer, open_viewer, version as viewer_version};

use std::path::PathBuf;

/// What Rerun said.
pub type Refusal = Box<dyn std::error::Error + Send + Sync>;

/// Why a file for the viewer could not be written, or read again.
#[derive(Debug, thiserror::Error)]
pub enum ViewError {
    /// The file cannot be written, or Rerun refuses what goes into it.
    #[error("{}: cannot write the file for Rerun: {source}", file.display())]
    Write {
        /// The file.
        file: PathBuf,
        /// What Rerun said.
        source: Refusal,
    },
    /// The file cannot be read, or is none of Rerun's.
    #[error("{}: cannot read it as a file of Rerun: {source}", file.display())]
    Read {
        /// The file.
        file: PathBuf,
        /// What Rerun said.
        source: Refusal,
    },
    /// Lists of a review do not fit together.
    #[error("{part}: {field} is {found}, expected {expected}")]
    Fit {
        /// Tool, part of the mouth, or kind of row.
        part: String,
        /// Which list or number.
        field: &'static str,
        /// What was found.
        found: usize,
        /// What fits.
        expected: usize,
    },
    /// What should be shown does not fit together.
    #[error("level {level}: {field} has {found} entries, expected {expected}")]
    Shape {
        /// The level.
        level: u8,
        /// Which list.
        field: &'static str,
        /// Its length.
        found: usize,
        /// The length that fits.
        expected: usize,
    },
}
