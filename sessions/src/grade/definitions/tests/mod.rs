//! Tests of the metrics: the words of the table, and values by hand.

mod tools;
mod words;
mod zones;

use sulcus_core::Vec3;
use sulcus_core::tissue::gingiva::Site;
use sulcus_core::tissue::gingiva::Site::*;

use super::*;
use crate::exercise::Exercise;
use crate::exercise::events::Standing;
use crate::exercise::events::call::Call;
use crate::grade::crown::Crown;
use crate::grade::evidence::Evidence;
use crate::grade::hands::Moment;
use crate::grade::settings::Settings;
use crate::grade::sites::{Finding, SiteGrade};
use crate::grade::test_help::{SET, empty_scene, standing, zone};
use crate::grade::touches::Touch;

/// Session by hand, for the values of metrics.
struct By {
    exercise: Exercise,
    evidence: Evidence,
    sites: Vec<SiteGrade>,
    calls: Vec<Call>,
    touches: Vec<Touch>,
    set: Settings,
}

impl By {
    fn hand(sites: Vec<SiteGrade>) -> Self {
        let exercise = Exercise::built_in()
            .into_iter()
            .find(|one| one.name == "bimanual")
            .expect("built in");
        Self {
            evidence: Evidence::new(&empty_scene(), &exercise),
            exercise,
            sites,
            calls: Vec::new(),
            touches: Vec::new(),
            set: SET,
        }
    }

    fn measured(&self) -> Measured<'_> {
        Measured {
            exercise: &self.exercise,
            evidence: &self.evidence,
            sites: &self.sites,
            calls: &self.calls,
            touches: &self.touches,
            smoothness: Some(-1.75),
            set: &self.set,
        }
    }

    fn value(&self, name: &str) -> Option<f64> {
        find(name)?.value(&self.measured())
    }
}

fn call(site: Site) -> Call {
    Call {
        tooth: 36,
        site,
        depth_mm: 3,
        recession_mm: None,
        bleeding: None,
        furcation: None,
    }
}
