//! Last passes of the long proofs: `tests/long.passed`.
//!
//! The file has a line for each proof: name, key, minutes on the machine of the pass. The key is a hash of all sources
//! that the test links: the package of the test, the workspace's packages that it depends on, `Cargo.lock`, profiles,
//! toolchain. A proof whose key differs is behind: its last pass says nothing about the present sources. Lines that
//! begin with `#` stay as they are.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;

use super::{LONG, Long};

/// File with the passes, from the root of the workspace.
pub const FILE: &str = "tests/long.passed";

/// Files and folders of the workspace that every key contains: settings, and data outside of the packages that read it.
const SHARED: [&str; 8] = [
    "Cargo.lock",
    "Cargo.toml",
    "rust-toolchain.toml",
    ".cargo/config.toml",
    "server/scenes",
    "server/core/tests/counting",
    "tests/inputs",
    "docker/70-sulcus-devices.rules",
];

/// Files of the package `sulcus-tests` that no test links. A pass changes the first.
const NOT_LINKED: [&str; 2] = ["long.passed", "quarantine.txt"];

/// Folders of a package that its dependents do not link.
const OWN: [&str; 3] = ["tests", "benches", "examples"];

/// Sources of a package.
#[derive(Clone, Debug)]
pub struct Key {
    /// Folder of the package.
    pub folder: PathBuf,
    /// Hash of all sources that a test of the package links, 32 hexadecimal digits.
    pub hash: String,
}

/// A proof that has not passed on the present sources.
#[derive(Clone, Debug)]
pub struct Behind {
    /// Row of the table.
    pub long: &'static Long,
    /// Present key.
    pub key: String,
}

/// A package of the workspace.
struct Package {
    folder: PathBuf,
    /// Packages of the workspace that the library needs.
    needs: BTreeSet<String>,
    /// Further packages that the tests need.
    tests_need: BTreeSet<String>,
}

/// Root of the workspace.
pub fn root() -> PathBuf {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    root.canonicalize().unwrap_or(root)
}

/// Proofs that are behind, in the order of the table.
///
/// # Errors
/// Sources or passes cannot be read.
pub fn behind() -> Result<Vec<Behind>, String> {
    let (keys, passes) = (keys()?, passes()?);
    let row = |long: &'static Long| {
        let key = &keys.get(long.package)?.hash;
        let passed = passes.get(long.name).is_some_and(|pass| pass.0 == *key);
        (!passed).then(|| Behind {
            long,
            key: key.clone(),
        })
    };
    Ok(LONG.iter().filter_map(row).collect())
}

/// Passes by name: key and minutes.
///
/// # Errors
/// A line has another form.
pub fn passes() -> Result<BTreeMap<String, (String, f64)>, String> {
    let text = std::fs::read_to_string(root().join(FILE)).unwrap_or_default();
    let lines = text.lines().filter(|line| !line.starts_with('#'));
    let pass = |line: &str| {
        let parts: Vec<&str> = line.split_whitespace().collect();
        let [name, key, minutes] = parts[..] else {
            return Err(format!("{FILE}: `{line}`, expected name, key and minutes"));
        };
        let minutes = minutes
            .parse()
            .map_err(|_| format!("{FILE}: minutes are `{minutes}`, expected a number"))?;
        Ok((name.to_owned(), (key.to_owned(), minutes)))
    };
    lines.map(pass).collect()
}

/// Enters a pass. Rows of proofs that the table lacks are dropped.
///
/// # Errors
/// The file cannot be read or written.
pub fn enter(name: &str, key: &str, minutes: f64) -> Result<(), String> {
    let mut passes = passes()?;
    passes.insert(name.to_owned(), (key.to_owned(), minutes));
    let before = std::fs::read_to_string(root().join(FILE)).unwrap_or_default();
    let remarks = before.lines().filter(|line| line.starts_with('#'));
    let mut text: String = remarks.map(|line| format!("{line}\n")).collect();
    for long in LONG {
        if let Some((key, minutes)) = passes.get(long.name) {
            text += &format!("{} {key} {minutes:.1}\n", long.name);
        }
    }
    std::fs::write(root().join(FILE), text).map_err(|error| format!("{FILE}: {error}"))
}

/// Keys of all packages of the workspace, by name.
///
/// # Errors
/// cargo does not run, or a source cannot be read.
pub fn keys() -> Result<BTreeMap<String, Key>, String> {
    keys_of(&root())
}

/// Keys of all packages of the workspace at `root`.
fn keys_of(root: &Path) -> Result<BTreeMap<String, Key>, String> {
    let packages = packages(root)?;
    let folders: Vec<&Path> = packages.values().map(|one| one.folder.as_path()).collect();
    let mut shared = blake3::Hasher::new();
    for name in SHARED {
        let path = root.join(name);
        if path.is_dir() {
            shared.update(hash_package(&path, &[], true)?.as_bytes());
        } else if path.exists() {
            hash_file(&mut shared, root, &path)?;
        }
    }
    // Hashes of each package with and without its own tests.
    let mut parts = BTreeMap::new();
    for (name, package) in &packages {
        let of = |own| hash_package(&package.folder, &folders, own);
        parts.insert(name, (of(true)?, of(false)?));
    }
    let key = |(name, package): (&String, &Package)| {
        let mut linked = BTreeSet::new();
        let mut open: Vec<&String> = package.needs.iter().chain(&package.tests_need).collect();
        while let Some(next) = open.pop() {
            if next != name && linked.insert(next) {
                open.extend(&packages[next].needs);
            }
        }
        let mut hasher = shared.clone();
        hasher.update(parts[name].0.as_bytes());
        for other in linked {
            hasher.update(other.as_bytes());
            hasher.update(parts[other].1.as_bytes());
        }
        let hash = hasher.finalize().to_hex()[..32].to_owned();
        let folder = package.folder.clone();
        (name.clone(), Key { folder, hash })
    };
    Ok(packages.iter().map(key).collect())
}

/// Packages of the workspace, by name, from cargo.
fn packages(root: &Path) -> Result<BTreeMap<String, Package>, String> {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let mut command = Command::new(cargo);
    command
        .args(["metadata", "--format-version", "1", "--no-deps"])
        .current_dir(root);
    let output = command
        .output()
        .map_err(|error| format!("cargo: {error}"))?;
    if !output.status.success() {
        return Err(String::from_utf8_lossy(&output.stderr).into_owned());
    }
    let told: Value = serde_json::from_slice(&output.stdout)
        .map_err(|error| format!("cargo metadata: {error}"))?;
    let package = |package: &Value| {
        let folder = Path::new(package["manifest_path"].as_str()?).parent()?;
        let (mut needs, mut tests_need) = (BTreeSet::new(), BTreeSet::new());
        for dependency in package["dependencies"].as_array()? {
            if dependency["path"].is_string() {
                let to = if dependency["kind"] == "dev" {
                    &mut tests_need
                } else {
                    &mut needs
                };
                to.insert(dependency["name"].as_str()?.to_owned());
            }
        }
        let package_of = Package {
            folder: folder.to_owned(),
            needs,
            tests_need,
        };
        Some((package["name"].as_str()?.to_owned(), package_of))
    };
    let all = told["packages"].as_array();
    let all: Option<BTreeMap<String, Package>> =
        all.and_then(|all| all.iter().map(package).collect());
    all.ok_or_else(|| "cargo metadata has another form than expected".to_owned())
}

/// Hash of the files of a package, without other packages below it, documents and hidden files. `own`: with its tests.
fn hash_package(folder: &Path, packages: &[&Path], own: bool) -> Result<blake3::Hash, String> {
    let mut hasher = blake3::Hasher::new();
    let mut open = vec![folder.to_owned()];
    while let Some(path) = open.pop() {
        let name = path
            .file_name()
            .unwrap_or_default()
            .to_string_lossy()
            .into_owned();
        if path.is_file() {
            if !name.ends_with(".md") && !NOT_LINKED.contains(&name.as_str()) {
                hash_file(&mut hasher, folder, &path)?;
            }
            continue;
        }
        let mut inside = Vec::new();
        let entries =
            std::fs::read_dir(&path).map_err(|error| format!("{}: {error}", path.display()))?;
        for entry in entries {
            let entry = entry.map_err(|error| format!("{}: {error}", path.display()))?;
            let (path, name) = (entry.path(), entry.file_name());
            let name = name.to_string_lossy();
            let hidden = name.starts_with('.') || name == "target";
            let tests = !own && OWN.contains(&name.as_ref()) && path.parent() == Some(folder);
            if !hidden && !tests && !packages.contains(&path.as_path()) {
                inside.push(path);
            }
        }
        inside.sort();
        open.extend(inside.into_iter().rev());
    }
    Ok(hasher.finalize())
}

/// Adds name and content of a file.
fn hash_file(hasher: &mut blake3::Hasher, folder: &Path, path: &Path) -> Result<(), String> {
    let content = std::fs::read(path).map_err(|error| format!("{}: {error}", path.display()))?;
    let name = path.strip_prefix(folder).unwrap_or(path).to_string_lossy();
    for part in [name.as_bytes(), &content] {
        hasher.update(&(part.len() as u64).to_le_bytes());
        hasher.update(part);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A workspace where `a` depends on `b`, and the tests of `b` on `c`.
    fn workspace() -> tempfile::TempDir {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let write = |name: &str, text: &str| {
            let path = folder.path().join(name);
            std::fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
            std::fs::write(path, text).expect("written");
        };
        let members = "[workspace]\nresolver = \"3\"\nmembers = [\"a\", \"b\", \"b/c\"]\n";
        write("Cargo.toml", members);
        for (name, needs) in [
            ("a", "[dependencies]\nb = { path = \"../b\" }\n"),
            ("b", "[dev-dependencies]\nc = { path = \"c\" }\n"),
            ("b/c", ""),
        ] {
            let last = name.rsplit('/').next().expect("a name");
            let head = format!("[package]\nname = \"{last}\"\nversion = \"0.1.0\"\n");
            write(&format!("{name}/Cargo.toml"), &(head + needs));
            for file in ["src/lib.rs", "tests/it.rs", "README.md", "long.passed"] {
                write(&format!("{name}/{file}"), "");
            }
        }
        folder
    }

    #[test]
    fn a_key_changes_with_each_source_that_a_test_links_and_with_no_other() {
        let folder = workspace();
        let root = folder.path().canonicalize().expect("a folder");
        let hashes = || {
            let keys = keys_of(&root).expect("keys");
            ["a", "b", "c"].map(|name| keys[name].hash.clone())
        };
        for (file, changed) in [
            ("a/src/lib.rs", [true, false, false]),
            ("b/src/lib.rs", [true, true, false]),
            ("b/tests/it.rs", [false, true, false]),
            ("b/c/src/lib.rs", [false, true, true]),
            ("b/c/tests/it.rs", [false, false, true]),
            ("b/README.md", [false; 3]),
            ("b/long.passed", [false; 3]),
            ("Cargo.toml", [true; 3]),
        ] {
            let before = hashes();
            let path = root.join(file);
            let text = std::fs::read_to_string(&path).expect("text") + "\n";
            std::fs::write(&path, text).expect("written");
            let after = hashes();
            let differs = [0, 1, 2].map(|k| before[k] != after[k]);
            assert_eq!(differs, changed, "{file}");
        }
    }
}
