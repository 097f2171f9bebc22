//! A film of a history: pictures at equal intervals, each drawn as a snapshot.

use std::ops::ControlFlow;

use super::recorder::simulated;
use super::snapshots::{MAX_FILM_PICTURES, Snapshots};
use super::{MILLISECONDS, scene};
use crate::output::page::PROGRAM;
use crate::output::{Background, Figure, FilmFormat, Reel};
use crate::scenario::Scenario;
use crate::studies::{Counted, Progress, RunnerError, StudyError, Watch};
use crate::{Model, Recorder, Sample};

/// Options of a film.
#[derive(Clone, Debug, PartialEq)]
pub struct FilmOptions {
    /// Time of the history that passes in a second of the film, in seconds, from 0.001 to 1000; below 1 it is slow motion.
    pub speed: f64,
    /// Width and height in pixels: even numbers from 160 to 3840.
    pub size_px: [u32; 2],
    /// Colour behind the structure.
    pub background: Background,
    /// Text below the structure; `None` for the legend.
    pub caption: Option<String>,
    /// Factor on the displacements, from 0.001 to 1000000.
    pub exaggeration: f64,
}

impl FilmOptions {
    /// Checks all numbers.
    ///
    /// # Errors
    /// When one is out of range.
    pub fn check(&self) -> Result<(), String> {
        let is_allowed =
            |side_px: &u32| (160..=3840).contains(side_px) && side_px.is_multiple_of(2);
        Err(if !(1e-3..=1e3).contains(&self.speed) {
            "the speed of a film is from 0.001 to 1000 times real time, such as 0.25"
        } else if !self.size_px.iter().all(is_allowed) {
            "width and height of a film are even numbers from 160 to 3840, such as 1280x720"
        } else if !(1e-3..=1e6).contains(&self.exaggeration) {
            "the factor on the displacements is from 0.001 to 1000000, such as 10"
        } else {
            return Ok(());
        }
        .to_owned())
    }
}

/// A film of a history, and of the fall if the structure overturns.
#[derive(Clone, Debug)]
pub struct Film {
    snapshots: Snapshots,
    title: String,
    options: FilmOptions,
}

impl Film {
    /// Pictures a second.
    pub const RATE_HZ: u16 = 25;

    /// Simulates a scenario, and keeps the states that the film shows. `watch` receives the progress in milliseconds of simulated time.
    ///
    /// # Errors
    /// When an option is out of range, the motion cannot be computed, the film would be too long, or the work is cancelled.
    pub fn simulate(
        scenario: &Scenario,
        model: &dyn Model,
        options: &FilmOptions,
        watch: Watch<'_>,
    ) -> Result<Self, StudyError> {
        options.check().map_err(StudyError::Scenario)?;
        let request = scenario.request();
        let interval_s = options.speed / f64::from(Self::RATE_HZ);
        let snapshots = Snapshots::new(scene(scenario, model), options.exaggeration);
        let mut recorder = Camera {
            snapshots: snapshots
                .every(interval_s)
                .with_caption(options.caption.clone(), options.speed),
            watch,
            duration_ms: (request.end_s * MILLISECONDS).round() as usize,
            status: Ok(()),
        };
        model.simulate(scenario.ground_motion(), &request, Some(&mut recorder))?;
        recorder.status?;
        Ok(Self {
            snapshots: recorder.snapshots,
            title: scenario.title.clone().unwrap_or_default(),
            options: options.clone(),
        })
    }

    /// Number of pictures.
    pub fn pictures(&self) -> usize {
        self.snapshots.count()
    }

    /// Draws and encodes the film. `watch` receives the number of finished pictures.
    ///
    /// # Errors
    /// When the program was built without films, the system has no suitable font, the encoder fails, or the work is cancelled.
    pub fn encode(&self, format: FilmFormat, watch: Watch<'_>) -> Result<Vec<u8>, StudyError> {
        let (size_px, background) = (self.options.size_px, self.options.background);
        let (shown, figure) = (
            self.snapshots.drawn_samples(),
            Figure::of_frame(size_px, background),
        );
        let (all, rate_hz) = (shown.len(), Self::RATE_HZ);
        let draw = |number: usize| {
            let sample = &shown[number..=number];
            self.snapshots.sheet(figure, &self.title, sample)
        };
        let reel = Reel {
            size_px,
            rate_hz,
            count: all,
            background,
            program: PROGRAM,
            draw: &draw,
        };
        let mut watch = |done| {
            watch(Progress {
                done,
                all,
                counted: Counted::Pictures,
            })
        };
        Ok(reel.encode(format, &mut watch)?)
    }
}

/// Passes the samples of a history on to the pictures.
struct Camera<'w> {
    snapshots: Snapshots,
    watch: Watch<'w>,
    duration_ms: usize,
    /// The error that ends the history.
    status: Result<(), StudyError>,
}

impl Recorder for Camera<'_> {
    fn sample(&mut self, sample: &Sample) -> ControlFlow<()> {
        self.snapshots.push(sample);
        let done = (sample.time_s * MILLISECONDS) as usize;
        let all = self.duration_ms;
        let progress = simulated(done, all);
        if (self.watch)(progress).is_break() {
            self.status = Err(RunnerError::Cancelled(progress).into());
        } else if self.snapshots.count() == MAX_FILM_PICTURES {
            self.status = Err(StudyError::scenario(format!(
                "a film has fewer than {MAX_FILM_PICTURES} pictures, and the history needs more: choose a greater speed, or a shorter duration_s"
            )));
        }
        match self.status {
            Ok(()) => ControlFlow::Continue(()),
            Err(_) => ControlFlow::Break(()),
        }
    }

    fn wants_thrust_line(&self) -> bool {
        true
    }

    fn wants_fall(&self) -> bool {
        true
    }

    fn fall_sample(&mut self, sample: &Sample) -> ControlFlow<()> {
        self.sample(sample)
    }
}
