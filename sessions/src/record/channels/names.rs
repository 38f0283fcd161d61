//! Parts of topics from names of tools and objects.

/// Names as parts of entity paths: small letters, digits and `_`; never empty, all different.
pub(crate) fn paths<'a>(names: impl Iterator<Item = &'a str>) -> Vec<String> {
    let mut paths: Vec<String> = Vec::new();
    for name in names {
        let plain = plain(name);
        let mut path = plain.clone();
        let mut n = 1;
        while paths.contains(&path) {
            n += 1;
            path = format!("{plain}_{n}");
        }
        paths.push(path);
    }
    paths
}

fn plain(name: &str) -> String {
    let mut plain = String::with_capacity(name.len());
    for c in name.chars() {
        if c.is_ascii_alphanumeric() {
            plain.push(c.to_ascii_lowercase());
        } else if !plain.is_empty() && !plain.ends_with('_') {
            plain.push('_');
        }
    }
    let plain = plain.trim_end_matches('_');
    if plain.is_empty() {
        "unnamed".to_owned()
    } else {
        plain.to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_are_plain_and_no_two_the_same() {
        let names = ["Tooth 36", "tooth-36", "  ", "", "Zunge (ü)", "tooth 36 2"];
        assert_eq!(
            paths(names.into_iter()),
            [
                "tooth_36",
                "tooth_36_2",
                "unnamed",
                "unnamed_2",
                "zunge",
                "tooth_36_2_2"
            ]
        );
    }
}
