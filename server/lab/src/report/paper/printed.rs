//! What the paper prints, place by place: figures, tables and claims with a number.
//!
//! Wang, Shi, Liu, Zhang, Xiao: "Haptic Simulation of Organ Deformation and Hybrid Contacts in
//! Dental Operations", IEEE Transactions on Haptics, 2014. The text at hand was extracted from the
//! page: it has the captions, but neither pictures nor the cells of Tables 1 to 3. What stands only
//! there is [`Value::Unknown`]; nothing here is read off a curve, computed or filled in. Units are
//! the paper's own; beside an unknown stands the unit to report in. Quotation marks in `conditions`
//! are the paper's words.

use Value::{AtMost, Number, Range, Unknown, Words};

/// A value as the paper has it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Value {
    /// One number.
    Number(f64),
    /// From the first to the second.
    Range(f64, f64),
    /// An upper bound: "less than", "smaller than", "below", "within".
    AtMost(f64),
    /// A statement without a number of its own, shortened.
    Words(&'static str),
    /// The text at hand does not have it (it stands in a picture, or was lost, or is not printed).
    Unknown,
}

/// One printed thing.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Printed {
    /// Short kebab-case key, unique in [`PRINTED`].
    pub id: &'static str,
    /// Where: "Fig. 14", "Table 2", "section 3.2".
    pub place: &'static str,
    /// The quantity or the claim.
    pub what: &'static str,
    /// What the paper prints for it.
    pub value: Value,
    /// The paper's unit, empty where there is none.
    pub unit: &'static str,
    /// Scene and conditions as the paper states them.
    pub conditions: &'static str,
}

/// Rows `id, place, value, unit, what, conditions;` as [`Printed`].
macro_rules! printed {
    ($($id:literal, $at:literal, $value:expr, $unit:literal, $what:literal, $when:literal;)*) => {
        &[$(Printed {
            id: $id,
            place: $at,
            what: $what,
            value: $value,
            unit: $unit,
            conditions: $when,
        }),*]
    };
}

/// Everything printed, by topic, about in the order of the paper.
pub(crate) const PRINTED: &[Printed] = printed! {
    // Rates, in sections 1 and 4.
    "update-rate-khz", "section 1.2.2", Number(1.0), "kHz", "haptic loop", "a single thread";
    "multirate-loss", "section 1.2.2", Words("can lead to loss of the subtle force feeling"), "",
        "asynchronous update of constraints", "two loops; especially sliding along fine features";
    "time-step-ms", "section 4.4", Number(1.0), "ms", "time step", "one haptic cycle";

    // Sphere trees, in sections 2, 3, 5.1, 6 and 8.4.
    "skeleton-level", "section 3.1", Number(2.0), "",
        "tree level that is the skeleton", "first choice in each cycle, finer if time is left";
    "skeleton-spheres", "section 3.1", Number(64.0), "", "spheres in the skeleton", "level 2";
    "skeleton-springs", "section 3.1", Unknown, "", "springs in the skeleton", "";
    "tree-children", "Eq. 17", Number(8.0), "", "children of a parent sphere", "";
    "tree-level3-spheres", "section 8.4", Unknown, "", "spheres at level 3", "tool, gingiva";
    "tree-tongue-level", "section 8.4", Number(2.0), "", "level of the deformation model", "tongue";
    "tree-tool-level", "section 8.4", Number(3.0), "", "level of the rigid tool's tree", "";
    "tree-gingiva-level", "section 8.4", Number(3.0), "", "level of the gingiva's tree", "";
    "tree-tooth-level", "section 8.4", Unknown, "", "level of the tooth's tree", "not named";
    "tree-triangles", "section 2", Unknown, "", "triangles displayed", "\"a fine triangle mesh\"";

    // Collision and constraint counts, in section 3.2.
    "ccp-tool-speed", "section 3.2", Number(0.5), "mm/ms",
        "assumed speed of the haptic tool", "\"a person's average moving speed\"; gives d";
    "ccp-growth-mm", "section 3.2", Unknown, "mm",
        "growth d of the graphic tool's spheres", "from speed and interval; no length is printed";
    "fig4-pairs", "Fig. 4", Unknown, "",
        "intersecting pairs with and without prediction", "a picture; text: \"greatly reduces\"";
    "pairs-per-region", "section 3.2", AtMost(10.0), "",
        "contacting sphere pairs per contact region", "\"typically\", with a suitable d";
    "contact-regions", "section 3.2", AtMost(50.0), "",
        "simultaneous contact regions", "supposed, not measured";
    "constraints-max", "section 3.2", Number(500.0), "",
        "most constraint inequalities", "from the two bounds above";
    "solve-500-ms", "section 3.2", AtMost(1.0), "ms",
        "time to solve 500 constraints", "\"easily solved within 1 ms\"";

    // One dimension, in sections 4 and 8.1. Eq. 9 is garbled: read with Eq. 7 and 8; no numbers.
    "fig7-spheres", "Fig. 7", Words("at least two: one fixed, one moving"), "",
        "spheres of the 1-DoF object", "motion along X only, explicit Euler";
    "table1-mass-g", "Table 1", Number(20.0), "g", "mass m of the moving sphere", "caption";
    "table1-damping-ratio", "Table 1", Number(0.5), "", "damping ratio, extracted as z", "caption";
    "table1-coupling-n-per-m", "Table 1", Number(200.0), "N/m", "coupling stiffness kc", "caption";
    "table1-penalty-n-per-m", "Table 1", Number(5.0), "N/m", "penalty stiffness kp", "caption";
    "table1-spring-n-per-m", "Table 1", Unknown, "N/m", "spring stiffness kS", "cells are lost";
    "table1-case-count", "Table 1", Unknown, "", "number of cases", "\"several combinations\"";
    "table1-contact-velocity", "Table 1", Unknown, "mm/s", "contact velocities", "\"various\"";
    "table1-outcome", "section 8.1", Words("stable, with large or small deformation"), "",
        "outcome of the 1-DoF cases", "various contact velocities; shown by the video";
    "eq9-underdamped", "Eq. 9", Words("bc / (kS + kp)"), "s",
        "limit of the time step, r < 0", "explicit Euler, one spring; r = bc^2 - 4 (kS + kp) m";
    "eq9-critical", "Eq. 9", Words("2 sqrt(m / (kS + kp))"), "s", "limit, r = 0", "one spring";
    "eq9-overdamped", "Eq. 9", Words("4 m / (bc + sqrt(r))"), "s", "limit, r > 0", "one spring";
    "eq9-table1-limit-ms", "Eq. 9", Unknown, "ms", "limit in the cases of Table 1", "kS is lost";
    "eq9-tongue-limit-ms", "Eq. 9", Unknown, "ms",
        "limit of the time step for the tongue", "section 8.1 has kS and damping, no mass, no kp";
    "coupling-limit", "section 8.1", AtMost(0.9), "N/mm",
        "stable coupling stiffness of the device", "Phantom Premium 3.0 6DoF, as an example";
    "stiffness-ratio", "section 8.1", Words("the smaller kS/kp, the greater the deformation"), "",
        "what makes deformation large", "together with a large kc";
    "mass-raises-limit", "section 8.1", Words("a greater m"), "", "raises the limit", "given kS";

    // Gingiva, sphere update and optimisation, in sections 5 to 7.
    "fig8-sub-gingivae", "Fig. 8", Unknown, "",
        "number of sub-gingivae", "\"several\", lower jaw, segmented by hand, one per tooth";
    "gingiva-tree-levels", "section 5.1", Number(3.0), "",
        "levels of a sub-gingiva's tree", "\"e.g.\"; the finer level carries the deformation";
    "fig9-attenuation", "Fig. 9", Range(0.0, 1.0), "",
        "attenuation a of Eq. 14", "open interval, one constant for all spheres; value not printed";
    "gingiva-stiffness", "Eq. 11", Unknown, "N/mm", "stiffness kd of the gingiva", "can be tuned";
    "gingiva-penalty", "Eq. 12", Unknown, "N/mm", "penalty stiffness Kp at the gingiva", "";
    "eq15-radius", "Eq. 15", Unknown, "mm", "R of the release 2R", "neither defined nor given";
    "pocket-threshold-g", "section 5.2", Number(200.0), "g",
        "force that damages the pocket's bottom", "\"e.g.\", along the vertical, from [29]";
    "tool-unknowns", "Eq. 19", Number(6.0), "", "unknowns of the optimisation", "per tool";
    "metric-translation", "Eq. 20", Unknown, "N/mm", "kt of the diagonal G", "see [23]";
    "metric-rotation", "Eq. 20", Unknown, "N mm/rad", "kr of the diagonal G", "see [23]";
    "exact-contact", "section 7", Words("neither penetration nor perceptible separation"), "",
        "graphic tool against object", "when contact force or torque occurs";
    "no-virtual-coupling", "abstract", Words("stable without virtual coupling"), "",
        "stability of the haptic display", "configuration-based constrained optimisation";

    // Machine and devices, in section 8.
    "machine-processor", "section 8", Words("Intel Core 2"), "", "processor", "all experiments";
    "machine-clock-ghz", "section 8", Number(2.2), "GHz", "clock", "printed as 2.20";
    "machine-memory-gb", "section 8", Number(2.0), "GB", "memory", "all experiments";

    // The tongue under the tool, and against FEM, in section 8.1.
    "fig14-states", "Fig. 14", Words("local only; global; multi-region"), "",
        "states a to c of the deformation", "root and bottom layer of the tongue fixed";
    "fig14-force-n", "Fig. 14", Unknown, "N", "peak of the force curve", "curves over time";
    "fig14-torque", "Fig. 14", Unknown, "N mm", "peak of the torque curve", "curves over time";
    "fig14-indentation-mm", "Fig. 14", Unknown, "mm", "indentation of the tongue", "";
    "fig14-penetration", "section 8.1", Words("no visual penetration can be perceived"), "",
        "penetration of the tool into the tongue", "single- and multi-region contacts";
    "fig14-jump", "section 8.1", Words("no abrupt jump or vibration"), "",
        "graphic tool between two adjacent time steps", "during the whole manipulation";
    "fig15-young-kpa", "Fig. 15", Number(100.0), "kPa", "Young's modulus", "FEM, ANSYS; from [25]";
    "fig15-poisson", "Fig. 15", Number(0.49), "", "Poisson ratio", "FEM, ANSYS; from [25]";
    "fig15-spring", "Fig. 15", Number(0.5), "N/mm", "spring stiffness", "sphere model, by hand";
    "fig15-damping", "Fig. 15", Number(0.6), "Ns/mm", "damping", "sphere model, tuned by hand";
    "fig15-load-cases", "Fig. 15", Words("tip from the top; lateral side; top, distributed"), "",
        "static load cases a to c", "equal point loads in both models; root and bottom fixed";
    "fig15-load-n", "Fig. 15", Unknown, "N", "size of the static loads", "three cases";
    "fig15-displacement-mm", "Fig. 15", Unknown, "mm", "largest displacement", "three cases";
    "fig15-error-percent", "Fig. 15", AtMost(5.0), "percent",
        "geometric error of corresponding deformed points", "static; percent of what is not said";
    "fig15-case-error-percent", "Fig. 15", Unknown, "percent", "error case by case", "three cases";
    "tuned-error-percent", "section 8.4", Number(5.0), "percent", "error after tuning by hand", "";

    // The pocket, in section 8.2.
    "fig16-gap", "Fig. 16", Words("no interpenetrations or separations"), "",
        "between graphic tool and tooth or gingiva", "a: hybrid contact, b: gingiva only";
    "fig16-clearance-mm", "Fig. 16", Unknown, "mm", "clearance of the pocket", "\"small\"";
    "fig17-sequence", "Fig. 17", Words("clockwise, counter-clockwise, clockwise"), "",
        "sense of the torque in a to c", "probe slightly rotated in the pocket; follows the hand";
    "fig17-torque", "Fig. 17", Unknown, "N mm", "peak of the torque curve", "contact switches";
    "fig17-angle-deg", "Fig. 17", Unknown, "deg", "angle of turning", "\"slightly\"";
    "fig17-stable", "section 8.2", Words("stable during the whole manipulation sequence"), "",
        "force and torque feedback", "probe turned in the pocket";
    "fig18-sequence", "Fig. 18", Words("uni-lateral; bi-lateral; the same, turned; bottom"), "",
        "contact states a to d", "insertion during pocket depth measurement";
    "fig18-force-n", "Fig. 18", Unknown, "N", "force components of each state", "four states";
    "fig18-turn", "Fig. 18", Words("torque direction changes responsively, stable"), "",
        "deliberate rotation under bi-lateral contact", "b and c";
    "fig18-bottom-force", "Fig. 18", Words("an obvious force threshold can be felt"), "",
        "force at the bottom of the pocket", "no number here; section 5.2 has 200 g as an example";
    "fig18-depth-mm", "Fig. 18", Unknown, "mm", "depth of the pocket", "a target depth per pocket";

    // Times, the whole mouth: section 8.3. Table 2's row names are lost: these are section 2's.
    "table2-case1-level", "section 8.3", Number(2.0), "",
        "level of collision and optimisation, Case 1", "large deformation; skeleton at level 2";
    "table2-case2-level", "section 8.3", Number(3.0), "",
        "level of collision and optimisation, Case 2", "large deformation; skeleton at level 2";
    "table2-case1-collision-ms", "Table 2", Unknown, "ms", "collision detection", "Case 1";
    "table2-case1-deformation-ms", "Table 2", Unknown, "ms", "deformation", "Case 1";
    "table2-case1-optimisation-ms", "Table 2", Unknown, "ms", "optimisation", "Case 1";
    "table2-case2-collision-ms", "Table 2", Unknown, "ms", "collision detection", "Case 2";
    "table2-case2-deformation-ms", "Table 2", Unknown, "ms", "deformation", "Case 2";
    "table2-case2-optimisation-ms", "Table 2", Unknown, "ms", "optimisation", "Case 2";
    "fig19-stable", "Fig. 19", Words("the haptic interaction is stable"), "",
        "two tools in the whole mouth", "two Phantom Omnis; tongue and gingiva deform";
    "table3-data", "Table 3", Unknown, "",
        "data of the whole mouth", "headings and cells are lost; caption: complex oral cavity";

    // Force error of the spheres, and what the paper leaves open, in sections 8.4 and 9.
    "ripple-level2-percent", "section 8.4", AtMost(10.0), "percent",
        "force error on a curved surface, level 2", "ellipsoid, from [23]; tool not named";
    "ripple-level3-percent", "section 8.4", AtMost(5.0), "percent",
        "force error on a curved surface, level 3", "ellipsoid, from [23]; tool not named";
    "bumps-when-slow", "section 8.4", Words("small bumps may be felt"), "",
        "sliding slowly", "on the gingiva; the tongue is felt smooth when sliding fast";
    "open-multirate", "section 9", Words("one 1 kHz loop, or threads with a finer model"), "",
        "not checked: which feels more realistic", "finer: e.g. FEM; section 1.2.2 claims one loop";
    "open-finer-levels", "section 8.4", Words("deformation model of level 3 or level 4"), "",
        "planned: finer deformation in time", "by GPU; a challenge at haptic rates";
    "open-finer-stability", "section 8.4", Words("could create new instabilities"), "",
        "smaller springs with the same parameters", "explicit methods; to be considered";
    "open-pop-through", "section 9", Words("continuous collision detection"), "",
        "future work: pop-through", "thin objects";
};
