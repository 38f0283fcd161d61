//! Teeth of a whole mouth as compiled and as drawn.

use std::sync::OnceLock;

use sulcus_core::tissue::TissueModel;
use sulcus_core::tissue::gingiva::ToothFrame;
use sulcus_core::{Object, Scene, Vec3};
use sulcus_display::Display;
use sulcus_proto::display::{DisplayObject, Finish, Kind};
use sulcus_scene::anatomy::Tooth;
use sulcus_scene::anatomy::patient::{LOWER, Patient, ToothChart};
use sulcus_scene::mesh::TriMesh;

use crate::common::compiled;

/// A whole mouth with its display.
fn mouth() -> &'static (Scene, Display) {
    static MOUTH: OnceLock<(Scene, Display)> = OnceLock::new();
    MOUTH.get_or_init(|| {
        let mut patient = Patient::healthy("one");
        patient.teeth = LOWER.map(ToothChart::healthy).to_vec();
        let scene = compiled(&patient, &LOWER);
        let display = Display::new(&scene).expect("a display");
        (scene, display)
    })
}

/// A tooth as compiled and as drawn, in its own frame.
pub struct Seen {
    pub fdi: u8,
    pub shape: Tooth,
    pub compiled: TriMesh,
    pub drawn: TriMesh,
    /// L*, a*, b* of the vertices.
    pub lab: Vec<[f64; 3]>,
    pub finishes: Vec<Finish>,
}

impl Seen {
    /// Height over the CEJ, mm.
    pub fn above_cej(&self, p: &Vec3) -> f64 {
        p.z - self.shape.cej(p.y.atan2(p.x))
    }

    /// Mean colour of the vertices that a rule accepts.
    pub fn mean(&self, rule: impl Fn(&Vec3) -> bool) -> [f64; 3] {
        let vertices = self.drawn.vertices.iter().zip(&self.lab);
        let of: Vec<&[f64; 3]> = vertices.filter(|(v, _)| rule(v)).map(|(_, c)| c).collect();
        assert!(of.len() > 2, "tooth {}: {} vertices", self.fdi, of.len());
        [0, 1, 2].map(|k| of.iter().map(|c| c[k]).sum::<f64>() / of.len() as f64)
    }
}

/// All teeth of a whole mouth.
pub fn teeth() -> Vec<Seen> {
    let (scene, display) = mouth();
    let objects = scene.objects.iter().zip(&display.scene().objects);
    let teeth = objects.filter(|(_, shown)| shown.kind == Kind::Tooth);
    teeth
        .map(|(object, shown)| seen(scene, object, shown))
        .collect()
}

fn frame(scene: &Scene, fdi: u8) -> ToothFrame {
    let models = scene.objects.iter().filter(|object| object.fdi == fdi);
    let mut frames = models.filter_map(|object| match &object.tissue {
        TissueModel::Gingiva(model) => Some(model.tooth),
        _ => None,
    });
    frames.next().expect("a gingiva")
}

fn seen(scene: &Scene, object: &Object, shown: &DisplayObject) -> Seen {
    let frame = frame(scene, object.fdi);
    let own = |v: [f32; 3]| {
        let off = Vec3::from(v.map(f64::from)) - frame.origin;
        Vec3::new(
            off.dot(&frame.mesial),
            off.dot(&frame.buccal),
            off.dot(&frame.axis),
        ) * 1e3
    };
    let mirrored = frame.mesial.cross(&frame.buccal).dot(&frame.axis) < 0.0;
    let mesh = |vertices: Vec<Vec3>, triangles: Vec<[u32; 3]>| TriMesh {
        vertices,
        triangles: triangles
            .into_iter()
            .map(|[a, b, c]| if mirrored { [a, c, b] } else { [a, b, c] })
            .collect(),
    };
    let compiled = object.mesh.vertices.iter().map(|v| own(*v)).collect();
    Seen {
        fdi: object.fdi,
        shape: Tooth::lower(object.fdi).expect("a tooth"),
        compiled: mesh(compiled, object.mesh.triangles.clone()),
        drawn: mesh(
            shown.mesh.vertices().map(own).collect(),
            shown.mesh.triangles().collect(),
        ),
        lab: shown.mesh.vertex_colours.iter().map(lab).collect(),
        finishes: shown.mesh.finishes.clone(),
    }
}

/// L*, a*, b* of an sRGB colour by the definitions of CIE 15 and IEC 61966-2-1.
fn lab(srgb: &[u8; 4]) -> [f64; 3] {
    let linear = |c: u8| {
        let c = f64::from(c) / 255.0;
        if c > 0.04045 {
            ((c + 0.055) / 1.055).powf(2.4)
        } else {
            c / 12.92
        }
    };
    let [r, g, b] = [linear(srgb[0]), linear(srgb[1]), linear(srgb[2])];
    let f = |t: f64| {
        if t > 0.008856 {
            t.cbrt()
        } else {
            7.787 * t + 16.0 / 116.0
        }
    };
    let x = f((0.4124 * r + 0.3576 * g + 0.1805 * b) / 0.9505);
    let y = f(0.2126 * r + 0.7152 * g + 0.0722 * b);
    let z = f((0.0193 * r + 0.1192 * g + 0.9505 * b) / 1.089);
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}
