//! Clients for download: everybody may fetch them, and no other file of the server.

use axum::http::{Method, StatusCode, header};

use crate::house::{CLIENT, Fake, request, router, run, send, text};

#[test]
fn a_station_fetches_its_client_without_a_sign_in_and_nothing_beside_it() {
    run(async {
        let router = router(&Fake::new());
        let get = |path: &str| send(&router, request(&Method::GET, path, None, ""));
        let page = text(get("/clients").await).await;
        assert!(page.contains(&format!("/clients/{CLIENT}")), "{page}");
        assert!(page.contains("apt-get install"), "{page}");
        let answer = get(&format!("/clients/{CLIENT}")).await;
        let headers = answer.headers();
        assert_eq!(headers[header::CONTENT_TYPE], "application/octet-stream");
        let disposition = headers[header::CONTENT_DISPOSITION].to_str().unwrap();
        assert!(disposition.starts_with("attachment"), "{disposition}");
        assert_eq!(text(answer).await, "program");
        for path in [
            "/clients/none",
            "/clients/sulcus-client-none",
            "/clients/..%2fclients%2fsulcus-client_1_amd64.deb",
            "/clients/sulcus-client%2f..%2f..%2fstation.key",
            "/clients/%2fetc%2fpasswd",
        ] {
            assert_eq!(get(path).await.status(), StatusCode::NOT_FOUND, "{path}");
        }
    });
}
