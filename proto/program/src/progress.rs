//! Progress of a long task, as lines on standard error.

use std::cell::RefCell;

use crate::tell;

/// Progress lines of one task: percentage and stage, each line once.
#[derive(Debug, Default)]
pub struct ProgressLines {
    last: RefCell<String>,
}

impl ProgressLines {
    /// Writes the stage and the completed fraction of the whole task, 0 to 1, unless the last line said the same.
    pub fn report(&self, stage: &str, fraction: f64) {
        let line = format!("{:3.0} %  {stage}", 100.0 * fraction);
        if *self.last.borrow() != line {
            tell!("{line}");
            self.last.replace(line);
        }
    }
}
