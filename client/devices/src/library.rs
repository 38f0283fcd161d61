//! Library of a vendor, opened at run time and never closed.
//!
//! A driver fails at its second load in one process. A registry therefore opens each library once and keeps the library
//! until the process ends.

use std::error::Error;
use std::ffi::OsString;
use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use libloading::Library;

use crate::State;

/// Library of a vendor and the places at which it is searched.
#[derive(Clone, Copy, Debug)]
pub struct Wanted {
    /// Name for messages, for example `OpenHaptics (libHD)`.
    pub name: &'static str,
    /// Environment variable with the path of the library. A set variable is the only place that is tried.
    pub variable: &'static str,
    /// File names or paths, in the order of their trial. The loader of the system searches a name without a directory.
    pub candidates: &'static [&'static str],
    /// Environment variable of a development kit with directories below it; empty without one.
    pub kit: (&'static str, &'static [&'static str]),
    /// What a person installs to get the library.
    pub remedy: &'static str,
}

/// Open library.
#[derive(Debug)]
pub struct Opened {
    name: &'static str,
    path: PathBuf,
    library: Library,
}

/// Reason why a library cannot be used.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum LoadError {
    /// No candidate exists.
    Absent(String),
    /// A file exists and does not load. The text of the system's loader is part of the sentence.
    Unusable(String),
    /// The library has no such function.
    Symbol(String),
}

/// Libraries opened so far, by the name of [`Wanted`].
static OPENED: Mutex<Vec<&'static Opened>> = Mutex::new(Vec::new());

/// Opens the library, or returns the open one.
///
/// # Errors
/// No candidate exists, or a candidate does not load.
pub fn open(wanted: &Wanted) -> Result<&'static Opened, LoadError> {
    let mut opened = OPENED.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(found) = opened.iter().find(|opened| opened.name == wanted.name) {
        return Ok(found);
    }
    let named = std::env::var_os(wanted.variable).filter(|path| !path.is_empty());
    let kit = std::env::var_os(wanted.kit.0).filter(|path| !path.is_empty());
    let mut failures = Vec::new();
    for path in places(wanted, named.clone(), kit) {
        // SAFETY: the initialisers of a vendor's library run. The library is the one that the person installed or
        // named, and it stays open until the process ends.
        match unsafe { Library::new(&path) } {
            Ok(library) => {
                let found: &'static Opened = Box::leak(Box::new(Opened {
                    name: wanted.name,
                    path,
                    library,
                }));
                opened.push(found);
                return Ok(found);
            }
            Err(error) => {
                let text = error
                    .source()
                    .map_or_else(|| error.to_string(), ToString::to_string);
                failures.push((path, text));
            }
        }
    }
    Err(failed(wanted, named.is_some(), &failures))
}

/// Paths to try, in this order.
fn places(wanted: &Wanted, named: Option<OsString>, kit: Option<OsString>) -> Vec<PathBuf> {
    if let Some(path) = named {
        return vec![path.into()];
    }
    let in_kit = kit.into_iter().flat_map(|home| {
        let directories = wanted
            .kit
            .1
            .iter()
            .map(move |sub| Path::new(&home).join(sub));
        let names = wanted.candidates.iter().filter(|name| !name.contains('/'));
        let names: Vec<&str> = names.copied().collect();
        directories.flat_map(move |directory| {
            names
                .iter()
                .map(|name| directory.join(name))
                .collect::<Vec<_>>()
        })
    });
    let names = wanted.candidates.iter().map(PathBuf::from);
    names.chain(in_kit).collect()
}

/// Reason of the failures, one sentence.
fn failed(wanted: &Wanted, is_named: bool, failures: &[(PathBuf, String)]) -> LoadError {
    let Wanted {
        name,
        variable,
        remedy,
        ..
    } = wanted;
    let broken = failures.iter().find(|(path, error)| exists(path, error));
    match (broken, failures.first()) {
        (Some((path, error)), _) => LoadError::Unusable(format!(
            "{name}: {} does not load ({error}): install what the text names, or set {variable} to another file",
            path.display()
        )),
        (None, Some((path, error))) if is_named => LoadError::Absent(format!(
            "{name}: {variable} names {}, which is not there ({error}): correct or remove the variable",
            path.display()
        )),
        _ => LoadError::Absent(format!(
            "{name} is not installed: {remedy}, or set {variable} to the library's file"
        )),
    }
}

/// Whether the file of a failed candidate exists: on the disk, or in the search path by the loader's text, which then
/// names another file or another cause.
fn exists(path: &Path, error: &str) -> bool {
    if path.components().count() > 1 {
        return path.exists();
    }
    let name = path.to_string_lossy();
    let is_absent = [
        "No such file",
        "cannot open shared object",
        "not found",
        "could not be found",
    ]
    .iter()
    .any(|text| error.contains(text));
    !(is_absent && error.contains(name.as_ref()) || error.contains("LoadLibrary"))
}

impl Opened {
    /// Path under which the library was opened.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Returns the function `symbol` of type `T`.
    ///
    /// # Safety
    /// `T` is a function pointer of the signature that the library has for `symbol`.
    ///
    /// # Errors
    /// The library has no such function: the sentence names it.
    pub unsafe fn function<T: Copy>(&self, symbol: &'static str) -> Result<T, LoadError> {
        // SAFETY: the caller's promise about `T`. The copied pointer stays valid, as the library is never closed.
        unsafe { self.library.get::<T>(symbol) }
            .map(|found| *found)
            .map_err(|_| {
                LoadError::Symbol(format!(
                    "{}: {} has no function {symbol}: install the library's present version",
                    self.name,
                    self.path.display()
                ))
            })
    }
}

impl LoadError {
    /// State of a back-end with this error.
    pub fn state(&self) -> State {
        match self {
            Self::Absent(_) => State::NoLibrary,
            Self::Unusable(_) => State::Error,
            Self::Symbol(_) => State::WrongVersion,
        }
    }
}

impl fmt::Display for LoadError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Absent(text) | Self::Unusable(text) | Self::Symbol(text) => f.write_str(text),
        }
    }
}

impl Error for LoadError {}

#[cfg(test)]
mod tests {
    use super::*;

    const WANTED: Wanted = Wanted {
        name: "no library (libsulcus-none)",
        variable: "SULCUS_NO_SUCH_LIBRARY",
        candidates: &["libsulcus-none.so.3", "/usr/lib/libsulcus-none.so"],
        kit: ("SULCUS_NO_SUCH_KIT", &["lib", "lib64"]),
        remedy: "install the package none",
    };

    #[test]
    fn an_override_is_the_only_place() {
        let all = places(&WANTED, None, Some("/kit".into()));
        let expected = [
            "libsulcus-none.so.3",
            "/usr/lib/libsulcus-none.so",
            "/kit/lib/libsulcus-none.so.3",
            "/kit/lib64/libsulcus-none.so.3",
        ];
        assert_eq!(all, expected.map(PathBuf::from));
        let one = places(&WANTED, Some("/own/lib.so".into()), Some("/kit".into()));
        assert_eq!(one, [PathBuf::from("/own/lib.so")]);
    }

    #[test]
    fn an_absent_library_and_a_missing_dependency_are_told_apart() {
        let error = open(&WANTED).expect_err("the library is absent");
        assert_eq!(error.state(), State::NoLibrary, "{error}");
        assert!(
            error.to_string().contains("install the package none"),
            "{error}"
        );
        assert!(
            error.to_string().contains("SULCUS_NO_SUCH_LIBRARY"),
            "{error}"
        );
        let text = "libncurses.so.5: cannot open shared object file: No such file or directory";
        let error = failed(
            &WANTED,
            false,
            &[("libsulcus-none.so.3".into(), text.into())],
        );
        assert_eq!(error.state(), State::Error);
        assert!(error.to_string().contains("libncurses.so.5"), "{error}");
    }
}
