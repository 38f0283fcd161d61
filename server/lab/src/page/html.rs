//! The words and tables of the page.

use std::fmt::Write;

use sulcus_program::PathText;
use sulcus_scene::error::{LevelError, Spread};

use super::gallery::{Galleries, Gallery, Picture};
use super::scale::round_up;
use super::{LevelErrors, Subject, chart};

pub(super) const STYLE: &str = "
:root{color-scheme:light}
body{font:16px/1.5 system-ui,'DejaVu Sans',sans-serif;color:#1b1f24;background:#f4f5f7;margin:0}
main{max-width:1240px;margin:0 auto;padding:24px}
h1{font-size:1.7em;margin:.2em 0}h2{font-size:1.25em;margin:0 0 .3em}h3{font-size:1em;margin:1.1em 0 .3em}
section{background:#fff;border:1px solid #dfe2e6;border-radius:8px;padding:18px 22px;margin:18px 0}
.facts{display:flex;flex-wrap:wrap;gap:6px 34px;margin:.6em 0;padding:0}
.facts div{white-space:nowrap}.facts b{font-weight:600}
table{border-collapse:collapse;width:100%;font-variant-numeric:tabular-nums}
.wide{overflow-x:auto}
th,td{padding:5px 9px;text-align:right;border-bottom:1px solid #e6e8eb}
th{font-weight:600;color:#3b424a;vertical-align:bottom}
th.group{text-align:center;border-bottom:2px solid #9aa3ad}
td.first,th.first{border-left:1px solid #d3d7dc}
.pictures{display:flex;gap:18px;align-items:flex-end;margin:.4em 0}
figure{margin:0;min-width:0}figure img{display:block;max-width:100%;height:auto}
figcaption{font-size:.85em;color:#4c545d}
.bar{height:5px;border:1px solid #555;border-top:0;margin-top:2px}
.level{display:grid;grid-template-columns:minmax(0,1fr) 430px;gap:10px 26px;align-items:start}
@media(max-width:1000px){.level{grid-template-columns:1fr}}
@media(max-width:640px){.pictures{flex-wrap:wrap}}
svg{width:100%;max-width:690px;font:12px system-ui,'DejaVu Sans',sans-serif}
.soft,.note{color:#59626c}.note{font-size:.92em}
.gap{fill:#1c5ea8;color:#1c5ea8;font-weight:600}.bulge{fill:#b35806;color:#b35806;font-weight:600}
";

/// The whole page.
pub(super) fn page(subject: &Subject, levels: &[LevelErrors], galleries: &Galleries) -> String {
    let name = escaped(&subject.name);
    let mut html = format!(
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" content=\"width=device-width\">\n<title>Sphere tree of {name}</title>\n<style>{STYLE}</style></head>\n<body><main>\n<h1>Sphere tree of {name}</h1>\n"
    );
    facts(&mut html, subject);
    html.push_str("<section><h2>Error, level by level</h2>\n");
    table(&mut html, &subject.report.levels);
    html.push_str(&chart::convergence(&subject.report.levels));
    explanation(&mut html);
    html.push_str("</section>\n");
    for zone in &subject.report.zones {
        let _ = writeln!(
            html,
            "<section><h2>In the zone “{}” only</h2>\n<p class=\"note\">{:.2} mm² of the mesh ({:.1} %). “Spheres to mesh” is over exposed points whose nearest point of the mesh is in the zone; “–”: there is none.</p>",
            escaped(&zone.name),
            zone.area_mm2,
            1e-4 * zone.area_mm2 / subject.distance.mesh().area(),
        );
        table(&mut html, &zone.levels);
        html.push_str("</section>\n");
    }
    // The finest level is what people came for.
    for (k, level) in levels.iter().enumerate().rev() {
        section(&mut html, subject, level, k, galleries);
    }
    html.push_str("</main></body></html>\n");
    html
}

fn facts(html: &mut String, subject: &Subject) {
    let mesh = subject.distance.mesh();
    let (low, high) = mesh.bounds();
    let size = (high - low) * 1e3;
    let facts = [
        ("file", escaped(&subject.file.shown().to_string())),
        ("triangles", mesh.triangles.len().to_string()),
        (
            "size",
            format!("{:.2} × {:.2} × {:.2} mm", size.x, size.y, size.z),
        ),
        ("area", format!("{:.2} mm²", 1e6 * mesh.area())),
        ("volume", format!("{:.2} mm³", 1e9 * mesh.signed_volume())),
        ("built in", format!("{:.2} s", subject.build_s)),
        ("measured in", format!("{:.2} s", subject.measure_s)),
    ];
    html.push_str("<div class=\"facts\">");
    for (what, value) in facts {
        let _ = write!(
            html,
            "<div><span class=\"soft\">{what}</span> <b>{value}</b></div>"
        );
    }
    html.push_str("</div>\n");
}

fn table(html: &mut String, levels: &[LevelError]) {
    let volumes = levels.iter().any(|level| level.volume.is_some());
    html.push_str(
        "<div class=\"wide\"><table><thead><tr><th rowspan=\"2\">level</th><th rowspan=\"2\">spheres</th><th class=\"group first\" colspan=\"3\">mesh to spheres, mm</th><th class=\"group first\" colspan=\"3\">spheres to mesh, mm</th><th class=\"group first\" colspan=\"2\">of the area, %</th>",
    );
    if volumes {
        html.push_str("<th class=\"group first\" colspan=\"3\">of the volume, %</th>");
    }
    html.push_str(
        "</tr>\n<tr><th class=\"first\">mean</th><th>p95</th><th>max</th><th class=\"first\">mean</th><th>p95</th><th>max</th><th class=\"first\">outside</th><th>by &gt; 0.05&nbsp;mm</th>",
    );
    if volumes {
        html.push_str("<th class=\"first\">error</th><th>missing</th><th>excess</th>");
    }
    html.push_str("</tr></thead>\n<tbody>");
    for level in levels {
        let far = level.uncovered_beyond.iter().find(|u| u.beyond_mm == 0.05);
        let _ = write!(
            html,
            "<tr><td>{}</td><td>{}</td>{}{}<td class=\"first\">{:.1}</td><td>{:.2}</td>",
            level.level,
            level.spheres,
            cells(&level.mesh_to_spheres_mm),
            cells(&level.spheres_to_mesh_mm),
            level.uncovered_area_percent,
            far.map_or(0.0, |far| far.percent),
        );
        if let Some(volume) = &level.volume {
            let _ = write!(
                html,
                "<td class=\"first\">{:+.2}</td><td>{:.2}</td><td>{:.2}</td>",
                volume.volume_error_percent,
                volume.missing_volume_percent,
                volume.excess_volume_percent,
            );
        }
        html.push_str("</tr>\n");
    }
    html.push_str("</tbody></table></div>\n");
}

/// Three cells of a table.
fn cells(spread: &Spread) -> String {
    let cell = |mm: f64| match mm.is_nan() {
        true => "–".to_owned(),
        false => format!("{mm:.4}"),
    };
    format!(
        "<td class=\"first\">{}</td><td>{}</td><td>{}</td>",
        cell(spread.mean),
        cell(spread.p95),
        cell(spread.max),
    )
}

fn explanation(html: &mut String) {
    html.push_str(
        "<p class=\"note\"><b>Mesh to spheres</b>: how far a point of the mesh is from the surface of the nearest sphere, be it a <span class=\"gap\">gap</span> (the mesh sticks out of the spheres: a tool sinks in before it is stopped) or a <span class=\"bulge\">bulge</span> (a sphere sticks out of the mesh: a tool is stopped too early). <b>Spheres to mesh</b>: how far the exposed surface of all spheres together is from the mesh. Means and percentiles are weighted by area; each maximum is searched for until nothing larger can be left (to a fifth of a percent, unless a bound is printed with the level). <b>Outside</b>: area of the mesh that is in no sphere. <b>Volume</b>: spheres together against the mesh.</p>\n",
    );
}

fn section(
    html: &mut String,
    subject: &Subject,
    level: &LevelErrors,
    index: usize,
    galleries: &Galleries,
) {
    let error = &subject.report.levels[index];
    let _ = write!(
        html,
        "<section id=\"level{0}\"><h2>Level {0}: {1} sphere{2}</h2>\n<div class=\"level\"><div>",
        level.level,
        error.spheres,
        if error.spheres == 1 { "" } else { "s" },
    );
    let _ = write!(
        html,
        "<p>Largest gap <b class=\"gap\">{:.3} mm</b>, largest bulge <b class=\"bulge\">{:.3} mm</b>. Full colour is an error of {} mm or more, on this level's pictures and histogram.</p>",
        error.max_gap_mm, error.max_bulge_mm, level.scale.full_mm,
    );
    for (what, spread) in [
        ("mesh to spheres", &error.mesh_to_spheres_mm),
        ("spheres to mesh", &error.spheres_to_mesh_mm),
    ] {
        if let Some(at_most) = spread.max_at_most
            && at_most > 1.003 * spread.max + 1e-4
        {
            let _ = write!(
                html,
                "<p class=\"note\">The search for the maximum {what} stopped early: it is {:.4} mm at least and {at_most:.4} mm at most.</p>",
                spread.max
            );
        }
    }
    if error.cavity_area_percent > 0.05 {
        let _ = write!(
            html,
            "<p class=\"note\">{:.1} % of the spheres' exposed area lines closed cavities inside. It is part of “spheres to mesh”; without it the mean is {:.4} mm and the maximum {:.4} mm.</p>",
            error.cavity_area_percent, error.outer_to_mesh_mm.mean, error.outer_to_mesh_mm.max,
        );
    }
    html.push_str("</div><div>");
    html.push_str(&chart::histogram(level));
    html.push_str("</div></div>\n");
    pictures(html, "", &galleries.whole[index]);
    for (zone, gallery) in subject.zones.iter().zip(&galleries.zones) {
        let what = format!(" in the zone “{}”", escaped(&zone.name));
        pictures(html, &what, &gallery[index]);
    }
    let _ = writeln!(
        html,
        "<p class=\"note\">Measured at {} points of the mesh and {} exposed points of the spheres; volumes along rays {:.3} mm apart.</p></section>",
        error.measured.mesh_points, error.measured.exposed_points, error.measured.ray_spacing_mm,
    );
}

fn pictures(html: &mut String, place: &str, gallery: &Gallery) {
    for (what, pictures) in [
        ("The mesh, coloured by error", &gallery.errors),
        ("The spheres", &gallery.spheres),
    ] {
        let _ = write!(html, "<h3>{what}{place}</h3><div class=\"pictures\">");
        for picture in pictures {
            figure(html, what, picture);
        }
        html.push_str("</div>\n");
    }
}

fn figure(html: &mut String, what: &str, picture: &Picture) {
    // A round length, the same in all pictures of a gallery: they are drawn to one scale.
    let length = round_up(60.0 * picture.pixel_mm);
    let _ = write!(
        html,
        "<figure><img src=\"{}\" width=\"{}\" height=\"{}\" alt=\"{what}, {}\" title=\"{}\"><div class=\"bar\" style=\"width:{:.2}%\"></div><figcaption>{length} mm · {}</figcaption></figure>",
        picture.uri,
        picture.width,
        picture.height,
        picture.caption,
        picture.file,
        100.0 * length / (picture.pixel_mm * picture.width as f64),
        picture.caption,
    );
}

/// Text that cannot be mistaken for markup.
pub(super) fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
}
