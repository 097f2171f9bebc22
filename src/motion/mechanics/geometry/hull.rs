//! Convex hulls of points.

use nalgebra::Vector2;

use super::field::quarter_turn;

/// Whether the convex hulls of two sets of points are further apart than a length. A line between two polygons can be turned until it is
/// parallel to an edge of one of them, so the edges of both are tried.
pub fn are_apart(sets: [&[Vector2<f64>]; 2], length: f64) -> bool {
    let edges = sets.into_iter().flat_map(edges);
    edges.map(quarter_turn).any(|normal| {
        let [one, other] = sets.map(|points| {
            let distances = points.iter().map(|point| point.dot(&normal));
            distances.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], at| {
                [low.min(at), high.max(at)]
            })
        });
        (one[0] - other[1]).max(other[0] - one[1]) > length * normal.norm()
    })
}

/// Edges of the convex hull of points as vectors (A. M. Andrew, "Another efficient algorithm for convex hulls in two dimensions",
/// Information Processing Letters 9, 1979).
fn edges(points: &[Vector2<f64>]) -> Vec<Vector2<f64>> {
    let mut points = points.to_vec();
    points.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    let mut edges = Vec::new();
    for _ in 0..2 {
        let mut chain: Vec<Vector2<f64>> = Vec::new();
        for point in &points {
            while let [.., before, last] = chain[..]
                && (last - before).perp(&(point - last)) <= 0.0
            {
                chain.pop();
            }
            chain.push(*point);
        }
        edges.extend(chain.windows(2).map(|pair| pair[1] - pair[0]));
        points.reverse();
    }
    edges
}
