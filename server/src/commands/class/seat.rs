//! `sulcus-server class seat`: a learner at a station of the running server.

use anyhow::{Context, bail};
use clap::Args;
use serde_json::json;
use sulcus_program::say;

use super::PlaceArgs;
use crate::control_socket::{Request, ask};
use crate::plan::StationPlan;
use crate::state::classes::task::seating;
use crate::state::date::now_s;

#[derive(Clone, Debug, Args)]
pub(super) struct SeatArgs {
    #[command(flatten)]
    place: PlaceArgs,
    /// Name of the station
    station: String,
    /// Opaque id of the learner, such as s-4f7k2
    learner: String,
}

pub(super) fn run(args: &SeatArgs) -> anyhow::Result<()> {
    let classes = args.place.classes()?;
    let seating = seating(&classes.roll()?, &args.learner, classes.folder())?;
    let request = Request::SetPlan {
        station: args.station.clone(),
        change: seating.change,
    };
    let Some(plan) = ask(classes.folder(), &request)? else {
        bail!(
            "no server runs with this state folder; `sulcus-server plan set STATION --learner ID` keeps a learner for the next start"
        );
    };
    let plan: StationPlan = serde_json::from_value(plan)
        .context("the plan of the running server cannot be read; install the same release")?;
    classes.seat(&args.station, &args.learner, now_s())?;
    if args.place.json {
        say!(
            "{}",
            json!({ "station": args.station, "learner": args.learner, "plan": plan })
        );
    } else {
        say!("{}", plan.lines());
    }
    Ok(())
}
