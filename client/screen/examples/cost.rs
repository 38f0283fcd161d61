//! Processor time of a frame by level of quality: `cost SCENE.bin [VIEW [FRAMES [WIDTH HEIGHT]]]`. The example `encode`
//! of `sulcus-display` writes such scenes. The time is that of the whole process, all threads, with the read-back.

use nalgebra::{UnitQuaternion, Vector3};
use rustix::time::{ClockId, clock_gettime};
use sulcus_proto::display::{DisplayScene, Moved, MovedHandle};
use sulcus_screen::camera::Camera;
use sulcus_screen::error::ScreenError;
use sulcus_screen::gpu::{Backend, Drawing, Graphics, Mode, Renderer};
use sulcus_screen::moment::Moment;
use sulcus_screen::quality::Quality;
use sulcus_screen::stage::Stage;
use sulcus_screen::views::View;

/// Frames that are drawn before the measured ones.
const WARM: usize = 3;
/// Angle between the glass of a mirror and the line to the eye, degrees.
const TURN_DEG: f32 = 25.0;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let argument = |k: usize| arguments.get(k).map(String::as_str);
    let number = |k: usize, usual: u32| argument(k).map_or(Ok(usual), str::parse);
    let scene = argument(0).ok_or("expected a file with a display scene")?;
    let scene = DisplayScene::from_bytes(&std::fs::read(scene)?)?;
    let view: View = argument(1).unwrap_or("buccal").parse()?;
    let frames = number(2, 30)? as usize;
    let size = [number(3, 1280)?, number(4, 720)?];
    let rest = Moment::rest(&scene);
    let aspect = f64::from(size[0]) / f64::from(size[1]);
    let camera = view.camera(&scene, &rest, None, aspect);
    let mirror = with_mirror(&scene, &rest, &camera);
    println!(
        "{} x {} pixels, {frames} frames, ms of processor time for each",
        size[0], size[1]
    );
    println!("level    triangles  mouth  + mirror  + all tissue moves");
    for quality in Quality::ALL {
        let stage = Stage::new(&scene, quality.looks().merged_um);
        let triangles = stage.triangles();
        let graphics = Graphics::headless(Backend::Any)?;
        if quality == Quality::ALL[0] {
            println!("({})", graphics.name());
        }
        let mut renderer = Renderer::new(graphics, stage, quality, Mode::Beauty);
        let mut cost = |moment: &dyn Fn(usize) -> Moment| -> Result<f64, ScreenError> {
            let drawing = Drawing::through(camera);
            let mut start = 0.0;
            for k in 0..WARM + frames {
                if k == WARM {
                    start = used_ms();
                }
                renderer.picture(&drawing, &moment(k), size)?;
            }
            Ok((used_ms() - start) / frames.max(1) as f64)
        };
        let mouth = cost(&|_| rest.clone())?;
        let glass = cost(&|_| mirror.clone())?;
        let moving = cost(&|k| Moment {
            moved: moved(&scene, k),
            ..mirror.clone()
        })?;
        let name = quality.name();
        println!("{name:<8} {triangles:>9} {mouth:>6.1} {glass:>9.1} {moving:>19.1}");
    }
    Ok(())
}

/// Processor time of this process so far, ms.
fn used_ms() -> f64 {
    let used = clock_gettime(ClockId::ProcessCPUTime);
    used.tv_sec as f64 * 1e3 + used.tv_nsec as f64 * 1e-6
}

/// The instant with each mirror held in the middle of the picture.
fn with_mirror(scene: &DisplayScene, rest: &Moment, camera: &Camera) -> Moment {
    let mut moment = rest.clone();
    let middle = camera.middle().cast::<f32>();
    let to_eye = (camera.eye().cast::<f32>() - middle).normalize();
    for (at, tool) in moment.tools.iter_mut().zip(&scene.tools) {
        let Some(glass) = tool.glass else { continue };
        let normal = Vector3::from(glass.normal);
        let facing = UnitQuaternion::rotation_between(&normal, &to_eye).unwrap_or_default();
        let aside = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), TURN_DEG.to_radians());
        at.held = true;
        at.orientation = aside * facing;
        at.position = middle + to_eye * 15.0 - at.orientation * Vector3::from(glass.centre) * 1e3;
    }
    moment
}

/// All handles of all skins, moved by up to 0.1 mm.
fn moved(scene: &DisplayScene, frame: usize) -> Vec<Moved> {
    let steps = 1 + (frame % 50) as i16;
    let skins = (0u16..).zip(&scene.objects);
    let moved = skins.filter_map(|(object, one)| {
        let handles = 0..one.skin.as_ref()?.handles.len() as u16;
        let handles = handles.map(|handle| MovedHandle {
            handle,
            by: [0, 0, steps],
        });
        Some(Moved {
            object,
            handles: handles.collect(),
        })
    });
    moved.filter(|moved| !moved.handles.is_empty()).collect()
}
