use archrock::mechanics::{impact::*, limit, mechanism::HingeSites, ring::Ring};
fn main() {
    for (b, t, s) in [
        (180.0, 0.15, None),
        (157.5, 0.15, None),
        (157.5, 0.15, Some(7)),
        (157.5, 0.15, Some(28)),
        (180.0, 0.12, None),
        (120.0, 0.1, None),
        (30.0, 0.02, None),
    ] {
        let ring = Ring::new(t, f64::to_radians(b)).unwrap();
        let sites = s.map_or(HingeSites::Anywhere, HingeSites::Voussoirs);
        let i = limit::incipient(&ring, sites).unwrap();
        println!(
            "{b} {t} {s:?} {:.10} {:?}",
            i.acceleration_g,
            i.mechanism.hinges_rad().map(f64::to_degrees)
        );
        for m in [ImpactModel::SameSections, ImpactModel::Mirrored] {
            println!(
                "  {m:?} {:?}",
                impact(&i.mechanism, &ring, sites, m).map(|i| i.restitution)
            );
        }
        let mut m = i.mechanism;
        let t0 = std::time::Instant::now();
        for k in 0..30 {
            let Some(im) = impact(&m, &ring, sites, ImpactModel::MaxRestitution) else {
                println!("none");
                break;
            };
            let five = MomentumTheorems::solve(&im.mechanism, &closing_field(&m, &ring), &ring);
            let h = im.mechanism.hinges_rad().map(|h| {
                if k % 2 == 0 {
                    b - h.to_degrees()
                } else {
                    h.to_degrees()
                }
            });
            if k < 5 || k > 26 {
                println!(
                    "  {k} {:.10} {:?} {:.1e}",
                    im.restitution,
                    h,
                    five.rate / im.rate_ratio - 1.0
                );
            }
            m = im.mechanism;
        }
        println!("{:?}", t0.elapsed());
    }
}
