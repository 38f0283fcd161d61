//! Renderers on any adapter, seeded numbers, statistics of pictures.

use nalgebra::Point2;
use sulcus_proto::display::DisplayScene;
use sulcus_screen::camera::{Camera, Vector};
use sulcus_screen::gpu::{Backend, Drawing, Graphics, Image, Mode, Renderer};
use sulcus_screen::moment::Moment;
use sulcus_screen::quality::Quality;
use sulcus_screen::stage::Stage;
use sulcus_support::Resource;

use crate::shapes::V;

/// Device of any adapter; `None` without one, with a line on the terminal.
pub fn graphics() -> Option<Graphics> {
    Resource::Adapter.or_skip(Graphics::headless(Backend::Any).map_err(|error| error.to_string()))
}

/// Drawer of a scene.
pub fn renderer(scene: &DisplayScene, quality: Quality, mode: Mode) -> Option<Renderer> {
    // Identity pictures are compared with the meshes of the scene.
    let thinned_um = match mode {
        Mode::Beauty => quality.looks().thinned_um,
        Mode::Identity => 0,
    };
    let stage = Stage::new(scene, thinned_um);
    Some(Renderer::new(graphics()?, stage, quality, mode))
}

/// Camera given by the corners of its glass (lower left, lower right, upper left) and its eye.
#[derive(Clone, Copy)]
pub struct Eye {
    pub glass: [V; 3],
    pub eye: V,
    pub mirrored: bool,
    pub size: [u32; 2],
}

impl Eye {
    /// Eye before the middle of a glass of a height, square to it.
    pub fn looking(eye: V, target: V, height: f64, size: [u32; 2]) -> Self {
        let back = (eye - target).normalize();
        let right = V::z().cross(&back).normalize() * (height * 0.5);
        let up = back.cross(&right);
        let right = right * (f64::from(size[0]) / f64::from(size[1]));
        Self {
            glass: [
                target - right - up,
                target + right - up,
                target - right + up,
            ],
            eye,
            mirrored: false,
            size,
        }
    }

    pub fn camera(&self) -> Camera {
        let mut camera = Camera::through(self.glass, self.eye);
        camera.mirrored = self.mirrored;
        camera
    }

    pub fn drawing(&self) -> Drawing {
        Drawing::through(self.camera())
    }

    pub fn picture(&self, renderer: &mut Renderer, moment: &Moment) -> Image {
        renderer
            .picture(&self.drawing(), moment, self.size)
            .expect("a picture")
    }

    /// Direction from the eye through a place of the picture, in pixels from the upper left corner.
    pub fn through(&self, at: Point2<f64>) -> V {
        let [low, right, high] = self.glass;
        let [w, h] = self.size.map(f64::from);
        let x = if self.mirrored { w - at.x } else { at.x } / w;
        let point = low + (right - low) * x + (high - low) * (1.0 - at.y / h);
        (point - self.eye).normalize()
    }

    /// Place of a point in the picture, pixels.
    pub fn place(&self, point: &Vector) -> Point2<f64> {
        let [low, right, high] = self.glass;
        let [w, h] = self.size.map(f64::from);
        let (u, v) = (right - low, high - low);
        let normal = u.cross(&v);
        let ray = point - self.eye;
        let on = self.eye + ray * (normal.dot(&(low - self.eye)) / normal.dot(&ray)) - low;
        let (x, y) = (on.dot(&u) / u.norm_squared(), on.dot(&v) / v.norm_squared());
        Point2::new(if self.mirrored { 1.0 - x } else { x } * w, (1.0 - y) * h)
    }

    /// Pixels that a length in the plane of the glass covers.
    pub fn pixels(&self, mm: f64) -> f64 {
        mm * f64::from(self.size[1]) / (self.glass[2] - self.glass[0]).norm()
    }
}

/// Numbers of a seed (Steele, Lea, Flood, "Fast splittable pseudorandom number generators", 2014).
pub struct Seeded(pub u64);

impl Seeded {
    /// Number from 0 to 1, without 1.
    pub fn share(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Number from `low` to `high`.
    pub fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.share()
    }
}

/// Colours as numbers.
pub fn rgb(colour: [u8; 4]) -> [f64; 3] {
    [0, 1, 2].map(|k| f64::from(colour[k]))
}

/// Mean of the channels, 0 to 255.
pub fn brightness(colour: [u8; 4]) -> f64 {
    rgb(colour).iter().sum::<f64>() / 3.0
}

/// Mean colour of pixels; `None` without a pixel.
pub fn mean(colours: impl IntoIterator<Item = [u8; 4]>) -> Option<[f64; 3]> {
    let (mut sum, mut count) = ([0.0; 3], 0.0);
    for colour in colours {
        let colour = rgb(colour);
        sum = [0, 1, 2].map(|k| sum[k] + colour[k]);
        count += 1.0;
    }
    (count > 0.0).then(|| sum.map(|x| x / count))
}

/// Pixels of two pictures of one size: column, row, both colours.
pub fn pairs<'a>(
    a: &'a Image,
    b: &'a Image,
) -> impl Iterator<Item = (u32, u32, [u8; 4], [u8; 4])> + 'a {
    assert_eq!([a.width, a.height], [b.width, b.height]);
    let width = a.width;
    let pixels = (0u32..).zip(a.rgba.iter().zip(&b.rgba));
    pixels.map(move |(k, (a, b))| (k % width, k / width, *a, *b))
}
