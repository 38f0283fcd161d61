//! Paths of entities.

/// Path of an entity. A name may contain any characters.
pub(crate) fn entity(root: &str, name: &str) -> String {
    let plain: String = name
        .chars()
        .map(|c| if c.is_ascii_alphanumeric() { c } else { '_' })
        .collect();
    let plain = if plain.is_empty() {
        "_".to_owned()
    } else {
        plain
    };
    format!("{root}/{plain}")
}
