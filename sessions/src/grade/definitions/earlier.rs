//! Earlier words of definitions, as recordings carry them, whose meaning is that of the present words.

/// Name of a metric, and the first 16 hexadecimal digits of the BLAKE3 of an earlier definition.
///
/// A row says that the function of the metric is the same. A change of a function deletes the rows of its metric. A
/// change of words alone adds a row.
#[rustfmt::skip]
const SAME_MEANING: [(&str, &str); 31] = [
    ("zones_charted", "7c6985287e472205"),
    ("tour_order", "f2d94abbd8a948c7"),
    ("floor_reached", "7f4fc003fa526145"),
    ("misread", "a6c39d5ae770de01"),
    ("called_exact", "54154140770eaefc"),
    ("called_within_1mm", "81062a4f83599a87"),
    ("called_bias", "950f2a292a338edd"),
    ("touches_too_light", "19c603b1aa87846f"),
    ("touches_too_heavy", "012a260a9ba91d83"),
    ("readings_held", "26fd0277ecc5a6ae"),
    ("readings_too_heavy", "e0d6a1da54a6677d"),
    ("force_in_band", "00bc83f438c2a7a2"),
    ("trauma_events", "8a9ea2f153cfcc53"),
    ("damage_events", "c7f0a1162970633c"),
    ("angle_mid", "c707f6e5caea6ee5"),
    ("angle_proximal", "dca96e9dde0c7ad5"),
    ("walking_step", "fabf23f9e9b8daa7"),
    ("withdrawals", "6108ddad321c24a6"),
    ("recession_within_1mm", "258a2fda9d10e681"),
    ("bleeding_agreement", "fea1fc8846426a47"),
    ("furcation_agreement", "fe9c35626b250fbd"),
    ("target_visible", "158e488e402e4cb2"),
    ("coordination", "d87897f0bcfab068"),
    ("mirror_force", "fe87872bbc84dbc0"),
    ("mirror_peak", "051aa0900b6a67cf"),
    ("probe_peak", "8b8295643f658350"),
    ("crown_covered", "342e8d61c92249f2"),
    ("contact_force", "02a459f4a7703c34"),
    ("smoothness", "5fdde0ed58aefa12"),
    ("path_length", "8b0a1c1dcf1aca8d"),
    ("time", "d16e336d457e1e29"),
];

/// Whether `recorded` is an earlier definition of the metric `name` with the present meaning.
pub(super) fn is_same(name: &str, recorded: &str) -> bool {
    let hash = blake3::hash(recorded.as_bytes()).to_hex();
    SAME_MEANING.contains(&(name, &hash[..16]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grade::definitions::find;

    #[test]
    fn earlier_words_belong_to_metrics_that_exist() {
        for (name, _) in SAME_MEANING {
            assert!(find(name).is_some(), "{name}");
        }
    }

    #[test]
    fn the_words_of_another_metric_have_another_meaning() {
        let words = "Largest force on the probe.";
        assert!(!is_same("probe_peak", words));
    }
}
