//! The page of `sulcus-server report`, `report.html`: three answers first, then the tables and plots behind them.

mod answers;
mod failures;
mod matrix;
mod networks;
mod passivity;
mod peers;
mod plots;
mod rates;
mod screen;

use askama::Template;

pub(crate) use answers::answers;
pub(crate) use failures::failures;

use super::filters;
use super::plot::Svg;
use crate::report::{Beside, LOOKS_S, Report, Row, sentences};
use answers::{Answer, Line};
use matrix::Matrix;
use networks::Network;
use passivity::Passivity;
use peers::Peers;
use plots::{Growth, OneDof, PaperFigure, Speed};
use screen::Screen;

/// Load of a machine, as a share of its logical cores, beyond which times are too long.
const BUSY: f64 = 1.25;

/// The whole page.
#[derive(Template)]
#[template(path = "report.html")]
struct Page<'a> {
    report: &'a Report,
    busy: bool,
    answers: [Answer; 3],
    speed: Speed,
    matrix: Matrix,
    looks_ms: f64,
    /// Rows of the hard cases with a bound that does not hold.
    broken: Vec<&'a Row>,
    passivity: Passivity<'a>,
    /// Chosen coupling, onset and margin of each device, one sentence each.
    devices: Vec<String>,
    growth: Vec<Growth<'a>>,
    one_dof: OneDof,
    peers: Option<Peers>,
    screen: Option<Screen>,
    networks: Option<Vec<Network>>,
    paper: Option<Paper<'a>>,
}

/// The paper, figure by figure.
struct Paper<'a> {
    beside: &'a Beside,
    figures: Vec<PaperFigure<'a>>,
}

/// The whole page as HTML.
///
/// # Errors
/// If a template cannot be rendered: a fault of this program.
pub(crate) fn page(report: &Report) -> askama::Result<String> {
    let machine = &report.machine;
    let page = Page {
        report,
        busy: machine.load > BUSY * machine.logical_cores as f64,
        answers: answers(report),
        speed: Speed::of(report),
        matrix: Matrix::of(&report.matrix),
        looks_ms: LOOKS_S[usize::from(report.quick)] * 1e3,
        broken: report
            .rows
            .iter()
            .filter(|row| !row.broken.is_empty())
            .collect(),
        passivity: Passivity::of(&report.passivity),
        devices: sentences(&report.devices),
        growth: report.growth.lines.iter().map(Growth::of).collect(),
        one_dof: OneDof::of(&report.one_dof),
        peers: report.peers.as_ref().map(Peers::of),
        screen: report.screen.as_ref().map(Screen::of),
        networks: report.networks.as_ref().map(Network::all),
        paper: report.paper.as_ref().map(|beside| Paper {
            beside,
            figures: beside.curves.iter().map(PaperFigure::of).collect(),
        }),
    };
    page.render()
}

#[cfg(test)]
mod tests;
