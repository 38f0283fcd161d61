//! First lesson: hold, touch, read a band, walk. The steps are found from the state of the session alone.
//!
//! Thresholds are chosen for a beginner: each asks for the motion itself, not for skill.

use crate::camera::Vector;
use crate::depth;
use crate::moment::Moment;
use crate::readings::Site;
use crate::views::tip;
use sulcus_proto::display::{DisplayScene, Kind};

/// Distance of the mark from the buccal margin, outward and upward, mm: free of the crown.
const MARK_MM: [f64; 2] = [5.0, 13.0];
/// Largest distance of the tip from the mark, mm.
const NEAR_MM: f64 = 3.0;
/// Time at the mark, and time of a soft contact, seconds.
const HOLD_S: f64 = 1.0;
const TOUCH_S: f64 = 1.0;
/// Time without force that ends a contact, seconds.
const RELEASE_S: f64 = 0.1;
/// Force of a soft contact, newtons. Probing is taught at 0.2 N; a hand without feeling needs more room.
const SOFT_N: [f64; 2] = [0.03, 0.6];
/// Largest distance of the tip from a charted site in a contact with the crown, mm.
const CROWN_MM: f64 = 12.0;
/// Least height of the tip above the nearest site in such a contact, mm.
const ABOVE_MM: f64 = 0.5;
/// Least depth of a tip in a pocket, mm, and time outside that ends a walk, seconds.
const IN_MM: f64 = 0.3;
const OUT_S: f64 = 0.3;
/// Least height of a bob, mm, number of bobs, and length of a walk along the margin, mm.
const BOB_MM: f64 = 0.4;
const BOBS: u32 = 3;
const WALK_MM: f64 = 3.0;

/// Step of the lesson.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// Take the tool and move the tip to the mark.
    Hold,
    /// Touch the enamel softly, and lift.
    Touch,
    /// Read a band.
    Read,
    /// Walk along the margin within the pocket.
    Walk,
}

impl Step {
    /// All steps in order.
    pub const ALL: [Self; 4] = [Self::Hold, Self::Touch, Self::Read, Self::Walk];

    /// Name in events.
    pub fn name(self) -> &'static str {
        match self {
            Self::Hold => "hold",
            Self::Touch => "touch",
            Self::Read => "read",
            Self::Walk => "walk",
        }
    }
}

/// State of the probe at an instant.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Seen {
    /// Time since the state before, seconds.
    pub dt_s: f64,
    /// Tip of the probe, mm; `None` in no hand.
    pub tip_mm: Option<Vector>,
    /// Depth of the tip below the margin, mm; `None` outside of pockets.
    pub depth_mm: Option<f64>,
    /// Distance from the nearest charted site and height above it, mm; `None` without sites.
    pub from_site_mm: Option<[f64; 2]>,
    /// Force on the probe, newtons.
    pub force_n: f64,
}

impl Seen {
    /// State at an instant of a scene.
    pub fn of(scene: &DisplayScene, moment: &Moment, force_n: f64, dt_s: f64) -> Self {
        let Some((tip_mm, _)) = tip(scene, moment) else {
            return Self {
                dt_s,
                ..Self::default()
            };
        };
        let gingivae = scene.objects.iter().filter(|one| one.kind == Kind::Gingiva);
        let sites = gingivae.flat_map(|one| &one.sites);
        let from = |site: &[f32; 3]| {
            let off = tip_mm - depth::millimetres(*site);
            [off.norm(), off.z]
        };
        let nearest = sites.map(from).min_by(|a, b| a[0].total_cmp(&b[0]));
        Self {
            dt_s,
            tip_mm: Some(tip_mm),
            depth_mm: depth::along_margin(scene, moment),
            from_site_mm: nearest,
            force_n,
        }
    }
}

/// Lesson under way.
#[derive(Clone, Debug)]
pub struct FirstLesson {
    mark: Vector,
    /// Number of finished steps.
    done: usize,
    /// Time at the mark, seconds.
    held_s: f64,
    contact: Contact,
    walk: Option<Walked>,
}

/// Contact of the tip, from its first force to its release.
#[derive(Clone, Copy, Debug, Default)]
struct Contact {
    /// Soft time at the crown, seconds.
    soft_s: f64,
    /// Whether the force was too great at any time: a heavy press begins softly.
    is_heavy: bool,
    /// Time without force, seconds.
    free_s: f64,
}

/// Walk under way.
#[derive(Clone, Copy, Debug)]
struct Walked {
    /// Place of its begin, mm.
    from: Vector,
    /// Largest and smallest depth since the last turn, mm.
    deepest: f64,
    highest: f64,
    /// Whether the tip is on its way up.
    rises: bool,
    bobs: u32,
    out_s: f64,
}

impl FirstLesson {
    /// Lesson at the first gingiva with charted sites; `None`: the scene has none.
    pub fn new(scene: &DisplayScene) -> Option<Self> {
        let is_gingiva = |kind: Kind| kind == Kind::Gingiva;
        let mut objects = scene.objects.iter();
        let gingiva = objects.find(|one| is_gingiva(one.kind) && one.sites.len() == 6)?;
        let site = |site: Site| depth::millimetres(gingiva.sites[site.number()]);
        let mut out = site(Site::Buccal) - site(Site::Lingual);
        out.z = 0.0;
        let [outward, up] = MARK_MM;
        let mark = site(Site::Buccal) + out.normalize() * outward + Vector::z() * up;
        Some(Self {
            mark,
            done: 0,
            held_s: 0.0,
            contact: Contact::default(),
            walk: None,
        })
    }

    /// Present step; `None` at the end.
    pub fn step(&self) -> Option<Step> {
        Step::ALL.get(self.done).copied()
    }

    /// Place to which the tip is to be moved, mm.
    pub fn mark(&self) -> Vector {
        self.mark
    }

    /// Whether the present contact is or was too heavy.
    pub fn is_heavy(&self) -> bool {
        self.contact.is_heavy
    }

    /// Whether the present contact was soft for long enough: the tip may be lifted.
    pub fn may_lift(&self) -> bool {
        !self.contact.is_heavy && self.contact.soft_s >= TOUCH_S
    }

    /// Takes in a state. Returns the step that it completes.
    pub fn see(&mut self, seen: &Seen) -> Option<Step> {
        let step = self.step()?;
        let is_done = match step {
            Step::Hold => {
                let near = |tip: &Vector| (tip - self.mark).norm() < NEAR_MM;
                let is_near = seen.tip_mm.as_ref().is_some_and(near);
                self.held_s = if is_near {
                    self.held_s + seen.dt_s
                } else {
                    0.0
                };
                self.held_s >= HOLD_S
            }
            Step::Touch => self.touches(seen),
            Step::Read => false,
            Step::Walk => self.walks(seen),
        };
        is_done.then(|| self.next(step))
    }

    /// Takes in the answer to the question of the step [`Step::Read`]. Returns the step if the answer completes it.
    pub fn answered(&mut self, is_right: bool) -> Option<Step> {
        let step = self.step().filter(|step| *step == Step::Read && is_right)?;
        Some(self.next(step))
    }

    fn next(&mut self, step: Step) -> Step {
        self.done += 1;
        (self.held_s, self.contact, self.walk) = (0.0, Contact::default(), None);
        step
    }

    /// A contact counts at its release, when all of it is known.
    fn touches(&mut self, seen: &Seen) -> bool {
        let [least, most] = SOFT_N;
        if seen.tip_mm.is_some() && seen.force_n >= least {
            let at_crown = |[far, up]: [f64; 2]| far < CROWN_MM && up > ABOVE_MM;
            self.contact.free_s = 0.0;
            self.contact.is_heavy |= seen.force_n > most;
            if seen.from_site_mm.is_some_and(at_crown) {
                self.contact.soft_s += seen.dt_s;
            }
            return false;
        }
        self.contact.free_s += seen.dt_s;
        if self.contact.free_s < RELEASE_S {
            return false;
        }
        let is_soft = self.may_lift();
        self.contact = Contact::default();
        is_soft
    }

    fn walks(&mut self, seen: &Seen) -> bool {
        let inside = seen.depth_mm.filter(|mm| *mm >= IN_MM);
        let (Some(depth), Some(tip)) = (inside, seen.tip_mm) else {
            let left = self.walk.as_mut().is_some_and(|walk| {
                walk.out_s += seen.dt_s;
                walk.out_s > OUT_S
            });
            if left || seen.tip_mm.is_none() {
                self.walk = None;
            }
            return false;
        };
        let walk = self.walk.get_or_insert(Walked {
            from: tip,
            deepest: depth,
            highest: depth,
            rises: false,
            bobs: 0,
            out_s: 0.0,
        });
        walk.out_s = 0.0;
        if walk.rises {
            walk.highest = walk.highest.min(depth);
            if depth > walk.highest + BOB_MM {
                // Down again: a bob is complete.
                (walk.rises, walk.deepest) = (false, depth);
                walk.bobs += 1;
            }
        } else {
            walk.deepest = walk.deepest.max(depth);
            if depth < walk.deepest - BOB_MM {
                (walk.rises, walk.highest) = (true, depth);
            }
        }
        let along = (tip - walk.from).xy().norm();
        walk.bobs >= BOBS && along >= WALK_MM
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lesson(done: usize) -> FirstLesson {
        FirstLesson {
            mark: Vector::new(1.0, 2.0, 3.0),
            done,
            held_s: 0.0,
            contact: Contact::default(),
            walk: None,
        }
    }

    const REST: Seen = Seen {
        dt_s: 0.016,
        tip_mm: None,
        depth_mm: None,
        from_site_mm: None,
        force_n: 0.0,
    };

    #[test]
    fn doing_nothing_and_a_hand_elsewhere_complete_no_step() {
        let far = Seen {
            tip_mm: Some(Vector::new(50.0, 0.0, 0.0)),
            from_site_mm: Some([50.0, 40.0]),
            force_n: 0.2,
            ..REST
        };
        for done in 0..4 {
            let mut lesson = lesson(done);
            for seen in [REST, far] {
                assert!((0..10_000).all(|_| lesson.see(&seen).is_none()), "{done}");
            }
        }
    }

    #[test]
    fn a_soft_contact_at_the_crown_counts_at_its_release_and_a_heavy_one_is_told() {
        let touch = |force_n: f64, up: f64| Seen {
            tip_mm: Some(Vector::zeros()),
            from_site_mm: Some([4.0, up]),
            force_n,
            ..REST
        };
        // Forces of a contact in turn, each for 80 states, then the release.
        let press = |forces: &[f64], up: f64| {
            let mut lesson = lesson(1);
            let (mut is_heavy, mut may_lift) = (false, false);
            for force_n in forces {
                for _ in 0..80 {
                    assert_eq!(lesson.see(&touch(*force_n, up)), None, "before the release");
                    (is_heavy, may_lift) = (lesson.is_heavy(), lesson.may_lift());
                }
            }
            let released = touch(0.0, up);
            let found = (0..20).find_map(|_| lesson.see(&released));
            (found, is_heavy, may_lift)
        };
        assert_eq!(press(&[0.2], 3.0), (Some(Step::Touch), false, true));
        assert_eq!(press(&[0.9], 3.0), (None, true, false));
        assert_eq!(press(&[0.2, 0.9, 0.2], 3.0), (None, true, false), "a ramp");
        assert_eq!(press(&[0.2], -1.0), (None, false, false), "on the gum");
    }

    #[test]
    fn a_contact_is_not_added_up_from_short_ones() {
        let mut lesson = lesson(1);
        for k in 0..2000 {
            let force_n = if k % 40 < 20 { 0.2 } else { 0.0 };
            let seen = Seen {
                tip_mm: Some(Vector::zeros()),
                from_site_mm: Some([4.0, 3.0]),
                force_n,
                ..REST
            };
            assert_eq!(lesson.see(&seen), None);
        }
    }

    #[test]
    fn a_walk_needs_bobs_way_and_the_pocket() {
        let walk = |bob_mm: f64, way_mm: f64, leaves: bool| {
            let mut lesson = lesson(3);
            (0..600).find_map(|k| {
                let share = f64::from(k) / 600.0;
                let bob = (share * 10.0 * std::f64::consts::TAU).sin();
                let out = leaves && k % 150 > 120;
                lesson.see(&Seen {
                    tip_mm: Some(Vector::new(way_mm * share, 0.0, 0.0)),
                    depth_mm: (!out).then_some(2.0 + 0.5 * bob_mm * bob),
                    ..REST
                })
            })
        };
        assert_eq!(walk(1.0, 6.0, false), Some(Step::Walk));
        assert_eq!(walk(0.2, 6.0, false), None, "no bobs");
        assert_eq!(walk(1.0, 2.0, false), None, "no way");
        assert_eq!(walk(1.0, 6.0, true), None, "out of the pocket");
    }

    #[test]
    fn only_a_right_answer_completes_the_reading() {
        let mut lesson = lesson(2);
        assert_eq!(lesson.answered(false), None);
        assert_eq!(lesson.answered(true), Some(Step::Read));
        assert_eq!(
            (lesson.answered(true), lesson.step()),
            (None, Some(Step::Walk))
        );
    }
}
