//! Which sites bleed after the probe has left them: those that the patient's chart says, once the floor was touched, and
//! those where a hand was so heavy that healthy tissue bleeds. Each is said once.

use serde_json::json;
use sulcus_core::Scene;
use sulcus_core::output::ForceZone;

use super::KINDS;
use super::pocket::Pocket;
use super::visit::Probe;
use crate::record::occurrence::Occurrence;

/// Force on the floor under which it was not probed, newtons.
const TOUCHED: f64 = 0.05;

/// Which sites bleed by now, by pocket and site: by inflammation, by trauma.
#[derive(Clone, Debug)]
pub struct Bleeding(Vec<[[bool; 2]; 6]>);

impl Bleeding {
    /// Nothing bleeds.
    pub fn new(pockets: usize) -> Self {
        Self(vec![[[false; 2]; 6]; pockets])
    }

    /// After a tick of a probe, whose occurrences `said` has from `first` on.
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
        // The end of the visit stands among them: tool and tick are its own.
        let Some(left) = said[first..]
            .iter()
            .find(|one| one.kind == KINDS[3])
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
                    kind: KINDS[5].into(),
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
