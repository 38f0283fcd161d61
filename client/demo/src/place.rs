//! Place of the ticks of a session: remark for the person.

use sulcus_connection::link::Link;
use sulcus_program::tell;

/// Tells the reason against ticks at the hand, if the client asked for them.
pub fn tell_place(link: &Link) {
    let remark = &link.hello().plan.tick_remark;
    if !remark.is_empty() {
        let remark: String = remark.chars().filter(|c| !c.is_control()).collect();
        tell!("note: the server computes the ticks: {remark}");
    }
}
