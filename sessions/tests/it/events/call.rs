//! What a client says that was called.

use sulcus_core::tissue::gingiva::Site;
use sulcus_sessions::Occurrence;
use sulcus_sessions::exercise::events::call::Call;

use super::two_teeth::scene;

#[test]
fn a_call_is_read_with_suspicion() {
    let scene = scene();
    let call = Call {
        tooth: 36,
        site: Site::DistoLingual,
        depth_mm: 5,
        recession_mm: Some(-2),
        bleeding: Some(true),
        furcation: None,
    };
    let logged = Occurrence::parse(&call.at(77).to_string()).unwrap();
    assert_eq!(
        (logged.tick, Call::read(&logged.data, &scene)),
        (77, Ok(call))
    );
    assert_eq!(call.truth(&scene), Some(5e-3));
    // What is not called has no key, and null is as good as none.
    let depth_only = Call {
        recession_mm: None,
        bleeding: None,
        ..call
    };
    let said = r#"{"depth_mm":5,"site":"distolingual","tooth":36}"#;
    assert_eq!(depth_only.data().to_string(), said);
    let nulls =
        r#"{"depth_mm":5,"site":"distolingual","tooth":36,"bleeding":null,"recession_mm":null}"#;
    assert_eq!(
        Call::read(&serde_json::from_str(nulls).unwrap(), &scene),
        Ok(depth_only)
    );
    let read = |text: &str| Call::read(&serde_json::from_str(text).unwrap(), &scene);
    for (text, words) in [
        ("null", ["tooth is null", "FDI"]),
        ("[36]", ["tooth is null", "FDI"]),
        (
            r#"{"tooth":46,"site":"buccal","depth_mm":3}"#,
            ["tooth is 46", "gingiva here"],
        ),
        (
            r#"{"tooth":0,"site":"buccal","depth_mm":3}"#,
            ["tooth is 0", "FDI"],
        ),
        (
            r#"{"tooth":292,"site":"buccal","depth_mm":3}"#,
            ["tooth is 292", "FDI"],
        ),
        (
            r#"{"tooth":36,"site":"labial","depth_mm":3}"#,
            ["site is \"labial\"", "mesiobuccal"],
        ),
        (
            r#"{"tooth":36,"site":3,"depth_mm":3}"#,
            ["site is 3", "one of"],
        ),
        (
            r#"{"tooth":36,"site":"buccal","depth_mm":21}"#,
            ["depth_mm is 21", "0 to 20"],
        ),
        (
            r#"{"tooth":36,"site":"buccal","depth_mm":2.5}"#,
            ["depth_mm is 2.5", "whole"],
        ),
        (
            r#"{"tooth":36,"site":"buccal","depth_mm":-1}"#,
            ["depth_mm is -1", "whole"],
        ),
        (
            r#"{"tooth":36,"site":"buccal","depth_mm":1,"recession_mm":21}"#,
            ["recession_mm is 21", "-10 to 20"],
        ),
        (
            r#"{"tooth":36,"site":"buccal","depth_mm":1,"recession_mm":"2"}"#,
            ["recession_mm is \"2\"", "whole"],
        ),
        (
            r#"{"tooth":36,"site":"buccal","depth_mm":1,"bleeding":1}"#,
            ["bleeding is 1", "true, false"],
        ),
        (
            r#"{"tooth":36,"site":"buccal","depth_mm":1,"furcation":4}"#,
            ["furcation is 4", "0 to 3"],
        ),
        (
            r#"{"tooth":36,"site":"mesiobuccal","depth_mm":1,"furcation":1}"#,
            ["furcation is 1", "middle of a side"],
        ),
    ] {
        let told = read(text).unwrap_err().to_string();
        assert!(
            words.iter().all(|word| told.contains(word)),
            "{text}: {told}"
        );
    }
}

proptest::proptest! {
    #[test]
    fn whatever_a_client_says_a_call_or_nothing_comes_of_it(text in ".{0,200}") {
        if let Some(said) = Occurrence::parse(&format!("reading_called at tick 1: {text}")) {
            let _ = Call::read(&said.data, &scene());
        }
    }
}
