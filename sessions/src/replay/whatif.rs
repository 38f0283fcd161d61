//! "What if": another solver, tissue or level in a recorded session's scene.

use std::fmt;

use sulcus_core::optimise::SolverKind;
use sulcus_core::tissue::TissueModel;
use sulcus_core::tissue::printed::as_printed;
use sulcus_core::{Scene, SceneError, TickInput};

/// What to put in place of a scene's tissues.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TissueChoice {
    /// Nothing yields.
    Rigid,
    /// Springs and gingivae by the paper's own equations, before the optimisation instead of in it. What the paper has not
    /// (a tongue by finite elements) stays.
    Printed,
}

/// What is to be different. Made from the compiled scene alone: what takes its meshes (finer trees, another organ) is for whoever
/// compiles scenes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct WhatIf {
    /// Solver in the tick.
    pub solver: Option<SolverKind>,
    /// Tissues.
    pub tissue: Option<TissueChoice>,
    /// Level at which what is rigid is touched, of those that its trees hold.
    pub level: Option<u8>,
    /// Level of detail of tissues that have more than one ([`TickInput::detail`]), throughout.
    pub detail: Option<u8>,
    /// Whether calibrated trees are touched as one smooth surface or sphere by sphere.
    pub blend: Option<bool>,
}

/// Why a scene cannot be changed so.
#[derive(Debug, thiserror::Error)]
pub enum WhatIfError {
    /// It has nothing of the kind.
    #[error("{field} is {found}, expected {expected}")]
    Field {
        /// What was asked for.
        field: &'static str,
        /// Value found.
        found: String,
        /// What it could be.
        expected: String,
    },
    /// It would not be a scene any more.
    #[error("the scene cannot be used when changed so: {0}")]
    Scene(#[from] SceneError),
}

impl WhatIf {
    /// Whether anything was asked.
    pub fn is_asked(&self) -> bool {
        *self != Self::default()
    }

    /// The scene as it would be, validated, and what was changed in words.
    ///
    /// # Errors
    /// When the scene has nothing that the change could be made to.
    pub fn applied_to(&self, scene: &Scene) -> Result<(Scene, Vec<String>), WhatIfError> {
        let mut scene = scene.clone();
        let mut said = Vec::new();
        if let Some(choice) = self.tissue {
            said.push(put_tissue(&mut scene, choice)?);
        }
        if let Some(level) = self.level {
            said.push(put_level(&mut scene, level)?);
        }
        if let Some(detail) = self.detail {
            if detail > TickInput::MAX_DETAIL {
                return field(
                    "level of detail",
                    detail,
                    format!("0 to {}", TickInput::MAX_DETAIL),
                );
            }
            said.push(format!("tissues at level of detail {detail}"));
        }
        if let Some(blend) = self.blend {
            said.push(put_blend(&mut scene, blend)?);
        }
        if let Some(solver) = self.solver {
            scene.params.solver = solver;
            said.push(format!("solver {}", Named(solver)));
        }
        scene.validate()?;
        Ok((scene, said))
    }

    /// Whether a state of the recorded scene is one of the changed scene, too: in another geometry, or tissue that yields otherwise, a tool
    /// may be inside of what it lay against, and comes from nowhere out of it.
    pub fn keeps_states(&self) -> bool {
        self.tissue.is_none() && self.level.is_none() && self.blend.is_none()
    }

    /// The input as it would be.
    pub fn input(&self, input: &TickInput) -> TickInput {
        TickInput {
            detail: self.detail.unwrap_or(input.detail),
            ..*input
        }
    }
}

fn field<T>(field: &'static str, found: impl ToString, expected: String) -> Result<T, WhatIfError> {
    Err(WhatIfError::Field {
        field,
        found: found.to_string(),
        expected,
    })
}

fn put_tissue(scene: &mut Scene, choice: TissueChoice) -> Result<String, WhatIfError> {
    let before: Vec<TissueModel> = scene.objects.iter().map(|o| o.tissue.clone()).collect();
    match choice {
        TissueChoice::Rigid => scene
            .objects
            .iter_mut()
            .for_each(|object| object.tissue = TissueModel::Rigid),
        TissueChoice::Printed => as_printed(scene),
    }
    let changed = scene.objects.iter().zip(&before);
    let changed = changed
        .filter(|(object, before)| object.tissue != **before)
        .count();
    let (name, expected) = match choice {
        TissueChoice::Rigid => ("rigid", "a scene in which something yields"),
        TissueChoice::Printed => ("as printed", "a scene with springs or gingivae"),
    };
    if changed == 0 {
        return field("tissue", name, expected.to_owned());
    }
    Ok(format!("{changed} of {} objects {name}", before.len()))
}

fn put_level(scene: &mut Scene, level: u8) -> Result<String, WhatIfError> {
    let rigid = || {
        scene
            .objects
            .iter()
            .filter(|object| object.tissue.is_rigid())
    };
    let deepest = rigid().map(|object| object.tree.depth()).max();
    if deepest.is_none_or(|deepest| level > deepest) {
        let expected = deepest.map_or_else(
            || "a scene in which something is rigid".to_owned(),
            |deepest| format!("0 to {deepest}, the levels that the recorded trees hold"),
        );
        return field("level", level, expected);
    }
    let mut changed = 0;
    // (A gingiva's data is that of its own level; a tongue's level is its springs'.)
    for object in scene.objects.iter_mut().filter(|o| o.tissue.is_rigid()) {
        let to = level.min(object.tree.depth());
        changed += u32::from(object.level != to);
        object.level = to;
    }
    if changed == 0 {
        let expected = "another level than what is rigid was recorded at";
        return field("level", level, expected.to_owned());
    }
    Ok(format!("{changed} rigid objects at level {level}"))
}

fn put_blend(scene: &mut Scene, blend: bool) -> Result<String, WhatIfError> {
    let lengths = |scene: &Scene| -> Vec<f64> {
        (0..scene.objects.len())
            .map(|k| scene.blend_of(k))
            .collect()
    };
    let before = lengths(scene);
    scene.params.blend = blend;
    let (name, said, expected) = if blend {
        (
            "on",
            "blended surfaces",
            "a scene in which calibrated trees are touched sphere by sphere",
        )
    } else {
        (
            "off",
            "bare spheres",
            "a scene in which something is blended",
        )
    };
    if lengths(scene) == before {
        return field("blend", name, expected.to_owned());
    }
    Ok(said.to_owned())
}

struct Named(SolverKind);

impl fmt::Display for Named {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self.0 {
            SolverKind::ActiveSet => "active-set",
            SolverKind::Clarabel => "clarabel",
        })
    }
}
