//! The layout that opens with a recording. It answers an operator's questions in their order: what happened (events), how
//! it moved (orbits, displacement, control), and under which gains (settings, poles, damping) at the time cursor.

use rerun::RecordingStreamBuilder;
use rerun::archetypes::{Scalars, SeriesLines};
use rerun::blueprint::components::PanelState;
use rerun::blueprint::{
    Blueprint, BlueprintActivation, ContainerLike, Grid, Horizontal, SelectionPanel, Spatial2DView, Spatial3DView,
    Tabs, TextDocumentView, TextLogView, TimePanel, TimeSeriesView, Vertical, VisualizableArchetype as _, Visualizer,
    VisualizerComponentMapping,
};
use rerun::log::LogMsg;
use rotor::Rotor;
use wire::StepLayout;

use super::scene;
use crate::schema::{self, NumberColumn};
use crate::session::Source;

/// The messages that carry the layout; none if rerun has been switched off by its environment variable.
pub(super) fn blueprint(rotor: &Rotor, steps: StepLayout, source: Source) -> Vec<LogMsg> {
    // Its own builder of layouts obeys the variable and would then have nothing to send.
    if std::env::var("RERUN").is_ok_and(|value| ["0", "false", "off"].contains(&value.to_lowercase().as_str())) {
        return Vec::new();
    }
    let made = RecordingStreamBuilder::new(schema::APPLICATION).enabled(true).memory();
    let Ok((stream, storage)) = made else { return Vec::new() };
    if layout(rotor, steps, source).send(&stream, BlueprintActivation::default()).is_err() {
        return Vec::new();
    }
    // The stream's own recording is empty: only the layout goes into the file.
    let is_layout = |message: &LogMsg| message.store_id().is_blueprint();
    storage.take().into_iter().filter(is_layout).collect()
}

fn layout(rotor: &Rotor, steps: StepLayout, source: Source) -> Blueprint {
    let masses = steps.masses();
    let orbit = |mass: usize| {
        let path = scene::orbit_path(mass);
        Spatial2DView::new(format!("orbit of mass {} (e_t, z up)", mass + 1)).with_origin(path.as_str()).into()
    };
    let orbits: Vec<ContainerLike> = (0..masses).map(orbit).collect();
    let orbits: ContainerLike = if masses <= 4 {
        Horizontal::new(orbits).with_name("orbits").into()
    } else {
        Grid::new(orbits).with_name("orbits").into()
    };
    let title = "shaft (across in e_t, z up; along not to scale)";
    let shaft: ContainerLike = Spatial3DView::new(title).with_origin(schema::SHAFT).into();
    // A shaft is known by its shape, a chain by the orbits of its few masses.
    let motion = if rotor.is_chain() { [orbits, shaft] } else { [shaft, orbits] };
    let motion: ContainerLike = Tabs::new(motion).into();
    let poles: ContainerLike = Spatial2DView::new("poles (w0, im up)").with_origin(schema::POLES).into();
    let named = |wanted: &dyn Fn(&str) -> bool| -> Vec<NumberColumn> {
        schema::columns(steps).into_iter().filter(|column| wanted(&column.name)).collect()
    };
    let place = named(&|name| name.starts_with(['y', 'z']));
    let velocity = named(&|name| name.starts_with("vy") || name.starts_with("vz"));
    // Of the first control bearing, and with a number each of the further ones; not what was asked of them.
    let delivered = |name: &str| {
        ["uy", "uz", "bearing_uy", "bearing_uz"].contains(&name.trim_end_matches(|c: char| c.is_ascii_digit()))
    };
    let control = named(&delivered);
    let speed = named(&|name| name == "speed");
    let gain_view = TimeSeriesView::new("settings").with_contents([scene::values_path()]);
    let damping = format!("{}/min_damping", schema::POLES);
    let series = Tabs::new([
        Vertical::new([
            plot("displacement (e_t)", &place),
            plot("control (w0^2 e_t)", &control),
            TimeSeriesView::new("minimum damping ratio").with_contents([damping.as_str()]).into(),
        ])
        .with_name("motion")
        .with_row_shares([2.0, 2.0, 1.0])
        .into(),
        plot("velocity (w0 e_t)", &velocity),
        plot("speed (w0)", &speed),
        gain_view.into(),
        TimeSeriesView::new("pace").with_origin(schema::HEALTH).into(),
    ]);
    let events = TextLogView::new("events").with_origin(schema::EVENTS);
    let in_force = TextDocumentView::new("settings in force").with_origin(schema::SETTINGS);
    let words = Horizontal::new([ContainerLike::from(events), in_force.into()]).with_column_shares([2.0, 1.0]);
    let top = Horizontal::new([motion, poles]).with_column_shares([masses.min(4) as f32, 1.0]);
    let root = Vertical::new([ContainerLike::from(top), series.into(), words.into()]).with_row_shares([2.0, 3.0, 2.0]);
    let timeline = if source == Source::Live { schema::WALL } else { schema::TAU };
    Blueprint::new(root)
        .with_auto_views(false)
        .with_auto_layout(false)
        .with_time_panel(TimePanel::new().with_state(PanelState::Collapsed).with_timeline(timeline))
        .with_selection_panel(SelectionPanel::from_state(PanelState::Collapsed))
}

/// Some columns of the steps over time, each a line with its name.
fn plot(title: &str, columns: &[NumberColumn]) -> ContainerLike {
    let line = |column: &NumberColumn| -> Visualizer {
        let source = VisualizerComponentMapping::new_source_component_with_selector(
            Scalars::descriptor_scalars().component.as_str(),
            schema::ROW,
            format!(".{}", column.name),
        );
        SeriesLines::new().with_names([column.name.as_str()]).visualizer().with_mappings([source.into()])
    };
    let steps = format!("/{}", schema::STEPS);
    TimeSeriesView::new(title)
        .with_contents([steps.as_str()])
        .with_overrides(steps.as_str(), columns.iter().map(line))
        .into()
}
