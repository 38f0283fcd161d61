//! Draws a display scene at rest: `draw SCENE.bin OUT.png [VIEW [TOOTH [QUALITY [TURN TILT ZOOM]]]]`. The example
//! `encode` of `sulcus-display` writes such scenes.

use sulcus_proto::display::DisplayScene;
use sulcus_screen::gpu::{Backend, Drawing, Graphics, Mode, Renderer};
use sulcus_screen::moment::Moment;
use sulcus_screen::quality::Quality;
use sulcus_screen::stage::Stage;
use sulcus_screen::views::View;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let argument = |k: usize| arguments.get(k).map(String::as_str);
    let number = |k: usize, usual: f64| argument(k).map_or(Ok(usual), str::parse);
    let (Some(scene), Some(out)) = (argument(0), argument(1)) else {
        return Err("expected a file with a display scene, and the file to write".into());
    };
    let scene = DisplayScene::from_bytes(&std::fs::read(scene)?)?;
    let view: View = argument(2).unwrap_or("overview").parse()?;
    let tooth = argument(3).map(str::parse).transpose()?;
    let quality: Quality = argument(4).unwrap_or("full").parse()?;
    let stage = Stage::new(&scene, quality.looks().thinned_um);
    let moment = Moment::rest(&scene);
    let size = [1280, 720];
    let camera = view.camera(&scene, &moment, tooth, 1280.0 / 720.0);
    let camera = camera
        .orbited(
            number(5, 0.0)?.to_radians(),
            number(6, 0.0)?.to_radians(),
            1.0,
        )
        .magnified(number(7, 1.0)?);
    println!("{} triangles", stage.triangles());
    let graphics = Graphics::headless(Backend::Any)?;
    let mut renderer = Renderer::new(graphics, stage, quality, Mode::Beauty);
    let image = renderer.picture(&Drawing::through(camera), &moment, size)?;
    std::fs::write(out, image.png()?)?;
    Ok(())
}
