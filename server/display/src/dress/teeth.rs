//! Display mesh of a tooth: fewer triangles than the simulation's, with lines for steps of colour.

use std::sync::OnceLock;

use sulcus_core::Vec3;
use sulcus_proto::CodecError;
use sulcus_proto::display::{DisplayMesh, Finish};
use sulcus_scene::anatomy::mouth::DrawnTooth;
use sulcus_scene::mesh::distance::MeshDistance;

use super::colour::Lab;
use super::cut::cut;
use super::enamel::{Enamel, FISSURE_MM, HALO_MM, STEP_MM, variation};
use super::flip::flip;
use super::sheet::Sheet;
use super::thin::{Limits, thin};
use super::trace::trace;

/// Depth under the CEJ down to which the drawn surface is true, mm: as far as recession can bare a root.
const BARED_MM: f64 = 6.0;
/// Limits of the crown, mm.
const CROWN: Limits = Limits {
    off: 0.023,
    long: 1.4,
    turned: 0.86,
};
/// Limits of the root that recession can bare, mm.
const NECK: Limits = Limits {
    off: 0.025,
    long: 2.4,
    turned: 0.78,
};
/// Limits of the root in the bone, mm.
const BURIED: Limits = Limits {
    off: 0.4,
    long: 5.0,
    turned: 0.2,
};
/// Heights over the CEJ of lines along which a margin runs, mm. Light falls off towards a margin, so that vertices in
/// rows are needed there. Chosen.
const MARGIN_MM: [f64; 2] = [0.8, 1.7];
/// Largest distance of a flipped edge's middle from the surface, mm.
const FLIPPED_MM: f64 = 0.008;

/// Drawn surface of the teeth of one number, in the frame of a left tooth.
struct Drawn {
    /// Vertices, mm.
    at: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
    /// Colours of the average shade.
    colours: Vec<Lab>,
    finishes: Vec<Finish>,
}

/// Returns the display mesh of a tooth, world axes, metres.
///
/// # Errors
/// The mesh is beyond the limits of a display.
pub fn tooth(tooth: &DrawnTooth) -> Result<DisplayMesh, CodecError> {
    let drawn = drawn(tooth);
    let (frame, shade) = (&tooth.frame, variation(tooth.fdi));
    let place = |p: &Vec3| {
        let at = frame.origin + (frame.mesial * p.x + frame.buccal * p.y + frame.axis * p.z) * MM;
        crate::display::f32s(&at)
    };
    // The frame of a right tooth turns a surface inside out.
    let mirrored = frame.mesial.cross(&frame.buccal).dot(&frame.axis) < 0.0;
    let turned = |&[a, b, c]: &[u32; 3]| if mirrored { [a, c, b] } else { [a, b, c] };
    let colours: Vec<[u8; 4]> = drawn
        .colours
        .iter()
        .map(|colour| colour.moved(shade).to_srgb())
        .collect();
    let vertices: Vec<[f32; 3]> = drawn.at.iter().map(place).collect();
    let triangles: Vec<[u32; 3]> = drawn.triangles.iter().map(turned).collect();
    let whole = colours.first().copied().unwrap_or_default();
    DisplayMesh::new(&vertices, &triangles, whole, &colours)?.with_finishes(drawn.finishes.clone())
}

/// Draws the surfaces of all teeth, one number on each thread.
pub fn prepare(teeth: &[Option<DrawnTooth>]) {
    std::thread::scope(|scope| {
        for number in 1..10 {
            let mut all = teeth.iter().flatten();
            if let Some(tooth) = all.find(|tooth| tooth.fdi % 10 == number) {
                scope.spawn(|| drawn(tooth));
            }
        }
    });
}

/// Metres of a millimetre.
const MM: f64 = 1e-3;

/// Returns the drawn surface of a tooth's number, made once per process. Both sides share it.
fn drawn(tooth: &DrawnTooth) -> &'static Drawn {
    static ALL: [OnceLock<Drawn>; 10] = [const { OnceLock::new() }; 10];
    ALL[usize::from(tooth.fdi % 10)].get_or_init(|| draw(tooth))
}

fn draw(tooth: &DrawnTooth) -> Drawn {
    let enamel = Enamel::new(tooth.shape);
    let original = MeshDistance::new(tooth.mesh.clone().placed(1.0 / MM, Vec3::zeros()));
    let mut sheet = Sheet::of(original.mesh());
    thin(&mut sheet, &|p| match enamel.above_cej(p) {
        above if above > -0.5 => CROWN,
        above if above > -BARED_MM - 0.5 => NECK,
        _ => BURIED,
    });
    flip(&mut sheet, &|p| {
        let is_buried = enamel.above_cej(p) < -BARED_MM - 2.0;
        original.signed(p).abs() < if is_buried { BURIED.off } else { FLIPPED_MM }
    });
    let onto = |p: &Vec3| original.nearest(p).point;
    for height in [0.0, -STEP_MM].into_iter().chain(MARGIN_MM) {
        cut(&mut sheet, &|p| enamel.above_cej(p) - height, &onto);
    }
    if enamel.is_front() {
        for depth in HALO_MM {
            cut(&mut sheet, &|p| enamel.under_edge(p) - depth, &onto);
        }
    }
    let is_table = |p: &Vec3| enamel.is_table(p);
    // In a crease the nearest place may lie on its other side, so that vertices of a fissure stay in their triangles.
    let there = |p: &Vec3| *p;
    for fissure in enamel.fissures() {
        trace(&mut sheet, &fissure.points, &is_table, &there);
    }
    // A distance that is not finite, off the table, has no crossing.
    cut(
        &mut sheet,
        &|p| enamel.fissure(p).0.min(1.0) - FISSURE_MM,
        &there,
    );
    sheet.drop_unused();
    let looks: Vec<_> = sheet.at.iter().map(|p| enamel.look(p)).collect();
    Drawn {
        triangles: sheet.to_mesh().triangles,
        colours: looks.iter().map(|look| look.colour).collect(),
        finishes: looks.iter().map(|look| look.finish).collect(),
        at: sheet.at,
    }
}
