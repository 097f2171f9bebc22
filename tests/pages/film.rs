//! Films, decoded again: their pictures are those of the history at equal intervals.

use std::fs;

use roxmltree::Document;

use crate::common::program::{names, printed, refused, scenarios};
use crate::common::results::{named, points};

fn pulse() -> String {
    let path = scenarios().join("semicircle-pulse.toml");
    path.display().to_string()
}

/// Pictures between two samples are those of a history that has samples there.
#[test]
fn pictures_between_samples_are_interpolated() {
    let folder = tempfile::tempdir().unwrap();
    let own = pulse();
    let corners = |step: &str| {
        let step = format!("simulation.output_step_s={step}");
        let pulse = "ground.rectangular.amplitude_g=-0.30";
        let end = [
            "--set",
            "simulation.duration_s=0.9",
            "--set",
            &step,
            "--set",
            pulse,
        ];
        let arguments = [
            "run",
            &own,
            "--out",
            "o",
            "--film",
            "500",
            "--exaggerate",
            "20",
        ];
        printed(folder.path(), &[&arguments[..], &end].concat());
        let film = folder.path().join("o/film");
        let frames = names(&film).into_iter();
        let frames = frames.map(|name| fs::read_to_string(film.join(name)).unwrap());
        let corners = frames.map(|frame| {
            let picture = Document::parse(&frame).unwrap();
            let bodies = (0..3).flat_map(|body| {
                let marks = named(&picture, &format!("body {body}")).into_iter();
                marks.flat_map(|mark| points(&mark)).collect::<Vec<_>>()
            });
            bodies.collect::<Vec<_>>()
        });
        corners.collect::<Vec<_>>()
    };
    // Samples every 5 ms, of which the film shows every second or third instant, and samples at all its instants.
    let (between, at) = (corners("0.005"), corners("0.002"));
    assert_eq!((between.len(), at.len()), (451, 451));
    let mut largest_px: f64 = 0.0;
    for (frame, (between, at)) in between.iter().zip(&at).enumerate() {
        assert_eq!(between.len(), at.len(), "picture {frame}");
        for (a, b) in between.iter().zip(at) {
            largest_px = largest_px.max((a - b).norm());
        }
    }
    // A body that accelerates by a deviates from even motion by a dt^2 / 8.
    assert!(largest_px < 0.05, "{largest_px}");
    let first_and_last = at[0].iter().zip(at.last().unwrap());
    let moved_px = first_and_last
        .map(|(a, b)| (a - b).norm())
        .fold(0.0, f64::max);
    assert!(moved_px > 5.0, "the film moves by {moved_px}");
}

#[test]
fn wrong_options_of_a_film_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let own = pulse();
    let built = cfg!(feature = "print");
    for (options, words) in [
        (&["--out", "a.avi"][..], "mp4, webm, gif and png"),
        (&["--out", "a"], "mp4, webm, gif and png"),
        (&["--out", "a.gif", "--size", "640x361"], "even numbers"),
        (&["--out", "a.gif", "--size", "640"], "such as 1280x720"),
        (&["--out", "a.gif", "--speed", "0"], "0.001 to 1000"),
        (&["--out", "a.gif", "--exaggerate", "0"], "0.001 to 1000000"),
        (&["--out", "a.gif", "--background", "reddish"], "rrggbb"),
        (&["--out", "none/a.gif"], "none/a.gif"),
        (&["--out", "a.gif", "--speed", "0.001"], "greater speed"),
    ] {
        let words = match options {
            _ if built => words,
            [_, "a.avi" | "a", ..] | [_, _, "--background", _] => words,
            [_, _, "--size", "640"] => words,
            _ => "cargo install --path . --locked --features print",
        };
        refused(
            folder.path(),
            &[&["film", &own], options].concat(),
            &[words],
        );
    }
    let words = match built {
        true => "one model",
        false => "cargo install --path . --locked --features print",
    };
    let blocks = scenarios().join("free-hinges.toml").display().to_string();
    let several = ["film", &blocks, "--hinges", "four,free"];
    refused(folder.path(), &several, &[words]);
    assert!(names(folder.path()).is_empty());
}

#[cfg(feature = "print")]
mod decoded {
    use super::*;
    use crate::common::program::{archrock, command, skip_without, stderr};
    use std::path::Path;
    use std::process::Command;

    /// Pictures of a film, as red, green and blue of each pixel.
    type Pictures = Vec<Vec<[u8; 3]>>;

    /// Draws a picture of a film over the one before, whose pixels stay where it is transparent.
    fn over(pictures: &mut Pictures, pixels: &[u8]) {
        let mut picture = pictures.last().cloned().unwrap_or_default();
        picture.resize(pixels.len() / 4, [0; 3]);
        for (pixel, new) in picture.iter_mut().zip(pixels.chunks_exact(4)) {
            if new[3] == u8::MAX {
                pixel.copy_from_slice(&new[..3]);
            }
        }
        pictures.push(picture);
    }

    fn of_gif(file: &[u8], size_px: [u16; 2]) -> Pictures {
        let mut options = gif::DecodeOptions::new();
        options.set_color_output(gif::ColorOutput::RGBA);
        let mut decoder = options.read_info(file).unwrap();
        assert_eq!([decoder.width(), decoder.height()], size_px);
        let mut pictures = Vec::new();
        while let Some(frame) = decoder.read_next_frame().unwrap() {
            assert_eq!(frame.delay, 4, "25 a second");
            over(&mut pictures, &frame.buffer);
        }
        assert_eq!(decoder.repeat(), gif::Repeat::Infinite);
        pictures
    }

    fn of_png(file: &[u8], size_px: [u16; 2]) -> Pictures {
        let mut decoder = png::Decoder::new(file);
        decoder.set_transformations(png::Transformations::EXPAND);
        let mut reader = decoder.read_info().unwrap();
        let info = reader.info();
        assert_eq!([info.width, info.height], size_px.map(u32::from));
        let count = info.animation_control().unwrap().num_frames;
        let mut pictures = Vec::new();
        for _ in 0..count {
            let mut pixels = vec![0; reader.output_buffer_size()];
            reader.next_frame(&mut pixels).unwrap();
            let frame = reader.info().frame_control().unwrap();
            assert_eq!((frame.delay_num, frame.delay_den), (1, 25));
            over(&mut pictures, &pixels);
        }
        pictures
    }

    const SIZE_PX: [usize; 2] = [320, 240];
    /// Rows with the structure.
    const STRUCTURE: std::ops::Range<usize> = SIZE_PX[0] * 60..SIZE_PX[0] * 160;
    /// The caption.
    const BELOW: std::ops::RangeFrom<usize> = SIZE_PX[0] * 200..;

    /// Makes a GIF of 0.8 s, and returns its pictures.
    fn film(folder: &Path, options: &[&str]) -> Pictures {
        let own = pulse();
        let set = "simulation.duration_s=0.8";
        let arguments = [
            "film", &own, "--out", "a.gif", "--size", "320x240", "--set", set,
        ];
        printed(folder, &[&arguments[..], options].concat());
        of_gif(&fs::read(folder.join("a.gif")).unwrap(), [320, 240])
    }

    /// Number of pixels that differ visibly.
    fn different(a: &[[u8; 3]], b: &[[u8; 3]]) -> usize {
        let differ =
            |(a, b): &(&[u8; 3], &[u8; 3])| a.iter().zip(*b).any(|(a, b)| a.abs_diff(*b) > 60);
        a.iter().zip(b).filter(differ).count()
    }

    #[test]
    fn a_film_has_a_picture_every_25th_of_a_second() {
        let folder = tempfile::tempdir().unwrap();
        let at = folder.path();
        let usual = film(at, &["--caption", "M"]);
        assert_eq!(usual.len(), 21);
        // Animated PNG has the same pictures.
        let (own, set) = (pulse(), "simulation.duration_s=0.8");
        let arguments = [
            "film", &own, "--out", "a.png", "--size", "320x240", "--set", set,
        ];
        printed(at, &[&arguments[..], &["--caption", "M"]].concat());
        assert!(of_png(&fs::read(at.join("a.png")).unwrap(), [320, 240]) == usual);
        assert!(usual.windows(2).all(|pair| pair[0] != pair[1]), "it moves");
        // The first picture is at rest: its displacements are zero times any factor. Softened edges have the colours of two palettes.
        let exaggerated = film(at, &["--caption", "M", "--exaggerate", "20"]);
        let moved =
            |number: usize| different(&usual[number][STRUCTURE], &exaggerated[number][STRUCTURE]);
        assert!(moved(0) < 20, "{}", moved(0));
        assert!(moved(10) > 500, "{}", moved(10));
        // At half the speed there are twice as many pictures, and every second one is the same but for its palette.
        let slow = film(at, &["--caption", "M", "--speed", "0.5"]);
        assert_eq!(slow.len(), 41);
        for (number, picture) in usual.iter().enumerate() {
            let other = different(picture, &slow[2 * number]);
            assert!(other < 60, "{other} pixels of picture {number}");
        }
    }

    #[test]
    fn an_earlier_film_is_replaced_and_another_file_is_not() {
        let folder = tempfile::tempdir().unwrap();
        let (at, own) = (folder.path(), pulse());
        film(at, &["--speed", "4"]);
        assert_eq!(film(at, &["--speed", "8"]).len(), 3);
        fs::write(at.join("b.gif"), "GIF89a of somebody else").unwrap();
        refused(at, &["film", &own, "--out", "b.gif"], &["did not write it"]);
        assert!(fs::read(at.join("b.gif")).unwrap().ends_with(b"else"));
    }

    #[test]
    fn the_film_of_the_mirrored_motion_is_the_mirror_image() {
        let folder = tempfile::tempdir().unwrap();
        let with = |more: &[&str]| {
            let options = ["--caption", "", "--exaggerate", "10"];
            film(folder.path(), &[&options[..], more].concat())
        };
        let right = with(&[]);
        let left = with(&["--set", "ground.rectangular.amplitude_g=0.30"]);
        assert_eq!(right.len(), left.len());
        for (number, (right, left)) in right.iter().zip(&left).enumerate().step_by(5) {
            let rows = left[STRUCTURE].chunks_exact(SIZE_PX[0]);
            let mirror: Vec<[u8; 3]> = rows.flat_map(|row| row.iter().rev().copied()).collect();
            // Only softened edges differ.
            let mirror = different(&right[STRUCTURE], &mirror);
            assert!(mirror < 300, "{mirror} pixels of picture {number}");
            let same = different(&right[STRUCTURE], &left[STRUCTURE]);
            assert!(
                number == 0 || same > 1000,
                "{same} pixels of picture {number}"
            );
        }
    }

    #[test]
    fn backgrounds_and_captions_are_those_of_the_options() {
        let folder = tempfile::tempdir().unwrap();
        let film = |options: &[&str]| film(folder.path(), &[&["--speed", "8"], options].concat());
        assert_eq!(film(&[])[2][0], [255; 3]);
        assert_eq!(film(&["--background", "f5f0e6"])[2][0], [0xf5, 0xf0, 0xe6]);
        let bright = |options: &[&str]| {
            let dark = film(&[&["--background", "black"], options].concat());
            dark[0][BELOW].iter().filter(|pixel| pixel[1] > 200).count()
        };
        // Texts are white on black.
        let (legend, own) = (bright(&[]), bright(&["--caption", "M"]));
        assert!(
            legend > 100 && own > 0 && own < legend / 4,
            "{legend}, {own}"
        );
        assert_eq!(bright(&["--caption", ""]), 0);
    }

    /// The number of pictures, the size and the duration of a film, by ffprobe.
    fn probed(folder: &Path, file: &str) -> (String, f64) {
        let shown = "stream=codec_name,width,height,nb_read_frames,avg_frame_rate:format=duration";
        let output = Command::new("ffprobe")
            .args([
                "-v",
                "error",
                "-count_frames",
                "-of",
                "csv=p=0",
                "-show_entries",
                shown,
                file,
            ])
            .current_dir(folder)
            .output()
            .unwrap();
        assert!(output.status.success(), "{output:?}");
        let text = String::from_utf8(output.stdout).unwrap();
        let (stream, duration_s) = text.trim().split_once('\n').unwrap();
        (stream.to_owned(), duration_s.parse().unwrap())
    }

    #[test]
    fn ffmpeg_encodes_mp4_and_webm() {
        let found = Command::new("ffprobe").arg("-version").output();
        if !found.is_ok_and(|output| output.status.success()) {
            skip_without("ffmpeg");
            return;
        }
        let folder = tempfile::tempdir().unwrap();
        let (at, own) = (folder.path(), pulse());
        let end = ["--set", "simulation.duration_s=0.4", "--size", "320x180"];
        let output = archrock(at, &[&["film", &own], &end[..]].concat());
        let path = format!(
            "results{0}semicircle-pulse{0}film.mp4",
            std::path::MAIN_SEPARATOR
        );
        assert!(
            stderr(&output).contains(&format!("{path}: 11 pictures of 320x180")),
            "{output:?}"
        );
        assert_eq!(
            names(&at.join("results/semicircle-pulse")),
            ["archrock.json", "film.mp4"]
        );
        printed(at, &[&["film", &own, "--out", "a.webm"], &end[..]].concat());
        for (file, codec) in [(&*path, "h264"), ("a.webm", "vp9")] {
            let (stream, duration_s) = probed(at, file);
            assert_eq!(stream, format!("{codec},320,180,25/1,11"));
            assert!((duration_s - 11.0 / 25.0).abs() < 0.01, "{duration_s}");
        }
        // The earlier film is replaced.
        printed(
            at,
            &[&["film", &own, "--out", "a.webm", "--speed", "2"], &end[..]].concat(),
        );
        assert!(probed(at, "a.webm").0.ends_with(",6"));
    }

    /// Without ffmpeg MP4 is refused and GIF is the default; if it fails its message is shown, and there is no file.
    #[cfg(unix)]
    #[test]
    fn a_missing_or_failing_encoder_leaves_no_file() {
        use std::os::unix::fs::PermissionsExt as _;
        let folder = tempfile::tempdir().unwrap();
        let (at, own) = (folder.path(), pulse());
        let tools = at.join("tools");
        fs::create_dir(&tools).unwrap();
        let run = |options: &[&str]| {
            let size = ["--size", "320x180", "--set", "simulation.duration_s=0.2"];
            let arguments = [&["film", &own], options, &size].concat();
            command(at, &arguments)
                .env("PATH", &tools)
                .output()
                .unwrap()
        };
        let output = run(&["--out", "a.mp4"]);
        assert_eq!(output.status.code(), Some(2));
        assert!(
            stderr(&output).contains("needs the program ffmpeg")
                || stderr(&output).contains("need the program ffmpeg")
        );
        assert!(run(&[]).status.success());
        assert_eq!(
            names(&at.join("results/semicircle-pulse")),
            ["archrock.json", "film.gif"]
        );
        let script = "#!/bin/sh\n[ \"$1\" = -version ] && exit 0\necho 'Unknown encoder libx264' >&2\nexit 1\n";
        fs::write(tools.join("ffmpeg"), script).unwrap();
        fs::set_permissions(tools.join("ffmpeg"), fs::Permissions::from_mode(0o755)).unwrap();
        for options in [&["--out", "a.mp4"][..], &[]] {
            let output = run(options);
            assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
            assert!(stderr(&output).contains("ffmpeg failed: Unknown encoder libx264"));
        }
        assert_eq!(names(at), ["results", "tools"]);
        assert_eq!(
            names(&at.join("results/semicircle-pulse")),
            ["archrock.json", "film.gif"]
        );
    }
}
