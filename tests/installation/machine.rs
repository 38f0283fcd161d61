//! A bare Debian machine: a root of its own with a service manager, and a shell in it.
//!
//! The machine has its own processes and mounts, and the network of this one. All of its processes end with it.

use std::io::{BufRead, BufReader, Write as _};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

/// Packages that a machine has besides the essential ones: a service manager that runs without a kernel of its own, and a
/// program that fetches files.
const PACKAGES: &str = "systemctl,curl,ca-certificates";

/// Shell of the machine, as its first process: all processes end with it. Argument: root.
const BEGIN: &str = r#"
mount -t proc proc "$1/proc"
mount --rbind /dev "$1/dev"
exec chroot "$1" /bin/sh
"#;

/// Line that ends the output of a command, before its exit code.
const END: &str = "--- end of the command";

/// Root of a bare Debian, packed.
pub struct Debian {
    folder: tempfile::TempDir,
}

impl Debian {
    /// Packs a root.
    ///
    /// # Errors
    /// This machine has no root, no `mmdebstrap` or no packages of Debian.
    pub fn new() -> Result<Self, String> {
        let folder = tempfile::tempdir().map_err(|error| error.to_string())?;
        let made = Command::new("mmdebstrap")
            .args([
                "--quiet",
                "--variant=minbase",
                "--include",
                PACKAGES,
                "bookworm",
            ])
            .arg(folder.path().join("root.tar"))
            .output()
            .map_err(|error| format!("mmdebstrap: {error}"))?;
        if made.status.success() {
            Ok(Self { folder })
        } else {
            Err(String::from_utf8_lossy(&made.stderr).into_owned())
        }
    }

    /// A new machine.
    pub fn machine(&self, name: &str) -> Machine {
        let root = self.folder.path().join(name);
        std::fs::create_dir(&root).expect("a folder");
        let unpacked = Command::new("tar")
            .arg("-xf")
            .arg(self.folder.path().join("root.tar"))
            .arg("-C")
            .arg(&root)
            .args(["--exclude=./dev/*"])
            .status();
        assert!(unpacked.expect("tar starts").success());
        Machine::start(root)
    }
}

/// A running machine.
pub struct Machine {
    root: PathBuf,
    shell: Child,
    input: ChildStdin,
    output: BufReader<ChildStdout>,
}

impl Machine {
    fn start(root: PathBuf) -> Self {
        let mut shell = Command::new("unshare")
            .args(["--mount", "--pid", "--fork", "--kill-child", "--"])
            .args(["sh", "-euc", BEGIN, "sh"])
            .arg(&root)
            .env_clear()
            .env("PATH", "/usr/sbin:/usr/bin:/sbin:/bin")
            .env("HOME", "/root")
            .env("LC_ALL", "C.UTF-8")
            .env("DEBIAN_FRONTEND", "noninteractive")
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .expect("unshare starts");
        let input = shell.stdin.take().expect("piped");
        let output = BufReader::new(shell.stdout.take().expect("piped"));
        let mut machine = Self {
            root,
            shell,
            input,
            output,
        };
        machine.ok("cd /root && exec 2>&1");
        machine
    }

    /// Path of this machine for a path of the bare one.
    pub fn path(&self, inside: &str) -> PathBuf {
        self.root.join(inside.trim_start_matches('/'))
    }

    /// Runs a command line. Returns its exit code and its output.
    pub fn run(&mut self, line: &str) -> (i32, String) {
        // The command reads nothing of the shell's own input.
        writeln!(
            self.input,
            "{{ {line}\n}} </dev/null; code=$?; echo; echo '{END}' $code"
        )
        .expect("a shell");
        let mut told = String::new();
        loop {
            let mut next = String::new();
            let read = self.output.read_line(&mut next).expect("text");
            assert!(read > 0, "the machine ended in `{line}`: {told}");
            if let Some(code) = next.strip_prefix(END) {
                return (code.trim().parse().expect("a code"), told);
            }
            told += &next;
        }
    }

    /// Runs a command line that must succeed. Returns its output.
    pub fn ok(&mut self, line: &str) -> String {
        let (code, told) = self.run(line);
        assert_eq!(code, 0, "{line}\n{told}");
        told
    }

    /// Copies a file of this machine into `/root`.
    pub fn receive(&self, file: &Path) {
        let name = file.file_name().expect("a name");
        std::fs::copy(file, self.path("root").join(name)).expect("a copy");
    }
}

impl Drop for Machine {
    fn drop(&mut self) {
        let _ = self.shell.kill();
        let _ = self.shell.wait();
    }
}
