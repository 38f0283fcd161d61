//! Exams of classes and learners: begin, end, seal, release.

use super::change::Target;
use super::record::{Exam, MOST_EXAMS, Released, Roll};
use super::{ClassError, Classes, told};
use crate::state::date;

impl Roll {
    /// Begins an exam and returns its id. The exam is sealed until its release.
    pub(super) fn begin_exam(
        &mut self,
        target: &Target,
        title: &str,
        by: &str,
        now_s: u64,
    ) -> String {
        self.last_exam += 1;
        let id = format!("e-{}", self.last_exam);
        let learners = match target {
            // Learners of the class follow.
            Target::Class(_) => Vec::new(),
            Target::Learner(learner) => vec![learner.clone()],
        };
        self.exams.push(Exam {
            id: id.clone(),
            of: target.id().to_owned(),
            title: title.to_owned(),
            learners,
            by: by.to_owned(),
            begun_unix_s: now_s,
            ended_unix_s: None,
            sealed_until_unix_s: None,
            released: None,
        });
        id
    }

    /// Ends the exams of a class or a learner: later recordings do not belong to them.
    pub(super) fn end_exams(&mut self, of: &str, now_s: u64) {
        for exam in self.exams.iter_mut().filter(|exam| exam.of == of) {
            exam.ended_unix_s.get_or_insert(now_s);
        }
    }

    /// Brings the parts into line after a change: learners who came into a class belong to its running exam.
    pub(super) fn tidy(&mut self) {
        for exam in &mut self.exams {
            if exam.ended_unix_s.is_some() {
                continue;
            }
            for learner in self.learners.iter().filter(|one| one.class == exam.of) {
                if !exam.learners.contains(&learner.id) {
                    exam.learners.push(learner.id.clone());
                }
            }
        }
        let surplus = self.exams.len().saturating_sub(MOST_EXAMS);
        self.exams.drain(..surplus);
    }
}

impl Classes {
    /// Sets the time until which instructors see only that an exam exists; `None`: until the release.
    ///
    /// # Errors
    /// No exam has the id, or its results are released.
    pub fn seal(&self, exam: &str, until_unix_s: Option<u64>) -> Result<(), ClassError> {
        self.change(|book| {
            let found = find(&mut book.roll, exam)?;
            if found.released.is_some() {
                let why = format!("the results of exam {exam} are released and cannot be sealed");
                return Err(ClassError::Invalid(why));
            }
            found.sealed_until_unix_s = until_unix_s;
            let until = until_unix_s.map_or("its release".into(), date::minute);
            Ok(((), vec![("seal exam", format!("{exam} until {until}"))]))
        })
    }

    /// Releases the results of an exam to its learners, for good.
    ///
    /// # Errors
    /// No exam has the id, or the exam is still the present task.
    pub fn release(&self, exam: &str, now_s: u64) -> Result<(), ClassError> {
        self.change(|book| {
            let found = find(&mut book.roll, exam)?;
            if found.ended_unix_s.is_none() {
                let why = format!(
                    "exam {exam} is still the present plan; give the class or the learner another plan first"
                );
                return Err(ClassError::Invalid(why));
            }
            let by = self.by.clone();
            found.released.get_or_insert(Released { unix_s: now_s, by });
            Ok(((), vec![("release exam", exam.to_owned())]))
        })
    }
}

fn find<'a>(roll: &'a mut Roll, id: &str) -> Result<&'a mut Exam, ClassError> {
    let found = roll.exams.iter_mut().find(|exam| exam.id == id);
    found.ok_or_else(|| ClassError::Unknown(format!("no exam has the id `{}`", told(id))))
}
