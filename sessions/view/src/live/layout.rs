//! Layout of a live view: the mouth, the pocket close up, force and depth of the last seconds.

use rerun::RecordingStream;
use rerun::external::re_sdk_types::blueprint::archetypes::{PlotLegend, TimeAxis};
use rerun::external::re_sdk_types::blueprint::components::LinkAxis;
use rerun::external::re_sdk_types::datatypes::{TimeInt, TimeRange, TimeRangeBoundary};

use crate::error::Refusal;
use crate::layout::{Part, View};
use crate::review::ReviewPicture;
use crate::review::layout::{TEETH, close_up, space};

/// Force on the floor of the pocket, N.
pub(super) const FORCE: &str = "/plots/floor_force";
/// Depth of the tip and of the site, mm.
pub(super) const DEPTH: &str = "/plots/depth";
/// Forces on the hands, arrows from the tips.
pub(super) const PUSHES: &str = "/forces/hands";
/// Time that a plot shows, nanoseconds.
const SHOWN_NS: i64 = 30_000_000_000;

pub(super) fn of(picture: &ReviewPicture) -> Part {
    let mouth = ["/mouth/**", "/tools/**", "/hands/**", "/forces/**", TEETH];
    let name = format!(
        "mouth (arrows: {} mm for 1 N; pale blue: the hand)",
        picture.arrow_mm_per_n
    );
    let overview = space(&name, &mouth, picture.overview).into_part();
    let mut side = Vec::new();
    side.extend(picture.close_up.map(|eye| (1.6, close_up(picture, eye))));
    side.push((1.0, plot("force on the pocket's floor, N", FORCE)));
    side.push((1.0, plot("depth, mm (grey: by the scene)", DEPTH)));
    Part::Row(vec![(1.6, overview), (1.0, Part::Column(side))])
}

fn plot(name: &str, path: &str) -> Part {
    let range = TimeRange {
        start: TimeRangeBoundary::CursorRelative(TimeInt(-SHOWN_NS)),
        end: TimeRangeBoundary::CursorRelative(TimeInt(0)),
    };
    View::new("TimeSeries", name, &[path])
        .with(
            "TimeAxis",
            TimeAxis::new()
                .with_link(LinkAxis::Independent)
                .with_view_range(range),
        )
        .with("PlotLegend", PlotLegend::new().with_visible(false))
        .into_part()
}

/// Names and colours of the lines.
pub(super) fn styles(stream: &RecordingStream) -> Result<(), Refusal> {
    const YELLOW: u32 = 0xffdc3cff;
    const GREY: u32 = 0x8c8c96ff;
    let thick = rerun::Arrows3D::update_fields().with_radii([0.22]);
    stream.log_static(PUSHES, &thick)?;
    for (path, names, colours) in [
        (FORCE, &["force"][..], &[YELLOW][..]),
        (
            DEPTH,
            &["reached by the tip", "by the scene"],
            &[YELLOW, GREY],
        ),
    ] {
        let lines = rerun::SeriesLines::new()
            .with_names(names.iter().copied())
            .with_colors(colours.iter().map(|&c| rerun::Color::from_u32(c)))
            .with_widths(names.iter().map(|_| 1.5f32));
        stream.log_static(path, &lines)?;
    }
    Ok(())
}
