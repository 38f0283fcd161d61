//! Patient files and the console's chart.

use sulcus_console::house::cases::{Chart, FieldFault, Sides, ToothChart};
use sulcus_core::tissue::gingiva::Site;
use sulcus_scene::anatomy::patient::{
    Furcations, LOWER, Patient, PatientFault, Sides as OwnSides, ToothChart as OwnTooth,
};

/// Chart of a patient: every present tooth of the model.
pub(super) fn chart(patient: &Patient) -> Chart {
    let teeth = LOWER.into_iter().filter_map(|fdi| patient.tooth(fdi));
    Chart {
        label: patient.name.clone(),
        missing: patient.missing.clone(),
        teeth: teeth.map(|tooth| shown(&tooth)).collect(),
    }
}

/// Chart of a tooth.
pub(super) fn shown(tooth: &OwnTooth) -> ToothChart {
    ToothChart {
        fdi: tooth.fdi,
        depth_mm: sides(&tooth.depth_mm),
        recession_mm: sides(&tooth.recession_mm),
        bleeding: sides(&tooth.bleeding),
        inflammation: tooth.inflammation,
        furcation: [tooth.furcation.buccal, tooth.furcation.lingual],
        mobility: tooth.mobility,
    }
}

/// Patient of a chart. Ranges are not checked.
pub(super) fn patient(chart: &Chart) -> Patient {
    Patient {
        name: chart.label.clone(),
        missing: chart.missing.clone(),
        teeth: chart.teeth.iter().map(own).collect(),
    }
}

fn own(tooth: &ToothChart) -> OwnTooth {
    OwnTooth {
        fdi: tooth.fdi,
        depth_mm: own_sides(&tooth.depth_mm),
        recession_mm: own_sides(&tooth.recession_mm),
        bleeding: own_sides(&tooth.bleeding),
        inflammation: tooth.inflammation,
        furcation: Furcations {
            buccal: tooth.furcation[0],
            lingual: tooth.furcation[1],
        },
        mobility: tooth.mobility,
    }
}

fn sides<T: Copy>(sides: &OwnSides<T>) -> Sides<T> {
    Sides {
        buccal: sides.buccal,
        lingual: sides.lingual,
    }
}

fn own_sides<T: Copy>(sides: &Sides<T>) -> OwnSides<T> {
    OwnSides {
        buccal: sides.buccal,
        lingual: sides.lingual,
    }
}

/// Fault with its place in the form.
pub(super) fn fault(fault: &PatientFault) -> FieldFault {
    FieldFault {
        fdi: fault.fdi,
        site: fault.site.map(place),
        key: fault.key.to_owned(),
        text: fault.to_string(),
    }
}

/// Side of a site, and its place on the side.
fn place(site: Site) -> (&'static str, u8) {
    match site {
        Site::MesioBuccal => ("buccal", 0),
        Site::Buccal => ("buccal", 1),
        Site::DistoBuccal => ("buccal", 2),
        Site::MesioLingual => ("lingual", 0),
        Site::Lingual => ("lingual", 1),
        Site::DistoLingual => ("lingual", 2),
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use sulcus_scene::anatomy::patient::{Condition, generate};

    use super::*;
    use crate::cases::edit::is_same;

    proptest! {
        #[test]
        fn a_patient_survives_the_form_and_its_json(
            seed in any::<u64>(), condition in 0_usize..3, lost in 0_usize..14, third in any::<bool>(),
        ) {
            let mut before = generate(seed, Condition::ALL[condition]);
            let lost = LOWER[lost];
            before.teeth.retain(|tooth| tooth.fdi != lost);
            before.missing.retain(|fdi| *fdi != lost);
            before.missing.push(lost);
            if third {
                before.missing.push(38);
            }
            let json = serde_json::to_vec(&chart(&before)).expect("a chart");
            let read = Chart::parse(&json).expect("own form");
            let after = patient(&read);
            prop_assert!(is_same(&before, &after), "{before:?} {after:?}");
        }
    }

    #[test]
    fn a_tooth_without_an_entry_is_shown_healthy_and_stays_without_one() {
        let before = Patient::healthy("one");
        let shown = chart(&before);
        assert_eq!(shown.teeth.len(), LOWER.len());
        let text = crate::cases::edit::edited(&before.to_toml(), &patient(&shown));
        assert_eq!(text.as_deref(), Some(before.to_toml().as_str()));
    }

    #[test]
    fn each_site_has_its_own_place() {
        let mut all = Site::ALL.map(place).to_vec();
        all.sort_unstable();
        all.dedup();
        assert_eq!(all.len(), 6);
        for site in Site::ALL {
            let (side, k) = place(site);
            assert!(site.name().ends_with(side), "{}", site.name());
            assert_eq!(site.is_proximal(), k != 1, "{}", site.name());
        }
    }
}
