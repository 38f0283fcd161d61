//! A scene of two round teeth, and paths of a probe in it that are laid out by hand.

use sulcus_core::output::{ForceZone, PocketReading};
use sulcus_core::scene::Band;
use sulcus_core::tissue::TissueModel;
use sulcus_core::tissue::gingiva::{Gingiva, GingivaParams, Place, Prescribed, Site, ToothFrame};
use sulcus_core::tissue::printed::PrintedSkeleton;
use sulcus_core::{
    DisplayMesh, MAX_TOOLS, Object, Params, Pose, Quat, Scene, Sphere, SphereTree, TickOutput,
    Tool, ToolOutput, Vec3,
};
use sulcus_sessions::exercise::Exercise;
use sulcus_sessions::{Events, Occurrence};

/// Height of the margin over the tooth's origin, radius of a tooth, and how far apart two are, metres.
const MARGIN: f64 = 1e-3;
const RADIUS: f64 = 4e-3;
const APART: f64 = 9e-3;

fn object(name: &str, fdi: u8, spheres: &[Sphere], tissue: TissueModel) -> Object {
    Object {
        name: name.into(),
        fdi,
        tree: SphereTree::over_leaves(spheres).unwrap(),
        level: 3,
        tissue,
        mesh: DisplayMesh::default(),
        carriers: Vec::new(),
    }
}

fn ball(x: f64, y: f64, z: f64, radius: f64) -> Sphere {
    Sphere {
        centre: Vec3::new(x, y, z),
        radius,
    }
}

/// A column, dense enough to be nearly round.
fn tooth(fdi: u8, x: f64) -> Object {
    let column: Vec<Sphere> = (-40..=40)
        .map(|k| ball(x, 0.0, f64::from(k) * 2e-4, RADIUS))
        .collect();
    object("tooth", fdi, &column, TissueModel::Rigid)
}

fn gingiva(fdi: u8, x: f64) -> Object {
    let spheres = [
        ball(x + 6e-3, 0.0, 0.0, 1e-3),
        ball(x - 6e-3, 0.0, 0.0, 1e-3),
    ];
    let mut object = object("gingiva", fdi, &spheres, TissueModel::Rigid);
    let place = Place {
        away: Vec3::x(),
        on_surface: Vec3::zeros(),
        spread: 0.0,
        height: 0.0,
        floor: false,
    };
    let mut sites = [3.0, 2.0, 4.0, 5.0, 2.5, 3.5].map(|mm| Prescribed {
        depth: mm * 1e-3,
        recession: 0.0,
        bleeds: false,
    });
    sites[Site::DistoBuccal as usize].bleeds = true;
    object.tissue = TissueModel::Gingiva(Box::new(Gingiva {
        params: GingivaParams::default(),
        tooth: ToothFrame {
            origin: Vec3::new(x, 0.0, 0.0),
            axis: Vec3::z(),
            mesial: Vec3::x(),
            buccal: Vec3::y(),
        },
        margin: vec![MARGIN; 8],
        proximal: 50f64.to_radians(),
        sites,
        places: vec![place; object.tree.nodes().len()],
        level: 3,
    }));
    object
}

fn tool(name: &str, bands: usize, spheres: &[Sphere]) -> Tool {
    let band = Band {
        from: 0.0,
        to: 1e-3,
        dark: true,
    };
    Tool {
        name: name.into(),
        tree: SphereTree::over_leaves(spheres).unwrap(),
        level: 3,
        working_point: Vec3::zeros(),
        tip: Vec3::zeros(),
        tip_axis: -Vec3::z(),
        stiffness_n_per_m: 500.0,
        stiffness_nm_per_rad: 0.5,
        park: Pose::identity(),
        bands: vec![band; bands],
        mesh: DisplayMesh::default(),
    }
}

/// Teeth 36 (at the origin, its mesial side along x) and 35, their gingivae, a tongue of one sphere; a probe, a mirror.
pub fn scene() -> Scene {
    let tongue = TissueModel::PrintedSkeleton(PrintedSkeleton::new(0, Vec::new(), Vec::new()));
    Scene {
        name: "two teeth".into(),
        source_hash: String::new(),
        params: Params::default(),
        tools: vec![
            tool("probe", 3, &[ball(0.0, 0.0, 0.0, 1e-4)]),
            tool("mirror", 0, &[ball(0.0, 0.0, 0.0, 10e-3)]),
        ],
        objects: vec![
            tooth(36, 0.0),
            gingiva(36, 0.0),
            tooth(35, APART),
            gingiva(35, APART),
            object("tongue", 0, &[ball(0.0, -0.03, 0.0, 10e-3)], tongue),
        ],
    }
}

/// Where the probe is in a tick.
#[derive(Clone, Copy, Debug)]
pub struct At {
    /// Degrees from mesial over buccal, about tooth 36.
    pub around: f64,
    /// Below the margin, mm; negative above.
    pub depth: f64,
    /// On the floor, N.
    pub force: f64,
    /// Tilt of the tip into the col along the tooth's surface, degrees: mesially on the mesial half.
    pub mesially: f64,
}

fn zone(force: f64) -> ForceZone {
    let heavier = [
        (1.96, ForceZone::Damage),
        (0.5, ForceZone::Trauma),
        (0.25, ForceZone::TooHeavy),
    ];
    heavier
        .iter()
        .find(|(from, _)| force >= *from)
        .map_or(ForceZone::Light, |(_, zone)| *zone)
}

/// What the core would put out with the probe there; `object` is whose pocket is read.
pub fn output(tick: u64, at: Option<At>, object: u16) -> TickOutput {
    let mut tools = [ToolOutput::absent(Pose::identity()); MAX_TOOLS];
    if let Some(at) = at {
        let around = at.around.to_radians();
        let r = RADIUS + 2e-4;
        let tip = Vec3::new(r * around.cos(), r * around.sin(), MARGIN - at.depth * 1e-3);
        // Turned about the buccal axis the tip, which points down, goes mesially.
        let turn = -at.mesially.to_radians();
        let orientation = Quat::from_axis_angle(&Vec3::y_axis(), turn);
        tools[0] = ToolOutput {
            status: 0,
            graphic: Pose::new(tip, orientation),
            pocket: (at.depth > 0.0).then_some(PocketReading {
                object,
                around,
                depth: at.depth * 1e-3,
                floor_force: at.force,
                zone: zone(at.force),
                entered_zone: false,
            }),
            ..tools[0]
        };
    }
    TickOutput {
        tick,
        hash: 0,
        tools,
        work: 0,
    }
}

pub const UPRIGHT: At = At {
    around: 90.0,
    depth: 2.0,
    force: 0.0,
    mesially: 0.0,
};

pub fn exercise() -> Exercise {
    Exercise::free("test", 1.0)
}

/// All that is told of a path from tick 1 on, in the pocket of 36.
pub fn told(path: impl IntoIterator<Item = At>) -> Vec<Occurrence> {
    let scene = scene();
    let mut events = Events::new(&scene, &exercise());
    run(&mut events, &scene, 1, path)
}

pub fn run(
    events: &mut Events,
    scene: &Scene,
    from: u64,
    path: impl IntoIterator<Item = At>,
) -> Vec<Occurrence> {
    let mut all = Vec::new();
    for (tick, at) in (from..).zip(path) {
        all.extend(events.take(scene, &output(tick, Some(at), 1), None));
    }
    all
}

/// From one place to another in so many ticks, the last included.
pub fn to(from: At, until: At, ticks: u64) -> impl Iterator<Item = At> {
    (1..=ticks).map(move |k| {
        let s = k as f64 / ticks as f64;
        let mix = |a: f64, b: f64| a + s * (b - a);
        At {
            around: mix(from.around, until.around),
            depth: mix(from.depth, until.depth),
            force: mix(from.force, until.force),
            mesially: mix(from.mesially, until.mesially),
        }
    })
}

/// Kind and site, or the pair of a withdrawal.
pub fn short(all: &[Occurrence]) -> Vec<String> {
    let text = |one: &Occurrence, key: &str| one.data[key].as_str().unwrap_or("").to_owned();
    all.iter()
        .map(|one| format!("{} {}{}", one.kind, text(one, "site"), text(one, "from")))
        .collect()
}
