//! Views: eyes as a seated operator has them, by region of the mouth.
//!
//! The eye is 420 mm from the tooth (careoptical; range 340 to 500), the picture 15 to 18 degrees high. Directions follow
//! the clock positions of a right-handed operator; the exact angles are chosen. A left-handed operator has mirrored
//! directions. Today this changes the view of the mirror alone, and only while no tooth lies beside the glass.

use sulcus_proto::display::{DisplayObject, DisplayScene, Kind};

use crate::camera::{Camera, Vector};
use crate::handed::Handed;
use crate::moment::Moment;

/// Distance of the eye, mm.
const EYE_MM: f64 = 420.0;
/// Distance to the side of a tooth from a glass at which the eye is over the opposite side of the mouth, mm.
///
/// A mirror that holds the tongue aside leans to the teeth by some 27 degrees. Its glass shows their lingual side to an
/// eye that is 40 degrees over the opposite side.
const BESIDE_MM: f64 = 8.0;
/// Tooth of a view without one.
const USUAL: u8 = 36;

/// View of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum View {
    /// The whole lower arch from the front and above.
    Overview,
    /// The front teeth.
    Front,
    /// Buccal side of a tooth.
    Buccal,
    /// Lingual side of a tooth, over the opposite side of the arch.
    Lingual,
    /// The glass of the mirror, as the operator sees it.
    Mirror,
    /// The tip of the probe.
    CloseUp,
}

impl View {
    /// All views.
    pub const ALL: [Self; 6] = [
        Self::Overview,
        Self::Front,
        Self::Buccal,
        Self::Lingual,
        Self::Mirror,
        Self::CloseUp,
    ];

    /// Name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Overview => "overview",
            Self::Front => "front",
            Self::Buccal => "buccal",
            Self::Lingual => "lingual",
            Self::Mirror => "mirror",
            Self::CloseUp => "close-up",
        }
    }

    /// Camera of the view for a right-handed operator. `tooth` is the FDI number of the tooth in the middle; `aspect`
    /// is width over height.
    pub fn camera(
        self,
        scene: &DisplayScene,
        moment: &Moment,
        tooth: Option<u8>,
        aspect: f64,
    ) -> Camera {
        self.camera_of(Handed::Right, scene, moment, tooth, aspect)
    }

    /// Camera of the view for an operator with the probe in `hand`.
    pub fn camera_of(
        self,
        hand: Handed,
        scene: &DisplayScene,
        moment: &Moment,
        tooth: Option<u8>,
        aspect: f64,
    ) -> Camera {
        let mouth = Mouth::new(scene);
        let middle = mouth.middle;
        let at = |target: Vector, towards: Vector, away: f64, height_mm: f64| {
            let height = 2.0 * (0.5 * height_mm / away).atan().to_degrees();
            let eye = target + towards.normalize() * away;
            Camera::looking(eye, target, Vector::z(), height, aspect)
        };
        let size = mouth.size.max(20.0);
        match self {
            Self::Overview => at(middle, Vector::new(0.62, 0.0, 0.78), EYE_MM, 1.15 * size),
            Self::Front => {
                let target = mouth.front.unwrap_or(middle) + Vector::new(0.0, 0.0, -2.0);
                at(target, Vector::new(0.93, 0.0, 0.36), EYE_MM, 36.0)
            }
            Self::Buccal | Self::Lingual => {
                let (place, buccal) = mouth.tooth(scene, tooth.unwrap_or(USUAL));
                let (towards, height) = match self {
                    Self::Buccal => (buccal * 0.85 + Vector::new(0.35, 0.0, 0.40), 30.0),
                    _ => (buccal * -0.62 + Vector::new(0.30, 0.0, 0.75), 30.0),
                };
                at(place, towards, EYE_MM, height)
            }
            Self::Mirror => {
                let glass = scene.tools.iter().position(|tool| tool.glass.is_some());
                let held = glass.filter(|k| moment.tools[*k].held);
                let centre = held.and_then(|k| {
                    let glass = scene.tools[k].glass?;
                    let tool = moment.tools[k];
                    let mm = nalgebra::Vector3::from(glass.centre) * crate::stage::MM;
                    Some((tool.orientation * mm + tool.position).cast::<f64>())
                });
                let target = centre.unwrap_or(middle);
                // Share of the way to an eye that sees a tooth beside the glass in it.
                let beside = centre.map_or(0.0, |centre| {
                    let (crown, _) = mouth.nearest(scene, &centre);
                    ((crown.y - centre.y) / BESIDE_MM).clamp(-1.0, 1.0)
                });
                let front = Vector::new(0.62, -0.12 * hand.side(), 0.78);
                let over = Vector::new(0.15, -0.62 * beside.signum(), 0.78);
                at(target, front.lerp(&over, beside.abs()), EYE_MM, 42.0)
            }
            Self::CloseUp => {
                let (tip, along) = tip(scene, moment).unwrap_or((middle, -Vector::z()));
                let (_, buccal) = mouth.nearest(scene, &tip);
                // Across the working end, from the side of the cheek.
                let aside = buccal - along * buccal.dot(&along);
                let towards = aside * 0.9 + Vector::new(0.15, 0.0, 0.35);
                // All bands of a probe show, so that they can be counted from the last one.
                at(tip - along * 7.0, towards, 300.0, 23.0)
            }
        }
    }
}

impl std::str::FromStr for View {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let found = Self::ALL.into_iter().find(|view| view.name() == text);
        found.ok_or_else(|| {
            let names = Self::ALL.map(Self::name).join(", ");
            format!("`{text}` is no view, expected one of: {names}")
        })
    }
}

/// Tip of the first held probe and the direction out of it, world axes, mm.
pub fn tip(scene: &DisplayScene, moment: &Moment) -> Option<(Vector, Vector)> {
    let probe = |(k, _): &(usize, _)| moment.tools[*k].held;
    let is_probe =
        |(_, tool): &(usize, &sulcus_proto::display::DisplayTool)| !tool.bands.is_empty();
    let (k, tool) = scene
        .tools
        .iter()
        .enumerate()
        .filter(is_probe)
        .find(probe)?;
    let at = moment.tools[k];
    let mm = |v: [f32; 3]| at.orientation * nalgebra::Vector3::from(v);
    let tip = mm(tool.tip) * crate::stage::MM + at.position;
    Some((tip.cast::<f64>(), mm(tool.tip_axis).cast::<f64>()))
}

/// Places in a mouth.
struct Mouth {
    middle: Vector,
    /// Longest horizontal extent of the teeth, or of everything in a scene without teeth, mm.
    size: f64,
    front: Option<Vector>,
}

impl Mouth {
    fn new(scene: &DisplayScene) -> Self {
        let teeth: Vec<&DisplayObject> = scene
            .objects
            .iter()
            .filter(|one| one.kind == Kind::Tooth)
            .collect();
        let all: Vec<&DisplayObject> = scene.objects.iter().collect();
        let seen = if teeth.is_empty() { &all } else { &teeth };
        let mut places = seen.iter().flat_map(|one| one.mesh.vertices().map(mm));
        let first = places.next().unwrap_or_default();
        let (low, high) = places.fold((first, first), |(low, high), at| {
            (low.inf(&at), high.sup(&at))
        });
        let mut middle = (low + high) * 0.5;
        // Roots hang below; the eye looks at the crowns.
        middle.z = high.z - 5.0;
        let incisors: Vec<Vector> = scene
            .objects
            .iter()
            .filter(|one| one.kind == Kind::Tooth && one.fdi % 10 == 1)
            .map(crown)
            .collect();
        Self {
            middle,
            size: (high.x - low.x).max(high.y - low.y),
            front: (!incisors.is_empty())
                .then(|| incisors.iter().sum::<Vector>() / incisors.len() as f64),
        }
    }

    /// Crown of a tooth and the horizontal unit vector buccally; without this tooth those of the first one.
    fn tooth(&self, scene: &DisplayScene, fdi: u8) -> (Vector, Vector) {
        let teeth = || scene.objects.iter().filter(|one| one.kind == Kind::Tooth);
        let tooth = teeth()
            .find(|one| one.fdi == fdi)
            .or_else(|| teeth().next());
        let Some(tooth) = tooth else {
            return (self.middle, Vector::x());
        };
        let place = crown(tooth);
        let gingiva = scene
            .objects
            .iter()
            .find(|one| one.kind == Kind::Gingiva && one.fdi == tooth.fdi);
        let sites = gingiva
            .map(|one| &one.sites)
            .filter(|sites| sites.len() == 6);
        let buccal = sites.map(|sites| mm(sites[1]) - mm(sites[4]));
        let outwards = buccal.unwrap_or_else(|| place - self.middle);
        let level = Vector::new(outwards.x, outwards.y, 0.0);
        (place, level.try_normalize(1e-9).unwrap_or_else(Vector::x))
    }

    /// The same for the tooth nearest to a place.
    fn nearest(&self, scene: &DisplayScene, place: &Vector) -> (Vector, Vector) {
        let teeth = scene.objects.iter().filter(|one| one.kind == Kind::Tooth);
        // Once for each tooth: a crown takes all vertices, and a window asks in every frame.
        let away = teeth.map(|tooth| ((crown(tooth) - place).norm(), tooth.fdi));
        let nearest = away.min_by(|a, b| a.0.total_cmp(&b.0));
        self.tooth(scene, nearest.map_or(USUAL, |(_, fdi)| fdi))
    }
}

/// Unit vector along a tooth, up from the root, world axes. `None`: the scene has no such tooth.
///
/// The vector runs from the middle of the lowest quarter of the drawn surface to that of the highest quarter.
pub fn along(scene: &DisplayScene, fdi: u8) -> Option<Vector> {
    let is_it = |one: &&DisplayObject| one.kind == Kind::Tooth && one.fdi == fdi;
    let tooth = scene.objects.iter().find(is_it)?;
    let all = || tooth.mesh.vertices().map(mm);
    let heights = || all().map(|at| at.z);
    let (low, high) = (
        heights().fold(f64::INFINITY, f64::min),
        heights().fold(f64::NEG_INFINITY, f64::max),
    );
    let middle = |from: f64, to: f64| {
        let none = Vector::repeat(f64::INFINITY);
        let slab = all().filter(|at| (from..=to).contains(&at.z));
        let (low, high) = slab.fold((none, -none), |(low, high), at| {
            (low.inf(&at), high.sup(&at))
        });
        (low + high) * 0.5
    };
    let quarter = 0.25 * (high - low);
    let along = middle(high - quarter, high) - middle(low, low + quarter);
    along.try_normalize(1e-9)
}

/// Middle of a tooth's crown, 4 mm below its highest point.
fn crown(tooth: &DisplayObject) -> Vector {
    let top = tooth
        .mesh
        .vertices()
        .map(mm)
        .fold(f64::NEG_INFINITY, |top, at| top.max(at.z));
    let above: Vec<Vector> = tooth
        .mesh
        .vertices()
        .map(mm)
        .filter(|at| at.z > top - 8.0)
        .collect();
    let middle = above.iter().sum::<Vector>() / above.len().max(1) as f64;
    Vector::new(middle.x, middle.y, top - 4.0)
}

fn mm(at: [f32; 3]) -> Vector {
    Vector::from(at.map(|x| f64::from(x) * 1e3))
}
