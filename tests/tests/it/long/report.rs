//! The quick report, whole.

use sulcus_support::long;

use crate::report::quick_report_is_whole;

#[test]
fn a_quick_report_writes_its_page_and_its_numbers_and_all_holds() {
    if long::selected("quick-report") {
        quick_report_is_whole();
    }
}
