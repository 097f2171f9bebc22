//! Charts: axes, marks in the units of the axes, and a legend.

use crate::axes::{Axes, Scale};
use crate::figure::Figure;
use crate::sheet::{Key, PartHeight, Sheet};
use crate::svg::{Drawing, Frame, Stroke, Symbol};

/// Distance from the left side of the picture to a plot, with space for the label of the y axis.
pub const LEFT_PX: f64 = 85.0;
/// Distance from the left side of the picture to a panel, whose label is above it.
pub(crate) const PANEL_LEFT_PX: f64 = 66.0;
/// Height of the texts below a plot.
pub const BELOW_PX: f64 = 56.0;

/// A chart, or one of several panels with a common x axis.
pub struct Chart {
    /// Height of the plot on the screen, in pixels.
    pub height_px: f64,
    /// Label and scale of the lower side; with an empty label only ticks are drawn.
    pub x: (String, Scale),
    /// Label and scale of the left side.
    pub y: (String, Scale),
    /// True if the label of the y axis is above the plot.
    pub is_panel: bool,
    /// Entries of the legend.
    pub keys: Vec<Key>,
    /// Marks drawn before the grid.
    pub below: Vec<Mark>,
    /// Marks drawn after the grid.
    pub marks: Vec<Mark>,
}

impl Chart {
    /// Makes a chart with axes and without marks.
    pub fn new(height_px: f64, x: (&str, Scale), y: (&str, Scale)) -> Self {
        Self {
            height_px,
            x: (x.0.to_owned(), x.1),
            y: (y.0.to_owned(), y.1),
            is_panel: false,
            keys: Vec::new(),
            below: Vec::new(),
            marks: Vec::new(),
        }
    }

    /// Makes a chart of curves on scales that contain all curves, and zero on the y axis. Each curve is in the legend.
    pub fn around(
        figure: Figure,
        height_px: f64,
        [x_label, y_label]: [&str; 2],
        curves: Vec<Mark>,
    ) -> Self {
        let points = || curves.iter().flat_map(Mark::points);
        let x = Scale::around(points().map(|point| point.0), figure.ticks(8));
        let y = Scale::around(points().map(|point| point.1).chain([0.0]), 6);
        Self::new(height_px, (x_label, x), (y_label, y)).with_named(curves)
    }

    /// Adds marks, each also as an entry of the legend.
    pub fn with_named(mut self, marks: Vec<Mark>) -> Self {
        self.keys.extend(marks.iter().map(Mark::key));
        self.marks.extend(marks);
        self
    }

    /// Draws the chart alone, below a title.
    pub fn draw(self, figure: Figure, title: &str) -> String {
        let mut sheet = Sheet::new(figure, title);
        self.add_to(&mut sheet);
        sheet.finish()
    }

    /// Adds legend, plot and axes to a picture. Returns the index of the plot among the parts of the picture.
    pub fn add_to(mut self, sheet: &mut Sheet<'_>) -> usize {
        sheet.legend(LEFT_PX, std::mem::take(&mut self.keys));
        sheet.gap(8.0);
        let plot = self.add_plot(sheet);
        sheet.gap(BELOW_PX);
        plot
    }

    /// Adds plot and axes to a picture. Returns the index of the plot among the parts of the picture.
    pub fn add_plot(self, sheet: &mut Sheet<'_>) -> usize {
        let figure = sheet.figure;
        let height = PartHeight::Plot(figure.height_px(self.height_px));
        sheet.part(height, move |drawing, part| {
            let is_panel = self.is_panel;
            let left_px = if is_panel { PANEL_LEFT_PX } else { LEFT_PX };
            let axes = Axes {
                frame: figure.right_of(left_px, part),
                x: self.x.1,
                y: self.y.1,
            };
            draw(drawing, &axes, &self.below);
            axes.draw(drawing, figure.decimal_mark, &self.y.0, is_panel);
            axes.label_x(drawing, figure.decimal_mark, &self.x.0);
            draw(drawing, &axes, &self.marks);
        })
    }
}

/// A mark of a chart: its name for scripts and tests, its shape, and its stroke, whose colour also fills areas.
#[derive(Clone, Debug)]
pub struct Mark {
    /// Name of the mark.
    pub name: String,
    /// Stroke of its lines.
    pub stroke: Stroke,
    shape: Shape,
}

/// Values on both axes.
type Point = (f64, f64);

/// The shape of a mark.
#[derive(Clone, Debug)]
pub enum Shape {
    /// A curve, interrupted at values that are not finite.
    Curve(Vec<Point>),
    /// A filled area.
    Area(Vec<Point>),
    /// Filled boxes between opposite corners.
    Boxes(Vec<[Point; 2]>),
    /// A range along the x axis, shaded with this opacity.
    Range([f64; 2], f64),
    /// A circle of this radius in pixels.
    Circle(Point, f64),
    /// An arrow at the right end of the plot at this y, for a value beyond the axis.
    Beyond(f64),
    /// Short lines at the lower side; lines too close to the previous one are omitted.
    Ticks(Vec<f64>),
    /// Marks clipped to the plot.
    Clipped(Vec<Mark>),
    /// A symbol, moved inside the plot.
    Symbol(Point, Symbol),
}

/// Smallest distance between ticks, in pixels; closer ones would merge.
const BETWEEN_TICKS_PX: f64 = 2.5;

impl Mark {
    /// Makes a mark.
    pub fn new(name: impl Into<String>, stroke: Stroke, shape: Shape) -> Self {
        let name = name.into();
        Self {
            name,
            stroke,
            shape,
        }
    }

    /// Makes a curve, interrupted at values that are not finite.
    pub fn curve(
        name: impl Into<String>,
        stroke: Stroke,
        points: impl IntoIterator<Item = Point>,
    ) -> Self {
        Self::new(name, stroke, Shape::Curve(points.into_iter().collect()))
    }

    /// Makes a step curve across the scale: it starts at `first` and jumps at each x of `rises` to the given y.
    pub fn staircase(
        name: impl Into<String>,
        stroke: Stroke,
        (x, first): (Scale, f64),
        rises: impl IntoIterator<Item = Point>,
    ) -> Self {
        let mut before = first;
        let mut corners = vec![(x.low, before)];
        for (x, y) in rises {
            corners.extend([(x, before), (x, y)]);
            before = y;
        }
        corners.push((x.high, before));
        Self::curve(name, stroke, corners)
    }

    /// Makes a vertical line across the plot.
    pub fn upright(name: impl Into<String>, stroke: Stroke, x: f64, y: Scale) -> Self {
        Self::curve(name, stroke, [(x, y.low), (x, y.high)])
    }

    /// Makes an area between a lower and an upper curve.
    pub fn between(
        name: &str,
        fill: &'static str,
        low: impl IntoIterator<Item = Point>,
        high: impl IntoIterator<Item = Point>,
    ) -> Self {
        let high: Vec<Point> = high.into_iter().collect();
        let corners = low.into_iter().chain(high.into_iter().rev()).collect();
        Self::new(name, Stroke::new(fill, 0.0, ""), Shape::Area(corners))
    }

    /// Clips marks to the plot.
    pub fn clipped(marks: Vec<Self>) -> Self {
        Self::new("", Stroke::new("", 0.0, ""), Shape::Clipped(marks))
    }

    /// Makes a symbol.
    pub fn symbol(symbol: Symbol, at: Point) -> Self {
        Self::new("", Stroke::new("", 0.0, ""), Shape::Symbol(at, symbol))
    }

    /// Returns the entry in a legend.
    pub fn key(&self) -> Key {
        Key::line(&self.name, self.stroke)
    }

    /// Returns the points of a curve; empty for other marks.
    pub fn points(&self) -> &[Point] {
        match &self.shape {
            Shape::Curve(points) => points,
            _ => &[],
        }
    }

    /// Returns true if a curve is zero throughout.
    pub fn is_flat(&self) -> bool {
        self.points().iter().all(|(_, value)| *value == 0.0)
    }

    /// Draws the mark.
    pub fn draw(&self, drawing: &mut Drawing, axes: &Axes) {
        let (name, stroke) = (&*self.name, self.stroke);
        let place = |(x, y): &Point| axes.place(*x, *y);
        match &self.shape {
            Shape::Curve(points) => drawing.curve(name, points.iter().map(place), stroke),
            Shape::Area(corners) => {
                drawing.polygon(name, corners.iter().map(place), stroke.color, stroke);
            }
            Shape::Boxes(boxes) => {
                let boxes = boxes.iter().map(|corners| corners.each_ref().map(place));
                drawing.boxes(name, boxes, stroke);
            }
            Shape::Range(ends, opacity) => {
                let [left, right] = ends.map(|x| axes.place(x, axes.y.low).x);
                let frame = Frame {
                    left,
                    width: right - left,
                    ..axes.frame
                };
                drawing.band(name, &frame, stroke.color, *opacity);
            }
            Shape::Circle(at, radius_px) => drawing.circle(name, place(at), *radius_px, stroke),
            Shape::Beyond(y) => {
                let tip = axes.place(axes.x.high, *y);
                let (y, back, barb) = (tip.y, tip.x - 11.0, tip.x - 5.0);
                let arrow = format!(
                    "M{back:.2} {y:.2}H{x:.2}M{barb:.2} {:.2}L{x:.2} {y:.2}L{barb:.2} {:.2}",
                    y - 3.0,
                    y + 3.0,
                    x = tip.x,
                );
                drawing.path(name, &arrow, "none", stroke);
            }
            Shape::Ticks(all) => {
                let mut last_px = f64::NEG_INFINITY;
                for x in all {
                    let at = axes.place(*x, axes.y.low);
                    if at.x - last_px >= BETWEEN_TICKS_PX {
                        let path = format!("M{:.2} {:.2}v-10", at.x, at.y);
                        drawing.path(name, &path, "none", stroke);
                        last_px = at.x;
                    }
                }
            }
            Shape::Symbol((x, y), symbol) => {
                let [x, y] = [(x, &axes.x), (y, &axes.y)].map(|(at, scale)| {
                    // Without a number it is at the end of the axis.
                    let at = if at.is_nan() { scale.low } else { *at };
                    at.clamp(scale.low, scale.high)
                });
                drawing.symbol(axes.place(x, y), symbol);
            }
            Shape::Clipped(marks) => {
                drawing.within(&axes.frame, |drawing| draw(drawing, axes, marks));
            }
        }
    }
}

/// Draws marks in order, the last on top.
fn draw(drawing: &mut Drawing, axes: &Axes, marks: &[Mark]) {
    for mark in marks {
        mark.draw(drawing, axes);
    }
}
