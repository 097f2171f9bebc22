//! The command `film`.

use std::ops::ControlFlow;
use std::path::PathBuf;
use std::process;
use std::sync::atomic::Ordering;

use archrock::output::{Background, FilmFormat, Origin, PrintError, check_named_file};
use archrock::scenario::{Scenario, Varied};
use archrock::studies::run::{Film, FilmOptions};
use archrock::studies::{Progress, StudyError};

use super::Failure;
use super::interrupts::{INTERRUPTED, INTERRUPTED_CODE, listen_to_interrupts};
use super::models::{ModelsOption, warn_of};
use super::named_files::write_named;
use super::progress::{Display, print_always, print_status};
use super::scenario_file::ScenarioFile;
use super::study::publish;

#[derive(clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    scenario: ScenarioFile,
    /// File of the film: .mp4 or .webm (by ffmpeg), .gif or .png (animated) [default: film.mp4 in results/<name of the scenario file>;
    /// film.gif without ffmpeg].
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Speed relative to real time, such as 0.25 for slow motion.
    #[arg(long, value_name = "TIMES", default_value_t = 1.0)]
    speed: f64,
    /// Width and height in pixels.
    #[arg(long, value_name = "WIDTHxHEIGHT", default_value = "1280x720", value_parser = size_px)]
    size: [u32; 2],
    /// Colour of the background: white, black or rrggbb.
    #[arg(long, value_name = "COLOUR", default_value = "white")]
    background: Background,
    /// Text below the structure, in place of the legend; '' for none.
    #[arg(long, value_name = "TEXT")]
    caption: Option<String>,
    /// Factor on the displacements.
    #[arg(long, value_name = "K", default_value_t = 1.0)]
    exaggerate: f64,
    #[command(flatten)]
    models: ModelsOption,
}

/// The command in the list of results of a folder.
const FILM: &str = "film";

pub fn film(arguments: &Arguments) -> Result<(), Failure> {
    let out = arguments.out.as_deref();
    let format = out.map_or_else(FilmFormat::best, FilmFormat::of_file)?;
    let options = FilmOptions {
        speed: arguments.speed,
        size_px: arguments.size,
        background: arguments.background,
        caption: arguments.caption.clone(),
        exaggeration: arguments.exaggerate,
    };
    options.check()?;
    let input = arguments.scenario.open()?;
    let scenario = arguments.models.read_one(&input, "a film")?;
    let ready = scenario.check_for_run();
    ready.map_err(|message| input.input_error(message))?;
    warn_of(std::slice::from_ref(&scenario), &Varied::default());
    let name = format!("{FILM}.{}", format.name());
    let folder = match out {
        Some(file) => {
            let free = check_named_file(file);
            free.map_err(|wrong| {
                Failure::Input(format!("{wrong}; choose another file with --out"))
            })?;
            None
        }
        None => {
            let destination = input.results(None);
            let folder = destination.lock(FILM, Origin::of(&scenario), None, false)?;
            folder.check(&[&name])?;
            Some(folder)
        }
    };
    listen_to_interrupts();
    let made = make(&scenario, &options, format);
    if INTERRUPTED.load(Ordering::Relaxed) {
        // Removes an empty folder.
        drop(folder);
        print_always("interrupted");
        process::exit(INTERRUPTED_CODE);
    }
    let (pictures, film) = made?;
    let mut path = arguments.out.clone().unwrap_or_default();
    if let Some(folder) = folder {
        folder.add(&name, &film)?;
        publish(&folder)?;
        path = folder.path().join(name);
    } else {
        write_named(&path, &film, "--out")?;
    }
    let ([width, height], rate_hz) = (options.size_px, Film::RATE_HZ);
    print_status(&format!(
        "{}: {pictures} pictures of {width}x{height} pixels, {:.2} s at {rate_hz} a second",
        path.display(),
        pictures as f64 / f64::from(rate_hz)
    ));
    Ok(())
}

/// Simulates the scenario and encodes its film. Returns the number of pictures, and the file.
fn make(
    scenario: &Scenario,
    options: &FilmOptions,
    format: FilmFormat,
) -> Result<(usize, Vec<u8>), StudyError> {
    let model = scenario.model();
    let model = model.map_err(|error| StudyError::Scenario(error.to_string()))?;
    let film = Film::simulate(scenario, &*model, options, &mut watch())?;
    Ok((film.pictures(), film.encode(format, &mut watch())?))
}

/// Shows progress; ends the work after Ctrl-C.
fn watch() -> impl FnMut(Progress) -> ControlFlow<()> {
    let mut display = None;
    move |progress| {
        let display = display.get_or_insert_with(|| Display::new(progress));
        display.show(progress);
        match INTERRUPTED.load(Ordering::Relaxed) {
            true => ControlFlow::Break(()),
            false => ControlFlow::Continue(()),
        }
    }
}

impl From<PrintError> for Failure {
    fn from(error: PrintError) -> Self {
        match error {
            PrintError::NotBuilt | PrintError::NoFfmpeg | PrintError::UnknownFilm(_) => {
                Self::Input(error.to_string())
            }
            error => Self::Work(error.to_string()),
        }
    }
}

fn size_px(text: &str) -> Result<[u32; 2], String> {
    let sides = text.split_once('x');
    let sides = sides.and_then(|(width, height)| Some([width.parse().ok()?, height.parse().ok()?]));
    sides.ok_or_else(|| "give width and height in pixels, such as 1280x720".to_owned())
}
