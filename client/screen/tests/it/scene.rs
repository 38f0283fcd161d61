//! A mouth from formulas: three teeth, their gingivae, two sheets that move, floor, tongue, a probe and a mirror.
//! Lengths in millimetres; the teeth stand along x, buccal is +y.

use nalgebra::{Rotation3, UnitQuaternion};
use sulcus_proto::datagram::WirePose;
use sulcus_proto::display::{
    DisplayBand, DisplayGlass, DisplayObject, DisplayScene, DisplayTool, Kind, Skin,
};
use sulcus_screen::moment::{Moment, ToolAt};

use crate::shapes::{Colour, Shape, V};

pub const ENAMEL: Colour = [226, 216, 196, 255];
pub const ROOT: Colour = [186, 140, 84, 255];
pub const GUM: Colour = [196, 104, 104, 255];
const STEEL: Colour = [176, 178, 182, 255];
const DARK: Colour = [22, 22, 24, 255];
/// Numbers of objects: the gingiva of tooth 36, the two sheets.
pub const GINGIVA_36: u16 = 4;
pub const SHEETS: [u16; 2] = [6, 7];
/// Slots of tools.
pub const PROBE: usize = 0;
pub const MIRROR: usize = 1;
/// Radius of the glass.
pub const GLASS_MM: f64 = 10.6;
/// Height of the border between crown and bared root.
pub const BORDER_MM: f64 = 1.5;
/// Length of a band of the probe; bands with an odd number are dark, the last one ends at 15 mm.
pub const BAND_MM: f64 = 1.0;
/// Circle and tube of a gingiva, and height of its middle.
const RING_MM: [f64; 2] = [6.2, 1.8];
const RING_Z_MM: f64 = -3.0;

/// The whole scene.
pub fn mouth() -> DisplayScene {
    let mut objects = Vec::new();
    for (fdi, x) in [(37, -11.0), (36, 0.0), (35, 11.0)] {
        let shape = tooth().moved(V::new(x, 0.0, 0.0));
        objects.push(object(Kind::Tooth, fdi, &shape));
    }
    for (fdi, x, fine) in [(37, -11.0, 1), (36, 0.0, 2), (35, 11.0, 1)] {
        let middle = V::new(x, 0.0, RING_Z_MM);
        let ring = Shape::torus(RING_MM[0], RING_MM[1], [64 * fine, 20 * fine]);
        let ring = ring.coloured(GUM).moved(middle);
        let mut ring = object(Kind::Gingiva, fdi, &ring);
        ring.sites = sites(middle).iter().map(metres).collect();
        objects.push(ring);
    }
    for [from, to] in [[-15.0, 0.0], [0.0, 15.0]] {
        objects.push(sheet(from, to));
    }
    let floor = Shape::block(V::new(-40.0, -45.0, -18.0), V::new(40.0, 30.0, -15.0), 12);
    objects.push(object(Kind::Mucosa, 0, &floor.coloured([176, 84, 84, 255])));
    let tongue = Shape::ellipsoid(V::new(22.0, 9.0, 9.0), 48).moved(V::new(-6.0, -28.0, -8.0));
    objects.push(object(
        Kind::Tongue,
        0,
        &tongue.coloured([188, 96, 100, 255]),
    ));
    let board = Shape::block(V::new(-60.0, -62.0, -25.0), V::new(60.0, -58.0, 40.0), 2);
    objects.push(object(Kind::Other, 0, &board.coloured([90, 120, 90, 255])));
    DisplayScene {
        tick_ns: 1_000_000,
        tools: vec![probe(), mirror()],
        objects,
    }
}

/// The probe at the buccal side of tooth 36 and the mirror at its lingual side, both held.
pub fn held(scene: &DisplayScene) -> Moment {
    let mut moment = Moment::rest(scene);
    let slant = Rotation3::from_euler_angles(-0.35, 0.2, 0.0);
    moment.tools[PROBE] = tool_at(V::new(2.0, 7.4, -2.5), &slant);
    moment.tools[MIRROR] = mirror_at(V::new(0.0, -14.0, 6.0), V::new(0.3, 1.5, 0.1));
    moment
}

/// Mirror with its glass at a place, towards a direction; the handle runs to the front.
pub fn mirror_at(centre: V, normal: V) -> ToolAt {
    let aside = V::new(1.0, 0.0, 0.0);
    let z = normal.normalize();
    let y = z.cross(&aside).normalize();
    let turn = Rotation3::from_basis_unchecked(&[y.cross(&z), y, z]);
    tool_at(centre, &turn)
}

/// Held tool.
pub fn tool_at(at: V, turn: &Rotation3<f64>) -> ToolAt {
    let q = UnitQuaternion::from_rotation_matrix(turn);
    let pose = WirePose {
        position: metres(&at),
        orientation: [q.w, q.i, q.j, q.k].map(|x| x as f32),
    };
    ToolAt::new(true, &pose)
}

/// Sites on the upper outer side of a gingiva, in the order of a chart.
fn sites(middle: V) -> [V; 6] {
    let out = RING_MM[0] + RING_MM[1] * 0.5f64.sqrt();
    let up = V::new(0.0, 0.0, RING_MM[1] * 0.5f64.sqrt());
    [45.0f64, 90.0, 135.0, 225.0, 270.0, 315.0].map(|degrees| {
        let (sine, cosine) = degrees.to_radians().sin_cos();
        middle + up + V::new(cosine * out, sine * out, 0.0)
    })
}

fn tooth() -> Shape {
    let outline = [
        (0.0, -13.0),
        (1.5, -12.5),
        (3.4, -5.0),
        (4.1, 0.0),
        (4.4, BORDER_MM),
        (5.2, 4.0),
        (5.0, 6.0),
        (4.0, 7.6),
        (2.0, 8.0),
        (0.0, 7.6),
    ];
    let colour = |z: f64| if z < BORDER_MM { ROOT } else { ENAMEL };
    let outline = outline.map(|(r, z)| (r, z, colour(z)));
    Shape::lathe(&outline, 48)
}

/// Sheet of gingiva with four handles; the border at x = 0 never moves.
fn sheet(from: f64, to: f64) -> DisplayObject {
    let shape = Shape::block(V::new(from, 9.5, -15.0), V::new(to, 11.0, -4.0), 12);
    let mut object = object(Kind::Gingiva, 0, &shape.clone().coloured(GUM));
    let handles = [0.2, 0.4, 0.6, 0.8].map(|share| V::new(from + (to - from) * share, 11.0, -5.0));
    let mut skin = Skin::over(handles.iter().map(metres).collect());
    for at in &shape.places {
        let near = |handle: &V| {
            let fixed = (at.x.abs() / 2.0).min(1.0);
            fixed * (-(at - handle).norm_squared() / 18.0).exp()
        };
        skin.push((0..).zip(&handles).map(|(k, handle)| (k, near(handle))));
    }
    object.skin = Some(skin);
    object
}

fn probe() -> DisplayTool {
    let band = |k: usize| DisplayBand {
        from: (k as f64 * BAND_MM * 1e-3) as f32,
        to: ((k + 1) as f64 * BAND_MM * 1e-3) as f32,
        dark: k % 2 == 1,
    };
    let mut outline = vec![(0.0, 0.0, STEEL)];
    for k in 0..16 {
        let colour = if band(k).dark { DARK } else { STEEL };
        let colour = if k == 15 { STEEL } else { colour };
        let z = (k as f64 * BAND_MM).max(1e-3);
        outline.push((0.28 + 0.012 * k as f64, z, colour));
    }
    outline.extend([
        (0.5, 20.0, STEEL),
        (2.0, 26.0, STEEL),
        (2.0, 90.0, STEEL),
        (0.0, 90.5, STEEL),
    ]);
    DisplayTool {
        bands: (0..15).map(band).collect(),
        glass: None,
        ..tool("probe", &Shape::lathe(&outline, 24))
    }
}

fn mirror() -> DisplayTool {
    let (rim, back) = (GLASS_MM + 0.5, -1.6);
    let head = [
        (0.0, back, STEEL),
        (rim, back, STEEL),
        (rim, 0.0, STEEL),
        (0.0, 0.0, STEEL),
    ];
    let mut whole = Shape::lathe(&head, 64);
    let handle = Shape::lathe(
        &[
            (0.0, 0.0, STEEL),
            (1.2, 0.0, STEEL),
            (1.8, 80.0, STEEL),
            (0.0, 80.0, STEEL),
        ],
        20,
    );
    // The handle leaves the rim on the reflecting side.
    let lean = Rotation3::from_axis_angle(&V::y_axis(), 65.0f64.to_radians());
    whole.join(handle.turned(&lean).moved(V::new(rim - 0.5, 0.0, -0.8)));
    DisplayTool {
        bands: Vec::new(),
        glass: Some(DisplayGlass {
            centre: [0.0; 3],
            normal: [0.0, 0.0, 1.0],
            radius: (GLASS_MM * 1e-3) as f32,
        }),
        ..tool("mirror", &whole)
    }
}

fn tool(name: &str, shape: &Shape) -> DisplayTool {
    DisplayTool {
        name: name.into(),
        mesh: shape.mesh(),
        bands: Vec::new(),
        glass: None,
        tip: [0.0; 3],
        tip_axis: [0.0, 0.0, -1.0],
        park: WirePose::IDENTITY,
    }
}

/// Object without skin and sites.
pub fn object(kind: Kind, fdi: u8, shape: &Shape) -> DisplayObject {
    DisplayObject {
        kind,
        fdi,
        mesh: shape.mesh(),
        skin: None,
        sites: Vec::new(),
    }
}

fn metres(at: &V) -> [f32; 3] {
    (at * 1e-3).cast::<f32>().into()
}
