//! Note of a recovery: the metadata record that a recovered file has.

use std::collections::BTreeMap;

use crate::record::gap::Gap;
use crate::record::program::Program;

/// Name of the metadata record.
pub(crate) const METADATA: &str = "sulcus.recovered";
/// Key of the program that recovered the file.
const BY: &str = "by";
/// Key of the damaged file's ending, as text.
const WAS: &str = "was";
/// Key of the missing part, as text.
const MISSING: &str = "missing";
/// Key of the gaps, as JSON; absent without a gap.
const GAPS: &str = "gaps";

/// Note of a recovery, in pairs of key and value.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Note(pub BTreeMap<String, String>);

impl Note {
    /// Note of this program about a file with this ending, this missing part and these gaps.
    pub fn new(was: String, missing: String, gaps: &[Gap]) -> Self {
        let mut pairs = BTreeMap::from([
            (BY.to_owned(), Program::this().to_string()),
            (WAS.to_owned(), was),
            (MISSING.to_owned(), missing),
        ]);
        if !gaps.is_empty() {
            pairs.insert(GAPS.to_owned(), Gap::list(gaps));
        }
        Self(pairs)
    }

    /// Ending of the damaged file; empty without the key.
    pub fn was(&self) -> String {
        self.0.get(WAS).cloned().unwrap_or_default()
    }

    /// Missing part; empty without the key.
    pub fn missing(&self) -> String {
        self.0.get(MISSING).cloned().unwrap_or_default()
    }

    /// Listed gaps, none without a list; `None` if the list is invalid.
    pub fn gaps(&self) -> Option<Vec<Gap>> {
        match self.0.get(GAPS) {
            Some(list) => Gap::parse(list),
            None => Some(Vec::new()),
        }
    }
}
