//! Reading of a probe from its picture: a depth behind a wall, by bands that show above the wall's edge.

use nalgebra::{Point2, Rotation3};
use sulcus_proto::display::{DisplayScene, Kind};
use sulcus_screen::gpu::{Image, Mode};
use sulcus_screen::moment::Moment;
use sulcus_screen::quality::Quality;

use crate::common::{Eye, Seeded, brightness, mean, renderer};
use crate::identity::SIZE;
use crate::scene::{BAND_MM, GUM, MIRROR, PROBE, mouth, object, tool_at};
use crate::shapes::{Shape, V};

/// Number of depths.
const DEPTHS: usize = 20;
/// Largest error of a reading, mm: half of the smallest step of a chart.
const ERROR_MM: f64 = 0.5;
/// End of the last dark band, mm from the tip; bands of one length begin at the tip with a light one.
const LAST_MM: f64 = 14.0;
/// Least difference of brightness between a dark and a light band, 255ths; shading of steel alone stays below.
const LEAST_CONTRAST: f64 = 70.0;

/// A wall of gingiva before the probe, with its edge at z = 0, and the tools of the mouth.
fn wall() -> DisplayScene {
    let mut scene = mouth();
    let shape = Shape::block(V::new(-14.0, 1.2, -16.0), V::new(14.0, 4.0, 0.0), 16);
    scene.objects = vec![object(Kind::Gingiva, 0, &shape.coloured(GUM))];
    scene
}

/// Brightness along the probe's axis and whether the wall covers it, from above downwards.
struct Profile {
    steps: Vec<(f64, bool)>,
}

impl Profile {
    /// Samples of a picture along a line, three pixels wide.
    fn new(picture: &Image, from: Point2<f64>, to: Point2<f64>) -> Self {
        let along = to - from;
        let count = along.norm().ceil() as usize;
        let across = nalgebra::Vector2::new(-along.y, along.x).normalize();
        let sample = |k: usize| {
            let at = from + along * (k as f64 / count as f64);
            let colours = [-1.0, 0.0, 1.0].map(|off| {
                let at = at + across * off;
                picture.at(at.x as u32, at.y as u32)
            });
            let [r, g, b] = mean(colours).expect("colours");
            // Steel and dark bands are grey, flesh is red.
            let is_wall = r > 1.35 * (0.5 * (g + b)) && r > 60.0;
            (colours.map(brightness).iter().sum::<f64>() / 3.0, is_wall)
        };
        Self {
            steps: (0..=count).map(sample).collect(),
        }
    }

    /// First sample of the wall with three more below.
    fn edge(&self) -> Option<usize> {
        self.steps
            .windows(4)
            .position(|four| four.iter().all(|(_, is_wall)| *is_wall))
    }

    /// Places where dark turns to light or light to dark above the wall, in samples. The border between dark and light
    /// lies halfway between the darkest and the lightest sample of the surroundings.
    fn transitions(&self, edge: usize) -> Vec<f64> {
        let bright: Vec<f64> = self.steps[..edge].iter().map(|(light, _)| *light).collect();
        let reach = 24;
        let level = |k: usize| {
            let near = &bright[k.saturating_sub(reach)..(k + reach).min(edge)];
            let low = near.iter().copied().fold(f64::INFINITY, f64::min);
            let high = near.iter().copied().fold(0.0, f64::max);
            (0.5 * (low + high), high - low)
        };
        let mut found = Vec::new();
        // The last two samples are mixed with the wall.
        for k in 1..edge.saturating_sub(2) {
            let (border, contrast) = level(k);
            let [a, b] = [bright[k - 1] - border, bright[k] - border];
            if contrast > LEAST_CONTRAST && (a < 0.0) != (b < 0.0) {
                found.push(k as f64 - 1.0 + a / (a - b));
            }
        }
        found
    }

    /// Depth behind the wall, mm: bands are counted from the highest one; the rest is measured by the last whole band.
    fn depth(&self) -> Option<f64> {
        let edge = self.edge()?;
        let transitions = self.transitions(edge);
        let last = *transitions.last()?;
        let mean = (last - transitions.first()?) / (transitions.len() - 1) as f64;
        let counted = LAST_MM - (transitions.len() - 1) as f64 * BAND_MM;
        Some(counted - (edge as f64 - last) / mean * BAND_MM)
    }
}

#[test]
fn depths_are_read_from_the_bands_to_half_a_millimetre() {
    let scene = wall();
    // The eye is level with the edge of the wall, so that the edge hides nothing above it.
    let eye = Eye::looking(V::new(30.0, 300.0, 0.0), V::new(0.0, 0.0, 0.0), 36.0, SIZE);
    for quality in [Quality::Full, Quality::Plain, Quality::Low] {
        let Some(mut renderer) = renderer(&scene, quality, Mode::Beauty) else {
            return;
        };
        let mut seeded = Seeded(20);
        let mut errors = Vec::new();
        for _ in 0..DEPTHS {
            let (depth, lean) = (seeded.within(1.0, 11.0), seeded.within(-0.2, 0.2));
            let axis = Rotation3::from_euler_angles(0.0, lean, 0.0) * V::z();
            let tip = V::new(seeded.within(-4.0, 4.0), 0.0, 0.0) - axis * depth;
            let mut moment = Moment::rest(&scene);
            moment.tools[PROBE] = tool_at(tip, &Rotation3::from_euler_angles(0.0, lean, 0.0));
            moment.tools[MIRROR].held = false;
            let picture = eye.picture(&mut renderer, &moment);
            let [from, to] = [17.0, 0.0].map(|along| eye.place(&(tip + axis * along)));
            let read = Profile::new(&picture, from, to).depth();
            errors.push(read.map_or(f64::INFINITY, |read| read - depth));
        }
        let good = errors
            .iter()
            .filter(|error| error.abs() <= ERROR_MM)
            .count();
        println!("{quality:?}: {good} of {DEPTHS} depths, errors {errors:.2?} mm");
        assert!(good + 1 >= DEPTHS, "{quality:?}: {errors:.2?}");
    }
}
