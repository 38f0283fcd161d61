//! Forces that a device does not display to the hand, and the metrics that therefore judge nobody.
//!
//! A metric of force judges how the hand uses what it feels. A mouse displays no force; the friction of a device hides
//! weaker forces. Such a metric has no score, no least score and no critical error, and the grade names the device.
//! Only a device that its client described counts ([`DeviceFacts::is_described`]): recordings before format 7 describe
//! none, and their grades stay as they are.

use serde::Serialize;
use sulcus_core::Scene;
use sulcus_core::math::fmin;
use sulcus_core::tissue::TissueModel;
use sulcus_core::tissue::gingiva::GingivaParams;

use super::definitions::{Definition, Feels};
use super::rubric::Bound;
use super::settings::Settings;
use crate::record::device::DeviceFacts;

/// Quantity that a device lacks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Lack {
    /// The device displays no force.
    Force,
    /// The device displays no torque. No metric needs torque.
    Torque,
    /// The friction of the device exceeds a force that a metric expects the hand to feel.
    Friction,
}

/// Device with a force or a torque that the hand does not feel.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Unfelt {
    /// Name of the tool.
    pub tool: String,
    /// Name of the device.
    pub device: String,
    /// Quantity that the device lacks.
    pub lacks: Lack,
    /// Names of the metrics that are not judged, in the order of the rubric.
    pub metrics: Vec<&'static str>,
    /// One sentence for people, without a full stop.
    pub text: String,
}

/// Described devices of a session, against the metrics of its rubric.
pub(super) struct Devices<'a> {
    scene: &'a Scene,
    set: &'a Settings,
    all: Vec<&'a DeviceFacts>,
    /// Least forces of trauma and damage of the scene's gingivae, newtons; `None` without a gingiva.
    zones: Option<(f64, f64)>,
    /// Lacks so far.
    found: Vec<Unfelt>,
}

impl<'a> Devices<'a> {
    /// Described devices of a session. A device that occurs several times counts once.
    pub fn new(devices: &'a [DeviceFacts], scene: &'a Scene, set: &'a Settings) -> Self {
        let mut all: Vec<&DeviceFacts> = Vec::new();
        for device in devices {
            let of_a_tool = usize::from(device.tool) < scene.tools.len();
            if of_a_tool && device.is_described() && !all.contains(&device) {
                all.push(device);
            }
        }
        let gingivae = scene
            .objects
            .iter()
            .filter_map(|object| match &object.tissue {
                TissueModel::Gingiva(gingiva) => Some(&gingiva.params),
                _ => None,
            });
        let zones = gingivae
            .map(|GingivaParams { trauma, damage, .. }| (*trauma, *damage))
            .reduce(|a, b| (fmin(a.0, b.0), fmin(a.1, b.1)));
        let mut devices = Self {
            scene,
            set,
            all,
            zones,
            found: Vec::new(),
        };
        devices.note_kinds();
        devices
    }

    /// Notes the devices without force, and those with force and without torque.
    fn note_kinds(&mut self) {
        for k in 0..self.all.len() {
            let device = self.all[k];
            if device.force_axes == 0 {
                self.note(device, Lack::Force, None);
            } else if device.torque_axes == 0 {
                self.note(device, Lack::Torque, None);
            }
        }
    }

    /// Reason why the metric judges nobody, as one sentence; `None` for a metric that is judged. `target` is the target
    /// of the rubric; `None` for a metric that only a critical error names.
    pub fn against(&mut self, known: &Definition, target: Option<&Bound>) -> Option<String> {
        let feels = known.feels()?;
        let force_n = match feels {
            Feels::Band => self.set.force_n[1],
            Feels::Trauma => self.zones?.0,
            Feels::Damage => self.zones?.1,
            Feels::Probe | Feels::Mirror => match target {
                Some(Bound::One(force)) => *force,
                Some(Bound::Band([_, most])) => *most,
                None => f64::INFINITY,
            },
        };
        // The first tool without bands is the mirror, as in the evidence of a grade.
        let mirror = self.scene.tools.iter().position(|t| t.bands.is_empty());
        let mut why = None;
        for k in 0..self.all.len() {
            let device = self.all[k];
            let holds_mirror = mirror == Some(usize::from(device.tool));
            if holds_mirror != (feels == Feels::Mirror) {
                continue;
            }
            let said = if device.force_axes == 0 {
                let said = format!("{} displays no force", self.named(device));
                self.note(device, Lack::Force, Some(known.name));
                said
            } else if device.friction_n > force_n {
                let said = format!(
                    "{} has a friction of {} N in free space, expected at most the {force_n} N that the hand must feel",
                    self.named(device),
                    device.friction_n
                );
                self.note(device, Lack::Friction, Some(known.name));
                said
            } else {
                continue;
            };
            why.get_or_insert(said);
        }
        why
    }

    /// Devices with what they lack, in the order of the session and the tools.
    pub fn found(self) -> Vec<Unfelt> {
        self.found
    }

    fn tool(&self, device: &DeviceFacts) -> String {
        let tool = self.scene.tools.get(usize::from(device.tool));
        tool.map_or(String::new(), |tool| tool.name.clone())
    }

    fn named(&self, device: &DeviceFacts) -> String {
        format!("device `{}` of the {}", device.name, self.tool(device))
    }

    fn note(&mut self, device: &DeviceFacts, lacks: Lack, metric: Option<&'static str>) {
        let tool = self.tool(device);
        let is_it =
            |one: &&mut Unfelt| one.tool == tool && one.device == device.name && one.lacks == lacks;
        if let Some(one) = self.found.iter_mut().find(is_it) {
            let new = metric.filter(|name| !one.metrics.contains(name));
            one.metrics.extend(new);
            return;
        }
        let named = self.named(device);
        let text = match lacks {
            Lack::Force => {
                format!("{named} displays no force, so metrics of force are without a score")
            }
            Lack::Torque => format!(
                "{named} displays no torque, so whether the hand yields to the lever of a contact remains open"
            ),
            Lack::Friction => format!(
                "{named} has a friction of {} N in free space, so metrics of weaker forces are without a score",
                device.friction_n
            ),
        };
        self.found.push(Unfelt {
            tool,
            device: device.name.clone(),
            lacks,
            metrics: metric.into_iter().collect(),
            text,
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grade::Rubric;
    use crate::grade::definitions::find;
    use crate::grade::test_help::{SET, empty_scene};

    fn touch(tool: u8, friction_n: f64) -> DeviceFacts {
        DeviceFacts {
            tool,
            name: "Touch".into(),
            library: "openhaptics".into(),
            friction_n,
            motion_axes: 6,
            force_axes: 3,
            force_dof: 3,
            ..DeviceFacts::default()
        }
    }

    /// Metrics of the rubric `bimanual` that are not judged, and the devices.
    fn not_judged(devices: &[DeviceFacts]) -> (Vec<String>, Vec<Unfelt>) {
        let scene = empty_scene();
        let mut of = Devices::new(devices, &scene, &SET);
        let rubrics = Rubric::built_in();
        let rubric = rubrics.iter().find(|one| one.name == "bimanual");
        let metrics = &rubric.expect("a rubric").metrics;
        let not = metrics.iter().filter(|weighed| {
            let known = find(&weighed.name).expect("known");
            of.against(known, Some(&weighed.target)).is_some()
        });
        let names = not.map(|weighed| weighed.name.clone()).collect();
        (names, of.found())
    }

    #[test]
    fn a_device_without_force_judges_no_force_of_its_own_tool() {
        let mouse = |tool| DeviceFacts {
            tool,
            name: "mouse".into(),
            library: "mouse".into(),
            motion_axes: 6,
            ..DeviceFacts::default()
        };
        let (names, found) = not_judged(&[mouse(0)]);
        assert!(names.contains(&"force_in_band".to_owned()), "{names:?}");
        assert!(names.contains(&"probe_peak".to_owned()), "{names:?}");
        assert!(!names.contains(&"mirror_force".to_owned()), "{names:?}");
        assert!(!names.contains(&"angle_mid".to_owned()), "{names:?}");
        assert_eq!((found.len(), found[0].lacks), (1, Lack::Force));
        assert_eq!(found[0].metrics, names);
        let (names, found) = not_judged(&[mouse(1)]);
        assert!(names.contains(&"mirror_force".to_owned()), "{names:?}");
        assert!(!names.contains(&"force_in_band".to_owned()), "{names:?}");
        assert_eq!(found[0].tool, "mirror");
    }

    #[test]
    fn friction_above_the_band_hides_the_band_and_no_larger_force() {
        let (names, found) = not_judged(&[touch(0, 0.26)]);
        assert!(names.contains(&"readings_held".to_owned()), "{names:?}");
        assert!(!names.contains(&"probe_peak".to_owned()), "{names:?}");
        let lacks: Vec<Lack> = found.iter().map(|one| one.lacks).collect();
        assert_eq!(lacks, [Lack::Torque, Lack::Friction]);
        assert_eq!(found[1].metrics, names);
        assert!(found[0].metrics.is_empty());
        // A friction within the band hides only a part of it.
        let (names, found) = not_judged(&[touch(0, 0.2)]);
        assert_eq!((names.len(), found.len()), (0, 1));
    }

    #[test]
    fn a_device_that_is_not_described_changes_nothing() {
        let device = DeviceFacts {
            name: "stylus".into(),
            ..DeviceFacts::default()
        };
        assert_eq!(not_judged(&[device]), (Vec::new(), Vec::new()));
        // Nor does a device of a slot without a tool.
        assert_eq!(not_judged(&[touch(2, 9.0)]), (Vec::new(), Vec::new()));
    }
}
