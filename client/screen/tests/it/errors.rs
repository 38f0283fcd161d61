//! Sizes out of range, empty scenes, frames of another scene.

use sulcus_proto::display::{DisplayFrame, DisplayScene, FrameTool, Moved, MovedHandle, Spot};
use sulcus_screen::error::ScreenError;
use sulcus_screen::gpu::{Drawing, Mode};
use sulcus_screen::moment::Moment;
use sulcus_screen::quality::Quality;
use sulcus_screen::views::View;

use crate::common::renderer;
use crate::identity::operator;
use crate::scene::{SHEETS, held, mouth};

#[test]
fn sizes_out_of_range_are_errors_and_the_largest_square_fits_a_buffer() {
    let scene = mouth();
    let Some(mut renderer) = renderer(&scene, Quality::Low, Mode::Identity) else {
        return;
    };
    let (drawing, moment) = (operator().drawing(), held(&scene));
    let most = renderer.graphics().largest();
    for size in [
        [0, 0],
        [0, 600],
        [960, 0],
        [15, 600],
        [most + 1, 16],
        [16, most + 1],
        [u32::MAX; 2],
    ] {
        let error = renderer.picture(&drawing, &moment, size);
        let error = error.err().unwrap_or_else(|| panic!("{size:?} was drawn"));
        assert!(
            matches!(error, ScreenError::Size { .. }),
            "{size:?}: {error}"
        );
        let told = error.to_string();
        assert!(
            told.contains(&format!("{} x {}", size[0], size[1])),
            "{told}"
        );
    }
    // A picture of the largest square would take a gigabyte. Rows of a picture's buffer are padded to whole blocks.
    let row = (4 * most).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
    let largest = wgpu::Limits::downlevel_defaults().max_buffer_size;
    assert!(u64::from(row) * u64::from(most) <= largest, "{most}");
    for size in [[16, 16], [17, 333], [most, 16], [16, most], [1000; 2]] {
        let picture = renderer
            .picture(&drawing, &moment, size)
            .expect("a picture");
        assert_eq!([picture.width, picture.height], size);
        assert_eq!(picture.rgba.len(), (size[0] * size[1]) as usize);
    }
}

#[test]
fn a_scene_without_objects_or_tools_is_drawn_from_every_view() {
    let mut scene = mouth();
    scene.objects.clear();
    let mut bare = scene.clone();
    bare.tools.clear();
    for (scene, moment) in [(&scene, held(&scene)), (&bare, Moment::rest(&bare))] {
        for mode in [Mode::Beauty, Mode::Identity] {
            for quality in [Quality::Full, Quality::Lowest] {
                let Some(mut renderer) = renderer(scene, quality, mode) else {
                    return;
                };
                for view in View::ALL {
                    let camera = view.camera(scene, &moment, Some(36), 1.5);
                    let drawing = Drawing::through(camera);
                    let picture = renderer.picture(&drawing, &moment, [96, 64]);
                    let picture = picture.expect("a picture");
                    let first = picture.at(0, 0);
                    let is_blank = picture.rgba.iter().all(|colour| *colour == first);
                    // The mirror fills the middle of its own view.
                    assert!(is_blank || !scene.tools.is_empty(), "{view:?}");
                    assert!(!is_blank || scene.tools.is_empty() || view != View::Mirror);
                }
            }
        }
    }
}

/// Frame with one moved handle and one spot.
fn frame(object: u16, handle: u16, spot: u16, site: u8) -> DisplayFrame {
    DisplayFrame {
        tick: 5_000,
        tools: [FrameTool::default(); 2],
        moved: vec![Moved {
            object,
            handles: vec![MovedHandle {
                handle,
                by: [900, 0, 0],
            }],
        }],
        spots: vec![Spot {
            object: spot,
            site,
            since: 0,
        }],
        ..DisplayFrame::default()
    }
}

/// Such frames are refused before they are drawn; a picture of one must not end the exercise all the same.
#[test]
fn frames_whose_numbers_do_not_fit_are_refused_and_drawn_without_panic() {
    let scene: DisplayScene = mouth();
    let Some(mut renderer) = renderer(&scene, Quality::Low, Mode::Beauty) else {
        return;
    };
    let eye = operator();
    let mut draw = |frame: &DisplayFrame| eye.picture(&mut renderer, &Moment::of(&scene, frame));
    let fitting = frame(SHEETS[0], 3, 4, 5);
    assert!(fitting.fits(&scene));
    draw(&fitting);
    let rest = draw(&DisplayFrame::default());
    for wrong in [
        frame(SHEETS[0], 4, 4, 5),
        frame(0, 0, 4, 5),
        frame(999, 0, 4, 5),
        frame(SHEETS[0], 3, 0, 5),
        frame(SHEETS[0], 3, 999, 5),
        frame(SHEETS[0], u16::MAX, 4, 255),
    ] {
        assert!(!wrong.fits(&scene), "{wrong:?}");
        draw(&wrong);
        assert!(draw(&DisplayFrame::default()) == rest, "{wrong:?} stays");
    }
}
