//! Pictures as PDF and PNG, for journals and programs without SVG, and pixels of films. The feature `print` is needed; builds without it take half
//! the time.

use std::path::Path;
use std::str::FromStr;

use thiserror::Error;

/// Format of a picture, named by the extension of its files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PictureFormat {
    /// Lines and texts, for browsers and drawing programs.
    Svg,
    /// Lines and texts for print, with fonts embedded.
    Pdf,
    /// Pixels: 600 per inch of print, 2 per pixel of the screen.
    Png,
}

/// Errors of converting a picture.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum PrintError {
    /// The program was built without the feature `print`.
    #[error(
        "this archrock was built without PDF, PNG and films, so pictures are SVG only: install it with `cargo install --path . --locked --features print` in a copy of its repository"
    )]
    NotBuilt,
    /// There is no such format.
    #[error("pictures are written as svg, pdf and png, not as {0:?}")]
    Unknown(String),
    /// There is no such format of films.
    #[error(
        "films are written as mp4, webm, gif and png (animated), not as {0:?}: give a name such as arch.mp4"
    )]
    UnknownFilm(String),
    /// The encoder of a film is missing.
    #[error(
        "MP4 and WebM need the program ffmpeg, which is not in the PATH: install it (https://ffmpeg.org), or choose .gif or .png"
    )]
    NoFfmpeg,
    /// The film cannot be encoded.
    #[error("the film cannot be encoded: {0}")]
    Film(String),
    /// The work was ended.
    #[error("the film was cancelled")]
    Cancelled,
    /// The system has no suitable font.
    #[error(
        "the system has no font like Helvetica: install Liberation Sans or DejaVu Sans, or take the picture as SVG"
    )]
    NoFont,
    /// The picture cannot be converted.
    #[error("the picture cannot be converted: {0}")]
    Failed(String),
}

impl FromStr for PictureFormat {
    type Err = PrintError;

    fn from_str(text: &str) -> Result<Self, PrintError> {
        let mut all = Self::ALL.iter().copied();
        let found = all.find(|format| text.eq_ignore_ascii_case(format.name()));
        let format = found.ok_or_else(|| PrintError::Unknown(text.to_owned()))?;
        let is_built = cfg!(feature = "print") || format == Self::Svg;
        is_built.then_some(format).ok_or(PrintError::NotBuilt)
    }
}

impl PictureFormat {
    /// All formats.
    const ALL: &[Self] = &[Self::Svg, Self::Pdf, Self::Png];

    /// Returns the extension of files.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Svg => "svg",
            Self::Pdf => "pdf",
            Self::Png => "png",
        }
    }

    /// Returns the format of a file from its extension; SVG without an extension.
    ///
    /// # Errors
    /// When there is no such format, or the program was built without it.
    pub fn of_file(path: &Path) -> Result<Self, PrintError> {
        match path.extension() {
            Some(extension) => extension.to_string_lossy().parse(),
            None => Ok(Self::Svg),
        }
    }

    /// Converts an SVG picture to this format.
    ///
    /// # Errors
    /// When the program was built without this format, or the system has no suitable font.
    pub fn of_picture(self, picture: &str) -> Result<Vec<u8>, PrintError> {
        match self {
            Self::Svg => Ok(picture.as_bytes().to_vec()),
            #[cfg(feature = "print")]
            Self::Pdf => converted::pdf(picture),
            #[cfg(feature = "print")]
            Self::Png => converted::png(picture),
            #[cfg(not(feature = "print"))]
            Self::Pdf | Self::Png => Err(PrintError::NotBuilt),
        }
    }
}

#[cfg(feature = "print")]
pub(crate) use converted::Raster;

#[cfg(feature = "print")]
mod converted {
    use krilla::Document;
    use krilla::geom::Size;
    use krilla::page::PageSettings;
    use krilla_svg::{SurfaceExt as _, SvgSettings};
    use resvg::tiny_skia::{self, Color, Pixmap, Transform};
    use resvg::usvg::fontdb::{Database, Family, Query};
    use resvg::usvg::{self, Options, Tree};

    use super::PrintError;
    use crate::svg::Background;
    use crate::text::FONTS;

    /// Resolution of pictures for print and for the screen, in dots per inch.
    const PRINT_DPI: f32 = 600.0;
    const SCREEN_DPI: f32 = 192.0;
    /// Pixels of CSS per inch, and points of print per inch.
    const CSS_DPI: f32 = 96.0;
    const POINTS_PER_INCH: f32 = 72.0;
    /// Fonts of systems without one like Helvetica. Each text keeps the length of the layout, so these fit too.
    const OTHER_FONTS: &[&str] = &["DejaVu Sans", "Noto Sans", "Roboto"];

    pub fn pdf(picture: &str) -> Result<Vec<u8>, PrintError> {
        let tree = Raster::new()?.tree(picture)?;
        let size = tree.size();
        let points = |px: f32| px * POINTS_PER_INCH / CSS_DPI;
        let size = Size::from_wh(points(size.width()), points(size.height()));
        let size = size.ok_or_else(|| failed("it has no size"))?;
        let mut document = Document::new();
        let mut page = document.start_page_with(PageSettings::new(size));
        let mut surface = page.surface();
        let drawn = surface.draw_svg(&tree, size, SvgSettings::default());
        surface.finish();
        page.finish();
        drawn.ok_or_else(|| failed("it cannot be drawn"))?;
        document
            .finish()
            .map_err(|error| PrintError::Failed(format!("{error:?}")))
    }

    pub fn png(picture: &str) -> Result<Vec<u8>, PrintError> {
        let tree = Raster::new()?.tree(picture)?;
        let header = picture.lines().next().unwrap_or_default();
        let is_print = header.contains("mm\"");
        let dpi = if is_print { PRINT_DPI } else { SCREEN_DPI };
        let size = tree.size();
        let scale = dpi / CSS_DPI;
        let scaled = tiny_skia::Size::from_wh(scale * size.width(), scale * size.height());
        let whole = scaled
            .ok_or_else(|| failed("it has no size"))?
            .to_int_size();
        let mut pixels = pixmap(whole.width(), whole.height())?;
        // Stretches the picture to whole pixels, so that the last row and column are as opaque as the others.
        let whole = whole.to_size();
        let scaled =
            Transform::from_scale(whole.width() / size.width(), whole.height() / size.height());
        resvg::render(&tree, scaled, &mut pixels.as_mut());
        pixels
            .encode_png()
            .map_err(|error| PrintError::Failed(error.to_string()))
    }

    fn failed(what: &str) -> PrintError {
        PrintError::Failed(what.to_owned())
    }

    fn pixmap(width: u32, height: u32) -> Result<Pixmap, PrintError> {
        Pixmap::new(width, height).ok_or_else(|| failed("it is too large"))
    }

    /// Reads pictures with the fonts of the system, which take long to find.
    pub struct Raster(Options<'static>);

    impl Raster {
        pub fn new() -> Result<Self, PrintError> {
            let mut options = Options::default();
            let fonts = options.fontdb_mut();
            fonts.load_system_fonts();
            let names = FONTS.split(", ").map(|name| match name {
                "sans-serif" => Family::SansSerif,
                name => Family::Name(name),
            });
            let names = names.collect::<Vec<_>>();
            let has = |fonts: &Database, names: &[Family<'_>]| {
                let query = Query {
                    families: names,
                    ..Query::default()
                };
                fonts.query(&query).is_some()
            };
            if !has(fonts, &names) {
                let mut others = OTHER_FONTS.iter();
                let other = others.find(|name| has(fonts, &[Family::Name(name)]));
                // Without a font texts would be missing without an error.
                fonts.set_sans_serif_family(*other.ok_or(PrintError::NoFont)?);
            }
            Ok(Self(options))
        }

        fn tree(&self, picture: &str) -> Result<Tree, PrintError> {
            usvg::Tree::from_str(picture, &self.0)
                .map_err(|error| PrintError::Failed(error.to_string()))
        }

        /// Returns red, green and blue of all pixels of a frame with the picture in the middle, as large as it fits.
        pub fn frame(
            &self,
            picture: &str,
            size_px: [u32; 2],
            background: Background,
        ) -> Result<Vec<u8>, PrintError> {
            let (tree, [width, height]) = (self.tree(picture)?, size_px);
            let mut pixels = pixmap(width, height)?;
            let [red, green, blue] = background.0;
            pixels.fill(Color::from_rgba8(red, green, blue, u8::MAX));
            let size = tree.size();
            let [width, height] = [width as f32, height as f32];
            let scale = (width / size.width()).min(height / size.height());
            let [left, top] = [width - scale * size.width(), height - scale * size.height()];
            let place = Transform::from_scale(scale, scale).post_translate(0.5 * left, 0.5 * top);
            resvg::render(&tree, place, &mut pixels.as_mut());
            let pixels = pixels.data().chunks_exact(4);
            Ok(pixels
                .flat_map(|pixel| [pixel[0], pixel[1], pixel[2]])
                .collect())
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_format_is_that_of_the_extension() {
        let format = |path: &str| PictureFormat::of_file(Path::new(path));
        assert_eq!(format("out/history.svg"), Ok(PictureFormat::Svg));
        assert_eq!(format("out/history"), Ok(PictureFormat::Svg));
        assert_eq!(format("a.EPS"), Err(PrintError::Unknown("EPS".to_owned())));
        if cfg!(feature = "print") {
            assert_eq!(format("a.PDF"), Ok(PictureFormat::Pdf));
        } else {
            assert_eq!(format("a.PDF"), Err(PrintError::NotBuilt));
            let picture = PictureFormat::Png.of_picture("<svg/>");
            assert_eq!(picture, Err(PrintError::NotBuilt));
        }
    }

    /// Requires `cargo test --features print`.
    #[cfg(feature = "print")]
    #[test]
    fn a_picture_keeps_its_size_and_its_texts() {
        use crate::Figure;
        use crate::sheet::Sheet;
        let figure: Figure = "84mm".parse().unwrap();
        let drawn = |text: &str| {
            let mut sheet = Sheet::new(figure, "");
            sheet.caption(26.0, text);
            sheet.gap(0.5 * figure.width_px - 4.0 - 34.0);
            sheet.finish()
        };
        let picture = drawn("Rotation (rad)");
        let pdf = PictureFormat::Pdf.of_picture(&picture).unwrap();
        let text = String::from_utf8_lossy(&pdf);
        assert!(text.starts_with("%PDF-") && text.contains("/FontFile"));
        let (_, page) = text.split_once("/MediaBox [").unwrap();
        let numbers = page.split_once(']').unwrap().0.split(' ');
        let numbers: Vec<f64> = numbers.filter_map(|text| text.parse().ok()).collect();
        for (points, mm) in [(numbers[2], 84.0), (numbers[3], 42.0)] {
            assert!((points - mm / 25.4 * 72.0).abs() < 0.01, "{points}");
        }
        let png = PictureFormat::Png.of_picture(&picture).unwrap();
        assert!(png.starts_with(b"\x89PNG"));
        let width = u32::from_be_bytes(png[16..20].try_into().unwrap());
        assert!((f64::from(width) - 84.0 / 25.4 * 600.0).abs() <= 1.0);
        let pixels = resvg::tiny_skia::Pixmap::decode_png(&png).unwrap();
        let mut pixels = pixels.pixels().iter();
        assert!(
            pixels.all(|pixel| pixel.alpha() == 255),
            "no edge shows through"
        );
        // Dark pixels show that the text is drawn.
        let empty = drawn("");
        assert!(png.len() > 1000 + PictureFormat::Png.of_picture(&empty).unwrap().len());
    }
}
