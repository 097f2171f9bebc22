//! Films: pictures one after another, as MP4 and WebM by the program `ffmpeg`, or as GIF and animated PNG. The feature `print` is needed.

use std::ops::ControlFlow;
use std::path::Path;
use std::process::{Command, Stdio};

use crate::print::PrintError;
use crate::svg::Background;

/// Format of a film, named by the extension of its file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FilmFormat {
    /// H.264, which all players and presentation programs show; encoded by `ffmpeg`.
    Mp4,
    /// VP9, for web pages; encoded by `ffmpeg`.
    WebM,
    /// 256 colours, repeated for ever.
    Gif,
    /// Animated PNG of 256 colours, repeated for ever; browsers show it.
    Png,
}

/// The encoder of MP4 and WebM.
const FFMPEG: &str = "ffmpeg";

impl FilmFormat {
    /// All formats.
    const ALL: &[Self] = &[Self::Mp4, Self::WebM, Self::Gif, Self::Png];

    /// Returns the extension of files.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Mp4 => "mp4",
            Self::WebM => "webm",
            Self::Gif => "gif",
            Self::Png => "png",
        }
    }

    /// Returns the format of a file from its extension.
    ///
    /// # Errors
    /// When there is no such format, or the program or its encoder is missing.
    pub fn of_file(path: &Path) -> Result<Self, PrintError> {
        let extension = path.extension().unwrap_or_default().to_string_lossy();
        let mut all = Self::ALL.iter().copied();
        let found = all.find(|format| extension.eq_ignore_ascii_case(format.name()));
        let format = found.ok_or_else(|| PrintError::UnknownFilm(extension.into_owned()))?;
        match format {
            _ if cfg!(not(feature = "print")) => Err(PrintError::NotBuilt),
            Self::Mp4 | Self::WebM if !has_ffmpeg() => Err(PrintError::NoFfmpeg),
            format => Ok(format),
        }
    }

    /// Returns MP4, or GIF if `ffmpeg` is missing.
    ///
    /// # Errors
    /// When the program was built without films.
    pub fn best() -> Result<Self, PrintError> {
        match Self::of_file(Path::new("film.mp4")) {
            Err(PrintError::NoFfmpeg) => Ok(Self::Gif),
            found => found,
        }
    }
}

fn has_ffmpeg() -> bool {
    let mut command = Command::new(FFMPEG);
    let command = command.arg("-version").stdin(Stdio::null());
    command.output().is_ok_and(|output| output.status.success())
}

/// The pictures of a film.
pub struct Reel<'a> {
    /// Width and height in pixels.
    pub size_px: [u32; 2],
    /// Pictures a second.
    pub rate_hz: u16,
    /// Number of pictures.
    pub count: usize,
    /// Colour around the pictures.
    pub background: Background,
    /// Name and version of the program that draws, for the file.
    pub program: &'a str,
    /// Draws a picture as SVG, from its number.
    pub draw: &'a (dyn Fn(usize) -> String + Sync),
}

/// Receives the number of finished pictures; a break ends the work.
type Done<'d> = &'d mut dyn FnMut(usize) -> ControlFlow<()>;

impl Reel<'_> {
    /// Makes the file of the film.
    ///
    /// # Errors
    /// When the program was built without films, the system has no suitable font, the encoder fails, or the work is ended.
    #[cfg(not(feature = "print"))]
    pub fn encode(&self, _: FilmFormat, _: Done<'_>) -> Result<Vec<u8>, PrintError> {
        Err(PrintError::NotBuilt)
    }
}

#[cfg(feature = "print")]
mod encoded {
    use std::cmp::Reverse;
    use std::collections::HashMap;
    use std::error::Error;
    use std::fs;
    use std::io::{Read as _, Seek as _, Write as _};
    use std::process::{Command, Stdio};

    use gif::{AnyExtension, DisposalMethod, Repeat};
    use png::{BitDepth, BlendOp, ColorType, Compression, FilterType};
    use rayon::iter::{IntoParallelIterator as _, ParallelIterator as _};

    use super::{Done, FFMPEG, FilmFormat, PrintError, Reel};
    use crate::print::Raster;

    type Encoded<T> = Result<T, Box<dyn Error>>;

    impl Reel<'_> {
        /// Makes the file of the film.
        ///
        /// # Errors
        /// When the system has no suitable font, the encoder fails, or the work is ended.
        pub fn encode(&self, format: FilmFormat, done: Done<'_>) -> Result<Vec<u8>, PrintError> {
            let frames = Frames(self, Raster::new()?);
            let film = match format {
                FilmFormat::Mp4 => {
                    frames.ffmpeg("-c:v libx264 -crf 18 -movflags +faststart -f mp4", done)
                }
                FilmFormat::WebM => {
                    let options = "-c:v libvpx-vp9 -crf 24 -b:v 0 -cpu-used 4 -row-mt 1 -f webm";
                    frames.ffmpeg(options, done)
                }
                FilmFormat::Gif => frames.gif(done),
                FilmFormat::Png => frames.png(done),
            };
            film.map_err(|error| match error.downcast::<PrintError>() {
                Ok(error) => *error,
                Err(error) => PrintError::Film(error.to_string()),
            })
        }
    }

    /// The pictures as pixels.
    struct Frames<'r>(&'r Reel<'r>, Raster);

    impl Frames<'_> {
        fn frame(&self, number: usize) -> Result<Vec<u8>, PrintError> {
            let Self(reel, raster) = self;
            raster.frame(&(reel.draw)(number), reel.size_px, reel.background)
        }

        /// Draws all pictures, several at a time, and passes them on in order.
        fn each(
            &self,
            prepare: impl Fn(Vec<u8>) -> Vec<u8> + Sync,
            mut add: impl FnMut(Vec<u8>) -> Encoded<()>,
            done: Done<'_>,
        ) -> Encoded<()> {
            let (count, batch) = (self.0.count, 2 * rayon::current_num_threads());
            for first in (0..count).step_by(batch) {
                let end = count.min(first + batch);
                let frames = (first..end).into_par_iter();
                let frames = frames.map(|number| self.frame(number).map(&prepare));
                let frames: Result<Vec<_>, _> = frames.collect();
                frames?.into_iter().try_for_each(&mut add)?;
                if done(end).is_break() {
                    return Err(PrintError::Cancelled.into());
                }
            }
            Ok(())
        }

        /// Encodes the film by `ffmpeg`, with these options.
        fn ffmpeg(&self, options: &str, done: Done<'_>) -> Encoded<Vec<u8>> {
            let ([width, height], rate_hz) = (self.0.size_px, self.0.rate_hz);
            // The arguments are divided at blanks.
            let name = self.0.program.split(' ').next().unwrap_or_default();
            // A file, because the index at the beginning of a film is written last.
            let file = tempfile::NamedTempFile::new()?.into_temp_path();
            let mut messages = tempfile::tempfile()?;
            // Players take the colours of films of this size for those of BT.709.
            let arguments = format!(
                "-loglevel error -f rawvideo -pix_fmt rgb24 -video_size {width}x{height} -framerate {rate_hz} -i - \
                 -vf scale=out_color_matrix=bt709:out_range=tv -pix_fmt yuv420p -colorspace bt709 -color_primaries bt709 \
                 -color_trc bt709 -metadata comment={name} {options} -y"
            );
            let mut command = Command::new(FFMPEG);
            let command = command.args(arguments.split(' ')).arg(&file);
            let piped = command.stdin(Stdio::piped()).stdout(Stdio::null());
            let mut program = piped.stderr(messages.try_clone()?).spawn()?;
            let mut input = program.stdin.take().ok_or("ffmpeg has no input")?;
            let fed = self.each(|frame| frame, |frame| Ok(input.write_all(&frame)?), done);
            drop(input);
            if !program.wait()?.success() {
                let mut text = String::new();
                messages.rewind()?;
                messages.read_to_string(&mut text)?;
                let lines: Vec<&str> = text.lines().collect();
                return Err(format!("ffmpeg failed: {}", lines.join("; ")).into());
            }
            fed?;
            Ok(fs::read(&file)?)
        }

        /// Returns red, green and blue of the most frequent colours of the first, the middle and the last picture, and of a last one. A drawing has few
        /// colours, and softened edges get the nearest ones.
        fn palette(&self) -> Encoded<Vec<u8>> {
            let last = self.0.count.saturating_sub(1);
            let frames = [self.frame(0)?, self.frame(last / 2)?, self.frame(last)?];
            let mut counts: HashMap<&[u8], usize> = HashMap::new();
            for pixel in frames.iter().flat_map(|frame| frame.chunks_exact(3)) {
                *counts.entry(pixel).or_default() += 1;
            }
            let mut colours: Vec<_> = counts.into_iter().collect();
            colours.sort_by_key(|(colour, count)| (Reverse(*count), *colour));
            let colours = colours.into_iter().take(UNCHANGED.into());
            let mut bytes: Vec<u8> = colours.flat_map(|(colour, _)| colour.to_vec()).collect();
            bytes.resize(3 * COLOURS, 0);
            Ok(bytes)
        }

        fn gif(&self, done: Done<'_>) -> Encoded<Vec<u8>> {
            /// The label of a comment.
            const COMMENT: AnyExtension = AnyExtension(0xFE);
            let [width, height] = self.0.size_px.map(u16::try_from);
            let (palette, width, height) = (self.palette()?, width?, height?);
            let (mut file, mut last) = (Vec::new(), Vec::new());
            let mut encoder = gif::Encoder::new(&mut file, width, height, &palette)?;
            encoder.set_repeat(Repeat::Infinite)?;
            encoder.write_raw_extension(COMMENT, &[self.0.program.as_bytes()])?;
            let add = |frame| {
                let changed = changes(&mut last, frame);
                let transparent = Some(UNCHANGED);
                let mut frame =
                    gif::Frame::from_indexed_pixels(width, height, changed, transparent);
                // In hundredths of a second.
                frame.delay = 100 / self.0.rate_hz;
                frame.dispose = DisposalMethod::Keep;
                Ok(encoder.write_frame(&frame)?)
            };
            self.each(|frame| indices(&palette, &frame), add, done)?;
            drop(encoder);
            Ok(file)
        }

        fn png(&self, done: Done<'_>) -> Encoded<Vec<u8>> {
            let (palette, [width, height]) = (self.palette()?, self.0.size_px);
            let (mut file, mut last) = (Vec::new(), Vec::new());
            let mut opacity = vec![u8::MAX; COLOURS];
            opacity[usize::from(UNCHANGED)] = 0;
            let mut encoder = png::Encoder::new(&mut file, width, height);
            encoder.set_color(ColorType::Indexed);
            encoder.set_depth(BitDepth::Eight);
            encoder.set_filter(FilterType::NoFilter);
            encoder.set_compression(Compression::Default);
            encoder.set_palette(&palette);
            encoder.set_trns(opacity);
            encoder.set_animated(u32::try_from(self.0.count)?, 0)?;
            encoder.set_frame_delay(1, self.0.rate_hz)?;
            encoder.set_blend_op(BlendOp::Over)?;
            encoder.add_text_chunk("Software".to_owned(), self.0.program.to_owned())?;
            let mut writer = encoder.write_header()?;
            let add = |frame| Ok(writer.write_image_data(&changes(&mut last, frame))?);
            self.each(|frame| indices(&palette, &frame), add, done)?;
            writer.finish()?;
            Ok(file)
        }
    }

    /// Number of colours of GIF and indexed PNG.
    const COLOURS: usize = 256;
    /// The last colour is transparent: the pixel is that of the picture before.
    const UNCHANGED: u8 = u8::MAX;

    /// Returns the number of the nearest colour of each pixel.
    fn indices(palette: &[u8], pixels: &[u8]) -> Vec<u8> {
        let nearest = |pixel: &[u8]| {
            let colours = (0..UNCHANGED).zip(palette.chunks_exact(3));
            let distances = colours.map(|(index, colour)| {
                let parts = colour.iter().zip(pixel);
                let squares = parts.map(|(a, b)| u32::from(a.abs_diff(*b)).pow(2));
                (squares.sum::<u32>(), index)
            });
            distances.min().map_or(0, |(_, index)| index)
        };
        let mut known: HashMap<&[u8], u8> = HashMap::new();
        let mut last: (&[u8], u8) = (&[], 0);
        let pixels = pixels.chunks_exact(3).map(|pixel| {
            if pixel != last.0 {
                let index = known.entry(pixel).or_insert_with(|| nearest(pixel));
                last = (pixel, *index);
            }
            last.1
        });
        pixels.collect()
    }

    /// Returns the changed pixels of a picture, and keeps the picture for the next one.
    fn changes(last: &mut Vec<u8>, new: Vec<u8>) -> Vec<u8> {
        let mut changed = new.clone();
        for (changed, last) in changed.iter_mut().zip(&*last) {
            if changed == last {
                *changed = UNCHANGED;
            }
        }
        *last = new;
        changed
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_format_of_a_film_is_that_of_the_extension() {
        let format = |path: &str| FilmFormat::of_file(Path::new(path));
        for unknown in ["a.avi", "a"] {
            assert!(matches!(format(unknown), Err(PrintError::UnknownFilm(_))));
        }
        let expected = match cfg!(feature = "print") {
            true => Ok(FilmFormat::Gif),
            false => Err(PrintError::NotBuilt),
        };
        assert_eq!(format("talk/a.GIF"), expected);
    }
}
