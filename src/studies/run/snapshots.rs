//! The deformed structure at chosen times: side by side in `snapshots.svg`, or one by one in a film.

use std::fmt::Write as _;
use std::sync::OnceLock;

use nalgebra::Vector2;

use crate::mechanics::BodyPoint;
use crate::output::elevation::{BODIES, STONE, SheetTransform, TIE, View};
use crate::output::{Anchor, Drawing, Figure, PartHeight, Scene, Sheet, Stroke, color};
use crate::{Pose, Sample, State};

/// Collects the samples nearest to chosen times, and draws them.
#[derive(Clone, Debug)]
pub(super) struct Snapshots {
    scene: Scene,
    exaggeration: f64,
    /// The requested times, in seconds, each with the nearest sample until now.
    taken: Vec<(f64, Option<Sample>)>,
    film: Option<FilmTimes>,
    /// Text in place of the legend.
    caption: Option<String>,
    /// Speed of a film, relative to real time.
    speed: f64,
    /// Largest joint stress in all pictures, in Pa, once it is known.
    largest_pa: OnceLock<f64>,
    /// Times of the first and the last sample, in seconds.
    span_s: [f64; 2],
}

/// The instants of a film.
#[derive(Clone, Debug)]
struct FilmTimes {
    /// Interval between pictures, in seconds.
    interval_s: f64,
    /// Time of the next picture, in seconds.
    next_s: f64,
    /// The last sample; `None` before the first one.
    last: Option<Sample>,
}

/// Largest number of pictures of a film.
pub(super) const MAX_FILM_PICTURES: usize = 9999;
/// Times that differ by less than this are the same, in seconds.
const SAME_S: f64 = 1e-9;
/// Largest number of pictures side by side.
const COLUMNS: usize = 3;
/// Smallest width of a picture.
const LEAST_PX: f64 = 180.0;

impl Snapshots {
    /// Makes snapshots of a structure, with displacements multiplied by `exaggeration`.
    pub(super) const fn new(scene: Scene, exaggeration: f64) -> Self {
        Self {
            scene,
            exaggeration,
            taken: Vec::new(),
            film: None,
            caption: None,
            speed: 1.0,
            largest_pa: OnceLock::new(),
            span_s: [f64::INFINITY, f64::NEG_INFINITY],
        }
    }

    /// Sets the times of the snapshots, in seconds.
    pub(super) fn at(mut self, times_s: &[f64]) -> Self {
        self.taken = times_s.iter().map(|time_s| (*time_s, None)).collect();
        self
    }

    /// Makes a film instead, with a picture at each of these intervals, in seconds.
    pub(super) fn every(mut self, interval_s: f64) -> Self {
        self.film = Some(FilmTimes {
            interval_s,
            next_s: f64::NEG_INFINITY,
            last: None,
        });
        self
    }

    /// Replaces the legend by a text if there is one; otherwise adds the speed of the film to it.
    pub(super) fn with_caption(mut self, caption: Option<String>, speed: f64) -> Self {
        (self.caption, self.speed) = (caption, speed);
        self
    }

    /// Number of pictures.
    pub(super) fn count(&self) -> usize {
        self.taken.len()
    }

    /// Adds a sample. Samples come in the order of time.
    pub(super) fn push(&mut self, sample: &Sample) {
        let time_s = sample.time_s;
        self.span_s = [self.span_s[0].min(time_s), time_s];
        if let Some(film) = &mut self.film {
            film.next_s = film.next_s.max(self.span_s[0]);
            while film.next_s <= time_s + SAME_S && self.taken.len() < MAX_FILM_PICTURES {
                let shown = match &film.last {
                    Some(last) if film.next_s < time_s - SAME_S => {
                        interpolate_sample(last, sample, film.next_s)
                    }
                    _ => sample.clone(),
                };
                self.taken.push((film.next_s, Some(shown)));
                film.next_s += film.interval_s;
            }
            film.last = Some(sample.clone());
            return;
        }
        for (wanted_s, nearest) in &mut self.taken {
            let miss_s = |sample: &Sample| (sample.time_s - *wanted_s).abs();
            let is_nearer = |nearest: &Sample| miss_s(sample) < miss_s(nearest);
            if nearest.as_ref().is_none_or(is_nearer) {
                *nearest = Some(sample.clone());
            }
        }
    }

    /// Requested times before the start and after the end of the history, in seconds. Their pictures show the first or the last instant.
    pub(super) fn outside_times_s(&self) -> [Vec<f64>; 2] {
        let [start_s, end_s] = self.span_s;
        let times_s = || self.taken.iter().map(|(time_s, _)| *time_s);
        [
            times_s().filter(|time_s| *time_s < start_s).collect(),
            times_s().filter(|time_s| *time_s > end_s).collect(),
        ]
    }

    /// Largest joint stress in all pictures, in Pa.
    fn largest_pa(&self) -> f64 {
        *self.largest_pa.get_or_init(|| {
            let pressures = self.drawn_samples().into_iter();
            let pressures = pressures.flat_map(|sample| &sample.pressures);
            let stresses_pa = pressures.flat_map(|pressure| pressure.edge_stresses_pa);
            stresses_pa.fold(0.0, f64::max)
        })
    }

    /// Thickness of the thinnest joint, in metres.
    fn thickness_m(&self) -> f64 {
        let sections = self.scene.sections.iter();
        let thicknesses_m = sections.map(|section| section.across_m.norm());
        thicknesses_m.fold(f64::INFINITY, f64::min)
    }

    /// Samples that are drawn.
    pub(super) fn drawn_samples(&self) -> Vec<&Sample> {
        let taken = self.taken.iter();
        taken.filter_map(|(_, sample)| sample.as_ref()).collect()
    }

    /// Draws all snapshots in one picture.
    pub(super) fn draw(&self, figure: Figure, title: &str) -> String {
        self.sheet(figure, title, &self.drawn_samples())
    }

    /// Draws each snapshot as a separate picture, all with one scale.
    pub(super) fn film_pictures(&self, figure: Figure, title: &str) -> Vec<String> {
        let shown = self.drawn_samples().into_iter();
        shown
            .map(|sample| self.sheet(figure, title, &[sample]))
            .collect()
    }

    /// Draws samples side by side.
    pub(super) fn sheet(&self, figure: Figure, title: &str, shown: &[&Sample]) -> String {
        let columns = figure.columns(shown.len().clamp(1, COLUMNS), LEAST_PX);
        let cell_px = figure.width_px / columns as f64;
        let [low_m, high_m] = self.scene.frame_m();
        let (width_m, height_m) = (high_m.x - low_m.x, high_m.y - low_m.y);
        // Leaves space for the sway; the picture is not higher than wide.
        let scale = ((cell_px - 30.0) / (1.25 * width_m)).min(cell_px / (1.1 * height_m));
        let mut sheet = Sheet::new(figure, title);
        sheet.gap(14.0);
        for samples in shown.chunks(columns) {
            let tall_px = 1.1 * scale * height_m;
            sheet.part(
                PartHeight::Structure(tall_px, tall_px),
                move |drawing, part| {
                    for (column, sample) in (0_u32..).zip(samples) {
                        let middle = (f64::from(column) + 0.5) * cell_px;
                        let sway_m = Vector2::new(0.0, 0.1 * height_m);
                        let place = SheetTransform::over([low_m, high_m + sway_m], middle, part);
                        let look = (0.5 * cell_px - 8.0, figure.background.ink());
                        self.draw_one(drawing, place, sample, look);
                    }
                },
            );
            sheet.gap(52.0);
        }
        sheet.caption(0.0, &self.caption());
        sheet.gap(8.0);
        sheet.finish()
    }

    fn caption(&self) -> String {
        let mut caption = match self.exaggeration {
            1.0 => "to scale".to_owned(),
            exaggeration => format!("displacements times {exaggeration}"),
        };
        match &self.caption {
            Some(own) if self.exaggeration == 1.0 => return own.clone(),
            Some(own) if own.is_empty() => return caption,
            Some(own) => return format!("{own} ({caption})"),
            None => {}
        }
        if self.speed != 1.0 {
            caption = format!("{} times real speed; {caption}", self.speed);
        }
        caption += "; dashed: at rest; circles: open hinges; blue: thrust line";
        let largest_pa = self.largest_pa();
        if largest_pa > 0.0 {
            let _ = write!(
                caption,
                "; wedges: compressive stress on closed joints, the highest {:.2} MPa",
                1e-6 * largest_pa
            );
        }
        let sizes = self.scene.sizes_in_words();
        if !sizes.is_empty() {
            let _ = write!(caption, "; {sizes}");
        }
        caption
    }

    fn draw_one(
        &self,
        drawing: &mut Drawing,
        place: SheetTransform,
        sample: &Sample,
        (half_px, ink): (f64, &'static str),
    ) {
        let left = place.at - Vector2::new(half_px, 0.0);
        let right = place.at + Vector2::new(half_px, 0.0);
        drawing.line(left, right, Stroke::new(color::GREY, 1.4, ""));
        let view = View {
            exaggeration: self.exaggeration,
            ..View::new(&self.scene, place, &sample.poses, &sample.hinges)
        };
        view.draw_built(drawing, "");
        if self.scene.has_settled() {
            for face in self.scene.supports_m(self.exaggeration) {
                let ends = face.map(|end| place.px(end));
                drawing.curve("support", ends, Stroke::new(ink, 2.0, ""));
            }
        }
        view.draw_behind(drawing);
        view.draw_blocks(drawing, |_, body| match body {
            None => ("still".to_owned(), "#e4e4e4"),
            Some(body) if sample.poses.len() == BODIES.len() => {
                (format!("body {body}"), BODIES[body])
            }
            Some(body) => (format!("body {body}"), STONE),
        });
        view.draw_loads(drawing, None, false);
        let moved = |point: &BodyPoint| view.px(point);
        let broken = |tie: usize| sample.ties.get(tie).is_some_and(|tie| tie.is_broken);
        for (tie, ends) in self.scene.ties(&sample.hinges).iter().enumerate() {
            let [from, to] = ends.each_ref().map(moved);
            if broken(tie) {
                let stroke = Stroke::new(color::ORANGE, 1.2, "4 3");
                for [end, other] in [[from, to], [to, from]] {
                    let stub = end + (other - end) * STUB_RATIO;
                    drawing.curve("broken tie", [end, stub], stroke);
                }
            } else {
                drawing.curve("tie", [from, to], TIE);
            }
        }
        for pressed in self.scene.compressed_joints(sample) {
            let high_m = WEDGE_RATIO * self.thickness_m() / self.largest_pa();
            let wedge = pressed.wedge(high_m);
            let stroke = Stroke::new(color::PURPLE, 0.8, "");
            drawing.polygon("stress", wedge.iter().map(moved), PRESSED, stroke);
            let ends = pressed.ends.iter().map(moved);
            drawing.curve("pressed", ends, Stroke::new(color::PURPLE, 2.4, ""));
        }
        for stretch in self.scene.thrust_line(sample) {
            let points = stretch.iter().map(moved);
            drawing.curve("thrust line", points, Stroke::new(color::BLUE, 1.6, ""));
        }
        view.draw_hinges(drawing);
        let state = match sample.state {
            State::Rest => "at rest".to_owned(),
            State::Rocking(sway) => format!("sways {}", sway.name()),
            State::Overturned(sway) => format!("overturned to the {}", sway.name()),
        };
        let below = place.at + Vector2::new(0.0, 22.0);
        let text = format!("{:.3} s, {state}", sample.time_s);
        drawing.label(below, Anchor::Middle, 0.0, text);
    }
}

/// State between two samples. The bodies move evenly from one to the other; everything else is that of the first one. At a change
/// of the mechanism, whose bodies are others, it is the nearer sample.
fn interpolate_sample(first: &Sample, second: &Sample, time_s: f64) -> Sample {
    let part = (time_s - first.time_s) / (second.time_s - first.time_s);
    let mut hinges = first.hinges.iter().zip(&second.hinges);
    let are_equal =
        first.hinges.len() == second.hinges.len() && hinges.all(|(a, b)| a.hinge == b.hinge);
    // Blocks, whose joints have gaps, are the same bodies at all times.
    if first.gaps_m.is_empty() && !are_equal {
        let nearer = if part < 0.5 { first } else { second };
        return Sample {
            time_s,
            ..nearer.clone()
        };
    }
    let poses = first.poses.iter().zip(&second.poses).map(|(from, to)| {
        let turn_rad = to.rotation_rad() - from.rotation_rad();
        let moved_m = from.translation.lerp(&to.translation, part);
        Pose::new(from.rotation_rad() + part * turn_rad, moved_m)
    });
    Sample {
        time_s,
        poses: poses.collect(),
        ..first.clone()
    }
}

/// Fraction of the length of a broken tie that is drawn at each end.
const STUB_RATIO: f64 = 0.4;
/// Height of the highest stress wedge, over the thickness of the thinnest joint.
const WEDGE_RATIO: f64 = 0.6;
/// The colour of stress wedges.
const PRESSED: &str = "#e3c3dc";
