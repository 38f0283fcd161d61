//! Drawer of all pictures of one run.

use std::collections::VecDeque;

use anyhow::{Context, anyhow, bail};
use sulcus_display::Display;
use sulcus_program::{PathText, say};
use sulcus_screen::eye::Eye;
use sulcus_screen::gpu::{Drawing, Graphics, Mode, Renderer};
use sulcus_screen::handed::Handed;
use sulcus_screen::head::Head;
use sulcus_screen::material::Glass;
use sulcus_screen::moment::Moment;
use sulcus_screen::quality::Quality;
use sulcus_screen::stage::Stage;

use super::shots::{Shot, Shots};
use crate::cli::PictureArgs;

/// Pictures that are still to be drawn, with their drawer.
pub struct Album<'a> {
    args: &'a PictureArgs,
    display: &'a Display,
    renderer: Renderer,
    glass: Glass,
    hand: Handed,
    head: Head,
    triangles: usize,
    /// Ticks of the pictures in order, each with its picture.
    left: VecDeque<(u64, Shot)>,
    last_tick: u64,
    /// Camera of a sequence, and the time of its last picture.
    eye: Option<(Eye, f64)>,
}

impl<'a> Album<'a> {
    /// Drawer for a scene with ticks of `tick_s` seconds. Pictures of tick 0 show the scene at rest, and are drawn
    /// here.
    ///
    /// # Errors
    /// An unknown name of a quality or of a glass, or a file that cannot be written.
    pub fn new(
        args: &'a PictureArgs,
        shots: Shots,
        display: &'a Display,
        tick_s: f64,
        graphics: Graphics,
    ) -> anyhow::Result<Self> {
        let named = |error: String| anyhow!(error);
        let quality: Quality = args.quality.parse().map_err(named).context("--quality")?;
        let glass: Glass = args.glass.parse().map_err(named).context("--glass")?;
        let hand: Handed = args.hand.parse().map_err(named).context("--hand")?;
        let head = Head::new(args.head_turn, args.head_tilt).map_err(named)?;
        let stage = Stage::new(display.scene(), quality.looks().thinned_um);
        let triangles = stage.triangles();
        let first = shots.all.first().filter(|_| shots.is_sequence);
        let eye = first.map(|shot| {
            let mut eye = Eye::new(shot.view);
            eye.tooth = shot.tooth;
            eye.hand = hand;
            (eye, shot.at_s)
        });
        let ticked = |shot: Shot| ((shot.at_s / tick_s).round() as u64, shot);
        let left: VecDeque<(u64, Shot)> = shots.all.into_iter().map(ticked).collect();
        let mut album = Self {
            args,
            display,
            renderer: Renderer::new(graphics, stage, quality, Mode::Beauty),
            glass,
            hand,
            head,
            triangles,
            last_tick: left.back().map_or(0, |(tick, _)| *tick),
            left,
            eye,
        };
        if album.is_due(0) {
            album.tick(0, &Moment::rest(display.scene()))?;
        }
        Ok(album)
    }

    /// Tick of the last picture.
    pub fn last_tick(&self) -> u64 {
        self.last_tick
    }

    /// Whether a picture is due at `tick` or was due before.
    pub fn is_due(&self, tick: u64) -> bool {
        self.left.front().is_some_and(|(due, _)| *due <= tick)
    }

    /// Draws all pictures that are due at `tick`.
    ///
    /// # Errors
    /// The adapter fails, or a file cannot be written.
    pub fn tick(&mut self, tick: u64, moment: &Moment) -> anyhow::Result<()> {
        while self.is_due(tick) {
            if let Some((_, shot)) = self.left.pop_front() {
                self.draw(&shot, moment)?;
            }
        }
        Ok(())
    }

    /// Draws all pictures of a scene in which nothing moves.
    ///
    /// # Errors
    /// The errors of [`Album::tick`].
    pub fn all(&mut self, moment: &Moment) -> anyhow::Result<()> {
        self.tick(u64::MAX, moment)
    }

    /// Whether all pictures were drawn.
    ///
    /// # Errors
    /// Some are left: no tick was recorded at their times.
    pub fn is_complete(&self) -> anyhow::Result<()> {
        if let Some((_, shot)) = self.left.front() {
            bail!("no tick was recorded at {} s", shot.at_s);
        }
        Ok(())
    }

    fn draw(&mut self, shot: &Shot, moment: &Moment) -> anyhow::Result<()> {
        let args = self.args;
        let mut moment = moment.clone();
        if args.no_tools {
            for tool in &mut moment.tools {
                tool.held = false;
            }
        }
        let [width, height] = args.size;
        let (aspect, scene) = (f64::from(width) / f64::from(height), self.display.scene());
        let camera = match &mut self.eye {
            Some((eye, before_s)) => {
                let elapsed_s = shot.at_s - std::mem::replace(before_s, shot.at_s);
                eye.camera(scene, &moment, aspect, elapsed_s)
            }
            None => shot
                .view
                .camera_of(self.hand, scene, &moment, shot.tooth, aspect),
        };
        let (turn, tilt) = (args.turn.to_radians(), args.tilt.to_radians());
        let camera = camera.orbited(turn, tilt, 1.0).magnified(args.zoom);
        let camera = self.head.seen(&camera);
        let mut drawing = Drawing::through(camera);
        (drawing.fog, drawing.scratches) = self.glass.looks();
        let png = self.renderer.picture(&drawing, &moment, args.size)?.png()?;
        let file = shot.out.shown();
        if let Some(folder) = shot
            .out
            .parent()
            .filter(|folder| !folder.as_os_str().is_empty())
        {
            std::fs::create_dir_all(folder)
                .with_context(|| format!("--out {file}: cannot make the folder"))?;
        }
        std::fs::write(&shot.out, png).with_context(|| format!("--out {file}: cannot write"))?;
        say!(
            "wrote {file}: {width} x {height} pixels, {} triangles, {:.3} s in the session",
            self.triangles,
            moment.time_s
        );
        Ok(())
    }
}
