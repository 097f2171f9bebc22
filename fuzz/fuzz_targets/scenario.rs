//! The scenario reader: every text is read or refused, with an error in printable words.
#![no_main]

use archrock::scenario::{Scenario, shown};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    match Scenario::parse(text, "s.toml") {
        // A valid scenario reads back the same.
        Ok(scenario) => assert_eq!(Scenario::parse(&scenario.to_toml(), "s.toml"), Ok(scenario)),
        Err(errors) => {
            assert!(!errors.0.is_empty());
            let lines = text.split('\n').count();
            for error in &errors.0 {
                let place = error.place.expect("an error in a text has a place");
                assert!((1..=lines).contains(&place.line) && place.column >= 1);
                assert_eq!(
                    shown(&error.message),
                    error.message,
                    "hidden characters are escaped"
                );
            }
        }
    }
});
