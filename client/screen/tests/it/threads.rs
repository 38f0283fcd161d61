//! Pictures are the same bytes from run to run and for any number of rasteriser threads.

use std::process::Command;

use sulcus_screen::gpu::Mode;
use sulcus_screen::quality::Quality;

use crate::common::renderer;
use crate::identity::operator;
use crate::scene::{held, mouth};

/// Variable of the environment with the file into which a child process writes its pixels.
const OUT: &str = "SULCUS_PIXELS_TO";

#[test]
fn pictures_are_the_same_bytes_for_any_number_of_threads() {
    let scene = mouth();
    let (moment, eye) = (held(&scene), operator());
    let mut bytes = Vec::new();
    for quality in Quality::ALL {
        let Some(mut renderer) = renderer(&scene, quality, Mode::Beauty) else {
            return;
        };
        let first = eye.picture(&mut renderer, &moment);
        let again = eye.picture(&mut renderer, &moment);
        assert!(
            first == again,
            "{quality:?}: two pictures of one renderer differ"
        );
        bytes.extend(first.rgba.into_iter().flatten());
    }
    if let Some(out) = std::env::var_os(OUT) {
        std::fs::write(out, bytes).expect("pixels are written");
        return;
    }
    let name = std::thread::current()
        .name()
        .expect("name of the test")
        .to_owned();
    for threads in ["0", "1", "2"] {
        let out =
            std::env::temp_dir().join(format!("sulcus-{}-{threads}.rgba", std::process::id()));
        let child = Command::new(std::env::current_exe().expect("this program"))
            .args(["--exact", &name])
            .env("LP_NUM_THREADS", threads)
            .env(OUT, &out)
            .output()
            .expect("a child");
        assert!(
            child.status.success(),
            "{}",
            String::from_utf8_lossy(&child.stdout)
        );
        let written = std::fs::read(&out).expect("pixels of the child");
        std::fs::remove_file(&out).expect("the file is removed");
        assert!(written == bytes, "LP_NUM_THREADS={threads}: other pixels");
    }
}
