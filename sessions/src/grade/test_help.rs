//! Shorthands for tests.

use sulcus_core::output::ForceZone;
use sulcus_core::scene::Band;
use sulcus_core::tissue::gingiva::Site;
use sulcus_core::{DisplayMesh, Params, Pose, Scene, Sphere, SphereTree, Tool, Vec3};

use super::settings::Settings;
use super::sites::{Finding, SiteGrade};
use crate::exercise::events::Standing;
use crate::exercise::events::angle::Tilt;

/// Settings of the built-in rubrics.
pub const SET: Settings = Settings {
    force_n: [0.1, 0.25],
    reached_mm: 0.5,
    misread_mm: 0.75,
    steady_mm: 1.5,
    ask_recession: false,
    ask_bleeding: false,
    ask_furcation: false,
};

/// A tip at an angle (degrees), depth (mm) and force (N), upright, 4 mm from the tooth's axis.
pub fn standing(tooth: u8, site: Site, around: f64, depth_mm: f64, force: f64) -> Standing {
    Standing {
        tooth,
        site,
        around: around.to_radians(),
        from_axis: 4e-3,
        depth: depth_mm * 1e-3,
        shown: depth_mm * 1e-3,
        force,
        zone: ForceZone::Light,
        tilt: Tilt {
            total: 0.0,
            mesiodistal: 0.0,
            buccolingual: 0.0,
        },
    }
}

/// A zone of the exercise with its prescribed, reached and called depth.
pub fn zone(site: Site, truth: f64, measured: Option<f64>, called: Option<u8>) -> SiteGrade {
    SiteGrade {
        tooth: 36,
        site,
        asked: true,
        probed: true,
        truth_mm: Some(truth),
        measured_mm: measured,
        called_mm: called,
        deepest_mm: measured,
        shown_mm: measured,
        max_force_n: Some(0.2),
        held_s: Some(1.0),
        pressed_s: Some(0.0),
        tilt_deg: Some(0.0),
        into_col_deg: None,
        tilt_right: Some(true),
        recession_truth_mm: Some(-2.0),
        recession_called_mm: None,
        bled: false,
        bleeding_called: None,
        furcation_truth: None,
        furcation_called: None,
        finding: Finding::Right,
    }
}

/// A scene with a probe and a mirror, and without objects.
pub fn empty_scene() -> Scene {
    let ball = [Sphere {
        centre: Vec3::zeros(),
        radius: 1e-4,
    }];
    let tool = |name: &str, bands: usize| Tool {
        name: name.into(),
        tree: SphereTree::over_leaves(&ball).expect("a ball"),
        level: 3,
        working_point: Vec3::zeros(),
        tip: Vec3::zeros(),
        tip_axis: -Vec3::z(),
        stiffness_n_per_m: 500.0,
        stiffness_nm_per_rad: 0.5,
        park: Pose::identity(),
        bands: vec![
            Band {
                from: 0.0,
                to: 1e-3,
                dark: true
            };
            bands
        ],
        mesh: DisplayMesh::default(),
    };
    Scene {
        name: "nothing".into(),
        source_hash: String::new(),
        params: Params::default(),
        tools: vec![tool("probe", 2), tool("mirror", 0)],
        objects: vec![],
    }
}
