//! Films: pictures one after another, as MP4 and WebM by the program `ffmpeg`, or as GIF and animated PNG. The feature `print` is needed.

use std::path::Path;
use std::process::{Command, Stdio};

use super::print::PrintError;

named! {
    /// Format of a film, named by the extension of its file.
    pub enum FilmFormat {
        /// H.264, which all players and presentation programs show; encoded by `ffmpeg`.
        Mp4 = "mp4",
        /// VP9, for web pages; encoded by `ffmpeg`.
        WebM = "webm",
        /// 256 colours, repeated for ever.
        Gif = "gif",
        /// Animated PNG of 256 colours, repeated for ever; browsers show it.
        Png = "png",
    }
}

/// The encoder of MP4 and WebM.
const FFMPEG: &str = "ffmpeg";

impl FilmFormat {
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
            _ if cfg!(not(feature = "print")) => Err(PrintError::NoFilms),
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
    let silent = command
        .arg("-version")
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null());
    silent.status().is_ok_and(|status| status.success())
}

/// The pictures of a film.
pub(crate) struct Reel<'a> {
    /// Width and height in pixels.
    pub(crate) size_px: [u32; 2],
    /// Pictures a second.
    pub(crate) rate_hz: u16,
    /// Number of pictures.
    pub(crate) count: usize,
    pub(crate) background: super::figure::Background,
    /// Draws a picture as SVG, from its number.
    pub(crate) draw: &'a (dyn Fn(usize) -> String + Sync),
}

impl Reel<'_> {
    /// Makes the file of the film. `done` receives the number of finished pictures; its error ends the work.
    ///
    /// # Errors
    /// When the program was built without films, the system has no suitable font, or the encoder fails.
    pub(crate) fn encode<E: From<PrintError>>(
        &self,
        format: FilmFormat,
        done: impl FnMut(usize) -> Result<(), E>,
    ) -> Result<Vec<u8>, E> {
        #[cfg(feature = "print")]
        return encoded::encode(self, format, done);
        #[cfg(not(feature = "print"))]
        {
            let _ = (format, done);
            Err(PrintError::NoFilms.into())
        }
    }
}

#[cfg(feature = "print")]
mod encoded {
    use std::collections::HashMap;
    use std::fmt::Display;
    use std::fs::{self, File};
    use std::io::{Read as _, Seek as _, Write as _};
    use std::process::{Child, Command, Stdio};

    use gif::{AnyExtension, DisposalMethod, Frame, Repeat};
    use png::{BitDepth, BlendOp, ColorType, Compression, FilterType};
    use rayon::iter::{IntoParallelIterator as _, ParallelIterator as _};

    use super::{FFMPEG, FilmFormat, PrintError, Reel};
    use crate::output::page::PROGRAM;
    use crate::output::print::Raster;

    pub fn encode<E: From<PrintError>>(
        reel: &Reel<'_>,
        format: FilmFormat,
        mut done: impl FnMut(usize) -> Result<(), E>,
    ) -> Result<Vec<u8>, E> {
        let frames = Frames(reel, Raster::new()?);
        let done = &mut done;
        match format {
            FilmFormat::Mp4 => {
                const MP4: [&str; 8] = [
                    "-c:v",
                    "libx264",
                    "-crf",
                    "18",
                    "-movflags",
                    "+faststart",
                    "-f",
                    "mp4",
                ];
                ffmpeg(&frames, &MP4, done)
            }
            FilmFormat::WebM => {
                const WEBM: [&str; 12] = [
                    "-c:v",
                    "libvpx-vp9",
                    "-crf",
                    "24",
                    "-b:v",
                    "0",
                    "-cpu-used",
                    "4",
                    "-row-mt",
                    "1",
                    "-f",
                    "webm",
                ];
                ffmpeg(&frames, &WEBM, done)
            }
            FilmFormat::Gif => gif(&frames, done),
            FilmFormat::Png => png(&frames, done),
        }
    }

    fn failed(error: impl Display) -> PrintError {
        PrintError::Film(error.to_string())
    }

    /// The pictures as pixels.
    struct Frames<'r>(&'r Reel<'r>, Raster);

    impl Frames<'_> {
        fn frame(&self, number: usize) -> Result<Vec<u8>, PrintError> {
            let Self(reel, raster) = self;
            raster.frame(&(reel.draw)(number), reel.size_px, reel.background)
        }

        /// Draws all pictures, several at a time, and passes them on in order.
        fn each<E: From<PrintError>>(
            &self,
            prepare: impl Fn(Vec<u8>) -> Vec<u8> + Sync,
            mut add: impl FnMut(Vec<u8>) -> Result<(), PrintError>,
            done: &mut dyn FnMut(usize) -> Result<(), E>,
        ) -> Result<(), E> {
            let (count, batch) = (self.0.count, 2 * rayon::current_num_threads());
            for first in (0..count).step_by(batch) {
                let end = count.min(first + batch);
                let frames = (first..end).into_par_iter();
                let frames = frames.map(|number| self.frame(number).map(&prepare));
                let frames: Result<Vec<_>, _> = frames.collect();
                frames?.into_iter().try_for_each(&mut add)?;
                done(end)?;
            }
            Ok(())
        }

        /// Width and height, where the format has 16 bits for them.
        fn size(&self) -> Result<[u16; 2], PrintError> {
            let [width, height] = self.0.size_px.map(u16::try_from);
            Ok([width.map_err(failed)?, height.map_err(failed)?])
        }
    }

    /// The program `ffmpeg`, which ends with its film.
    struct Running(Child);

    impl Drop for Running {
        fn drop(&mut self) {
            // It may have ended.
            let _ = self.0.kill();
            let _ = self.0.wait();
        }
    }

    fn ffmpeg<E: From<PrintError>>(
        frames: &Frames<'_>,
        format: &[&str],
        done: &mut dyn FnMut(usize) -> Result<(), E>,
    ) -> Result<Vec<u8>, E> {
        let [width, height] = frames.0.size_px;
        // Seekable, because the index at the beginning of a film is written last.
        let mut file = tempfile::Builder::new();
        let file = file
            .prefix("archrock-film-")
            .tempfile()
            .map_err(failed)?
            .into_temp_path();
        let mut messages = tempfile::tempfile().map_err(failed)?;
        let mut command = Command::new(FFMPEG);
        command
            .args([
                "-hide_banner",
                "-loglevel",
                "error",
                "-f",
                "rawvideo",
                "-pix_fmt",
                "rgb24",
            ])
            .args(["-video_size", &format!("{width}x{height}")])
            .args(["-framerate", &frames.0.rate_hz.to_string(), "-i", "-"])
            // Players take the colours of films of this size for those of BT.709.
            .args([
                "-vf",
                "scale=out_color_matrix=bt709:out_range=tv",
                "-pix_fmt",
                "yuv420p",
            ])
            .args([
                "-colorspace",
                "bt709",
                "-color_primaries",
                "bt709",
                "-color_trc",
                "bt709",
            ])
            .args(["-metadata", &format!("comment={PROGRAM}")])
            .args(format)
            .arg("-y")
            .arg(&file)
            .stdin(Stdio::piped())
            .stdout(Stdio::null())
            .stderr(messages.try_clone().map_err(failed)?);
        let mut program = Running(command.spawn().map_err(failed)?);
        let mut input = program.0.stdin.take();
        let add = |frame: Vec<u8>| {
            let written = input
                .as_mut()
                .map_or(Ok(()), |input| input.write_all(&frame));
            written.map_err(|_| reason(&mut program, &mut messages))
        };
        frames.each(|frame| frame, add, done)?;
        drop(input);
        match program.0.wait() {
            Ok(status) if status.success() => Ok(fs::read(&file).map_err(failed)?),
            _ => Err(reason(&mut program, &mut messages).into()),
        }
    }

    /// Returns the last messages of `ffmpeg`, which has failed.
    fn reason(program: &mut Running, messages: &mut File) -> PrintError {
        let _ = program.0.wait();
        let mut text = String::new();
        // Without its messages the film has failed all the same.
        let _ = messages
            .rewind()
            .and_then(|()| messages.read_to_string(&mut text));
        let lines: Vec<&str> = text
            .lines()
            .map(str::trim)
            .filter(|line| !line.is_empty())
            .collect();
        let last = &lines[lines.len().saturating_sub(3)..];
        failed(format!("ffmpeg failed: {}", last.join("; ")))
    }

    /// Number of colours of GIF and indexed PNG.
    const COLOURS: usize = 256;
    /// The last colour is transparent: the pixel is that of the picture before.
    const UNCHANGED: u8 = u8::MAX;

    /// The most frequent colours of a film. A drawing has few colours; softened edges get the nearest ones.
    struct Palette(Vec<[u8; 3]>);

    impl Palette {
        /// Takes the colours of the first, the middle and the last picture.
        fn of(frames: &Frames<'_>) -> Result<Self, PrintError> {
            let mut counts: HashMap<[u8; 3], usize> = HashMap::new();
            let last = frames.0.count.saturating_sub(1);
            for number in [0, last / 2, last] {
                for pixel in frames.frame(number)?.chunks_exact(3) {
                    *counts.entry([pixel[0], pixel[1], pixel[2]]).or_default() += 1;
                }
            }
            let mut colours: Vec<_> = counts.into_iter().collect();
            colours.sort_by_key(|(colour, count)| (usize::MAX - count, *colour));
            let mut colours: Vec<_> = colours.into_iter().map(|(colour, _)| colour).collect();
            colours.truncate(UNCHANGED.into());
            Ok(Self(colours))
        }

        /// Returns red, green and blue of all colours, with unused ones at the end.
        fn bytes(&self) -> Vec<u8> {
            let mut bytes = self.0.concat();
            bytes.resize(3 * COLOURS, 0);
            bytes
        }

        /// Returns the number of the nearest colour of each pixel.
        fn indices(&self, pixels: &[u8]) -> Vec<u8> {
            let mut known: HashMap<[u8; 3], u8> = HashMap::new();
            let mut last = ([0; 3], self.nearest([0; 3]));
            let pixels = pixels.chunks_exact(3);
            let index = pixels.map(|pixel| {
                let pixel = [pixel[0], pixel[1], pixel[2]];
                if pixel != last.0 {
                    last = (
                        pixel,
                        *known.entry(pixel).or_insert_with(|| self.nearest(pixel)),
                    );
                }
                last.1
            });
            index.collect()
        }

        fn nearest(&self, pixel: [u8; 3]) -> u8 {
            let distance = |colour: &[u8; 3]| -> u32 {
                let parts = colour.iter().zip(pixel);
                parts.map(|(a, b)| u32::from(a.abs_diff(b)).pow(2)).sum()
            };
            let nearest = (0..UNCHANGED)
                .zip(&self.0)
                .min_by_key(|(_, colour)| distance(colour));
            nearest.map_or(0, |(index, _)| index)
        }
    }

    /// Returns the changed pixels of a picture, and keeps the picture for the next one.
    fn changes(last: &mut Vec<u8>, new: Vec<u8>) -> Vec<u8> {
        let pairs = new.iter().zip(last.iter());
        let mut changed: Vec<u8> = pairs
            .map(|(new, last)| if new == last { UNCHANGED } else { *new })
            .collect();
        if changed.is_empty() {
            changed.clone_from(&new);
        }
        *last = new;
        changed
    }

    fn gif<E: From<PrintError>>(
        frames: &Frames<'_>,
        done: &mut dyn FnMut(usize) -> Result<(), E>,
    ) -> Result<Vec<u8>, E> {
        /// The label of a comment.
        const COMMENT: AnyExtension = AnyExtension(0xFE);
        let (palette, [width, height]) = (Palette::of(frames)?, frames.size()?);
        let (mut file, mut last) = (Vec::new(), Vec::new());
        let encoder = gif::Encoder::new(&mut file, width, height, &palette.bytes());
        let mut encoder = encoder.map_err(failed)?;
        encoder.set_repeat(Repeat::Infinite).map_err(failed)?;
        let comment = encoder.write_raw_extension(COMMENT, &[PROGRAM.as_bytes()]);
        comment.map_err(failed)?;
        let add = |frame| {
            let frame = Frame {
                width,
                height,
                // In hundredths of a second.
                delay: 100 / frames.0.rate_hz,
                transparent: Some(UNCHANGED),
                dispose: DisposalMethod::Keep,
                buffer: changes(&mut last, frame).into(),
                ..Frame::default()
            };
            encoder.write_frame(&frame).map_err(failed)
        };
        frames.each(|frame| palette.indices(&frame), add, done)?;
        drop(encoder);
        Ok(file)
    }

    fn png<E: From<PrintError>>(
        frames: &Frames<'_>,
        done: &mut dyn FnMut(usize) -> Result<(), E>,
    ) -> Result<Vec<u8>, E> {
        let (palette, [width, height]) = (Palette::of(frames)?, frames.0.size_px);
        let (mut file, mut last) = (Vec::new(), Vec::new());
        let mut encoder = png::Encoder::new(&mut file, width, height);
        encoder.set_color(ColorType::Indexed);
        encoder.set_depth(BitDepth::Eight);
        encoder.set_filter(FilterType::NoFilter);
        encoder.set_compression(Compression::Default);
        encoder.set_palette(palette.bytes());
        let mut opacity = vec![u8::MAX; COLOURS];
        opacity[usize::from(UNCHANGED)] = 0;
        encoder.set_trns(opacity);
        let count = u32::try_from(frames.0.count).map_err(failed)?;
        let header = encoder
            .set_animated(count, 0)
            .and_then(|()| encoder.set_frame_delay(1, frames.0.rate_hz))
            .and_then(|()| encoder.set_blend_op(BlendOp::Over))
            .and_then(|()| encoder.add_text_chunk("Software".to_owned(), PROGRAM.to_owned()))
            .and_then(|()| encoder.write_header());
        let mut writer = header.map_err(failed)?;
        let add = |frame| {
            let changed = changes(&mut last, frame);
            writer.write_image_data(&changed).map_err(failed)
        };
        frames.each(|frame| palette.indices(&frame), add, done)?;
        writer.finish().map_err(failed)?;
        Ok(file)
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
            false => Err(PrintError::NoFilms),
        };
        assert_eq!(format("talk/a.GIF"), expected);
    }
}
