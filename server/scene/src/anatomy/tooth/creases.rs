//! Lines of a chewing surface for a display: the surface's height and its fissures.

use super::Tooth;

/// Distance between points of a fissure, mm. Chosen.
const STEP_MM: f64 = 0.3;
/// Largest distance of a valley's bottom from the drawn groove, mm. Chosen.
const ASIDE_MM: f64 = 0.2;
/// Depth of the rounded edge of the crown under the chewing surface at which a fissure ends, mm. Chosen.
const ROUNDED_MM: f64 = 0.06;

/// Fissure of a premolar or molar, at the bottom of its valley.
#[derive(Clone, Debug, PartialEq)]
pub struct Fissure {
    /// Points along the fissure, x and y in the tooth's frame, mm, about 0.3 mm apart.
    pub points: Vec<[f64; 2]>,
    /// Whether the fissure is a supplementary one that fades towards its last point.
    pub fades: bool,
}

impl Tooth {
    /// Returns the height of the chewing surface or of the incisal edge over a point, mm. The rounding between this
    /// surface and the walls is left out.
    pub fn chewing(&self, x: f64, y: f64) -> f64 {
        let (form, size) = (self.form(), &self.size);
        let x = x * form.drawn.mesiodistal / size.mesiodistal;
        let y = y * form.drawn.buccolingual / size.buccolingual;
        self.raised((form.chewing)(x, y, self.relief))
    }

    /// Returns the fissures within the edge of the crown; none for incisors and canines.
    pub fn fissures(&self) -> Vec<Fissure> {
        let form = self.form();
        let [along, across] = [
            self.size.mesiodistal / form.drawn.mesiodistal,
            self.size.buccolingual / form.drawn.buccolingual,
        ];
        let place = |p: &[f64; 2]| [p[0] * along, p[1] * across];
        let main = form.fissures.main.iter().map(|chain| (*chain, false));
        let branches = form.fissures.branches.iter();
        main.chain(branches.map(|ends| (&ends[..], true)))
            .map(|(chain, fades)| {
                let chain: Vec<[f64; 2]> = chain.iter().map(place).collect();
                let mut points = self.settled(&chain);
                points.retain(|p| self.is_on_table(p));
                Fissure { points, fades }
            })
            .filter(|fissure| fissure.points.len() > 1)
            .collect()
    }

    /// Returns points along a chain. Points between its ends are moved across the chain to the bottom of the valley.
    fn settled(&self, chain: &[[f64; 2]]) -> Vec<[f64; 2]> {
        let mut settled = Vec::new();
        for (k, pair) in chain.windows(2).enumerate() {
            let [a, b] = [pair[0], pair[1]];
            let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
            let length = (dx * dx + dy * dy).sqrt();
            let steps = ((length / STEP_MM).ceil() as usize).max(1);
            for step in usize::from(k > 0)..=steps {
                let share = step as f64 / steps as f64;
                let at = [a[0] + dx * share, a[1] + dy * share];
                let is_end = (k == 0 && step == 0) || (k + 2 == chain.len() && step == steps);
                // Ends stay, because fissures meet there.
                let aside = if is_end {
                    0.0
                } else {
                    self.bottom(at, [-dy / length, dx / length])
                };
                settled.push([at[0] - dy / length * aside, at[1] + dx / length * aside]);
            }
        }
        settled
    }

    /// Returns how far the lowest place across a chain lies aside of it, mm.
    fn bottom(&self, at: [f64; 2], across: [f64; 2]) -> f64 {
        let height =
            |aside: f64| self.chewing(at[0] + across[0] * aside, at[1] + across[1] * aside);
        let mut best = (height(0.0), 0.0);
        for k in 1..=5 {
            for way in [1.0, -1.0] {
                let aside = way * ASIDE_MM * f64::from(k) / 5.0;
                // On a flat floor the fissure stays where it is.
                if height(aside) < best.0 - 1e-6 {
                    best = (height(aside), aside);
                }
            }
        }
        best.1
    }

    fn is_on_table(&self, p: &[f64; 2]) -> bool {
        let at = sulcus_core::Vec3::new(p[0], p[1], self.chewing(p[0], p[1]));
        self.distance(&at) < ROUNDED_MM
    }
}
