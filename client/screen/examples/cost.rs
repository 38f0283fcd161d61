//! Processor time of a frame by level of quality:
//! `cost SCENE.bin [VIEW,VIEW [FRAMES [WIDTH HEIGHT]]] [--levels NAME,NAME] [--json FILE]`. The example `encode` of `sulcus-display` writes such scenes.
//!
//! The time is that of the whole process, all threads. A frame is drawn as for a window: nobody reads the picture. The
//! last column has the time that a picture in memory takes more. The file goes to `sulcus-server report --screen`.

use nalgebra::{UnitQuaternion, Vector3};
use rustix::time::{ClockId, clock_gettime};
use serde_json::{Value, json};
use sulcus_proto::display::{DisplayScene, Moved, MovedHandle};
use sulcus_screen::camera::Camera;
use sulcus_screen::error::ScreenError;
use sulcus_screen::gpu::{Backend, Drawing, Graphics, Mode, Renderer, Work};
use sulcus_screen::moment::Moment;
use sulcus_screen::quality::Quality;
use sulcus_screen::stage::Stage;
use sulcus_screen::views::View;

/// Frames that are drawn before the measured ones.
const WARM: usize = 3;
/// Angle between the glass of a mirror and the line to the eye, degrees.
const TURN_DEG: f32 = 25.0;
/// Bounds of the processor time of a frame with a mirror, ms.
const BOUNDS: [(Quality, f64); 2] = [(Quality::Low, 30.0), (Quality::Lowest, 16.0)];

type Failure = Box<dyn std::error::Error>;

/// Arguments of the command line.
struct Arguments {
    scene: DisplayScene,
    views: Vec<View>,
    levels: Vec<Quality>,
    frames: usize,
    size: [u32; 2],
    json: Option<String>,
}

fn main() -> Result<(), Failure> {
    let arguments = arguments()?;
    let Arguments {
        scene,
        views,
        levels,
        frames,
        size,
        json,
    } = &arguments;
    println!(
        "{} x {} pixels, {frames} frames, ms of processor time for each",
        size[0], size[1]
    );
    println!(
        "level    view      triangles   drawn  draws  mouth  + mirror (least)  + all tissue moves  read back"
    );
    let (mut rows, mut adapter) = (Vec::new(), String::new());
    for quality in levels {
        let quality = *quality;
        let stage = Stage::new(scene, quality.looks().thinned_um);
        let graphics = Graphics::headless(Backend::Any)?;
        if adapter.is_empty() {
            adapter = graphics.name();
            println!("({adapter})");
        }
        let mut renderer = Renderer::new(graphics, stage, quality, Mode::Beauty);
        for view in views {
            rows.push(row(&arguments, &mut renderer, quality, *view)?);
        }
    }
    if let Some(file) = json {
        let levels: Vec<Value> = Quality::ALL.map(level).into();
        let bounds = BOUNDS.map(|(level, ms)| json!({"level": level.name(), "ms": ms}));
        let whole = json!({
            "machine": machine(),
            "adapter": adapter,
            "size": size,
            "frames": frames,
            "bounds": bounds,
            "levels": levels,
            "rows": rows,
        });
        std::fs::write(file, serde_json::to_string_pretty(&whole)? + "\n")?;
    }
    Ok(())
}

fn arguments() -> Result<Arguments, Failure> {
    let mut all: Vec<String> = std::env::args().skip(1).collect();
    let mut option = |name: &str| {
        let at = all.iter().position(|argument| argument == name)?;
        let value = all.get(at + 1).cloned();
        all.drain(at..(at + 2).min(all.len()));
        value
    };
    let json = option("--json");
    let levels = match option("--levels") {
        Some(names) => names.split(',').map(str::parse).collect::<Result<_, _>>()?,
        None => Quality::ALL.into(),
    };
    let argument = |k: usize| all.get(k).map(String::as_str);
    let number = |k: usize, usual: u32| argument(k).map_or(Ok(usual), str::parse);
    let scene = argument(0).ok_or("expected a file with a display scene")?;
    let views = argument(1).unwrap_or("buccal,overview").split(',');
    Ok(Arguments {
        scene: DisplayScene::from_bytes(&std::fs::read(scene)?)?,
        views: views.map(str::parse).collect::<Result<_, _>>()?,
        levels,
        frames: number(2, 30)?.max(1) as usize,
        size: [number(3, 1280)?, number(4, 720)?],
        json,
    })
}

/// Measures a level in a view, prints the numbers and returns them.
fn row(
    arguments: &Arguments,
    renderer: &mut Renderer,
    quality: Quality,
    view: View,
) -> Result<Value, ScreenError> {
    let Arguments {
        scene,
        frames,
        size,
        ..
    } = arguments;
    let rest = Moment::rest(scene);
    let camera = view.camera(scene, &rest, None, f64::from(size[0]) / f64::from(size[1]));
    let mirror = with_mirror(scene, &rest, &camera);
    let drawing = Drawing::through(camera);
    // Median of the frames: another program on the machine slows some of them.
    let mut cost = |moment: &dyn Fn(usize) -> Moment, is_read: bool| {
        let mut all = Vec::new();
        for k in 0..WARM + frames {
            let (moment, start) = (moment(k), used_ms());
            if is_read {
                renderer.picture(&drawing, &moment, *size)?;
            } else {
                renderer.unread(&drawing, &moment, *size)?;
            }
            all.push(used_ms() - start);
        }
        all.drain(..WARM);
        all.sort_unstable_by(f64::total_cmp);
        Ok::<_, ScreenError>((all[all.len() / 2], all[0], renderer.work()))
    };
    let (mouth, ..) = cost(&|_| rest.clone(), false)?;
    let (glass, least, work) = cost(&|_| mirror.clone(), false)?;
    let moves = |k| Moment {
        moved: moved(scene, k),
        ..mirror.clone()
    };
    let (moving, ..) = cost(&moves, false)?;
    let (read, ..) = cost(&|_| mirror.clone(), true)?;
    let triangles = renderer.stage().triangles();
    let Work {
        draws,
        triangles: drawn,
    } = work;
    let (name, view, read) = (quality.name(), view.name(), read - glass);
    println!(
        "{name:<8} {view:<9} {triangles:>9} {drawn:>7} {draws:>6} {mouth:>6.1} {glass:>9.1} {least:>7.1} {moving:>19.1} {read:>10.1}"
    );
    let rounded = |ms: f64| (ms * 10.0).round() / 10.0;
    Ok(json!({
        "level": name,
        "view": view,
        "triangles": triangles,
        "drawn_triangles": drawn,
        "draws": draws,
        "mouth_ms": rounded(mouth),
        "mirror_ms": rounded(glass),
        "mirror_least_ms": rounded(least),
        "moving_ms": rounded(moving),
        "read_back_ms": rounded(read),
    }))
}

/// Looks of a level.
fn level(quality: Quality) -> Value {
    let looks = quality.looks();
    json!({
        "level": quality.name(),
        "light": if looks.per_pixel { "each pixel" } else { "each vertex" },
        "samples": looks.samples,
        "shadow_texels": looks.shadow,
        "relief": looks.relief,
        "thinned_um": looks.thinned_um,
        "always": ["bands", "mirror", "bleeding", "bared roots"],
    })
}

/// Processor of this machine and its logical cores.
fn machine() -> Value {
    let text = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let name = text
        .lines()
        .find_map(|line| line.strip_prefix("model name"));
    let name = name
        .and_then(|line| line.split_once(": "))
        .map_or("unknown", |(_, name)| name);
    let cores = std::thread::available_parallelism().map_or(0, usize::from);
    json!({"processor": name, "cores": cores})
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
