//! Parameters of a tour, and their changes by a bad habit.

use sulcus_core::tissue::gingiva::Site;

use crate::habit::Habit;
use crate::pocket_path::Manner;

/// Visit of a tooth in a tour. Successive sites of one side are probed in one insertion.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Visit {
    /// FDI number of the tooth.
    pub tooth: u8,
    /// Sites in the order of probing.
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

/// Parameters of a tour, SI units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TourParams {
    /// Time by which the hand is to be out of the mouth, finished or not, seconds. Default: infinite.
    pub duration: f64,
    /// Force on the floor at which a depth is read, newtons. Default 0.205; 0.20 to 0.25 N are taught.
    pub force: f64,
    /// Force on the floor at which the way down of a bob ends, newtons. Default 0.14: the floor is only felt.
    pub turn_force: f64,
    /// Speed of the first way down of an insertion, m/s. Default 6 mm/s.
    pub insert_speed: f64,
    /// Speed of the way down of a bob, m/s. Default 9 mm/s.
    pub walk_speed: f64,
    /// Speed of a bob up and along the tooth, m/s. Default 12 mm/s. The way out of the pocket has twice this speed.
    pub bob_speed: f64,
    /// Speed through the air, m/s. Default 60 mm/s.
    pub air_speed: f64,
    /// Height of a bob over the felt floor, metres. Default 1.2 mm; 1 to 2 mm are taught.
    pub bob: f64,
    /// Distance between two stops along the tooth, metres. Default 1 mm.
    pub advance: f64,
    /// Time with a steady force before a depth is called, seconds. Default 1.
    pub read: f64,
    /// Whether the hand returns to the deepest felt place of a zone and reads it. Otherwise the depth is read at the
    /// end of the walk through the zone. Default yes.
    pub returns: bool,
    /// Depth of the target tip inside the tooth's surface, metres, so that its side stays on the tooth. Default
    /// 0.25 mm, which gives about 0.05 N.
    pub hug: f64,
    /// Smallest distance of a stop from the plane through the mesial and the distal midline, metres. Default 0.85 mm,
    /// in the col under the contact: 8 to 10 degrees from the midline of a molar, 25 degrees from that of an incisor.
    pub col: f64,
    /// Tilts that the operator uses. Default [`Manner::Taught`].
    pub manner: Manner,
    /// Further tilt away from the tooth, radians. Default 0.
    pub tilt: f64,
    /// Whether each site has its own insertion, with a withdrawal in between, instead of a walk. Default no.
    pub single: bool,
    /// Largest target depth below the margin, metres. Default 14 mm.
    pub deepest: f64,
    /// Seed of the errors in reading the marks; `None`: correct reading. Default none.
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

/// Distance of the line angle from the midline, metres. There an upright probe can enter beside a neighbour.
const LINE_ANGLE: f64 = 3.3e-3;

/// Largest target depth of the habit `stops-short`, metres below the margin.
const SHORT: f64 = 1.2e-3;

impl Habit {
    /// Changes the parameters and the visits of a tour to those of the habit. `seed` decides the errors of `misreads`.
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
            // The habit concerns only the mirror: see `Habit::holds_until`.
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
