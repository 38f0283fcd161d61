//! Writes the display scene of a scene file: `encode server/scenes/mouth.toml mouth.bin [SEED]`. The example `draw` of
//! `sulcus-screen` draws it.

use std::path::Path;

use sulcus_display::Display;
use sulcus_scene::{BuildOptions, compile_file};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [scene, out, seed @ ..] = &arguments[..] else {
        return Err(
            "expected a scene file, the file to write, and optionally the seed of the patient"
                .into(),
        );
    };
    let options = BuildOptions {
        seed: seed.first().map(|seed| seed.parse()).transpose()?,
        ..BuildOptions::cached()
    };
    let compiled = compile_file(Path::new(scene), &options, &|_, _| ())?;
    let begin = std::time::Instant::now();
    let display = Display::new(&compiled.scene)?;
    let triangles: usize = display
        .scene()
        .objects
        .iter()
        .map(|one| one.mesh.triangles().count())
        .sum();
    std::fs::write(out, display.bytes())?;
    println!(
        "{triangles} triangles of objects, {} bytes, {:.2} s",
        display.bytes().len(),
        begin.elapsed().as_secs_f64()
    );
    Ok(())
}
