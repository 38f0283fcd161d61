use super::*;

#[test]
fn every_shipped_model_is_valid_and_states_the_source_of_each_figure() {
    let all = shipped().expect("valid");
    assert_eq!(all.len(), 18);
    for model in &all {
        let text = model.to_toml().expect("TOML");
        assert_eq!(DeviceModel::from_toml(&text).as_ref(), Ok(model));
        assert!(!model.reported_as.is_empty(), "{}", model.name);
        let figures = text.matches("source = ").count();
        let origins = text.matches("from = \"").count();
        assert!(figures >= 10 && figures == origins, "{}", model.name);
        assert!(!text.contains("from = \"\""), "{}", model.name);
        // No device of the house exists: nothing may count as measured.
        assert!(!text.contains("measured\""), "{}", model.name);
    }
}

#[test]
fn a_model_is_found_by_the_name_that_its_library_reports() {
    let touch = shipped_for("openhaptics", "phantom omni ").expect("a Touch");
    assert_eq!(touch.name, "Touch");
    assert_eq!(shipped_for("haply", "Touch"), None);
    assert_eq!(shipped_for("openhaptics", "Unheard Of"), None);
}

#[test]
fn an_invalid_file_names_field_value_and_range() {
    let text = shipped_for("openhaptics", "Touch")
        .and_then(|touch| touch.to_toml().ok())
        .expect("a Touch");
    let with = |from: &str, to: &str| {
        assert!(text.contains(from), "{from}");
        DeviceModel::from_toml(&text.replacen(from, to, 1))
            .expect_err("refused")
            .to_string()
    };
    assert_eq!(
        with("value = 3.3", "value = nan"),
        "peak_force_n is NaN, expected 0.1 to 100"
    );
    assert_eq!(
        with("value = 0.88", "value = 4.0"),
        "continuous_force_n is 4, expected 0.05 to peak_force_n"
    );
    assert_eq!(
        with("torque_axes = 0", "torque_axes = 1"),
        "peak_torque_mnm is missing, expected a figure for a device with torque axes"
    );
    assert!(with("friction_n", "fiction_n").contains("fiction_n"));
    assert!(with("source = \"guess\"", "source = \"rumour\"").contains("rumour"));
}

/// The limits of three devices on a link of 1 kHz, by hand.
#[test]
fn the_coupling_follows_from_damping_period_and_delay() {
    let of = |library, model| shipped_for(library, model).expect("shipped");
    let touch = of("openhaptics", "Touch").coupling(1e-3, LOOP_DELAY_S, 1.0);
    // The driver's own limit is below 0.7 * 3 / (0.5 ms + 0.2 ms + 1 ms) = 1235 N/m.
    assert_eq!(touch.n_per_m, 500.0);
    assert_eq!(touch.nm_per_rad, f64::INFINITY);
    let slow = of("openhaptics", "Touch").coupling(1e-3, 0.02, 1.0);
    assert!((slow.n_per_m - 0.7 * 3.0 / 0.0215).abs() < 1e-9);
    let premium = of("openhaptics", "PHANTOM Premium 3.0 6DOF").coupling(1e-3, LOOP_DELAY_S, 1.0);
    assert!((premium.nm_per_rad - 0.3).abs() < 1e-12 && premium.n_per_m == 900.0);
    // A scale of two doubles the stiffness at the device.
    assert_eq!(
        of("openhaptics", "Touch")
            .coupling(1e-3, LOOP_DELAY_S, 2.0)
            .n_per_m,
        250.0
    );
}

#[test]
fn a_device_with_more_friction_than_force_says_so() {
    let touch = shipped_for("openhaptics", "Touch").expect("shipped");
    let remark = touch.friction_remark(0.2).expect("a remark");
    assert!(
        remark.contains("0.26 N, guess") && remark.contains("0.2 N"),
        "{remark}"
    );
    assert_eq!(touch.friction_remark(0.5), None);
    assert_eq!(
        shipped_for("haply", "inverse3").and_then(|m| m.friction_remark(0.2)),
        None
    );
}
