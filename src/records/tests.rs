//! Properties of all readers, and what their tests share.

use proptest::prelude::*;

use crate::*;

pub(crate) fn csv_layout() -> Layout {
    let number = TableColumn::Number(1);
    Layout {
        acceleration_column: Some(TableColumn::Name("a".to_owned())),
        ..Layout::table(Times::Column(number), Unit::Gravity)
    }
}

pub(crate) fn parse(text: &str, layout: &Layout) -> Result<Vec<(f64, f64)>, LineFault> {
    layout
        .parse(text.as_bytes())
        .map(|contents| contents.samples)
}

#[track_caller]
pub(crate) fn assert_fault(text: &str, layout: &Layout, line: usize, words: &str) {
    let fault = parse(text, layout).expect_err("faulty");
    assert_eq!(fault.line, line, "{fault:?}");
    assert!(fault.message.contains(words), "{fault:?}");
}

proptest! {
    /// Random and damaged files are either read with ascending times, or are an error.
    #[test]
    fn readers_never_panic(
        noise in any::<String>(),
        words in proptest::collection::vec(proptest::sample::select(WORDS), 0..40),
    ) {
        let damaged: String = words.concat();
        let text = format!("t,a\n{damaged}");
        for text in [&noise, &damaged, &text] {
            let blanks = Layout {
                times: Some(Times::Step(0.01)),
                skip_rows: 1,
                decimal: Decimal::Comma,
                ..Layout::table(Times::Step(0.01), Unit::Gravity)
            };
            let wrapped = Layout {
                wrapped: true,
                skip_rows: 0,
                ..blanks.clone()
            };
            let formats = Format::ALL.iter().map(|format| Layout::new(*format));
            let layouts = formats.chain([csv_layout(), blanks, wrapped]);
            let corrected = layouts.clone().map(|layout| Layout {
                baseline: Some(Baseline::Linear),
                high_pass_hz: Some(1.0),
                ..layout
            });
            for layout in layouts.chain(corrected) {
                match parse(text, &layout) {
                    Ok(samples) => {
                        prop_assert!(samples.len() >= 2);
                        prop_assert!(samples.windows(2).all(|pair| pair[0].0 < pair[1].0));
                        prop_assert!(samples.iter().all(|s| s.0.is_finite() && s.1.is_finite()));
                    }
                    Err(fault) => {
                        let lines = text.split('\n').count();
                        prop_assert!((1..=lines).contains(&fault.line));
                        prop_assert!(!fault.message.contains(char::is_control));
                    }
                }
            }
        }
    }
}

const WORDS: &[&str] = &[
    "Sampling Freq(Hz) 10Hz\n",
    "Scale Factor 3920(gal)/6182761\n",
    "Memo.\n",
    "2 CORRECTED ACCELEROGRAM\n",
    "Corrected accelerogram\n",
    "3 points of accel data equally spaced at .01 sec, in cm/sec2. (8f10.6)\n",
    "3 POINTS OF ACC DATA EQUALLY SPACED AT .01 SEC.\n",
    "* VOL1DS FILE\n",
    "NO. OF POINTS = 2 DURATION = .02\nUNITS ARE SECONDS AND G/10\n",
    "NO. OF POINTS = 2\nUNITS OF UNCOR ACCEL ARE SEC AND G/10.\n",
    "/& End of data\n",
    "1 Real-header values follow on 8 lines, Format= (8F13.6)\n",
    "3 acceleration pts, approx 0 secs, units=cm/sec2(04),Format=(8F10.5)\n",
    "Site \n",
    "Number of points 3\n",
    "1 2 3 4 5 6 7 8 9 10\n",
    "|\n",
    "NUMBER OF DATA : 3\nSAMPLING INTERVAL (sec) : .01\nRAW PGA VALUES (gal) : (N-S) 2\nN-S E-W U-D\n",
    "#RecordLength(sec): 0\n#SampleRate(Hz): 100\n#AmplitudeUnit: gal.\n#DataSequence: Time U(+)\n",
    "ORIENTACION C1: /V/N\nINTERVALO DE MUESTREO, C1: /.01/.01\nNUM. TOTAL DE MUESTRAS, C1: /2/2\nUNIDADES DE LOS DATOS: (Gal)\n----\n",
    "UNCORRECTED ACCELERATION UNIT: GAL\nNO. OF POINTS: 3 SPACED INTERVALS OF: .01 SEC\nPEAK VALUE: 2\n",
    "1e308",
    "NPTS",
    "DT",
    "=",
    " ",
    ",",
    ";",
    "\t",
    "\n",
    "\r\n",
    "2",
    "3",
    ".01",
    "-.5E-03",
    "+",
    "-",
    "e",
    "D",
    "é",
    "\u{1a}",
    "\"",
    "#",
    "UNITS OF ",
    "SAMPLING_INTERVAL_S: .01\n",
    "UNITS: cm/s^2\n",
    "G",
    "nan",
    "VELOCITY TIME",
    "t",
    "a",
    "0,0\n",
    "1,1\n",
];
