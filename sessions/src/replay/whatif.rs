//! Changes of a recorded scene for a comparison: another solver, tissue or level.

use std::fmt;

use sulcus_core::optimise::SolverKind;
use sulcus_core::tissue::TissueModel;
use sulcus_core::tissue::printed::as_printed;
use sulcus_core::{Scene, SceneError, TickInput};

/// Replacement of a scene's tissues.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TissueChoice {
    /// All tissues rigid.
    Rigid,
    /// Springs and gingivae by the paper's own equations, before the optimisation instead of in it. Tissues that the
    /// paper does not have, such as a tongue by finite elements, stay.
    Printed,
}

/// Changes of a scene, made from the compiled scene alone. Finer trees or other organs need the scene's meshes and
/// another compilation.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct WhatIf {
    /// Solver of the tick.
    pub solver: Option<SolverKind>,
    /// Model of all tissues.
    pub tissue: Option<TissueChoice>,
    /// Level of the rigid objects' sphere trees.
    pub level: Option<u8>,
    /// Level of detail of tissues with two levels ([`TickInput::detail`]).
    pub detail: Option<u8>,
    /// Whether calibrated trees are blended surfaces; otherwise they are bare spheres.
    pub blend: Option<bool>,
}

/// Reason why a scene cannot be changed.
#[derive(Debug, thiserror::Error)]
pub enum WhatIfError {
    /// The scene has nothing to which the change applies.
    #[error("{field} is {found}, expected {expected}")]
    Field {
        /// Name of the change.
        field: &'static str,
        /// Value found.
        found: String,
        /// Values expected.
        expected: String,
    },
    /// The changed scene is invalid.
    #[error("the changed scene is invalid: {0}")]
    Scene(#[from] SceneError),
}

impl WhatIf {
    /// Whether there is a change.
    pub fn is_asked(&self) -> bool {
        *self != Self::default()
    }

    /// Changed scene, validated, and the changes as text.
    ///
    /// # Errors
    /// The scene has nothing to which a change applies, or becomes invalid.
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

    /// Whether states of the recorded scene are valid in the changed scene. With another geometry or other tissue, a
    /// tool at a surface could be inside of it and could not come out.
    pub fn keeps_states(&self) -> bool {
        self.tissue.is_none() && self.level.is_none() && self.blend.is_none()
    }

    /// Changed input.
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
        TissueChoice::Rigid => ("rigid", "a scene with soft tissue"),
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
            || "a scene with a rigid object".to_owned(),
            |deepest| format!("0 to {deepest}, the levels of the recorded trees"),
        );
        return field("level", level, expected);
    }
    let mut changed = 0;
    // The data of a gingiva belong to its level, and the level of a tongue to its springs.
    for object in scene.objects.iter_mut().filter(|o| o.tissue.is_rigid()) {
        let to = level.min(object.tree.depth());
        changed += u32::from(object.level != to);
        object.level = to;
    }
    if changed == 0 {
        let expected = "another level than that of the recorded rigid objects";
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
            "a scene with calibrated trees as bare spheres",
        )
    } else {
        ("off", "bare spheres", "a scene with blended surfaces")
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
