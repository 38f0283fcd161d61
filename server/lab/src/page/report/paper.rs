//! The paper, figure by figure, beside what is measured.

use std::fmt::Write;

use super::super::html::escaped;
use super::super::plot::{Plot, Series};
use crate::report::Beside;

pub(super) fn paper(html: &mut String, beside: &Beside) {
    html.push_str("<section id=\"paper\"><h2>The paper, figure by figure</h2>\n<p class=\"note\">Wang, Shi, Liu, Zhang, Xiao: Haptic Simulation of Organ Deformation and Hybrid Contacts in Dental Operations, 2014. What stands only in a picture or was lost from the text at hand is said to be unknown. Hold the pointer over a row for how it was measured.</p>\n<div class=\"two\">");
    for curve in &beside.curves {
        let series = curve.series.iter().map(|(name, points)| Series {
            name: name.clone(),
            points: points.clone(),
            joined: true,
        });
        let plot = Plot {
            x: curve.x.into(),
            y: curve.y.into(),
            log: (false, false),
            series: series.collect(),
            limit: None,
        };
        let _ = write!(
            html,
            "<figure>{}<figcaption><b>{}</b>: {}. {}</figcaption></figure>",
            plot.svg(),
            escaped(curve.place),
            escaped(&curve.title),
            escaped(&curve.note)
        );
    }
    html.push_str("</div>\n<h3>One loop against two rates</h3><p class=\"note\">The study that the paper leaves open: tissue at about 60 Hz and force at 1 kHz, against everything in one loop. Differences of force are on the same way of the hand; the rest is with a hand that feels.</p><div class=\"wide\"><table class=\"small\"><thead><tr><th>scene</th><th>rates</th><th>force, N rms</th><th>difference, N rms</th><th>max</th><th>buzz, N</th><th>force step, N</th><th>energy, mJ</th><th></th></tr></thead><tbody>");
    for r in &beside.multi_rate {
        let (class, word) = match (r.stable, r.broken.len()) {
            (true, 0) => ("holds", "stable".to_owned()),
            (true, n) => ("shown", format!("bounded, {n} of the case's bounds broken")),
            (false, _) => ("broken", "not stable".to_owned()),
        };
        let _ = writeln!(
            html,
            "<tr title=\"{}\"><td>{}</td><td class=\"text\">{}</td><td>{:.3}</td><td>{:.4}</td><td>{:.3}</td><td>{:.4}</td><td>{:.3}</td><td>{:.3}</td><td class=\"{class}\">{word}</td></tr>",
            escaped(&r.broken.join("; ")),
            escaped(&r.scene),
            r.rates,
            r.rms_force_n,
            r.rms_difference_n,
            r.max_difference_n,
            r.buzz_n,
            r.force_step_n,
            r.energy_mj,
        );
    }
    html.push_str("</tbody></table></div>\n<h3>Everything printed</h3><p class=\"note\">How each was measured stands beside it, with the command that does it again.</p><div class=\"wide\"><table class=\"small\"><thead><tr><th>where</th><th>what</th><th>printed</th><th>measured here</th><th>how</th></tr></thead><tbody>");
    for row in &beside.rows {
        let printed = row
            .printed
            .as_deref()
            .map_or("<i>unknown</i>".to_owned(), escaped);
        let measured = row.measured.as_deref().map_or("–".to_owned(), escaped);
        let again = row.command.as_deref().map_or(String::new(), |command| {
            format!(" <code>{}</code>", escaped(command))
        });
        let _ = writeln!(
            html,
            "<tr title=\"{}\"><td>{}</td><td class=\"text\">{}</td><td class=\"text\">{printed}</td><td class=\"text\">{measured}</td><td class=\"text soft\">{}{again}</td></tr>",
            escaped(row.conditions),
            escaped(row.place),
            escaped(row.what),
            escaped(&row.how),
        );
    }
    html.push_str("</tbody></table></div></section>\n");
}
