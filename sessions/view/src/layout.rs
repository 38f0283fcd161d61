//! Layout for the viewer: containers, views and their properties, written as archetypes of a blueprint store.
//!
//! The builder of the SDK cannot set the eye of a 3D view or the axis of a plot. The archetypes for both are public.
//! Their paths in the store, `view/ID/PROPERTY`, are those of the builder's own properties.

use rerun::external::re_log_types::BlueprintActivationCommand;
use rerun::external::re_sdk_types::blueprint::archetypes as blueprint;
use rerun::external::re_sdk_types::blueprint::components::{
    AutoLayout, AutoViews, ColumnShare, ContainerKind, IncludedContent, PanelState, PlayState,
    QueryExpression, RootContainer, RowShare, TimelineName, ViewClass,
};
use rerun::external::re_sdk_types::datatypes::{Bool, Uuid};
use rerun::log::LogMsg;
use rerun::{AsComponents, RecordingStream, RecordingStreamBuilder};

use crate::error::Refusal;

/// View, or container of views with their shares of the space.
pub(crate) enum Part {
    /// Side by side.
    Row(Vec<(f32, Part)>),
    /// One above the other.
    Column(Vec<(f32, Part)>),
    /// One at a time.
    Tabs(Vec<Part>),
    /// Single view.
    View(Box<View>),
}

#[cfg(test)]
impl Part {
    /// Names of all views.
    pub(crate) fn names(&self) -> Vec<&str> {
        match self {
            Self::Row(parts) | Self::Column(parts) => {
                parts.iter().flat_map(|(_, part)| part.names()).collect()
            }
            Self::Tabs(parts) => parts.iter().flat_map(Self::names).collect(),
            Self::View(view) => vec![&view.name],
        }
    }
}

/// View of the viewer.
pub(crate) struct View {
    class: &'static str,
    name: String,
    origin: String,
    contents: Vec<String>,
    properties: Vec<(&'static str, Box<dyn AsComponents>)>,
}

impl View {
    /// View of `class` (`3D`, `TimeSeries`, `StateTimeline`, `TextLog`, `TextDocument`) on the given paths.
    pub fn new(class: &'static str, name: impl Into<String>, contents: &[&str]) -> Self {
        Self {
            class,
            name: name.into(),
            origin: "/".into(),
            contents: contents.iter().map(|&path| path.to_owned()).collect(),
            properties: Vec::new(),
        }
    }

    /// Sets the entity whose frame is the frame of the view.
    pub fn origin(mut self, path: &str) -> Self {
        self.origin = path.to_owned();
        self
    }

    /// Sets a property by the name of its archetype. The name `defaults` sets components of all entities without own
    /// ones.
    pub fn with(mut self, name: &'static str, property: impl AsComponents + 'static) -> Self {
        self.properties.push((name, Box::new(property)));
        self
    }

    pub fn into_part(self) -> Part {
        Part::View(Box::new(self))
    }
}

/// Sends the layout with the recording of `stream`. The slider moves on `timeline`. Views and containers are numbered
/// in the order of the tree, so the same layout always has the same names.
pub(crate) fn send(
    stream: &RecordingStream,
    application: &'static str,
    timeline: &str,
    play: PlayState,
    root: &Part,
) -> Result<(), Refusal> {
    let (store, messages) = RecordingStreamBuilder::new(application)
        .enabled(true)
        .blueprint()
        .memory()?;
    store.set_time_sequence("blueprint", 0);
    let mut writer = Writer { store, numbers: 0 };
    let (id, _) = writer.part(root)?;
    let store = writer.store;
    let viewport = blueprint::ViewportBlueprint::new()
        .with_root_container(RootContainer(Uuid { bytes: id }))
        .with_auto_layout(AutoLayout(Bool(false)))
        .with_auto_views(AutoViews(Bool(false)));
    store.log("viewport", &viewport)?;
    for panel in ["blueprint_panel", "selection_panel"] {
        let hidden = blueprint::PanelBlueprint::new().with_state(PanelState::Hidden);
        store.log(panel, &hidden)?;
    }
    let time = blueprint::TimePanelBlueprint::new()
        .with_state(PanelState::Collapsed)
        .with_timeline(TimelineName(timeline.into()))
        .with_play_state(play);
    store.log("time_panel", &time)?;
    let messages: Vec<LogMsg> = messages.take();
    let Some(blueprint_id) = messages.first().map(|first| first.store_id().clone()) else {
        return Err("the blueprint is empty".into());
    };
    let activate = BlueprintActivationCommand {
        blueprint_id,
        make_active: true,
        make_default: true,
    };
    stream.send_blueprint(messages, activate);
    Ok(())
}

struct Writer {
    store: RecordingStream,
    numbers: u8,
}

impl Writer {
    /// Writes a part; its id and its path in the store.
    fn part(&mut self, part: &Part) -> Result<([u8; 16], String), Refusal> {
        let id = self.next_id();
        let (kind, children, shares) = match part {
            Part::View(view) => {
                let path = format!("view/{}", text_of(&id));
                self.view(view, &path)?;
                return Ok((id, path));
            }
            Part::Tabs(children) => (ContainerKind::Tabs, children.iter().collect(), None),
            Part::Row(children) => split(ContainerKind::Horizontal, children),
            Part::Column(children) => split(ContainerKind::Vertical, children),
        };
        let mut contents = Vec::with_capacity(children.len());
        for child in children {
            contents.push(IncludedContent(self.part(child)?.1.into()));
        }
        let mut container = blueprint::ContainerBlueprint::new(kind).with_contents(contents);
        container = match (kind, shares) {
            (ContainerKind::Horizontal, Some(shares)) => {
                container.with_col_shares(shares.into_iter().map(ColumnShare::from))
            }
            (_, Some(shares)) => container.with_row_shares(shares.into_iter().map(RowShare::from)),
            (_, None) => container,
        };
        let path = format!("container/{}", text_of(&id));
        self.store.log(path.as_str(), &container)?;
        Ok((id, path))
    }

    fn view(&self, view: &View, path: &str) -> Result<(), Refusal> {
        let queries = view.contents.iter();
        let contents =
            blueprint::ViewContents::new(queries.map(|q| QueryExpression(q.as_str().into())));
        self.store.log(format!("{path}/ViewContents"), &contents)?;
        let named = blueprint::ViewBlueprint::new(ViewClass(view.class.into()))
            .with_display_name(view.name.as_str())
            .with_space_origin(view.origin.as_str());
        self.store.log(path, &named)?;
        for (name, property) in &view.properties {
            self.store.log(format!("{path}/{name}"), &**property)?;
        }
        Ok(())
    }

    /// Next number in the form of a random UUID.
    fn next_id(&mut self) -> [u8; 16] {
        self.numbers += 1;
        let mut id = [0; 16];
        (id[6], id[8], id[15]) = (0x40, 0x80, self.numbers);
        id
    }
}

fn split(
    kind: ContainerKind,
    children: &[(f32, Part)],
) -> (ContainerKind, Vec<&Part>, Option<Vec<f32>>) {
    let (shares, parts) = children.iter().map(|(share, part)| (*share, part)).unzip();
    (kind, parts, Some(shares))
}

/// Text form of a UUID.
fn text_of(id: &[u8; 16]) -> String {
    let mut text = String::with_capacity(36);
    for (k, byte) in id.iter().enumerate() {
        if matches!(k, 4 | 6 | 8 | 10) {
            text.push('-');
        }
        text.push_str(&format!("{byte:02x}"));
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ids_are_written_as_uuids_are() {
        let mut id = [0; 16];
        (id[0], id[6], id[15]) = (0xab, 0x40, 7);
        assert_eq!(text_of(&id), "ab000000-0000-4000-0000-000000000007");
    }
}
