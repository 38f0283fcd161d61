//! Protection of input files and recordings from being overwritten.

use std::io::Read as _;
use std::path::Path;

use sulcus_program::PathText;

/// First bytes of every MCAP file.
const MCAP: &[u8] = b"\x89MCAP0\r\n";

/// Checks that `out`, given as `option`, may be written.
///
/// # Errors
/// `out` is a recording, or one of the files in `read`, under any name.
pub fn may_write<'a>(
    option: &str,
    out: &Path,
    read: impl IntoIterator<Item = &'a Path>,
) -> anyhow::Result<()> {
    let Ok(real) = out.canonicalize() else {
        // No file is there, or the program may not see it. Writing then reports the reason.
        return Ok(());
    };
    let same = |path: &&Path| is_same(path, &real);
    if let Some(same) = read.into_iter().find(same) {
        anyhow::bail!(
            "{option} is `{}`, which is read as `{}`, expected another file: the content would be lost",
            out.shown(),
            same.shown()
        );
    }
    let mut first = [0; MCAP.len()];
    let is_recording = real.is_file()
        && std::fs::File::open(&real).is_ok_and(|mut file| file.read_exact(&mut first).is_ok())
        && first == MCAP;
    anyhow::ensure!(
        !is_recording,
        "{option} is `{}`, which is a recording, expected another file: the recording would be lost",
        out.shown()
    );
    Ok(())
}

/// Whether two paths lead to the same file, by links or by two names.
pub fn is_same(a: &Path, b: &Path) -> bool {
    #[cfg(unix)]
    {
        use std::os::unix::fs::MetadataExt as _;
        let id = |path: &Path| std::fs::metadata(path).map(|file| (file.dev(), file.ino()));
        if let (Ok(a), Ok(b)) = (id(a), id(b)) {
            return a == b;
        }
    }
    a.canonicalize()
        .is_ok_and(|a| b.canonicalize().is_ok_and(|b| a == b))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_read_and_recordings_are_not_written_over() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = |name: &str| folder.path().join(name);
        std::fs::write(path("table.csv"), "a,b\n").expect("written");
        std::fs::write(path("session.mcap"), [MCAP, b"..."].concat()).expect("written");
        let around = folder
            .path()
            .join("..")
            .join(folder.path().file_name().expect("a name"))
            .join("table.csv");
        let check = |out: &Path, read: &[&Path]| may_write("--csv", out, read.iter().copied());
        assert!(check(&path("new.csv"), &[&path("table.csv")]).is_ok());
        assert!(
            check(
                &path("table.csv"),
                &[&path("session.mcap"), &path("absent")]
            )
            .is_ok()
        );
        // The same file under another name.
        let told = check(&around, &[&path("table.csv")])
            .expect_err("it is read")
            .to_string();
        assert!(
            told.starts_with("--csv is `") && told.contains("which is read as"),
            "{told}"
        );
        #[cfg(unix)]
        {
            std::fs::hard_link(path("table.csv"), path("same.csv")).expect("linked");
            assert!(check(&path("same.csv"), &[&path("table.csv")]).is_err());
        }
        // A shell's expansion may put the first recording of a folder behind an option.
        let told = check(&path("session.mcap"), &[])
            .expect_err("a recording")
            .to_string();
        assert!(told.contains("which is a recording"), "{told}");
        // A device is neither an input file nor a recording.
        assert!(check(Path::new("/dev/null"), &[&path("table.csv")]).is_ok());
    }
}
