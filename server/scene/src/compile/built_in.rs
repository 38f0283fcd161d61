//! Scenes that are part of the programs.

use std::path::Path;

use crate::compile::compile_text;
use crate::compile::error::BuildError;
use crate::compile::options::{BuildOptions, Compiled};

/// A scene that needs no file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BuiltIn {
    /// A lower molar and a probe; the default.
    Crown,
    /// The molar with its gingiva and a pocket, and a probe.
    Pocket,
    /// A tongue and a mouth mirror.
    Tongue,
    /// The same tongue by finite elements.
    Organ,
    /// A whole lower jaw, a probe and a mouth mirror.
    Mouth,
}

/// No built-in scene has this name.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("scene `{0}` is not built in, expected one of {all}; name it with --scene", all = BuiltIn::ALL.map(BuiltIn::name).join(", "))]
pub struct NotBuiltIn(String);

impl BuiltIn {
    /// All built-in scenes.
    pub const ALL: [BuiltIn; 5] = [
        BuiltIn::Crown,
        BuiltIn::Pocket,
        BuiltIn::Tongue,
        BuiltIn::Organ,
        BuiltIn::Mouth,
    ];

    /// Returns its scene file.
    pub fn text(self) -> &'static str {
        match self {
            BuiltIn::Crown => include_str!("../../../scenes/crown.toml"),
            BuiltIn::Pocket => include_str!("../../../scenes/pocket.toml"),
            BuiltIn::Tongue => include_str!("../../../scenes/tongue.toml"),
            BuiltIn::Organ => include_str!("../../../scenes/organ.toml"),
            BuiltIn::Mouth => include_str!("../../../scenes/mouth.toml"),
        }
    }

    /// Returns the scene of a name. Exercises use these names.
    ///
    /// # Errors
    /// [`NotBuiltIn`] with the names that exist.
    pub fn named(name: &str) -> Result<Self, NotBuiltIn> {
        let found = Self::ALL.into_iter().find(|scene| scene.name() == name);
        found.ok_or_else(|| NotBuiltIn(name.to_owned()))
    }

    /// Returns its name: that of its file without the extension.
    pub fn name(self) -> &'static str {
        let file = self.file_name().to_str().unwrap_or_default();
        file.strip_suffix(".toml").unwrap_or(file)
    }

    /// Returns the name of its file in errors.
    pub fn file_name(self) -> &'static Path {
        Path::new(match self {
            BuiltIn::Crown => "crown.toml",
            BuiltIn::Pocket => "pocket.toml",
            BuiltIn::Tongue => "tongue.toml",
            BuiltIn::Organ => "organ.toml",
            BuiltIn::Mouth => "mouth.toml",
        })
    }
}

/// Compiles a built-in scene.
///
/// # Errors
/// Only if the program was built from invalid sources.
pub fn compile_built_in(
    which: BuiltIn,
    options: &BuildOptions,
    progress: &dyn Fn(&str, f64),
) -> Result<Compiled, BuildError> {
    compile_text(which.text(), which.file_name(), options, progress)
}

/// Compiles the default scene: a lower molar and a probe.
///
/// # Errors
/// Only if the program was built from invalid sources.
pub fn compile_default(
    options: &BuildOptions,
    progress: &dyn Fn(&str, f64),
) -> Result<Compiled, BuildError> {
    compile_built_in(BuiltIn::Crown, options, progress)
}
