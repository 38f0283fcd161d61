//! Eye of a window: a view, turned, tilted and magnified by the person.

use sulcus_proto::display::DisplayScene;

use crate::camera::{Camera, Vector};
use crate::handed::Handed;
use crate::head::Head;
use crate::moment::Moment;
use crate::views::View;

/// Largest turn and tilt, radians, and range of the magnification.
const TURN: f64 = 2.4;
const TILT: f64 = 1.2;
const ZOOM: [f64; 2] = [0.4, 8.0];
/// Turn for a pixel of a drag, radians.
const PER_PIXEL: f64 = 0.005;
/// Share of the remaining way that a view follows its subject in a second.
const FOLLOWS: f64 = 4.0;

/// Eye.
#[derive(Clone, Debug)]
pub struct Eye {
    /// View.
    pub view: View,
    /// Tooth in the middle of the views of one tooth; `None` for the usual one.
    pub tooth: Option<u8>,
    /// Turn to the right, radians.
    pub turn: f64,
    /// Tilt upwards, radians.
    pub tilt: f64,
    /// Magnification.
    pub zoom: f64,
    /// Whether the output is flipped left to right.
    pub mirrored: bool,
    /// Hand of the operator.
    pub hand: Handed,
    /// Head of the patient.
    pub head: Head,
    /// Middle of the picture, which follows a moving subject slowly, mm.
    middle: Option<Vector>,
}

impl Eye {
    /// Eye of a view.
    pub fn new(view: View) -> Self {
        Self {
            view,
            tooth: None,
            turn: 0.0,
            tilt: 0.0,
            zoom: 1.0,
            mirrored: false,
            hand: Handed::default(),
            head: Head::default(),
            middle: None,
        }
    }

    /// Changes the view, without turn and magnification. The patient's head stays.
    pub fn choose(&mut self, view: View) {
        *self = Self {
            tooth: self.tooth,
            mirrored: self.mirrored,
            hand: self.hand,
            head: self.head,
            ..Self::new(view)
        };
    }

    /// Turns by a drag in pixels, rightwards and downwards.
    pub fn drag(&mut self, x: f64, y: f64) {
        self.turn = (self.turn - x * PER_PIXEL).clamp(-TURN, TURN);
        self.tilt = (self.tilt - y * PER_PIXEL).clamp(-TILT, TILT);
    }

    /// Magnifies by steps of a wheel; negative steps shrink.
    pub fn magnify(&mut self, steps: f64) {
        self.zoom = (self.zoom * 1.1f64.powf(steps)).clamp(ZOOM[0], ZOOM[1]);
    }

    /// Camera at an instant, `elapsed_s` seconds after the one before.
    pub fn camera(
        &mut self,
        scene: &DisplayScene,
        moment: &Moment,
        aspect: f64,
        elapsed_s: f64,
    ) -> Camera {
        let mut camera = self
            .view
            .camera_of(self.hand, scene, moment, self.tooth, aspect);
        let wanted = camera.middle();
        // A hand trembles; a picture that follows at once would tremble with it.
        let share = (FOLLOWS * elapsed_s).clamp(0.0, 1.0);
        let middle = self
            .middle
            .map_or(wanted, |middle| middle.lerp(&wanted, share));
        self.middle = Some(middle);
        camera = camera.moved(&(middle - wanted));
        camera = camera
            .orbited(self.turn, self.tilt, 1.0)
            .magnified(self.zoom);
        camera.mirrored = self.mirrored;
        self.head.seen(&camera)
    }
}
