//! Outlines of teeth on a chart: crown and roots. Widths are parts of half a tooth, heights are millimetres from the
//! cemento-enamel junction towards the root.

/// Kind of a tooth, by its place in the quadrant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ToothKind {
    /// Places 1 and 2.
    Incisor,
    /// Place 3.
    Canine,
    /// Places 4 and 5.
    Premolar,
    /// Places 6 to 8.
    Molar,
}

impl ToothKind {
    /// Kind of the tooth with this FDI number.
    pub fn of(fdi: u8) -> Self {
        match fdi % 10 {
            1 | 2 => Self::Incisor,
            3 => Self::Canine,
            4 | 5 => Self::Premolar,
            _ => Self::Molar,
        }
    }

    /// Width of the tooth's cell, units of the drawing.
    pub fn width(self) -> f64 {
        match self {
            Self::Incisor => 39.0,
            Self::Canine => 42.0,
            Self::Premolar => 46.0,
            Self::Molar => 60.0,
        }
    }

    /// Outline: commands of an SVG path, each with points. A point is a part of the half width, and millimetres towards
    /// the root.
    fn outline(self) -> &'static [(char, &'static [(f64, f64)])] {
        match self {
            Self::Incisor => &[
                ('M', &[(-0.62, 0.0)]),
                ('C', &[(-0.62, 5.0), (-0.3, 11.0), (0.0, 12.5)]),
                ('C', &[(0.3, 11.0), (0.62, 5.0), (0.62, 0.0)]),
                ('C', &[(0.7, -3.0), (0.82, -6.0), (0.78, -8.2)]),
                ('L', &[(-0.78, -8.2)]),
                ('C', &[(-0.82, -6.0), (-0.7, -3.0), (-0.62, 0.0)]),
            ],
            Self::Canine => &[
                ('M', &[(-0.64, 0.0)]),
                ('C', &[(-0.62, 6.0), (-0.3, 13.0), (0.0, 14.0)]),
                ('C', &[(0.3, 13.0), (0.62, 6.0), (0.64, 0.0)]),
                ('C', &[(0.8, -3.0), (0.84, -5.0), (0.7, -6.5)]),
                ('L', &[(0.0, -8.8), (-0.7, -6.5)]),
                ('C', &[(-0.84, -5.0), (-0.8, -3.0), (-0.64, 0.0)]),
            ],
            Self::Premolar => &[
                ('M', &[(-0.66, 0.0)]),
                ('C', &[(-0.62, 6.0), (-0.32, 11.5), (0.0, 13.0)]),
                ('C', &[(0.32, 11.5), (0.62, 6.0), (0.66, 0.0)]),
                ('C', &[(0.84, -2.0), (0.86, -5.0), (0.66, -6.2)]),
                ('Q', &[(0.3, -8.4), (0.0, -7.2)]),
                ('Q', &[(-0.3, -8.4), (-0.66, -6.2)]),
                ('C', &[(-0.86, -5.0), (-0.84, -2.0), (-0.66, 0.0)]),
            ],
            Self::Molar => &[
                ('M', &[(-0.74, 0.0)]),
                ('C', &[(-0.78, 5.0), (-0.7, 11.0), (-0.5, 12.5)]),
                ('C', &[(-0.28, 11.5), (-0.18, 7.0), (0.0, 3.6)]),
                ('C', &[(0.18, 7.0), (0.28, 11.5), (0.5, 12.5)]),
                ('C', &[(0.7, 11.0), (0.78, 5.0), (0.74, 0.0)]),
                ('C', &[(0.9, -2.0), (0.9, -4.6), (0.74, -5.8)]),
                ('Q', &[(0.46, -7.6), (0.24, -6.2)]),
                ('Q', &[(0.0, -7.6), (-0.24, -6.2)]),
                ('Q', &[(-0.46, -7.6), (-0.74, -5.8)]),
                ('C', &[(-0.9, -4.6), (-0.9, -2.0), (-0.74, 0.0)]),
            ],
        }
    }

    /// Outline as an SVG path about `x` with the half width `half`. `cej` is the height of the cemento-enamel junction,
    /// `up` the direction of the root (-1 up the page, 1 down), `mm` the length of a millimetre.
    pub fn path(self, (x, half): (f64, f64), cej: f64, up: f64, mm: f64) -> String {
        let mut path = String::new();
        for (command, points) in self.outline() {
            path.push(*command);
            for (k, (along, root)) in points.iter().enumerate() {
                let gap = if k == 0 { "" } else { " " };
                path += &format!("{gap}{:.1},{:.1}", x + along * half, cej + up * root * mm);
            }
        }
        path + "Z"
    }
}

/// Place of a molar's furcation, millimetres from the cemento-enamel junction towards the root.
pub const FURCATION_MM: f64 = 4.4;
