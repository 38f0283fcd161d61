//! Entries of the list for hands without force: simulated operator, recording, mouse, 3D mouse, gamepad.

use std::path::PathBuf;

use sulcus_devices::{Found, State};

/// Entries of all hands without force.
pub fn forceless() -> Vec<Found> {
    let ready = |library, model: &str, motion_dof, message: &str| Found {
        model: model.into(),
        // Hands without force have the name of their kind as identity.
        serial: String::from(library),
        motion_dof,
        ..Found::nothing(library, State::Ready, message)
    };
    let needs = |feature: &str| format!("this build has none: build with `--features {feature}`");
    let in_window = |library, model: &str, feature: &str, built: bool, message: &str| {
        if built {
            ready(library, model, 6, message)
        } else {
            Found::nothing(library, State::NoLibrary, needs(feature))
        }
    };
    let mut all = vec![
        ready(
            "simulated",
            "simulated operator",
            6,
            "moves both hands without a person",
        ),
        ready(
            "playback",
            "hands of a recording",
            6,
            "name the recording, as in --device playback:session.mcap",
        ),
        in_window(
            "mouse",
            "mouse and keys",
            "view",
            cfg!(feature = "view"),
            "moves the tools in a window: --view --mouse",
        ),
        in_window(
            "gamepad",
            "gamepad",
            "gamepad",
            cfg!(feature = "gamepad"),
            "moves the tools in a window: --view --mouse",
        ),
    ];
    all.push(match (cfg!(feature = "view"), spacenavd()) {
        (false, _) => Found::nothing("spacenavd", State::NoLibrary, needs("view")),
        (true, None) => Found::nothing(
            "spacenavd",
            State::NoLibrary,
            "no spacenavd runs: install and start spacenavd for a 3D mouse",
        ),
        (true, Some(_)) => ready(
            "spacenavd",
            "3D mouse",
            6,
            "moves the tools in a window: --view --mouse",
        ),
    });
    all
}

/// Socket of spacenavd, if it exists.
fn spacenavd() -> Option<PathBuf> {
    let set = std::env::var_os("SPNAV_SOCKET").filter(|value| !value.is_empty());
    let path = set.map_or_else(|| PathBuf::from("/var/run/spnav.sock"), PathBuf::from);
    path.exists().then_some(path)
}
