//! Picture of a sphere tree for the viewer. A slider steps through the levels.

use std::path::Path;

use rerun::blueprint::{
    Blueprint, BlueprintActivation, ContainerLike, Horizontal, Spatial3DView, TextDocumentView,
    TimePanel, Vertical,
};
use rerun::{RecordingStream, RecordingStreamBuilder, RecordingStreamError};

use crate::error::{Refusal, ViewError};
use crate::tree_picture::{LevelPicture, TreePicture};

/// Name of the timeline that the slider moves on.
const TIMELINE: &str = "level";

/// Writes a file (`.rrd`) for the Rerun viewer of the same version: the mesh coloured by error beside the spheres, with
/// one pair of entities for each level, on a timeline `level`.
///
/// # Errors
/// The lists of a level differ in length, or the file cannot be written.
pub fn write_tree(path: &Path, picture: &TreePicture) -> Result<(), ViewError> {
    picture.fits()?;
    log(path, picture).map_err(|source| ViewError::Write {
        file: path.to_owned(),
        source,
    })
}

fn log(path: &Path, picture: &TreePicture) -> Result<(), Refusal> {
    let stream = RecordingStreamBuilder::new("sulcus_tree")
        // The file is written whatever the environment variables of Rerun are.
        .enabled(true)
        .save(path)?;
    stream.send_recording_name(picture.name.as_str())?;
    // The time of writing is left out. The level is the only time.
    stream.disable_timeline("log_time");
    stream.disable_timeline("log_tick");
    blueprint().send(&stream, BlueprintActivation::default())?;
    for root in ["error", "spheres"] {
        stream.log_static(root, &rerun::ViewCoordinates::RIGHT_HAND_Z_UP())?;
    }
    let mut before: Option<&LevelPicture> = None;
    for level in &picture.levels {
        stream.set_time_sequence(TIMELINE, i64::from(level.level));
        if let Some(before) = before {
            // Without this the level before would stay visible.
            for root in ["error", "spheres"] {
                stream.log(entity(root, before), &rerun::Clear::flat())?;
            }
        }
        log_level(&stream, picture, level)?;
        before = Some(level);
    }
    stream.flush_blocking()?;
    Ok(())
}

fn entity(root: &str, level: &LevelPicture) -> String {
    format!("{root}/level_{}", level.level)
}

fn log_level(
    stream: &RecordingStream,
    picture: &TreePicture,
    level: &LevelPicture,
) -> Result<(), RecordingStreamError> {
    let colours = |of: &[[u8; 3]]| -> Vec<rerun::Color> {
        of.iter()
            .map(|[r, g, b]| rerun::Color::from_rgb(*r, *g, *b))
            .collect()
    };
    let mesh = rerun::Mesh3D::new(picture.vertices.iter().copied())
        .with_triangle_indices(picture.triangles.iter().copied())
        .with_vertex_normals(picture.normals.iter().copied())
        .with_vertex_colors(colours(&level.vertex_colours));
    stream.log(entity("error", level), &mesh)?;
    let spheres = rerun::Points3D::new(level.centres.iter().copied())
        .with_radii(level.radii.iter().copied())
        .with_colors(colours(&level.sphere_colours));
    stream.log(entity("spheres", level), &spheres)?;
    stream.log(
        "caption",
        &rerun::TextDocument::new(level.caption.as_str())
            .with_media_type(rerun::MediaType::markdown()),
    )
}

/// Mesh and spheres side by side, the text about the level below, the slider at the bottom.
fn blueprint() -> Blueprint {
    let views: [ContainerLike; 2] = [
        Spatial3DView::new("mesh, coloured by error")
            .with_origin("/error")
            .into(),
        Spatial3DView::new("spheres").with_origin("/spheres").into(),
    ];
    let rows: [ContainerLike; 2] = [
        Horizontal::new(views).into(),
        TextDocumentView::new("this level")
            .with_origin("/caption")
            .into(),
    ];
    Blueprint::new(Vertical::new(rows).with_row_shares(vec![4.0, 1.0]))
        .with_auto_views(false)
        .with_time_panel(TimePanel::new().with_timeline(TIMELINE))
}
