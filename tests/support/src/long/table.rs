//! The table of long proofs.

use super::Long;

const fn long(name: &'static str, proves: &'static str, minutes: f64) -> Long {
    Long {
        name,
        proves,
        minutes,
    }
}

/// Every long proof, in the order of their slices.
pub const LONG: &[Long] = &[
    long(
        "hours-at-rest",
        "A tool at rest on a plate, in a pocket and on either tongue stays within a micrometre for an hour.",
        6.0,
    ),
    long(
        "random-poses",
        "A million random poses on every tissue model give finite forces and no penetration of converged ticks.",
        5.0,
    ),
    long(
        "judged-random-poses",
        "A hundred thousand random poses hold with Clarabel in the tick.",
        5.0,
    ),
    long(
        "every-case-over-the-longest-link",
        "Every hard case is passive over a link of 5 ms with 2 % loss.",
        3.0,
    ),
    long(
        "rates",
        "Every bound of eleven hard cases holds at 2 and 4 kHz.",
        3.0,
    ),
    long(
        "a-press-at-any-rate",
        "A slow press gives the same force at 1, 2 and 4 kHz to 2 %.",
        1.0,
    ),
    long(
        "judge-in-every-case-1",
        "The first quarter of the hard cases holds with Clarabel in the tick.",
        4.0,
    ),
    long(
        "judge-in-every-case-2",
        "The second quarter of the hard cases holds with Clarabel in the tick.",
        4.0,
    ),
    long(
        "judge-in-every-case-3",
        "The third quarter of the hard cases holds with Clarabel in the tick.",
        4.0,
    ),
    long(
        "judge-in-every-case-4",
        "The fourth quarter of the hard cases holds with Clarabel in the tick.",
        4.0,
    ),
    long(
        "whole-mouths",
        "The good operator reads every floor of two whole mouths and stays outside of every tooth.",
        3.0,
    ),
    long(
        "habits-of-hands-1-to-4",
        "Every probing habit of four hands costs 15 points and is named by its own metric.",
        4.0,
    ),
    long(
        "habits-of-hands-5-to-8",
        "Every probing habit of four hands costs 15 points and is named by its own metric.",
        4.0,
    ),
    long(
        "habits-of-hands-9-to-12",
        "Every probing habit of four hands costs 15 points and is named by its own metric.",
        4.0,
    ),
    long(
        "habits-of-hands-13-to-16",
        "Every probing habit of four hands costs 15 points and is named by its own metric.",
        4.0,
    ),
    long(
        "habits-of-hands-17-to-20",
        "Every probing habit of four hands costs 15 points and is named by its own metric.",
        4.0,
    ),
    long(
        "a-tongue-let-go-by-five-hands",
        "A tongue let go by five hands costs 15 points and is named by its own metric.",
        1.5,
    ),
    long(
        "light-hands",
        "In eight mouths more than half of the good operator's readings are at 0.20 to 0.23 N, and few are heavier or lighter than 0.15 to 0.25 N.",
        3.0,
    ),
    long(
        "real-arch-sounded",
        "Sounding the meshes of a real arch finds the pocket that the data describes.",
        0.7,
    ),
    long(
        "real-arch-probed",
        "On a real arch a probe opens a pocket, reads it, walks, and is never inside a tooth.",
        1.0,
    ),
    long(
        "real-arch-explored",
        "On a real arch an explorer made from a mesh rests on the crown and is never inside.",
        0.4,
    ),
    long(
        "real-tooth",
        "The crown of a real molar is explored as smoothly as a parametric one.",
        0.5,
    ),
    long(
        "real-tongue",
        "A mirror presses a tongue made from a scan aside, and the tongue comes back.",
        1.0,
    ),
    long(
        "tree-of-a-real-tooth",
        "The tree of a real molar meets its bounds at levels 3 and 4.",
        0.8,
    ),
    long(
        "tree-of-a-real-probe",
        "The tree of a probe from a mesh meets its bounds.",
        0.4,
    ),
    long(
        "tree-of-a-real-mirror",
        "The tree of a mirror from a mesh meets its bounds.",
        0.4,
    ),
    long(
        "tree-of-a-real-tongue",
        "The tree of a real tongue with a skeleton meets its bounds.",
        0.4,
    ),
    long(
        "tree-of-a-real-pocket",
        "The tree of a real gingiva fits the walls of the pocket and leaves it open.",
        1.2,
    ),
    long(
        "trees-of-parametric-instruments",
        "The trees of the parametric probe and mirror meet their bounds.",
        0.4,
    ),
    long(
        "importance-of-places",
        "A tree has more spheres where places count more.",
        0.4,
    ),
    long(
        "pocket-wall-and-tooth",
        "The wall of a pocket beside its tooth is as stiff at level 4 as at level 3.",
        0.8,
    ),
    long(
        "pocket-wall-alone",
        "The wall of a pocket alone is as stiff at level 4 as at level 3.",
        0.8,
    ),
    long(
        "turning-in-wider-pockets",
        "A probe that turns in pockets of 0.5, 0.65 and 0.8 mm neither buzzes nor steps.",
        1.5,
    ),
    long(
        "neo-hookean-reference",
        "Large displacements of a tongue are the reference's at every vertex.",
        3.0,
    ),
    long(
        "slow-variants-of-hard-cases",
        "Wider pockets, a pocket at rest and the organ at other speeds and stiffnesses hold every bound.",
        1.0,
    ),
    long(
        "printed-in-the-narrow-pocket",
        "The method as printed buzzes and throws the probe about in a pocket where the coupled one is calm.",
        0.6,
    ),
    long(
        "fitted-skeleton",
        "Springs fitted to cases of their own meet the unseen linear ones, which others do not.",
        1.0,
    ),
    long(
        "condensed-against-finer-elements",
        "Condensed elements of the built-in tongue come near to finer ones, and springs do not.",
        0.6,
    ),
    long(
        "condensed-real-tongue",
        "A condensed real tongue is as near to linear and neo-Hookean elements as it must be.",
        0.7,
    ),
    long(
        "every-habit-replays",
        "A session with any habit replays bit for bit and differs from the good one's.",
        2.0,
    ),
    long(
        "paper-in-short",
        "Every number that the paper prints stands beside a measured one, and the measured ones agree among themselves.",
        1.0,
    ),
    long(
        "quick-report",
        "`sulcus-server report --quick` measures every part, writes page and numbers, and every case holds.",
        3.0,
    ),
    long(
        "replay-is-faster-than-the-session",
        "A replay is several times as fast as the session.",
        1.0,
    ),
    long(
        "twenty-kills",
        "Recordings of twenty killed servers recover and lose at most 200 ms.",
        3.0,
    ),
    long(
        "gaps-of-every-length",
        "A session that is cut for 1 to 20 s, or by a crash, has the grade of the uncut session.",
        5.0,
    ),
    long(
        "any-bytes",
        "Ten million messages of any bytes cause no panic; over a connection they leave the memory as it is.",
        4.0,
    ),
    long(
        "door-first-half",
        "Half a million random sequences of orders, poses, stalls and faults break no limit of the door of a hand.",
        5.0,
    ),
    long(
        "door-second-half",
        "Another half a million random sequences break no limit of the door of a hand.",
        5.0,
    ),
    long(
        "two-devices",
        "Two devices of different vendors, at 1 and 4 kHz, feel each its own force in the whole mouth, frame by frame.",
        1.5,
    ),
    long(
        "touch-in-every-case",
        "A Touch with figures that are 30 % off does not swing in the hand of a person at rest, in any hard case.",
        4.0,
    ),
    long(
        "touch-x-in-every-case",
        "A Touch X with figures that are 30 % off does not swing in the hand of a person at rest, in any hard case.",
        4.0,
    ),
    long(
        "inverse3-in-every-case",
        "An Inverse3 with figures that are 30 % off does not swing in the hand of a person at rest, in any hard case.",
        4.0,
    ),
    long(
        "premium-1.5-in-every-case",
        "A Premium 1.5 with figures that are 30 % off does not swing in the hand of a person at rest, in any hard case.",
        4.0,
    ),
    long(
        "premium-3.0-in-every-case",
        "A Premium 3.0 with figures that are 30 % off does not swing in the hand of a person at rest, in any hard case.",
        4.0,
    ),
    long(
        "twenty-pages",
        "Twenty pages of the console, a stalled and a flooding one cost no tick and no memory.",
        4.0,
    ),
    long(
        "upgrade",
        "A school of an earlier release goes on with its tickets and lists, and old sessions have the same grades.",
        6.0,
    ),
    long(
        "times-at-the-hand",
        "With ticks at the hand, half of the commands reach the hand and of the ticks the server in time on every named network.",
        1.5,
    ),
    long(
        "outage-at-the-hand",
        "Ticks at the hand go on in an outage of 20 s and are handed in after it.",
        0.6,
    ),
];
