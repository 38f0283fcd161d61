use super::*;
use crate::grade::sites::Finding;
use askama::Template;

/// Chart with its key.
#[derive(Template)]
#[template(path = "chart.html")]
struct Whole {
    chart: ChartView,
}

/// Drawings of a chart.
fn drawn(chart: &Chart<'_>) -> String {
    let jaws = chart.view().jaws;
    jaws.iter().map(|jaw| jaw.markup().0).collect()
}

fn site(tooth: u8, site: Site, called: u8, recession: i8) -> SiteGrade {
    SiteGrade {
        tooth,
        site,
        asked: true,
        probed: true,
        truth_mm: Some(f64::from(called)),
        measured_mm: None,
        called_mm: Some(called),
        deepest_mm: None,
        shown_mm: None,
        max_force_n: None,
        held_s: None,
        pressed_s: None,
        tilt_deg: None,
        into_col_deg: None,
        tilt_right: None,
        recession_truth_mm: Some(f64::from(recession)),
        recession_called_mm: Some(recession),
        bled: true,
        bleeding_called: Some(true),
        furcation_truth: None,
        furcation_called: None,
        finding: Finding::Right,
    }
}

#[test]
fn the_attachment_lies_the_depth_below_the_margin_and_numbers_add_up() {
    // 5 + 3 = 8, 5 - 3 = 2 (the textbook's two examples).
    let sites = [
        site(36, Site::MesioBuccal, 5, 3),
        site(36, Site::Buccal, 5, -3),
    ];
    let chart = Chart {
        sites: &sites,
        teeth: &[36],
        patient: &PatientChart::default(),
        numbering: Numbering::Universal,
        truth: false,
    };
    let svg = drawn(&chart);
    for number in [
        ">5</text>",
        ">+3</text>",
        ">8</text>",
        ">−3</text>",
        ">2</text>",
        ">19</text>",
    ] {
        assert!(svg.contains(number), "{number}");
    }
    // The lower jaw's buccal row is the lower one, roots down: margin and attachment in the picture's own units.
    let margin_line = svg
        .split(&format!("stroke=\"{RED}\" stroke-width=\"2.4\""))
        .next()
        .unwrap_or("");
    let points = margin_line.rsplit("points=\"").next().unwrap_or("");
    let y: Vec<f64> = points
        .split(['"', ' '])
        .take(2)
        .filter_map(|point| point.split_once(',')?.1.parse().ok())
        .collect();
    assert!((y[0] - y[1] - 6.0 * MM).abs() < 0.11, "{y:?} {points}");
    assert!(!svg.contains("upper jaw"));
}

#[test]
fn no_line_is_drawn_where_nobody_said_where_the_margin_is() {
    let mut unsaid = site(36, Site::Buccal, 5, 0);
    unsaid.recession_called_mm = None;
    let svg = |sites: &[SiteGrade], truth: bool| {
        let chart = Chart {
            sites,
            teeth: &[36],
            patient: &PatientChart::default(),
            numbering: Numbering::Fdi,
            truth,
        };
        drawn(&chart)
    };
    let (red, blue) = (
        format!("stroke=\"{RED}\" stroke-width=\"2.4\""),
        format!("stroke=\"{BLUE}\" stroke-width=\"2.4\""),
    );
    let alone = svg(std::slice::from_ref(&unsaid), false);
    assert!(alone.contains(">5</text>"));
    assert!(!alone.contains(&red) && !alone.contains(&blue));
    // Between two that are known it parts them.
    let three = [
        site(36, Site::MesioBuccal, 3, -2),
        unsaid,
        site(36, Site::DistoBuccal, 3, -2),
    ];
    let parted = svg(&three, false);
    assert_eq!(parted.matches(&blue).count(), 2);
    // The blue line is the depth below the red one.
    let y = |svg: &str, colour: &str| -> f64 {
        let line = svg.split(colour).next().unwrap_or("");
        let points = line.rsplit("points=\"").next().unwrap_or("");
        let first = points.split(['"', ' ']).next().unwrap_or("");
        first
            .split_once(',')
            .and_then(|(_, y)| y.parse().ok())
            .unwrap_or(f64::NAN)
    };
    assert!((y(&parted, &blue) - y(&parted, &red) - 3.0 * MM).abs() < 0.11);
    // What is prescribed is drawn all the same, when it is asked for.
    assert!(svg(&three, true).contains("stroke=\"#000\" stroke-width=\"1.1\""));
}

#[test]
fn the_key_says_what_is_drawn_and_no_more() {
    let mut sites = [site(36, Site::Buccal, 5, -2)];
    let patient = PatientChart::read("[[tooth]]\nfdi = 36\nfurcation.buccal = 2\n");
    let says = |sites: &[SiteGrade], truth: bool| {
        let chart = Chart {
            sites,
            teeth: &[35, 36],
            patient: &patient,
            numbering: Numbering::Fdi,
            truth,
        };
        let html = Whole {
            chart: chart.view(),
        }
        .render()
        .expect("a page");
        let words = ["furcation", "dotted where", "prescribed", "nobody said"];
        let found = words.map(|word| html.contains(word));
        // Whatever the key says, the picture shows.
        assert_eq!(html.contains(" r=\"5\""), found[0]);
        found
    };
    assert_eq!(says(&sites, false), [false; 4]);
    assert_eq!(says(&sites, true), [true, true, true, false]);
    sites[0].furcation_called = Some(1);
    sites[0].recession_called_mm = None;
    assert_eq!(says(&sites, false), [true, false, false, true]);
}
