//! Errors of pictures.

/// Reason why there is no picture.
#[derive(Debug, thiserror::Error)]
pub enum ScreenError {
    /// No graphics adapter, neither hardware nor software.
    #[error(
        "no graphics adapter was found: {0}. On Debian the package `mesa-vulkan-drivers` has a software adapter"
    )]
    NoAdapter(String),
    /// The adapter has no device with the needed limits.
    #[error("the graphics adapter `{adapter}` gives no device: {why}")]
    NoDevice {
        /// Name of the adapter.
        adapter: String,
        /// Text of the driver.
        why: String,
    },
    /// The driver is lost, or reported an error.
    #[error("the graphics driver failed: {0}")]
    Lost(String),
    /// A picture has a size that the adapter cannot draw.
    #[error("the picture is {width} x {height} pixels, expected 16 to {most} for each")]
    Size {
        /// Width found.
        width: u32,
        /// Height found.
        height: u32,
        /// Largest width and height.
        most: u32,
    },
    /// A picture cannot be encoded.
    #[error("the picture cannot be written as PNG: {0}")]
    Png(#[from] png::EncodingError),
    /// No window can be opened.
    #[error("no display was found: {0}; `picture` draws without a display")]
    NoDisplay(String),
}
