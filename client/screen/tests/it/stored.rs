//! Lit pictures against stored ones: a change of the looks is seen and meant.

use std::path::{Path, PathBuf};

use sulcus_proto::display::{DisplayScene, Spot};
use sulcus_screen::gpu::{Drawing, Image, Mode};
use sulcus_screen::moment::Moment;
use sulcus_screen::quality::Quality;
use sulcus_screen::views::View;

use crate::common::{pairs, renderer, rgb};
use crate::scene::{GINGIVA_36, MIRROR, held, mirror_at, mouth};
use crate::shapes::V;

/// Size of a stored picture.
const SIZE: [u32; 2] = [640, 360];
/// Largest mean difference of a channel, 255ths.
const MEAN: f64 = 1.0;
/// Largest share of pixels with a channel that differs by more than 8.
const SHARE: f64 = 0.005;
/// Largest file, bytes.
const LARGEST: usize = 120_000;
/// Variable of the environment that rewrites the stored pictures.
const REWRITE: &str = "SULCUS_REWRITE_PICTURES";

/// Mean difference of a channel, and share of the pixels that differ by more than 8 in a channel.
pub fn difference(a: &Image, b: &Image) -> [f64; 2] {
    let (mut sum, mut far) = (0.0, 0.0);
    for (_, _, a, b) in pairs(a, b) {
        let (a, b) = (rgb(a), rgb(b));
        let apart = [0, 1, 2].map(|k| (a[k] - b[k]).abs());
        sum += apart.iter().sum::<f64>() / 3.0;
        far += f64::from(u8::from(apart.iter().any(|x| *x > 8.0)));
    }
    [sum, far].map(|x| x / a.rgba.len() as f64)
}

/// Reads a picture of three channels.
fn read(path: &Path) -> Result<Image, String> {
    let file = std::fs::File::open(path).map_err(|error| error.to_string())?;
    let decoder = png::Decoder::new(std::io::BufReader::new(file));
    let mut reader = decoder.read_info().map_err(|error| error.to_string())?;
    let size = reader.output_buffer_size().ok_or("too large")?;
    let mut bytes = vec![0; size];
    let frame = reader.next_frame(&mut bytes);
    let frame = frame.map_err(|error| error.to_string())?;
    let pixels = bytes.chunks_exact(3);
    Ok(Image {
        width: frame.width,
        height: frame.height,
        rgba: pixels.map(|c| [c[0], c[1], c[2], 255]).collect(),
    })
}

/// Instant of the stored pictures: both tools held, blood at two sites since three seconds. In the view of the mirror
/// the glass faces its eye and shows the lingual site.
fn instant(scene: &DisplayScene, view: View) -> Moment {
    let spot = |site| Spot {
        object: GINGIVA_36,
        site,
        since: 0,
    };
    let mut moment = held(scene);
    moment.spots = [0, 4].map(|site| (spot(site), 3.0)).into();
    if view == View::Mirror {
        moment.tools[MIRROR] = mirror_at(V::new(0.0, -14.0, 6.0), V::new(0.2, 0.55, 0.8));
    }
    moment
}

/// The picture as a file. The strongest compression keeps the repository small.
fn file(picture: &Image) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, picture.width, picture.height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_compression(png::Compression::High);
    let rgb: Vec<u8> = picture
        .rgba
        .iter()
        .flat_map(|c| [c[0], c[1], c[2]])
        .collect();
    let mut writer = encoder.write_header().expect("a header");
    writer.write_image_data(&rgb).expect("pixels");
    writer.finish().expect("an end");
    bytes
}

fn judge(view: View) {
    let scene = mouth();
    let moment = instant(&scene, view);
    let Some(mut renderer) = renderer(&scene, Quality::Full, Mode::Beauty) else {
        return;
    };
    let camera = view.camera(&scene, &moment, Some(36), 16.0 / 9.0);
    let drawn = renderer.picture(&Drawing::through(camera), &moment, SIZE);
    let drawn = drawn.expect("a picture");
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/pictures");
    let name = view.name();
    let path: PathBuf = folder.join(format!("{name}.png"));
    let bytes = file(&drawn);
    assert!(bytes.len() < LARGEST, "{name}: {} bytes", bytes.len());
    if std::env::var_os(REWRITE).is_some() {
        std::fs::write(&path, bytes).expect("the picture is written");
    }
    let help = format!(
        "If the new picture is meant: {REWRITE}=1 cargo test -p sulcus-screen --test it stored, then look at {}",
        path.display()
    );
    let stored = read(&path).unwrap_or_else(|why| panic!("{name}: {why}. {help}"));
    let [mean, share] = difference(&drawn, &stored);
    println!(
        "{name}: mean difference {mean:.4}, {:.3} % of pixels over 8",
        100.0 * share
    );
    assert!(
        mean < MEAN && share < SHARE,
        "{name}: mean difference {mean:.3} of at most {MEAN}, {:.3} % of pixels over 8, at most {:.1} %. {help}",
        100.0 * share,
        100.0 * SHARE
    );
}

#[test]
fn the_overview_is_the_stored_picture() {
    judge(View::Overview);
}

#[test]
fn the_buccal_view_is_the_stored_picture() {
    judge(View::Buccal);
}

#[test]
fn the_view_of_the_mirror_is_the_stored_picture() {
    judge(View::Mirror);
}

#[test]
fn the_close_up_of_the_probe_is_the_stored_picture() {
    judge(View::CloseUp);
}
