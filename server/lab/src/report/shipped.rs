//! The shipped scenes, each with hands that work in it.

use std::path::Path;

use sulcus_cases::mouth;
use sulcus_core::Scene;
use sulcus_operator::crown::{Crown, CrownParams};
use sulcus_operator::retraction::{Retraction, RetractionParams};
use sulcus_operator::script::Script;
use sulcus_operator::tour::Tour;
use sulcus_operator::tour_params::{TourParams, Visit};
use sulcus_scene::{BuildOptions, BuiltIn, compile_text};

/// Seed of the hands' tremor.
pub(super) const SEED: u64 = 7;

/// The hands come out of the mouth after what is measured, seconds.
const LEAVING: f64 = 8.0;

/// Makes a script that works for so many seconds.
type MakeScript = fn(&Scene, f64) -> Box<dyn Script + Send>;

/// A scene and its hands.
pub(super) struct Shipped {
    pub(super) name: &'static str,
    /// Time until the hands are at work, seconds.
    pub(super) begins: f64,
    pub(super) scene: fn() -> Scene,
    script: MakeScript,
}

impl Shipped {
    /// Hands that are at work in `scene`, this one or a changed one, until `ends`, seconds.
    pub(super) fn hands(&self, scene: &Scene, ends: f64) -> Box<dyn Script + Send> {
        (self.script)(scene, ends + LEAVING)
    }
}

/// What yields, in the order of the scenes: nothing, gingiva, a tongue of springs, one of finite elements, all of it.
pub(super) const SHIPPED: [Shipped; 5] = [
    Shipped {
        name: "crown",
        begins: 2.5,
        scene: || built_in(BuiltIn::Crown),
        script: |scene, duration| {
            let params = CrownParams {
                duration,
                ..CrownParams::default()
            };
            Box::new(Crown::new(scene, None, params).expect("a crown"))
        },
    },
    Shipped {
        name: "pocket",
        begins: 2.5,
        scene: || built_in(BuiltIn::Pocket),
        script: |scene, duration| {
            let params = TourParams {
                duration,
                ..TourParams::default()
            };
            let tour = [Visit::whole(mouth::PROBED)];
            Box::new(Tour::new(scene, &tour, params).expect("a pocket"))
        },
    },
    Shipped {
        name: "tongue",
        begins: 2.5,
        scene: || built_in(BuiltIn::Tongue),
        script: retraction,
    },
    Shipped {
        name: "organ",
        begins: 2.5,
        scene: || built_in(BuiltIn::Organ),
        script: retraction,
    },
    Shipped {
        name: "mouth",
        // The mirror comes first.
        begins: 7.0,
        scene: || super::mouth::shipped().clone(),
        script: |scene, duration| Box::new(mouth::hands(scene, duration)),
    },
];

fn built_in(which: BuiltIn) -> Scene {
    let compiled = compile_text(
        which.text(),
        Path::new("shipped.toml"),
        &BuildOptions::cached(),
        &|_, _| {},
    );
    compiled.expect("a shipped scene").scene
}

fn retraction(scene: &Scene, duration: f64) -> Box<dyn Script + Send> {
    let params = RetractionParams {
        duration,
        ..RetractionParams::default()
    };
    Box::new(Retraction::new(scene, params).expect("a tongue and a mirror"))
}
