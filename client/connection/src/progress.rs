//! Progress bars on standard error; no bar is drawn where that is not a terminal.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use sulcus_program::tell;

/// Maker of the progress bars of one run.
#[derive(Clone, Copy, Debug, Default)]
pub struct Steps;

/// Progress bar of one step.
pub struct Bar(ProgressBar);

/// Number of positions of a bar.
const PARTS: u64 = 1000;

impl Steps {
    /// Begins a step with the text `what`.
    pub fn bar(&self, what: &str) -> Bar {
        let bar =
            ProgressBar::with_draw_target(Some(PARTS), ProgressDrawTarget::stderr_with_hz(10));
        if let Ok(style) =
            ProgressStyle::with_template("{elapsed:>4} {bar:30} {percent:>3}%  {msg}")
        {
            bar.set_style(style);
        }
        bar.set_message(what.to_owned());
        Bar(bar)
    }
}

impl Bar {
    /// Shows the share of the step that is done, 0 to 1, and the text `what`.
    pub fn set(&self, what: &str, share: f64) {
        self.0.set_message(what.to_owned());
        self.0
            .set_position((share.clamp(0.0, 1.0) * PARTS as f64) as u64);
    }

    /// Prints a line on standard error, above the bar if one is drawn.
    pub fn say(&self, text: &str) {
        self.0.suspend(|| tell!("{text}"));
    }

    /// Ends the step and removes its bar.
    pub fn done(&self) {
        self.0.finish_and_clear();
    }
}
