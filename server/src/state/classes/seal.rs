//! Seal of exams: which role sees what of a recording, and from when on.

use serde::Serialize;
use sulcus_proto::Role;

use super::record::Exam;

/// Part of a recording that a person may see.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Sight {
    /// Nothing, not even that the recording exists.
    Nothing,
    /// The existence of the exam and of its sessions: neither the patient nor a result.
    Existence,
    /// Everything.
    All,
}

/// A recording about which a person asks.
#[derive(Clone, Copy, Debug)]
pub struct Asked<'a> {
    /// Whether the recording is that of the person.
    pub is_own: bool,
    /// Whether the mode of the recording is exam.
    pub is_exam: bool,
    /// The exam to which the recording belongs; `None`: no exam of a class, such as one set for a station alone.
    pub exam: Option<&'a Exam>,
}

impl Exam {
    /// Whether instructors see only that the exam exists, at a time in seconds since 1970.
    pub fn is_sealed(&self, now_s: u64) -> bool {
        self.released.is_none() && self.sealed_until_unix_s.is_none_or(|until| now_s < until)
    }
}

/// Part of a recording that a role may see at a time, seconds since 1970.
///
/// | role | practice | exam before its release | exam after its release |
/// |---|---|---|---|
/// | student | own | nothing | own |
/// | display | nothing | nothing | nothing |
/// | instructor | all | existence until the end of the seal, then all | all |
/// | examiner, admin | all | all | all |
///
/// An exam that was set for a station alone has no seal for teachers. A student never sees its results, because nobody
/// can release them.
pub fn may_see(role: Role, asked: Asked<'_>, now_s: u64) -> Sight {
    let is_released = asked.exam.is_some_and(|exam| exam.released.is_some());
    match role {
        Role::Display => Sight::Nothing,
        Role::Student if !asked.is_own => Sight::Nothing,
        Role::Student if asked.is_exam && !is_released => Sight::Nothing,
        Role::Instructor if asked.is_exam && asked.exam.is_some_and(|e| e.is_sealed(now_s)) => {
            Sight::Existence
        }
        Role::Student | Role::Instructor | Role::Examiner | Role::Admin => Sight::All,
    }
}

#[cfg(test)]
mod tests {
    use super::super::record::Released;
    use super::*;

    fn exam(sealed_until_unix_s: Option<u64>, is_released: bool) -> Exam {
        Exam {
            id: "e-1".into(),
            of: "c-1".into(),
            title: "probing".into(),
            learners: vec!["s-1".into()],
            by: "t-1".into(),
            begun_unix_s: 0,
            ended_unix_s: None,
            sealed_until_unix_s,
            released: is_released.then(|| Released {
                unix_s: 5,
                by: "t-1".into(),
            }),
        }
    }

    #[test]
    fn each_role_sees_what_the_table_says() {
        use Role::{Admin, Display, Examiner, Instructor, Student};
        use Sight::{All, Existence, Nothing};
        let sealed = exam(None, false);
        let dated = exam(Some(100), false);
        let released = exam(None, true);
        let released_early = exam(Some(100), true);
        // Exam, whether the mode is exam, time: own student, other student, display, instructor, examiner, admin.
        let table: [(Option<&Exam>, bool, u64, [Sight; 6]); 9] = [
            (None, false, 50, [All, Nothing, Nothing, All, All, All]),
            (None, true, 50, [Nothing, Nothing, Nothing, All, All, All]),
            (
                Some(&sealed),
                true,
                50,
                [Nothing, Nothing, Nothing, Existence, All, All],
            ),
            (
                Some(&sealed),
                true,
                u64::MAX,
                [Nothing, Nothing, Nothing, Existence, All, All],
            ),
            (
                Some(&dated),
                true,
                99,
                [Nothing, Nothing, Nothing, Existence, All, All],
            ),
            (
                Some(&dated),
                true,
                100,
                [Nothing, Nothing, Nothing, All, All, All],
            ),
            (
                Some(&released),
                true,
                50,
                [All, Nothing, Nothing, All, All, All],
            ),
            (
                Some(&released_early),
                true,
                50,
                [All, Nothing, Nothing, All, All, All],
            ),
            // Practice of a learner during an exam is no exam.
            (
                Some(&sealed),
                false,
                50,
                [All, Nothing, Nothing, All, All, All],
            ),
        ];
        for (row, (exam, is_exam, now_s, expected)) in table.into_iter().enumerate() {
            let columns = [
                (Student, true),
                (Student, false),
                (Display, true),
                (Instructor, false),
                (Examiner, false),
                (Admin, false),
            ];
            for ((role, is_own), expected) in columns.into_iter().zip(expected) {
                let asked = Asked {
                    is_own,
                    is_exam,
                    exam,
                };
                assert_eq!(
                    may_see(role, asked, now_s),
                    expected,
                    "row {row}, {role}, own {is_own}"
                );
            }
        }
    }
}
