//! Settings over HTTP.

use serde_json::json;
use sulcus_standin_haply::{Fault, Options, Service, Version, What};

use crate::client::{ARM, Client, http, shown};

#[test]
fn the_version_is_told() {
    let service = Service::start(Options {
        version: Version::new(3, 4, 2),
        ..Options::default()
    })
    .unwrap();
    assert_eq!(
        http(service.port(), "GET", "/version", ""),
        (200, json!({"project_version": "3.4.2"}))
    );
    service
        .fault(Fault::Version {
            version: Version::V3_5,
        })
        .unwrap();
    assert_eq!(
        http(service.port(), "GET", "/version", "").1["project_version"],
        "3.5.0"
    );
    service.fault(Fault::HttpError { requests: 1 }).unwrap();
    assert_eq!(http(service.port(), "GET", "/version", "").0, 500);
    assert_eq!(http(service.port(), "GET", "/version", "").0, 200);
    let log = service.log().unwrap();
    let requests = log
        .entries
        .iter()
        .filter(|entry| matches!(entry.what, What::Http { .. }));
    assert_eq!(requests.count(), 4);
}

#[test]
fn the_force_scale_is_told_and_set() {
    let service = Service::start(Options {
        watchdog_ms: 5000.0,
        force_scale: 0.5,
        ..Options::default()
    })
    .unwrap();
    let path = "/settings/devices/force_scale";
    assert_eq!(
        http(service.port(), "GET", path, ""),
        (200, json!({"force_scale": 0.5}))
    );
    let (mut client, _) = Client::connect(&service);
    assert_eq!(shown(&client.push(1.0)), 0.5);
    assert_eq!(http(service.port(), "POST", path, "2").0, 200);
    assert_eq!(shown(&client.push(1.0)), 2.0);
    assert_eq!(
        http(service.port(), "POST", path, "{\"force_scale\": 1}").0,
        200
    );
    assert_eq!(shown(&client.push(1.0)), 1.0);
    let bare = Service::start(Options {
        bare_settings: true,
        ..Options::default()
    })
    .unwrap();
    assert_eq!(http(bare.port(), "GET", path, ""), (200, json!(1.0)));
}

#[test]
fn the_config_of_a_device_is_told_and_set() {
    let service = Service::start(Options {
        watchdog_ms: 5000.0,
        ..Options::default()
    })
    .unwrap();
    let path = |name: &str| format!("/inverse3/{ARM}/config/{name}");
    let port = service.port();
    assert_eq!(
        http(port, "GET", &path("handedness"), ""),
        (200, json!("right"))
    );
    assert_eq!(http(port, "POST", &path("handedness"), "\"left\"").0, 200);
    let body = json!({"enabled": true, "scaling_factor": 0.25}).to_string();
    assert_eq!(http(port, "POST", &path("torque_scaling"), &body).0, 200);
    assert_eq!(
        http(
            port,
            "POST",
            &path("gravity_compensation"),
            "{\"enabled\": false}"
        )
        .0,
        200
    );
    let (mut client, inventory) = Client::connect(&service);
    let config = &inventory["inverse3"][0]["config"];
    assert_eq!(config["handedness"], "left");
    assert_eq!(
        config["gravity_compensation"],
        json!({"enabled": false, "scaling_factor": 1.0})
    );
    assert_eq!(shown(&client.push(1.0)), 0.25);
    assert_eq!(http(port, "POST", &path("handedness"), "{").0, 400);
    assert_eq!(http(port, "POST", &path("colour"), "1").0, 400);
    assert_eq!(http(port, "GET", "/inverse3/FFFF/config/basis", "").0, 404);
    assert_eq!(http(port, "GET", "/nothing", "").0, 404);
    assert_eq!(http(port, "DELETE", "/version", "").0, 405);
}
