//! Arguments of a window as its settings.

use anyhow::anyhow;
use sulcus_screen::quality::Quality;
use sulcus_screen::readings::{Foot, Switch};
use sulcus_screen::views::View;
use sulcus_screen::window::Settings;

use crate::cli::ViewArgs;

/// Value of an option by its name.
///
/// # Errors
/// The name is unknown.
pub fn named<T: std::str::FromStr<Err = String>>(option: &str, name: &str) -> anyhow::Result<T> {
    name.parse().map_err(|error| anyhow!("{option}: {error}"))
}

/// Settings of the window.
///
/// # Errors
/// A name is unknown, or this build has no device of this kind.
pub fn settings(args: &ViewArgs) -> anyhow::Result<Settings> {
    let view: View = named("--camera", &args.camera)?;
    let quality = args.quality.as_deref();
    let quality: Option<Quality> = quality.map(|name| named("--quality", name)).transpose()?;
    let switch = args.pedal.as_deref();
    let switch: Option<Switch> = switch.map(|name| named("--pedal", name)).transpose()?;
    if cfg!(not(feature = "gamepad")) && matches!(switch, Some(Switch::Pad(_))) {
        return Err(anyhow!(
            "--pedal: this build reads no gamepad; build with `--features gamepad`"
        ));
    }
    let used = named("--pedal-use", &args.pedal_use)?;
    Ok(Settings {
        title: "Sulcus".into(),
        view,
        quality,
        has_real_time: sulcus_link::schedule::may_fifo(),
        mirrored: args.half_mirror,
        glass: named("--glass", &args.glass)?,
        hand: named("--hand", &args.hand)?,
        pedal: switch.map(|switch| Foot::new(switch, used)),
    })
}
