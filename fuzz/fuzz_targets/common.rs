//! Properties of the readers of all record files.

use archrock_records::{Contents, Layout};

/// Reads the contents of a file. They give samples for a ground motion, or an error on one of the lines, in printable words.
pub fn check(layout: &Layout, contents: &[u8]) {
    match layout.parse(contents) {
        Ok(Contents { samples, .. }) => {
            assert!((2..=1_800_000).contains(&samples.len()));
            assert!(samples.iter().all(|s| s.0.abs() <= 1e6 && s.1.is_finite()));
            // Times computed as multiples of a step are rounded.
            assert!(
                samples
                    .windows(2)
                    .all(|pair| pair[1].0 - pair[0].0 > 0.999e-6)
            );
        }
        Err(fault) => {
            let lines = contents.split(|byte| *byte == b'\n').count();
            assert!((1..=lines).contains(&fault.line), "{fault}");
            assert!(!fault.message.is_empty() && fault.message.chars().count() < 1000);
            assert!(!fault.message.chars().any(char::is_control), "{fault}");
        }
    }
}
