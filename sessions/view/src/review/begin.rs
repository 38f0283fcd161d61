//! Constant part of a review: meshes, colours, texts, layout.

use std::path::Path;

use rerun::blueprint::components::PlayState;
use rerun::{RecordingStream, RecordingStreamBuilder};

use super::entity::entity;
use super::layout;
use super::normals::normals;
use super::picture::{MeshPicture, PartKind, ReviewPicture, Slider};
use crate::error::Refusal;
use crate::layout::Part;

/// Name of the application, by which the viewer keeps a layout.
pub(crate) const APPLICATION: &str = "sulcus_review";
/// Colour of the hand's ghost and of the line to it, sRGB.
const HAND: [u8; 3] = [90, 200, 255];
/// Opacity of the ghost, 0 to 255.
const GHOST_ALPHA: u8 = 90;

/// File with the constant part.
pub(super) fn begin(path: &Path, picture: &ReviewPicture) -> Result<RecordingStream, Refusal> {
    let stream = RecordingStreamBuilder::new(APPLICATION)
        // The file is written whatever the environment variables of Rerun are.
        .enabled(true)
        .save(path)?;
    constant(&stream, picture, &layout::of(picture))?;
    layout::styles(&stream, picture)?;
    Ok(stream)
}

/// Writes layout, tools, texts and explanation.
pub(crate) fn constant(
    stream: &RecordingStream,
    picture: &ReviewPicture,
    layout: &Part,
) -> Result<(), Refusal> {
    stream.send_recording_name(picture.name.as_str())?;
    stream.disable_timeline("log_time");
    stream.disable_timeline("log_tick");
    crate::layout::send(
        stream,
        APPLICATION,
        super::waiting::SESSION,
        match picture.slider {
            Slider::Start => PlayState::Paused,
            Slider::End => PlayState::Following,
        },
        layout,
    )?;
    stream.log_static("/", &rerun::ViewCoordinates::RIGHT_HAND_Z_UP())?;
    for tool in &picture.tools {
        let shown = mesh(&tool.mesh, Some([255; 4]));
        stream.log_static(entity("/tools", &tool.name), &shown)?;
        let ghost = MeshPicture {
            colour: HAND,
            vertex_colours: Vec::new(),
            ..tool.mesh.clone()
        };
        let ghost = mesh(&ghost, Some([255, 255, 255, GHOST_ALPHA]));
        stream.log_static(entity("/hands", &tool.name), &ghost)?;
        let line = rerun::LineStrips3D::update_fields()
            .with_radii([0.08])
            .with_colors([rerun::Color::from_rgb(HAND[0], HAND[1], HAND[2])]);
        stream.log_static(entity("/offsets", &tool.name), &line)?;
        let thick = rerun::Arrows3D::update_fields().with_radii([0.22]);
        stream.log_static(entity("/forces", &format!("on {}", tool.name)), &thick)?;
        let thin = rerun::Arrows3D::update_fields().with_radii([0.09]);
        stream.log_static(entity("/contacts", &tool.name), &thin)?;
    }
    let look = rerun::Points3D::update_fields()
        .with_show_labels(true)
        .with_colors([rerun::Color::from_rgb(190, 230, 190)])
        .with_radii([0.12]);
    stream.log_static(layout::SITES, &look)?;
    if !picture.teeth.is_empty() {
        let teeth = look
            .with_positions(picture.teeth.iter().map(|label| label.at))
            .with_labels(picture.teeth.iter().map(|label| label.text.as_str()));
        stream.log_static(layout::TEETH, &teeth)?;
    }
    let about = rerun::TextDocument::new(picture.about.as_str())
        .with_media_type(rerun::MediaType::markdown());
    stream.log_static(layout::ABOUT, &about)?;
    Ok(())
}

/// Colour of a contact's arrow by the kind of the touched part.
pub(super) fn colour_of(kind: PartKind) -> [u8; 3] {
    match kind {
        PartKind::Tooth => [120, 170, 255],
        PartKind::Gingiva => [255, 90, 80],
        PartKind::Tongue => [255, 150, 60],
        PartKind::Other => [200, 200, 200],
    }
}

/// Mesh that does not move, with a tint, or with the tint of the view.
pub(super) fn mesh(mesh: &MeshPicture, tint: Option<[u8; 4]>) -> rerun::Mesh3D {
    let one = [mesh.colour];
    let each = if mesh.vertex_colours.is_empty() {
        one.iter().cycle().take(mesh.vertices.len())
    } else {
        mesh.vertex_colours.iter().cycle().take(mesh.vertices.len())
    };
    let shown = rerun::Mesh3D::new(mesh.vertices.iter().copied())
        .with_triangle_indices(mesh.triangles.iter().copied())
        .with_vertex_normals(normals(&mesh.vertices, &mesh.triangles))
        .with_vertex_colors(colours(each));
    let Some([r, g, b, a]) = tint else {
        return shown;
    };
    shown
        .with_albedo_factor(rerun::Rgba32::from_unmultiplied_rgba(r, g, b, a))
        .with_face_rendering(rerun::components::MeshFaceRendering::DoubleSided)
}

/// Colours as Rerun's type.
pub(super) fn colours<'a>(
    of: impl IntoIterator<Item = &'a [u8; 3]>,
) -> impl Iterator<Item = rerun::Color> {
    of.into_iter()
        .map(|[r, g, b]| rerun::Color::from_rgb(*r, *g, *b))
}
