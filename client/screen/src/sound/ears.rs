//! Ears for all tools of a picture.

use sulcus_proto::TOOLS;
use sulcus_proto::display::DisplayScene;

use super::ear::Ear;
use super::strike::strike;
use super::surface::Surface;
use crate::moment::Moment;
use crate::stage::MM;

/// Ears by slot.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Ears([Ear; TOOLS]);

impl Ears {
    /// Takes a picture: its time, seconds, and the force of each tool, newtons. Returns the samples of each touch that
    /// begins.
    pub fn hear(
        &mut self,
        now_s: f64,
        scene: &DisplayScene,
        moment: &Moment,
        forces: [f64; TOOLS],
    ) -> Vec<Vec<i16>> {
        let mut sounds = Vec::new();
        for (k, ear) in self.0.iter_mut().enumerate() {
            let Some(tool) = scene.tools.get(k) else {
                continue;
            };
            let at = moment.tools[k];
            let tip = at.orientation * nalgebra::Vector3::from(tool.tip) * MM + at.position;
            let tip = tip.cast::<f64>();
            let force = if at.held { forces[k] } else { 0.0 };
            let surface = ear.hear(now_s, force, &tip).zip(Surface::at(scene, &tip));
            sounds.extend(surface.map(|(speed, surface)| strike(surface, speed)));
        }
        sounds
    }
}
