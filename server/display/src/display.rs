//! The scene of a display, made from a compiled scene.

use std::sync::Arc;

use sulcus_core::scene::Band;
use sulcus_core::tissue::TissueModel;
use sulcus_core::tissue::gingiva::{Gingiva, ToothFrame};
use sulcus_core::tissue::surface::SurfaceCompliance;
use sulcus_core::{DisplaySkin, Object, Scene, Tool, Vec3};
use sulcus_proto::CodecError;
use sulcus_proto::datagram::WirePose;
use sulcus_proto::display::{
    DisplayBand, DisplayGlass, DisplayMesh, DisplayObject, DisplayScene, DisplayTool, HANDLES,
    Kind, SceneHash, Skin,
};
use sulcus_scene::anatomy::mouth::{DrawnGingiva, Sheet, drawn_teeth, sheet};

use crate::clipped::Pocket;
use crate::dress;
use crate::glass::glass;
use crate::handles::{self, Place};
use crate::surface;

/// Angles of the sites of a gingiva that is a mesh, degrees from mesial over buccal.
const SITES_DEG: [f64; 6] = [35.0, 90.0, 145.0, 215.0, 270.0, 325.0];
/// Name of the object that supports the gingivae of a `[mouth]`.
const JAW: &str = "jaw";
/// Number of sectors round a tooth in which the crest of a printed gingiva is searched.
const SECTORS: usize = 72;

/// Scene of a display, with its bytes and the rule by which its handles follow the spheres.
pub struct Display {
    scene: DisplayScene,
    bytes: Arc<[u8]>,
    hash: SceneHash,
    pub(crate) followers: Vec<Option<Follower>>,
}

/// Rule by which the handles of an object follow its tissue.
pub(crate) enum Follower {
    /// Handles are the moving masters of a surface compliance.
    Masters,
    /// Handles are the spheres that carry a mesh.
    Same,
    /// Handles are interpolated between the spheres that carry a mesh.
    Spheres(DisplaySkin),
}

impl Display {
    /// Makes the display of a compiled scene. The first whole mouth of a process takes some seconds, the next ones
    /// about a second, so never in a thread that ticks.
    ///
    /// # Errors
    /// A mesh of the scene is beyond the limits of a display; the error names the rule.
    pub fn new(scene: &Scene) -> Result<Self, CodecError> {
        let sheet = sheet(scene);
        let (mut objects, mut followers) = (Vec::new(), Vec::new());
        let teeth = drawn_teeth(scene);
        dress::prepare(&teeth);
        for (k, (object, tooth)) in scene.objects.iter().zip(&teeth).enumerate() {
            let of_sheet = match &sheet {
                Some(sheet) => of_sheet(sheet, object, k)?,
                None => None,
            };
            let (mut shown, follower) = match of_sheet {
                Some(shown) => shown,
                None => shown(scene, object)?,
            };
            if shown.kind == Kind::Gingiva && shown.fdi == 0 {
                shown.fdi = number_of_tooth(scene, object);
            }
            if shown.kind == Kind::Tooth {
                shown.mesh = dress::tooth(shown.mesh, tooth.as_ref())?;
            }
            objects.push(shown);
            followers.push(follower);
        }
        let tools: Result<Vec<DisplayTool>, CodecError> = scene.tools.iter().map(tool).collect();
        let display = DisplayScene {
            tick_ns: scene.params.tick_ns(),
            tools: tools?,
            objects,
        };
        let bytes: Arc<[u8]> = display.to_bytes()?.into();
        Ok(Self {
            hash: SceneHash::of(&bytes),
            scene: display,
            bytes,
            followers,
        })
    }

    /// The scene.
    pub fn scene(&self) -> &DisplayScene {
        &self.scene
    }

    /// The encoded scene.
    pub fn bytes(&self) -> &Arc<[u8]> {
        &self.bytes
    }

    /// Hash of the encoded scene.
    pub fn hash(&self) -> SceneHash {
        self.hash
    }
}

/// FDI number of the tooth that a gingiva without a number surrounds: the nearest one, as in the events. 0 without a
/// tooth. Sites to be read, views and bleeding are found by this number.
fn number_of_tooth(scene: &Scene, object: &Object) -> u8 {
    let TissueModel::Gingiva(model) = &object.tissue else {
        return object.fdi;
    };
    let away = |tooth: &&Object| (tooth.tree.nodes()[0].centre - model.tooth.origin).norm();
    let teeth = scene.objects.iter();
    let teeth = teeth.filter(|other| other.fdi != 0 && other.tissue.is_rigid());
    let nearest = teeth.min_by(|a, b| away(a).total_cmp(&away(b)));
    nearest.map_or(0, |tooth| tooth.fdi)
}

/// Vector in the precision of the wire.
pub(crate) fn f32s(v: &Vec3) -> [f32; 3] {
    [v.x as f32, v.y as f32, v.z as f32]
}

/// Pose in the precision of the wire.
pub(crate) fn wire_pose(pose: &sulcus_core::Pose) -> WirePose {
    let q = &pose.orientation;
    WirePose {
        position: f32s(&pose.position),
        orientation: [q.w as f32, q.i as f32, q.j as f32, q.k as f32],
    }
}

fn tool(tool: &Tool) -> Result<DisplayTool, CodecError> {
    let band = |band: &Band| DisplayBand {
        from: band.from as f32,
        to: band.to as f32,
        dark: band.dark,
    };
    let (mesh, glass_radius) = dress::tool(tool)?;
    let glass = glass(tool).map(|found| DisplayGlass {
        radius: glass_radius.map_or(found.radius, |inside| inside as f32),
        ..found
    });
    Ok(DisplayTool {
        name: tool.name.clone(),
        mesh,
        bands: tool.bands.iter().map(band).collect(),
        glass,
        tip: f32s(&tool.tip),
        tip_axis: f32s(&tool.tip_axis),
        park: wire_pose(&tool.park),
    })
}

fn on_grid(mesh: &sulcus_core::DisplayMesh) -> Result<DisplayMesh, CodecError> {
    DisplayMesh::new(
        &mesh.vertices,
        &mesh.triangles,
        mesh.colour,
        &mesh.vertex_colours,
    )
}

/// Returns object `k` if its shape is a part of the sheet of soft tissues.
fn of_sheet(
    sheet: &Sheet,
    object: &Object,
    k: usize,
) -> Result<Option<(DisplayObject, Option<Follower>)>, CodecError> {
    if let (Some(drawn), TissueModel::Gingiva(model)) = (&sheet.gingivae[k], &object.tissue) {
        return drawn_gingiva(object, &model.tooth, drawn).map(Some);
    }
    let piece = match &sheet.ridges[k] {
        Some(ridge) => ridge,
        None if object.name == JAW && object.tissue.is_rigid() => &sheet.rest,
        None => return Ok(None),
    };
    let shown = DisplayObject {
        kind: Kind::Mucosa,
        fdi: object.fdi,
        mesh: surface::piece(piece)?,
        skin: None,
        sites: Vec::new(),
    };
    Ok(Some((shown, None)))
}

/// Returns an object with its own shape, and its rule of motion.
fn shown(scene: &Scene, object: &Object) -> Result<(DisplayObject, Option<Follower>), CodecError> {
    let plain = |kind, mesh| DisplayObject {
        kind,
        fdi: object.fdi,
        mesh,
        skin: None,
        sites: Vec::new(),
    };
    match &object.tissue {
        TissueModel::Rigid => Ok((plain(kind_of_rigid(object), on_grid(&object.mesh)?), None)),
        TissueModel::Gingiva(model) => mesh_gingiva(object, model),
        TissueModel::PrintedGingiva(model) => {
            let tooth = &scene.objects[usize::from(model.tooth)];
            let frame = frame_of_printed(tooth, &model.axis);
            let margin = highest(&frame, &places(&object.mesh));
            let pocket = Pocket {
                tooth: frame,
                margin: &|around| margin[sector(around)],
            };
            clipped(object, &pocket)
        }
        TissueModel::Surface(model) if model.masters.moving() <= HANDLES => {
            let mut shown = plain(Kind::Tongue, surface::tongue(&object.mesh)?);
            shown.skin = Some(skin_of_masters(object, model));
            Ok((shown, Some(Follower::Masters)))
        }
        _ => {
            let mut shown = plain(Kind::Tongue, surface::tongue(&object.mesh)?);
            let (skin, follower) = skin_of_spheres(object);
            shown.skin = Some(skin);
            Ok((shown, Some(follower)))
        }
    }
}

/// Kind of a rigid object. Jaw and healed ridges have fixed names.
fn kind_of_rigid(object: &Object) -> Kind {
    if object.fdi != 0 {
        Kind::Tooth
    } else if object.name == JAW || object.name.starts_with("healed ridge ") {
        Kind::Mucosa
    } else {
        Kind::Other
    }
}

/// Vertices of a mesh, metres.
fn places(mesh: &sulcus_core::DisplayMesh) -> Vec<Vec3> {
    let place = |v: &[f32; 3]| Vec3::from(v.map(f64::from));
    mesh.vertices.iter().map(place).collect()
}

fn drawn_gingiva(
    object: &Object,
    tooth: &ToothFrame,
    drawn: &DrawnGingiva,
) -> Result<(DisplayObject, Option<Follower>), CodecError> {
    // The compiled margin depends a little on the depth. The drawn one does not.
    let turns = drawn.margin.len();
    let margin = |around: f64| {
        let turn = around / std::f64::consts::TAU;
        drawn.margin[((turn - turn.floor()) * turns as f64) as usize % turns]
    };
    let sites = drawn.sites.iter().map(f32s).collect();
    let vertices = &drawn.piece.mesh.vertices;
    gingiva(
        object,
        tooth,
        &margin,
        vertices,
        surface::piece(&drawn.piece)?,
        sites,
    )
}

fn mesh_gingiva(
    object: &Object,
    model: &Gingiva,
) -> Result<(DisplayObject, Option<Follower>), CodecError> {
    let pocket = Pocket {
        tooth: model.tooth,
        margin: &|around| model.margin_at(around),
    };
    clipped(object, &pocket)
}

fn clipped(
    object: &Object,
    pocket: &Pocket<'_>,
) -> Result<(DisplayObject, Option<Follower>), CodecError> {
    let mesh = pocket.clip(&object.mesh);
    let crest = pocket.crest(&places(&mesh));
    let site = |degrees: f64| f32s(&pocket.at_margin(&crest, degrees.to_radians()));
    let sites = SITES_DEG.map(site).to_vec();
    let vertices = places(&mesh);
    gingiva(
        object,
        &pocket.tooth,
        pocket.margin,
        &vertices,
        on_grid(&mesh)?,
        sites,
    )
}

/// Returns a gingiva whose mesh follows handles near the margin.
fn gingiva(
    object: &Object,
    tooth: &ToothFrame,
    margin: &dyn Fn(f64) -> f64,
    vertices: &[Vec3],
    mesh: DisplayMesh,
    sites: Vec<[f32; 3]>,
) -> Result<(DisplayObject, Option<Follower>), CodecError> {
    let (chosen, spacing) = handles::choose(vertices, |v| {
        let (around, height) = tooth.cylindrical(v);
        Place {
            below: margin(around) - height,
            off_axis: tooth.from_axis(v),
        }
    });
    let handles: Vec<Vec3> = chosen.iter().map(|k| vertices[*k]).collect();
    let shown = DisplayObject {
        kind: Kind::Gingiva,
        fdi: object.fdi,
        mesh,
        skin: Some(handles::skin(vertices, &handles, spacing)),
        sites,
    };
    Ok((shown, Some(over_spheres(object, &handles))))
}

/// Rule of handles between the spheres that `MovedTissue::carrying` lists.
fn over_spheres(object: &Object, handles: &[Vec3]) -> Follower {
    let level = sulcus_sessions::MovedTissue::carrying_level(object);
    let centres = object.tree.shape_at(level).zip(0..);
    let centres: Vec<(u32, Vec3)> = centres.map(|((_, node), k)| (k, node.centre)).collect();
    Follower::Spheres(DisplaySkin::new(&centres, handles))
}

/// Skin over the spheres of the finest level that has few enough.
fn skin_of_spheres(object: &Object) -> (Skin, Follower) {
    let count = |level: &u8| object.tree.shape_at(*level).count() <= HANDLES;
    let level = (0..=object.level).rev().find(count).unwrap_or(0);
    let nodes = object.tree.shape_at(level).map(|(_, node)| node.centre);
    let handles: Vec<Vec3> = nodes.collect();
    let numbered: Vec<(u32, Vec3)> = (0..).zip(handles.iter().copied()).collect();
    let carriers = DisplaySkin::new(&numbered, &places(&object.mesh));
    let mut skin = Skin::over(handles.iter().map(f32s).collect());
    for v in 0..carriers.vertices() {
        skin.push(carriers.carriers(v).iter().map(|(k, w)| (*k as u16, *w)));
    }
    if level == sulcus_sessions::MovedTissue::carrying_level(object) {
        return (skin, Follower::Same);
    }
    (skin, over_spheres(object, &handles))
}

fn skin_of_masters(object: &Object, model: &SurfaceCompliance) -> Skin {
    let moving = model.masters.moving();
    let handles = model.masters.places[..moving].iter().map(f32s);
    let mut skin = Skin::over(handles.collect());
    for vertex in places(&object.mesh) {
        let weights = model.masters.weights(&vertex);
        let carriers = weights.into_iter().filter(|(k, _)| *k < moving);
        skin.push(carriers.map(|(k, w)| (k as u16, w)));
    }
    skin
}

/// Frame about the middle of a tooth's mesh. The gingiva as printed has no frame of its own.
fn frame_of_printed(tooth: &Object, axis: &Vec3) -> ToothFrame {
    let all = places(&tooth.mesh);
    let middle = all.iter().sum::<Vec3>() / all.len().max(1) as f64;
    let aside = if axis.x.abs() < 0.9 {
        Vec3::x()
    } else {
        Vec3::y()
    };
    let mesial = (aside - axis * axis.dot(&aside)).normalize();
    ToothFrame {
        origin: middle,
        axis: *axis,
        mesial,
        buccal: axis.cross(&mesial),
    }
}

/// Height of the highest vertex over the tooth's origin in each sector, metres; `f64::INFINITY` in an empty sector.
fn highest(tooth: &ToothFrame, vertices: &[Vec3]) -> [f64; SECTORS] {
    let mut highest = [f64::NEG_INFINITY; SECTORS];
    for v in vertices {
        let (around, height) = tooth.cylindrical(v);
        let sector = &mut highest[sector(around)];
        if height > *sector {
            *sector = height;
        }
    }
    highest.map(|height| {
        if height.is_finite() {
            height
        } else {
            f64::INFINITY
        }
    })
}

fn sector(around: f64) -> usize {
    let turns = around / std::f64::consts::TAU;
    ((turns - turns.floor()) * SECTORS as f64) as usize % SECTORS
}
