//! Both hands of a person without a force device: which hand moves, scale, clutch, and steady motions.

use nalgebra::Vector3;
use sulcus_proto::TOOLS;

use super::guide::Lead;
use super::motion::{Frame, Motion};
use super::one::Hand;
use super::pose::HandPose;

#[cfg(test)]
mod tests;

/// Device that gives steady motions, as shares of the greatest speed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Steady {
    /// Held keys.
    Keys,
    /// Cap of a 3D mouse.
    Cap,
    /// Sticks of a gamepad.
    Sticks,
}

/// Scales between input and motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scales {
    /// Translation for a count of the mouse, mm.
    pub mm_per_count: f64,
    /// Rotation for a count of the mouse, radians.
    pub rad_per_count: f64,
    /// Speed of a held key, mm/s.
    pub speed_mm_s: f64,
    /// Spin of a held key, rad/s.
    pub spin_rad_s: f64,
    /// Speed of a full deflection of a cap or a stick, in speeds of a held key.
    pub cap: f64,
    /// Share of all scales under precision.
    pub precise: f64,
}

impl Default for Scales {
    /// Chosen: 400 counts, a centimetre on the desk with a usual mouse, are 10 mm or 46 degrees. A held key moves
    /// 20 mm/s or turns 0.8 rad/s, a full cap three times that. Precision is a quarter.
    fn default() -> Self {
        Self {
            mm_per_count: 0.025,
            rad_per_count: 0.002,
            speed_mm_s: 20.0,
            spin_rad_s: 0.8,
            cap: 3.0,
            precise: 0.25,
        }
    }
}

/// Both hands, by the slots of the tools.
#[derive(Clone, Debug, PartialEq)]
pub struct Hands {
    hands: [Option<Hand>; TOOLS],
    held: [bool; TOOLS],
    chosen: usize,
    frame: Frame,
    scales: Scales,
    is_open: bool,
    is_precise: bool,
    /// Deflections of keys, cap and sticks, each number -1 to 1.
    steady: [Motion; 3],
}

impl Hands {
    /// Hands of a scene: `None` for a slot without a tool. Both hands hold their tools, the first hand is chosen, and
    /// the clutch is open.
    pub fn new(hands: [Option<Hand>; TOOLS], scales: Scales) -> Self {
        Self {
            hands,
            held: hands.map(|hand| hand.is_some()),
            chosen: hands.iter().position(Option::is_some).unwrap_or(0),
            frame: Frame::default(),
            scales,
            is_open: true,
            is_precise: false,
            steady: [Motion::none(); 3],
        }
    }

    /// Slot of the hand that moves.
    pub fn chosen(&self) -> usize {
        self.chosen
    }

    /// Chooses the next hand. The other hand stays where it is.
    pub fn choose_next(&mut self) {
        let next = (1..=TOOLS).map(|k| (self.chosen + k) % TOOLS);
        let mut with_tool = next.filter(|k| self.hands[*k].is_some());
        if let Some(next) = with_tool.next() {
            self.stop();
            self.chosen = next;
        }
    }

    /// Whether the clutch is open: motions then move nothing.
    pub fn is_open(&self) -> bool {
        self.is_open
    }

    /// Opens or closes the clutch. An opened clutch stops the hand at once.
    pub fn set_open(&mut self, open: bool) {
        if open {
            self.stop();
        }
        self.is_open = open;
    }

    /// Switches precision.
    pub fn set_precise(&mut self, precise: bool) {
        self.is_precise = precise;
    }

    /// Takes the axes of the picture.
    pub fn look(&mut self, frame: Frame) {
        self.frame = frame;
    }

    /// Takes the chosen tool up, or lays it down.
    pub fn take_or_lay(&mut self) {
        self.held[self.chosen] = !self.held[self.chosen] && self.hands[self.chosen].is_some();
    }

    /// Whether the hand of a slot holds its tool.
    pub fn is_held(&self, slot: usize) -> bool {
        self.held.get(slot).copied().unwrap_or(false)
    }

    /// Starts the way home of the chosen hand, with a closed clutch alone.
    pub fn go_home(&mut self) {
        if let Some(hand) = self.moving() {
            hand.go_home();
        }
    }

    /// Takes in a motion of the mouse, counts in the axes of the picture.
    pub fn apply(&mut self, counts: &Motion) {
        let share = self.share();
        let scaled = counts.times(
            self.scales.mm_per_count * share,
            self.scales.rad_per_count * share,
        );
        let by = self.frame.in_world(&scaled);
        if let Some(hand) = self.moving() {
            hand.apply(&by);
        }
    }

    /// Takes in the deflection of a steady device, each number -1 to 1. The deflection holds until the next call. A
    /// deflection that is not finite counts as none.
    pub fn deflect(&mut self, device: Steady, share: &Motion) {
        let clamped = |v: &Vector3<f64>| v.map(|x| x.clamp(-1.0, 1.0));
        self.steady[device as usize] = if share.is_finite() {
            Motion {
                shift: clamped(&share.shift),
                turn: clamped(&share.turn),
            }
        } else {
            Motion::none()
        };
    }

    /// Lets everything go, as a window that lost the focus must: held keys would never be released.
    pub fn let_go(&mut self) {
        self.steady = [Motion::none(); 3];
        self.is_precise = false;
        self.set_open(true);
    }

    /// Carries out the motion of a time, seconds.
    pub fn advance(&mut self, seconds: f64) {
        let [keys, cap, sticks] = &self.steady;
        let gain = self.scales.cap;
        let sum = keys.and(&cap.and(sticks).times(gain, gain));
        let share = self.share() * seconds;
        let (speed, spin) = (self.scales.speed_mm_s, self.scales.spin_rad_s);
        let by = self.frame.in_world(&sum.times(speed * share, spin * share));
        if let Some(hand) = self.moving() {
            hand.apply(&by);
        }
        for hand in self.hands.iter_mut().flatten() {
            hand.advance(seconds);
        }
    }

    /// Pose that a hand asks for; `None` for a slot without a tool.
    pub fn pose(&self, slot: usize) -> Option<HandPose> {
        Some(self.hands.get(slot)?.as_ref()?.pose())
    }

    /// Hand of a slot.
    pub fn hand(&self, slot: usize) -> Option<&Hand> {
        self.hands.get(slot)?.as_ref()
    }

    /// Pulls the target of a hand back to the bound of its tool, which is at `pose`.
    pub fn stick(&mut self, slot: usize, lead: &Lead, pose: &HandPose, graphic: &HandPose) {
        if let Some(Some(hand)) = self.hands.get_mut(slot) {
            let stuck = lead.stuck(&hand.pose(), pose, graphic, &hand.pivot());
            hand.put(&stuck);
        }
    }

    fn share(&self) -> f64 {
        if self.is_precise {
            self.scales.precise
        } else {
            1.0
        }
    }

    /// Chosen hand, with a closed clutch and a tool in it.
    fn moving(&mut self) -> Option<&mut Hand> {
        let may_move = !self.is_open && self.held[self.chosen];
        self.hands[self.chosen].as_mut().filter(|_| may_move)
    }

    fn stop(&mut self) {
        for hand in self.hands.iter_mut().flatten() {
            hand.stop();
        }
    }
}
