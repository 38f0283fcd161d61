//! How a tour is performed, and what each bad habit makes of it.

use sulcus_core::tissue::gingiva::Site;

use crate::habit::Habit;
use crate::pocket_path::Manner;

/// A tooth of a tour with its sites, in the order of the visit. Sites of one side that follow each other are probed in one
/// insertion.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Visit {
    /// FDI number.
    pub tooth: u8,
    /// Its sites.
    pub sites: Vec<Site>,
}

impl Visit {
    /// All six sites of a tooth: the buccal side from distal to mesial, then the lingual side likewise.
    pub fn whole(tooth: u8) -> Self {
        Self {
            tooth,
            sites: vec![
                Site::DistoBuccal,
                Site::Buccal,
                Site::MesioBuccal,
                Site::DistoLingual,
                Site::Lingual,
                Site::MesioLingual,
            ],
        }
    }
}

/// How pockets are probed. SI units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TourParams {
    /// When the hand is to be out of the mouth, done or not, seconds. Default: when it is done.
    pub duration: f64,
    /// Force on the floor at which a depth is read, newtons. Default 0.205: 0.20 to 0.25 N are taught.
    pub force: f64,
    /// Force at which a walking stroke turns back, newtons. Default 0.14: the floor is felt, not pressed.
    pub turn_force: f64,
    /// Speed of the first way down, m/s. Default 6 mm/s.
    pub insert_speed: f64,
    /// Speed of the way down of a bob, m/s. Default 9 mm/s.
    pub walk_speed: f64,
    /// Speed of the way up, and along the tooth, m/s. Default 12 mm/s.
    pub bob_speed: f64,
    /// Speed through the air, m/s. Default 60 mm/s.
    pub air_speed: f64,
    /// Height of a bob over the floor that was felt. Default 1.2 mm (1 to 1.5 mm; 1 to 2 are taught).
    pub bob: f64,
    /// How far a bob goes on along the tooth. Default 1 mm.
    pub advance: f64,
    /// How long the force stands before a depth is called, seconds. Default 1.
    pub read: f64,
    /// Whether a zone's deepest place is gone back to and read; else each zone is read where the walk through it ends.
    pub returns: bool,
    /// How far inside the tooth's surface the hand means the tip to be, so that its side stays on it. Default 0.25 mm: about
    /// 0.05 N.
    pub hug: f64,
    /// How near to the mesial and distal midlines the walk goes, metres. Default 0.85 mm: in the col under the contact (8 to 10
    /// degrees from the midline of a molar, 25 of an incisor).
    pub col: f64,
    /// Which tilts the operator knows. Default as taught.
    pub manner: Manner,
    /// Further tilt away from the tooth, radians. Default 0.
    pub tilt: f64,
    /// One insertion for each site, withdrawn in between, instead of a walk. Default no.
    pub single: bool,
    /// Deepest that the hand goes looking for a floor below the margin. Default 14 mm.
    pub deepest: f64,
    /// Seed of mistakes in reading the marks; none for an eye that reads them right.
    pub misread: Option<u64>,
}

impl Default for TourParams {
    fn default() -> Self {
        Self {
            duration: f64::INFINITY,
            force: 0.205,
            turn_force: 0.14,
            insert_speed: 6e-3,
            walk_speed: 9e-3,
            bob_speed: 12e-3,
            air_speed: 60e-3,
            bob: 1.2e-3,
            advance: 1e-3,
            read: 1.0,
            returns: true,
            hug: 0.25e-3,
            col: 0.85e-3,
            manner: Manner::Taught,
            tilt: 0.0,
            single: false,
            deepest: 14e-3,
            misread: None,
        }
    }
}

/// How far from the midline the line angle is, metres: where an upright probe goes down beside a neighbour.
const LINE_ANGLE: f64 = 3.3e-3;

/// How far below the margin a hand goes that stops before the floor, metres.
const SHORT: f64 = 1.2e-3;

impl Habit {
    /// What the habit makes of a tour; `seed` decides mistakes.
    pub fn spoil(self, params: &mut TourParams, tour: &mut Vec<Visit>, seed: u64) {
        match self {
            Habit::HeavyHand => {
                params.force = 0.6;
                params.turn_force = 0.5;
            }
            Habit::WrongAngle => {
                params.manner = Manner::Upright;
                params.col = LINE_ANGLE;
                params.tilt = 27f64.to_radians();
            }
            Habit::SkipsSites => {
                let mut count = 0;
                for visit in tour.iter_mut() {
                    visit.sites.retain(|site| {
                        count += u32::from(*site != Site::DistoLingual);
                        *site != Site::DistoLingual && count % 3 != 0
                    });
                }
                tour.retain(|visit| !visit.sites.is_empty());
            }
            Habit::Impatient => {
                params.force = 0.06;
                params.turn_force = 0.05;
                params.read = 0.15;
                params.returns = false;
                params.advance = 2.5e-3;
                params.bob = 2e-3;
                params.insert_speed = 10e-3;
                params.walk_speed = 12e-3;
            }
            // The mirror's matter.
            Habit::LetsTongueGo => {}
            Habit::SpotProbes => {
                params.single = true;
                params.col = LINE_ANGLE;
                params.manner = Manner::Upright;
            }
            Habit::Misreads => params.misread = Some(seed),
            Habit::StopsShort => params.deepest = SHORT,
        }
    }
}
