//! Recorded sessions and sphere trees as files for the Rerun viewer, and the program `sulcus-review`, which writes
//! them.
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

mod error;
mod tree_picture;

pub use error::{Refusal, ViewError};
pub use tree_picture::{LevelPicture, TreePicture};

#[cfg(feature = "rerun")]
mod cli;
#[cfg(feature = "rerun")]
mod layout;
#[cfg(feature = "rerun")]
pub mod live;
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
pub use review::{
    Arrow, Eye, FramePicture, Label, Lane, MeshPicture, Moment, Numbers, PartKind, PartPicture,
    ReviewFile, ReviewPicture, Slider, Standing, ToolPicture, ToolStanding, Weight,
};
#[cfg(feature = "rerun")]
pub use tree::write_tree;
