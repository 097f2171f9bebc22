//! Names of hinges and bodies, for programs and for people.

/// Names of the hinges of an arch, from left to right.
pub(crate) const HINGES: [&str; 4] = ["A", "B", "C", "D"];

/// Returns the names of the columns for each body: `rotation_left_rad`, or `rotation_rad` if there is only one body.
pub(crate) fn columns(bodies: &[String], quantity: &str, unit: &str) -> Vec<String> {
    let name = |body: &String| match &**body {
        "" => format!("{quantity}_{unit}"),
        body => format!("{quantity}_{body}_{unit}"),
    };
    bodies.iter().map(name).collect()
}

/// Returns the values of the bodies with their names, from left to right.
pub fn by_body(bodies: &[String], values: &[f64]) -> String {
    let named = bodies.iter().zip(values);
    let texts: Vec<_> = named
        .map(|(body, value)| format!("{body} {value:.6}").trim_start().to_owned())
        .collect();
    texts.join(", ")
}

/// Converts an angle to degrees, without rounding errors at the left springing.
pub(crate) fn degrees(angle_rad: f64) -> f64 {
    let angle_rad = if angle_rad < 1e-12 { 0.0 } else { angle_rad };
    angle_rad.to_degrees()
}
