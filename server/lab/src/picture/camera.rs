//! Where a picture is taken from: orthographic, so that lengths can be read off.

use sulcus_core::Vec3;
use sulcus_core::math::{fmax, fmin};

/// A side to look from.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Side {
    /// For file names.
    pub(crate) name: &'static str,
    /// For people.
    pub(crate) caption: &'static str,
    /// From the object to the eye.
    towards: [f64; 3],
    /// What is up in the picture.
    up: [f64; 3],
}

/// The three sides of a report, in the frame of the mouth: x anterior, y to the patient's left, z up.
pub(crate) const SIDES: [Side; 3] = [
    Side {
        name: "front",
        caption: "from the front (looking along −x)",
        towards: [1.0, 0.0, 0.0],
        up: [0.0, 0.0, 1.0],
    },
    Side {
        name: "left",
        caption: "from the patient's left (along −y)",
        towards: [0.0, 1.0, 0.0],
        up: [0.0, 0.0, 1.0],
    },
    Side {
        name: "above",
        caption: "from above (along −z)",
        towards: [0.0, 0.0, 1.0],
        up: [1.0, 0.0, 0.0],
    },
];

/// Left teeth from the tongue.
pub(crate) const LEFT_LINGUAL: Side = Side {
    name: "left-lingual",
    caption: "the left teeth from the tongue, from above the right shoulder",
    towards: [0.25, -0.72, 0.648],
    up: [-0.2128, 0.6127, 0.7611],
};

/// Left teeth from the cheek.
pub(crate) const LEFT_BUCCAL: Side = Side {
    name: "left-buccal",
    caption: "the left teeth from the cheek, from above",
    towards: [0.45, 0.65, 0.6124],
    up: [-0.3486, -0.5035, 0.7906],
};

/// Right teeth from the tongue.
pub(crate) const RIGHT_LINGUAL: Side = Side {
    name: "right-lingual",
    caption: "the right teeth from the tongue, from above the left shoulder",
    towards: [0.25, 0.72, 0.648],
    up: [-0.2128, -0.6127, 0.7611],
};

/// Right teeth from the cheek.
pub(crate) const RIGHT_BUCCAL: Side = Side {
    name: "right-buccal",
    caption: "the right teeth from the cheek, from above",
    towards: [0.45, -0.65, 0.6124],
    up: [-0.3486, 0.5035, 0.7906],
};

/// Sides from which a mouth is looked at.
pub(crate) const MOUTH: [Side; 5] = [SIDES[0], SIDES[1], SIDES[2], LEFT_LINGUAL, LEFT_BUCCAL];

/// An orthographic camera and its picture's size.
#[derive(Clone, Debug)]
pub(crate) struct Camera {
    pub(crate) right: Vec3,
    pub(crate) up: Vec3,
    pub(crate) towards: Vec3,
    pub(super) centre: Vec3,
    /// Length of a pixel, metres.
    pub(crate) pixel: f64,
    /// Pixels.
    pub(crate) width: usize,
    /// Pixels.
    pub(crate) height: usize,
}

impl Camera {
    /// Sees the box `low` to `high` (metres) from a side, a pixel being `pixel` metres.
    pub(crate) fn new(side: &Side, low: &Vec3, high: &Vec3, pixel: f64) -> Self {
        let (towards, up) = (Vec3::from(side.towards), Vec3::from(side.up));
        // Square to one another, whatever rounding the table has.
        let towards = towards.normalize();
        let right = up.cross(&towards).normalize();
        let up = towards.cross(&right);
        let extent = |axis: &Vec3| axis.abs().dot(&(high - low));
        let pixels = |axis: &Vec3| (extent(axis) / pixel).ceil().max(1.0) as usize;
        Self {
            width: pixels(&right),
            height: pixels(&up),
            centre: (low + high) * 0.5,
            right,
            up,
            towards,
            pixel,
        }
    }

    /// Column and row (pixels, from the upper left corner; the middle of the first pixel is 0.5) and
    /// distance towards the eye (metres) of a point.
    pub(crate) fn project(&self, point: &Vec3) -> Vec3 {
        let off = point - self.centre;
        Vec3::new(
            0.5 * self.width as f64 + off.dot(&self.right) / self.pixel,
            0.5 * self.height as f64 - off.dot(&self.up) / self.pixel,
            off.dot(&self.towards),
        )
    }

    /// The point (metres) that is seen at a column and row, at a distance towards the eye.
    pub(crate) fn unproject(&self, x: f64, y: f64, towards: f64) -> Vec3 {
        self.centre
            + self.right * ((x - 0.5 * self.width as f64) * self.pixel)
            + self.up * ((0.5 * self.height as f64 - y) * self.pixel)
            + self.towards * towards
    }
}

/// The pixels `[from, to)` of `count` whose middles are in a range.
pub(super) fn pixels(from: f64, to: f64, count: usize) -> std::ops::Range<usize> {
    let bound = |x: f64| fmin(fmax((x - 0.5).ceil(), 0.0), count as f64) as usize;
    bound(from)..bound(to)
}
