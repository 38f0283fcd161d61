//! Bleeding of sites after the probe has left them. Sites that bleed by the patient's chart bleed after a touch of the
//! floor. Sites after a trauma bleed, too. Each cause is one event for a site.

use serde_json::json;
use sulcus_core::Scene;
use sulcus_core::output::ForceZone;

use super::kinds::{BLEEDING, LEFT_SITE};
use super::pocket::Pocket;
use super::visit::Probe;
use crate::record::occurrence::Occurrence;

/// Least force on the floor that counts as a touch, newtons.
const TOUCHED: f64 = 0.05;

/// Bleeding sites so far, by pocket and site: by inflammation, by trauma.
#[derive(Clone, Debug)]
pub struct Bleeding(Vec<[[bool; 2]; 6]>);

impl Bleeding {
    /// State without bleeding.
    pub fn new(pockets: usize) -> Self {
        Self(vec![[[false; 2]; 6]; pockets])
    }

    /// Adds events of bleeding after a tick of a probe. `said` has the tick's occurrences from `first` on.
    pub fn after(
        &mut self,
        first: usize,
        said: &mut Vec<Occurrence>,
        probe: &Probe,
        pockets: &[Pocket],
        scene: &Scene,
    ) {
        let Some(visit) = probe.ended() else {
            return;
        };
        let Some(gingiva) = pockets[visit.pocket].gingiva(scene) else {
            return;
        };
        // The end of the visit is among the occurrences and has tool and tick.
        let Some(left) = said[first..]
            .iter()
            .find(|one| one.kind == LEFT_SITE)
            .cloned()
        else {
            return;
        };
        let inflamed = gingiva.prescribed(visit.site).bleeds && visit.max_force >= TOUCHED;
        let trauma = visit.heaviest >= ForceZone::Trauma;
        let causes = [("inflammation", inflamed), ("trauma", trauma)];
        let known = &mut self.0[visit.pocket][visit.site as usize];
        for ((cause, bleeds), known) in causes.into_iter().zip(known) {
            if bleeds && !*known {
                *known = true;
                said.push(Occurrence {
                    kind: BLEEDING.into(),
                    tick: left.tick,
                    data: json!({
                        "tool": left.data["tool"],
                        "tooth": pockets[visit.pocket].fdi,
                        "site": visit.site.name(),
                        "cause": cause,
                    }),
                });
            }
        }
    }
}
