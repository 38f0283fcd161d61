use std::path::Path;

use proptest::prelude::*;

use super::*;

fn parse(text: &str) -> Result<Patient, String> {
    Patient::parse(text, Path::new("p.toml")).map_err(|error| error.to_string())
}

#[test]
fn a_written_patient_is_read_and_what_is_left_out_is_healthy() {
    let patient = parse(
        "name = \"a\"\nmissing = [46]\n[[tooth]]\nfdi = 36\ndepth_mm.buccal = [5, 3, 4]\ndepth_mm.lingual = [6, 2, 7]\n",
    )
    .expect("a patient");
    let tooth = patient.tooth(36).expect("there");
    // Round the tooth: mesio-, mid-, distobuccal, then back along the lingual side.
    assert_eq!(tooth.depth_mm.round(), [5.0, 3.0, 4.0, 7.0, 2.0, 6.0]);
    assert_eq!(tooth.recession_mm, healthy_recession());
    assert_eq!(patient.tooth(31), Some(ToothChart::healthy(31)));
    assert_eq!(patient.tooth(46), None);
    assert_eq!(patient.tooth(38), None);
    assert_eq!(Sides::from_round(tooth.depth_mm.round()), tooth.depth_mm);
}

#[test]
fn what_cannot_be_is_said_with_tooth_site_value_and_range() {
    let tooth = |more: &str| format!("name = \"a\"\n[[tooth]]\nfdi = 36\n{more}\n");
    for (text, says) in [
        (
            "name = \" \"\n".to_owned(),
            "`name` is empty, expected a name",
        ),
        (
            "name = \"a\"\nmissing = [39]\n".to_owned(),
            "`missing` is 39, expected 31 to 37 or 41 to 47",
        ),
        (
            "name = \"a\"\nmissing = [36, 36]\n".to_owned(),
            "`missing` is 36 twice",
        ),
        (
            "name = \"a\"\nmissing = [36]\n[[tooth]]\nfdi = 36\n".to_owned(),
            "tooth 36 is both in `missing` and charted",
        ),
        (
            "name = \"a\"\n[[tooth]]\nfdi = 16\n".to_owned(),
            "`fdi` of a [[tooth]] is 16, of the upper jaw, expected teeth of the lower jaw",
        ),
        (
            "name = \"a\"\n[[tooth]]\nfdi = 38\n".to_owned(),
            "`fdi` of a [[tooth]] is 38, expected 31 to 37 or 41 to 47: the model has no third molars",
        ),
        (
            "name = \"a\"\nmissing = [11, 46, 25]\n".to_owned(),
            "`missing` is 11 and 25 of the upper jaw, expected teeth of the lower jaw",
        ),
        (
            tooth("depth_mm = [[3, 2, 3], [3, 2, 3]]"),
            "depth_mm: a list found",
        ),
        (
            tooth("depth_mm = { buccal = [3, 12, 3], lingual = [3, 2, 3] }"),
            "`depth_mm` of tooth 36, buccal is 12, expected 0.5 to 10 mm",
        ),
        (
            tooth("depth_mm = { buccal = [3, nan, 3], lingual = [3, 2, 3] }"),
            "`depth_mm` of tooth 36, buccal is NaN",
        ),
        (
            tooth("recession_mm = { buccal = [3, 2, 9], lingual = [3, 2, 3] }"),
            "`recession_mm` of tooth 36, distobuccal is 9",
        ),
        (
            tooth("recession_mm = { buccal = [7, 2, 3], lingual = [3, 2, 3] }"),
            "an attachment loss of at most 9 mm",
        ),
        (
            tooth("depth_mm = { buccal = [3, 2], lingual = [3, 2, 3] }"),
            "p.toml, line 4",
        ),
        (
            tooth("depht_mm = { buccal = [3, 2, 3], lingual = [3, 2, 3] }"),
            "depht_mm",
        ),
        (
            tooth("inflammation = 2"),
            "`inflammation` of tooth 36 is 2, expected 0 to 1",
        ),
        (
            tooth("furcation.buccal = 4"),
            "`furcation` of tooth 36 is 4",
        ),
        (
            tooth("furcation.buccal = 3"),
            "`furcation` of tooth 36 is 3 on one side only",
        ),
        (
            "name = \"a\"\n[[tooth]]\nfdi = 34\nfurcation.lingual = 1\n".to_owned(),
            "only molars have roots that divide",
        ),
        (tooth("mobility = 5"), "`mobility` of tooth 36 is 5"),
    ] {
        let error = parse(&text).expect_err(&text);
        assert!(error.contains(says), "{error}\nwanted: {says}");
    }
}

#[test]
fn generated_patients_are_what_they_are_called_and_the_same_every_time() {
    let mean = |condition| {
        let patients: Vec<Patient> = (1..=20).map(|seed| generate(seed, condition)).collect();
        let teeth: Vec<&ToothChart> = patients.iter().flat_map(|p| &p.teeth).collect();
        let sites = 6.0 * teeth.len() as f64;
        let depth: f64 = teeth.iter().flat_map(|t| t.depth_mm.round()).sum();
        let bleeding = teeth
            .iter()
            .flat_map(|t| t.bleeding.round())
            .filter(|b| *b)
            .count();
        let deepest = teeth
            .iter()
            .flat_map(|t| t.depth_mm.round())
            .fold(0.0, f64::max);
        (depth / sites, bleeding as f64 / sites, deepest)
    };
    let [healthy, gingivitis, periodontitis] = Condition::ALL.map(mean);
    assert!(
        healthy.0 < 2.5 && healthy.1 < 0.1 && healthy.2 <= 3.0,
        "{healthy:?}"
    );
    assert!(gingivitis.1 > 0.3 && gingivitis.2 <= 4.0, "{gingivitis:?}");
    assert!(
        periodontitis.0 > gingivitis.0 && periodontitis.2 >= 6.0,
        "{periodontitis:?}"
    );
    let lacking = (1..=20).filter(|s| !generate(*s, Condition::Periodontitis).missing.is_empty());
    assert!((2..=12).contains(&lacking.count()));
    assert_eq!(
        generate(7, Condition::Periodontitis),
        generate(7, Condition::Periodontitis)
    );
    assert_ne!(
        generate(7, Condition::Periodontitis).teeth,
        generate(8, Condition::Periodontitis).teeth
    );
}

proptest! {
    #[test]
    fn every_generated_patient_is_valid_and_survives_its_file(seed in any::<u64>(), which in 0..3_usize) {
        let patient = generate(seed, Condition::ALL[which]);
        prop_assert_eq!(parse(&patient.to_toml()), Ok(patient));
    }

    #[test]
    fn no_text_makes_reading_panic(text in ".{0,200}") {
        let _ = parse(&text);
    }
}
