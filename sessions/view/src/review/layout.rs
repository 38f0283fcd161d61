//! Layout of a review: the mouth on the left, numbers over time and the log on the right.

use rerun::RecordingStream;
use rerun::blueprint::components::{BackgroundKind, Eye3DKind};
use rerun::components::{AggregationPolicy, MarkerShape};
use rerun::external::re_sdk_types::blueprint::archetypes::{
    Background, EyeControls3D, LineGrid3D, PlotLegend, TextLogColumns, TimeAxis,
};
use rerun::external::re_sdk_types::blueprint::components::LinkAxis;
use rerun::external::re_sdk_types::blueprint::components::{TextLogColumn, TimelineColumn};
use rerun::external::re_sdk_types::blueprint::datatypes;
use rerun::external::re_sdk_types::datatypes::{TimeInt, TimeRange, TimeRangeBoundary};

use super::entity::entity;
use super::picture::{Eye, Lane, ReviewPicture};
use crate::error::Refusal;
use crate::layout::{Part, View};

/// Entity whose frame follows the probe's tip.
pub(crate) const CLOSE_UP: &str = "/close_up";
pub(super) const EVENTS: &str = "/events";
pub(crate) const TEETH: &str = "/labels/teeth";
pub(super) const SITES: &str = "/labels/sites";
pub(super) const ABOUT: &str = "/about";
/// Opacity of the gingiva in the close-up, 0 to 255, so that the tip in the pocket is visible.
const SEE_THROUGH: u8 = 105;

/// Layout of a review.
pub(super) fn of(picture: &ReviewPicture) -> Part {
    let scale = picture.arrow_mm_per_n;
    let close_up = picture.close_up.map(|eye| close_up(picture, eye));
    let mut below: Vec<(f32, Part)> = close_up.map(|part| (1.0, part)).into_iter().collect();
    if let Some(eye) = picture.retraction {
        let tongue = space(
            "tongue",
            &[
                "/mouth/**",
                "/tools/**",
                "/forces/**",
                "/contacts/**",
                TEETH,
            ],
            eye,
        );
        below.push((1.0, tongue.into_part()));
    }
    let overview = space(
        &format!("mouth (arrows: {scale} mm for 1 N; pale blue: the hand)"),
        &[
            "/mouth/**",
            "/tools/**",
            "/hands/**",
            "/offsets/**",
            "/forces/**",
            "/contacts/**",
            TEETH,
        ],
        picture.overview,
    );
    let mut space = vec![(1.1, overview.into_part())];
    if !below.is_empty() {
        space.push((1.0, Part::Row(below)));
    }
    let space = Part::Column(space);
    let log = View::new("TextLog", "what happened", &[EVENTS]).with("TextLogColumns", columns());
    let about = View::new("TextDocument", "this session, and how to read it", &[ABOUT]);
    let named = |names: &[&str], colours: &[&str]| -> String {
        let pairs = colours.iter().zip(names);
        let pairs: Vec<String> = pairs.map(|(c, name)| format!("{c}: {name}")).collect();
        format!(" ({})", pairs.join("; "))
    };
    let tools: Vec<&str> = picture
        .tools
        .iter()
        .map(|tool| tool.name.as_str())
        .collect();
    let hands = named(&tools, &["yellow", "blue"]);
    let work: Vec<&str> = picture.work.iter().map(String::as_str).collect();
    let work = named(&work, &["grey", "green", "yellow"]);
    let mut numbers = vec![(1.3, lanes(picture))];
    if picture.reading_band_n.is_some() {
        numbers.extend([
            (
                1.15,
                plot(
                    "force on the floor of the pocket, N (green: reading band; red: trauma)",
                    "/plots/floor_force/**",
                ),
            ),
            (
                1.15,
                plot(
                    "depth of the tip below the margin, mm (grey: prescribed; diamonds: called)",
                    "/plots/depth/**",
                ),
            ),
        ]);
    }
    numbers.extend([
        (
            0.9,
            plot(&format!("force on the hand, N{hands}"), "/plots/force/**"),
        ),
        (
            0.8,
            plot(
                &format!("torque on the hand, N mm{hands}"),
                "/plots/torque/**",
            ),
        ),
        (
            0.7,
            plot(&format!("work of a tick{work}"), "/plots/work/**"),
        ),
        (1.4, Part::Tabs(vec![log.into_part(), about.into_part()])),
    ]);
    let numbers = Part::Column(numbers);
    Part::Row(vec![(1.55, space), (1.0, numbers)])
}

pub(crate) fn space(name: &str, contents: &[&str], eye: Eye) -> View {
    let dark = rerun::Color::from_rgb(38, 42, 50);
    View::new("3D", name, contents)
        .with(
            "Background",
            Background::new(BackgroundKind::SolidColor).with_color(dark),
        )
        .with("LineGrid3D", LineGrid3D::new().with_visible(false))
        .with(
            "EyeControls3D",
            EyeControls3D::new()
                .with_kind(Eye3DKind::Orbital)
                .with_position(eye.at)
                .with_look_target(eye.on)
                .with_eye_up([0.0, 0.0, 1.0]),
        )
}

/// Close-up of the pocket from outside the tooth, in a frame that follows the tip. The gingiva is transparent, and
/// parts in front of the pocket are left out.
pub(crate) fn close_up(picture: &ReviewPicture, eye: Eye) -> Part {
    let tool = picture
        .tools
        .get(picture.probe)
        .map_or("", |tool| &tool.name);
    let (probe, hand) = (entity("/tools", tool), entity("/hands", tool));
    let (offset, push) = (
        entity("/offsets", tool),
        entity("/forces", &format!("on {tool}")),
    );
    let contacts = entity("/contacts", tool);
    let contents = [
        "/mouth/teeth/**",
        "/mouth/gingiva/**",
        "/mouth/jaw/**",
        &probe,
        &hand,
        &offset,
        &push,
        &contacts,
        "/forces/hands",
        SITES,
    ];
    // Gingivae have no tint of their own, so the view's tint holds. Only the near side is shown, because the far side
    // would blur the pocket.
    let through = rerun::Mesh3D::update_fields()
        .with_albedo_factor(rerun::Rgba32::from_unmultiplied_rgba(
            255,
            255,
            255,
            SEE_THROUGH,
        ))
        .with_face_rendering(rerun::components::MeshFaceRendering::Front);
    space("pocket (gingiva seen through)", &contents, eye)
        .origin(CLOSE_UP)
        .with("defaults", through)
        .into_part()
}

fn lanes(picture: &ReviewPicture) -> Part {
    let tool = picture
        .tools
        .get(picture.probe)
        .map_or("probe", |tool| &tool.name);
    let name = match picture.reading_band_n {
        Some(_) => format!("where the {tool} is, how heavy, and whether the target is seen"),
        None => "whether the target is seen".to_owned(),
    };
    View::new("StateTimeline", name, &["/lanes/**"])
        .with("TimeAxis", all_of(picture))
        .into_part()
}

/// Time axis over the whole review.
fn all_of(picture: &ReviewPicture) -> TimeAxis {
    let [start, end] = picture
        .span_ns
        .map(|ns| TimeRangeBoundary::Absolute(TimeInt(ns)));
    TimeAxis::new()
        .with_link(LinkAxis::LinkToGlobal)
        .with_view_range(TimeRange { start, end })
}

pub(crate) fn plot(name: &str, contents: &str) -> Part {
    View::new("TimeSeries", name, &[contents])
        // All plots have the same time axis.
        .with(
            "TimeAxis",
            TimeAxis::new().with_link(LinkAxis::LinkToGlobal),
        )
        .with("PlotLegend", PlotLegend::new().with_visible(false))
        .into_part()
}

fn columns() -> TextLogColumns {
    let session = datatypes::TimelineColumn {
        visible: true.into(),
        timeline: super::waiting::SESSION.into(),
    };
    let tick = datatypes::TimelineColumn {
        visible: false.into(),
        timeline: super::waiting::TICK.into(),
    };
    let kinds = [
        (datatypes::TextLogColumnKind::LogLevel, true),
        (datatypes::TextLogColumnKind::EntityPath, false),
        (datatypes::TextLogColumnKind::Body, true),
    ];
    TextLogColumns::new()
        .with_timeline_columns([TimelineColumn(session), TimelineColumn(tick)])
        .with_text_log_columns(kinds.map(|(kind, visible)| {
            TextLogColumn(datatypes::TextLogColumn {
                kind,
                visible: visible.into(),
            })
        }))
}

/// Names and colours of lines, points and lanes, which are constant.
pub(super) fn styles(stream: &RecordingStream, picture: &ReviewPicture) -> Result<(), Refusal> {
    let tools: Vec<&str> = picture
        .tools
        .iter()
        .map(|tool| tool.name.as_str())
        .collect();
    let work: Vec<&str> = picture.work.iter().map(String::as_str).collect();
    const TOOLS: [u32; 2] = [0xffdc3cff, 0x5ac8ffff];
    for (path, names, colours) in [
        ("/plots/force", &tools, &TOOLS[..]),
        ("/plots/torque", &tools, &TOOLS[..]),
        (
            "/plots/depth",
            &vec!["reached by the tip", "prescribed at this site"],
            &[0xffdc3cff, 0x8c8c96ff],
        ),
        ("/plots/floor_force", &vec!["force"], &[0xffdc3cff]),
        (
            "/plots/floor_force/band",
            &vec!["read from", "read up to"],
            &[0x50be5aff, 0x50be5aff],
        ),
        ("/plots/floor_force/trauma", &vec!["trauma"], &[0xe63c3cff]),
        ("/plots/work", &work, &[0x9696a0ff, 0x5aa0a0ff, 0xffdc3cff]),
    ] {
        let lines = rerun::SeriesLines::new()
            .with_names(names.iter().copied())
            .with_colors(colours.iter().map(|&c| rerun::Color::from_u32(c)))
            .with_widths(names.iter().map(|_| 1.5f32))
            // For each pixel both extremes are shown instead of the mean, so that peaks stay visible.
            .with_aggregation_policy(AggregationPolicy::MinMax);
        stream.log_static(path, &lines)?;
    }
    let called = rerun::SeriesPoints::new()
        .with_names(["called"])
        .with_colors([rerun::Color::from_u32(0x78ffa0ff)])
        .with_markers([MarkerShape::Diamond])
        .with_marker_sizes([6.0f32]);
    stream.log_static("/plots/depth/called", &called)?;
    for (lane, states) in [
        (
            Lane::Zone,
            &[
                ("light", 0x50be5aff),
                ("too heavy", 0xffb428ff),
                ("trauma", 0xe63c3cff),
                ("damage", 0x961e5aff),
            ][..],
        ),
        (
            Lane::Target,
            &[
                ("target visible", 0x5ac8ffff),
                ("target hidden", 0x787882ff),
            ],
        ),
    ] {
        let style = rerun::StateConfiguration::new()
            .with_values(states.iter().map(|(name, _)| *name))
            .with_colors(
                states
                    .iter()
                    .map(|(_, colour)| rerun::Color::from_u32(*colour)),
            );
        stream.log_static(lane.path(), &style)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::review::picture::{MeshPicture, Slider, ToolPicture};

    /// Before, half of a review of the tongue alone was empty.
    #[test]
    fn nothing_is_laid_out_that_would_be_empty() {
        let eye = Eye {
            at: [1.0, 0.0, 1.0],
            on: [0.0; 3],
        };
        let mut picture = ReviewPicture {
            name: String::new(),
            about: String::new(),
            tools: vec![ToolPicture {
                name: "mirror".into(),
                mesh: MeshPicture::default(),
                tip: [0.0; 3],
            }],
            probe: 0,
            parts: Vec::new(),
            teeth: Vec::new(),
            span_ns: [0, 1],
            reading_band_n: Some([0.2, 0.25]),
            trauma_n: None,
            overview: eye,
            retraction: Some(eye),
            close_up: Some(eye),
            arrow_mm_per_n: 20.0,
            work: Vec::new(),
            slider: Slider::Start,
        };
        let has = |picture: &ReviewPicture| {
            let layout = of(picture);
            let names = layout.names();
            let any = |word: &str| names.iter().any(|name| name.starts_with(word));
            [
                "mouth",
                "pocket",
                "tongue",
                "force on the floor",
                "depth",
                "what happened",
            ]
            .map(any)
        };
        assert_eq!(has(&picture), [true; 6]);
        (picture.reading_band_n, picture.close_up) = (None, None);
        assert_eq!(has(&picture), [true, false, true, false, false, true]);
        picture.retraction = None;
        assert_eq!(has(&picture), [true, false, false, false, false, true]);
    }
}
