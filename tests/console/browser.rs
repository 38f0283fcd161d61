//! A headless browser, driven through its driver on loopback.

use std::io::{BufRead, BufReader};
use std::os::unix::process::CommandExt as _;
use std::process::{Child, Command, Stdio};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use fantoccini::{Client, ClientBuilder, Locator};
use hyper_util::client::legacy::connect::HttpConnector;
use serde_json::{Value, json};
use sulcus_support::Resource;

/// Names of the driver, in the order of the attempts.
const DRIVERS: [&str; 2] = ["chromedriver", "/usr/lib/chromium-browser/chromedriver"];
/// Longest wait for anything on a page, on a busy machine.
pub const SOON: Duration = Duration::from_secs(120);

/// Lock of the browser: two browsers and their students would be more than two cores carry.
static ALONE: Mutex<()> = Mutex::new(());

/// Driver of a browser. A drop ends both.
pub struct Driver {
    _alone: MutexGuard<'static, ()>,
    process: Child,
    port: u16,
}

impl Driver {
    /// The driver, or a skip with a message where there is none.
    pub fn find() -> Option<Self> {
        Resource::Browser.or_skip(Self::start())
    }

    fn start() -> Result<Self, String> {
        let alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
        let starts = |name: &&&str| {
            let asked = Command::new(name).arg("--version").output();
            asked.is_ok_and(|ended| ended.status.success())
        };
        let name = DRIVERS.iter().find(starts);
        let name = name.ok_or("chromedriver does not start; Debian has it as chromium-driver")?;
        // A class has its browsers on other machines: here they must not take the time of the stations.
        let process = Command::new("nice")
            .args(["-n", "15", name, "--port=0"])
            .process_group(0)
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn();
        let mut process = process.map_err(|error| format!("nice does not start: {error}"))?;
        let mut lines = BufReader::new(process.stdout.take().ok_or("no output")?).lines();
        // `ChromeDriver was started successfully on port N.`
        let said = lines
            .by_ref()
            .map_while(Result::ok)
            .find(|line| line.contains("successfully on port "));
        let said = said.ok_or("chromedriver names no port")?;
        let digits: String = said
            .rsplit("on port ")
            .next()
            .unwrap_or_default()
            .chars()
            .take_while(char::is_ascii_digit)
            .collect();
        let port = digits.parse().map_err(|_| said.clone())?;
        // A pipe that nobody reads would stop the driver.
        std::thread::spawn(move || lines.for_each(drop));
        Ok(Self {
            _alone: alone,
            process,
            port,
        })
    }

    /// A new browser with a profile of its own. Names of other machines are never resolved.
    pub async fn browser(&self, is_dark: bool) -> Client {
        self.browser_with(is_dark, &["--disable-gpu"]).await
    }

    /// A new browser that draws in three dimensions, in software.
    pub async fn drawing_browser(&self) -> Client {
        let software = [
            "--use-gl=angle",
            "--use-angle=swiftshader",
            "--enable-unsafe-swiftshader",
        ];
        self.browser_with(true, &software).await
    }

    async fn browser_with(&self, is_dark: bool, more: &[&str]) -> Client {
        let scheme = if is_dark { 0 } else { 1 };
        let mut arguments = vec![
            "--headless=new",
            "--no-sandbox",
            "--disable-dev-shm-usage",
            "--ignore-certificate-errors",
            "--host-resolver-rules=MAP * ~NOTFOUND, EXCLUDE 127.0.0.1",
        ];
        arguments.extend(more);
        let scheme = format!("--blink-settings=preferredColorScheme={scheme}");
        arguments.push(&scheme);
        let wanted = json!({
            "goog:chromeOptions": { "args": arguments },
            "acceptInsecureCerts": true,
            // Milliseconds; the default of half a minute is short for a check of a page on a busy machine.
            "timeouts": { "script": 120_000 },
        });
        let Value::Object(wanted) = wanted else {
            unreachable!()
        };
        let mut builder = ClientBuilder::new(HttpConnector::new());
        builder.capabilities(wanted);
        let address = format!("http://127.0.0.1:{}", self.port);
        builder.connect(&address).await.expect("a browser")
    }
}

impl Drop for Driver {
    fn drop(&mut self) {
        // The browser is a process of the driver's group, and outlives a killed driver.
        let group = rustix::process::Pid::from_child(&self.process);
        let _ = rustix::process::kill_process_group(group, rustix::process::Signal::KILL);
        let _ = self.process.wait();
    }
}

/// Runs a test with a runtime.
pub fn run(test: impl Future<Output = ()>) {
    let runtime = tokio::runtime::Builder::new_current_thread()
        .enable_all()
        .build();
    runtime.unwrap().block_on(test);
}

/// Value of an expression on the page.
pub async fn value(page: &Client, expression: &str) -> Value {
    let script = format!("return ({expression});");
    let found = page.execute(&script, vec![]).await;
    found.unwrap_or_else(|error| panic!("{expression}: {error}"))
}

/// Waits until an expression on the page is true.
pub async fn until(page: &Client, what: &str, expression: &str) {
    until_within(page, what, expression, SOON).await;
}

/// The same with a time of its own.
pub async fn until_within(page: &Client, what: &str, expression: &str, within: Duration) {
    let begin = Instant::now();
    while value(page, expression).await != Value::Bool(true) {
        if begin.elapsed() > within {
            let text = value(page, "document.body.innerText").await;
            panic!(
                "waited in vain for {what}: {expression}\n{}",
                text.as_str().unwrap_or_default()
            );
        }
        tokio::time::sleep(Duration::from_millis(25)).await;
    }
}

/// Clicks what a selector finds.
pub async fn click(page: &Client, selector: &str) {
    let found = page.find(Locator::Css(selector)).await;
    let found = found.unwrap_or_else(|error| panic!("{selector}: {error}"));
    found
        .click()
        .await
        .unwrap_or_else(|error| panic!("{selector}: {error}"));
}

/// Types into the field that a selector finds.
pub async fn type_into(page: &Client, selector: &str, text: &str) {
    let found = page.find(Locator::Css(selector)).await;
    found.unwrap().send_keys(text).await.unwrap();
}

/// Opens the console and signs in with a ticket.
pub async fn sign_in(page: &Client, console: &str, ticket: &str) {
    page.goto(&format!("https://{console}/")).await.unwrap();
    type_into(page, "#token", ticket).await;
    click(page, "#by-ticket button").await;
    until(
        page,
        "the page of the stations",
        "document.querySelector('#stations') !== null",
    )
    .await;
}

/// Requests of the page that left its origin.
pub async fn foreign_requests(page: &Client) -> Value {
    let script = "performance.getEntriesByType('resource').map((entry) => entry.name).filter((name) => !name.startsWith(location.origin + '/'))";
    value(page, script).await
}
