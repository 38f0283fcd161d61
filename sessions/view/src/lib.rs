//! Recorded sessions and sphere trees as files for the Rerun viewer, and the program `sulcus-review`, which writes them.
//!
//! The program is the only one that links Rerun, behind the feature `rerun`. Without the feature this crate holds plain
//! data alone: [`TreePicture`] is the input of `sulcus-review tree`, which other programs start as a child process.
//!
//! # Looking at a file
//! `pip install rerun-sdk==0.36.3` brings the viewer of the matching version, and `rerun FILE` opens a file.
//! `rerun rrd stats FILE` and `rerun rrd verify FILE` list the contents.
//!
//! `picture.py` beside this crate's manifest renders a file without a window. Software rendering needs Mesa's Vulkan
//! driver, Debian's `mesa-vulkan-drivers`:
//!
//! ```text
//! sulcus-review SESSION.mcap --to 24 --slider end --out part.rrd --no-open
//! python sessions/view/picture.py part.rrd part.png
//! ```

#![cfg_attr(not(test), warn(clippy::print_stdout, clippy::print_stderr))]

mod tree_picture;

pub use tree_picture::{LevelPicture, TreePicture};

#[cfg(feature = "rerun")]
mod cli;
#[cfg(feature = "rerun")]
mod layout;
#[cfg(feature = "rerun")]
mod read;
#[cfg(feature = "rerun")]
mod review;
#[cfg(feature = "rerun")]
pub mod session;
#[cfg(feature = "rerun")]
mod tree;
#[cfg(feature = "rerun")]
mod viewer;

#[cfg(feature = "rerun")]
pub use cli::run;
#[cfg(feature = "rerun")]
pub use read::{Rows, count_rows};
#[cfg(feature = "rerun")]
pub use review::{
    Arrow, Eye, FramePicture, Label, Lane, MeshPicture, Moment, Numbers, PartKind, PartPicture,
    ReviewFile, ReviewPicture, Slider, Standing, ToolPicture, ToolStanding, Weight,
};
#[cfg(feature = "rerun")]
pub use tree::write_tree;
#[cfg(feature = "rerun")]
pub use viewer::{NoViewer, open_viewer, version as viewer_version};

use std::path::PathBuf;

use sulcus_program::PathText;

/// What Rerun said.
pub type Refusal = Box<dyn std::error::Error + Send + Sync>;

/// Why a file for the viewer could not be written, or read again.
#[derive(Debug, thiserror::Error)]
pub enum ViewError {
    /// The file cannot be written, or Rerun refuses what goes into it.
    #[error("{}: cannot write the file for Rerun: {source}", file.shown())]
    Write {
        /// The file.
        file: PathBuf,
        /// What Rerun said.
        source: Refusal,
    },
    /// The file cannot be read, or is none of Rerun's.
    #[error("{}: cannot read it as a file of Rerun: {source}", file.shown())]
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
