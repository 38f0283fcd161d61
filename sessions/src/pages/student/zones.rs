//! Zones of a session's page: reached and called depths, forces, findings.

use super::super::Look;
use crate::grade::class::Session;
use crate::grade::sites::{Finding, SiteGrade};

/// Table of the zones, as the template `student/zones.html` takes it.
pub struct Zones {
    /// Whether prescribed depths are shown.
    pub truth: bool,
    /// Whether reached depths and findings are shown. They tell how deep a pocket is, so not in an exam.
    pub reached: bool,
    /// Zones.
    pub rows: Vec<Zone>,
}

/// One zone.
pub struct Zone {
    /// Number of the tooth.
    pub tooth: String,
    /// Short name of the site.
    pub site: &'static str,
    /// Prescribed depth, mm.
    pub truth_mm: Option<f64>,
    /// Reached depth, mm.
    pub reached_mm: Option<f64>,
    /// Called depth, mm.
    pub called_mm: Option<f64>,
    /// Largest force, newtons.
    pub force_n: Option<f64>,
    /// Finding.
    pub finding: &'static str,
    /// Whether the finding is a fault.
    pub fault: bool,
}

impl Zones {
    /// Zones of a session; none without zones.
    pub fn of(session: &Session, look: &Look<'_>) -> Option<Self> {
        let sites = &session.grade.sites;
        let zone = |site: &SiteGrade| Zone {
            tooth: look.numbering.of(site.tooth),
            site: ["MB", "B", "DB", "DL", "L", "ML"][site.site as usize],
            truth_mm: site.truth_mm,
            reached_mm: site.measured_mm,
            called_mm: site.called_mm.map(f64::from),
            force_n: site.max_force_n,
            finding: in_short(site.finding),
            fault: site.finding != Finding::Right,
        };
        (!sites.is_empty()).then(|| Self {
            truth: look.truth,
            reached: !session.is_exam(),
            rows: sites.iter().map(zone).collect(),
        })
    }
}

/// Words of a finding for a narrow column.
fn in_short(finding: Finding) -> &'static str {
    match finding {
        Finding::NeverReachedFloor => "short of floor",
        Finding::Misread => "misread",
        Finding::ReadTooHeavy => "too heavy",
        Finding::NotProbed => "not probed",
        Finding::ReadTilted => "read tilted",
        Finding::Off => "over 1 mm off",
        other => other.words(),
    }
}
