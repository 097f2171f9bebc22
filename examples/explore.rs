use archrock::dynamics::{ground::*, history::*, rocking::*};
use archrock::mechanics::{
    arch::Arch, chain::Chain, impact::*, mechanism::*, ring::Ring, structure::*,
};
fn main() {
    let arch = |b: f64, t, s: Option<usize>, r| {
        let ring = Ring::new(t, b.to_radians()).unwrap();
        Arch {
            mean_radius_m: r,
            depth_m: 1.0,
            density_kg_m3: 2000.0,
            chain: std::sync::Arc::new(
                Chain::new(
                    ring,
                    s.map_or(HingeSites::Anywhere, HingeSites::Voussoirs),
                    ImpactModel::MaxRestitution,
                )
                .unwrap(),
            ),
        }
    };
    let a = arch(180.0, 0.15, None, 5.0);
    let l = a.link(0).unwrap();
    println!(
        "qc {} rot {:?} lim {} {:?}",
        l.critical_rad,
        l.mechanism.rotations(l.critical_rad),
        l.limit_rad,
        l.mechanism.rotations(l.limit_rad)
    );
    let g = GroundMotion::pulse(Pulse::Rectangular, -0.3 * 9.81, 0.2, 0.0);
    let rocking = Rocking::new(&a, &g, 9.81, 1e-8);
    for tol in [1e-9, 1e-13] {
        let req = Request {
            end_s: 10.0,
            relative_tolerance: tol,
            initial: None,
            output_step_s: None,
        };
        let h = history(&rocking, &req, |_| {}).unwrap();
        println!(
            "{:?} {} {} impacts {} peak {:?} defect {:.2e} {:?}",
            h.outcome,
            h.outcome_time_s,
            h.end_s,
            h.impacts.len(),
            h.peak_rotations_rad,
            h.energy_defect_ratio,
            h.cost
        );
        for i in h.impacts.iter().take(3) {
            println!(
                "  {:.10} {:?} {:?} {:?}",
                i.time_s,
                i.rates_rad_s(),
                i.energies(),
                i.impacts
            );
        }
        let t0 = std::time::Instant::now();
        for _ in 0..1000 {
            std::hint::black_box(history(&rocking, &req, |_| {}).unwrap());
        }
        println!("{:?}/hist", t0.elapsed() / 1000);
    }
    let t0 = std::time::Instant::now();
    let mut s = 0.0;
    for i in 0..1000000 {
        s += l.mechanism.coefficients(1e-8 * i as f64).inertia;
    }
    println!("{:?} {s}", t0.elapsed() / 1000000);
    let a = arch(157.5, 0.15, Some(7), 10.0);
    let l = a.link(0).unwrap();
    println!("qc {}", l.critical_rad);
    for tp in [0.2, 0.5, 1.0] {
        let out = |amp: f64| {
            let g = GroundMotion::pulse(Pulse::StepPair, amp * 9.81, tp, 0.0);
            let rocking = Rocking::new(&a, &g, 9.81, 1e-8);
            let h = history(
                &rocking,
                &Request {
                    end_s: 10.0,
                    relative_tolerance: 1e-10,
                    initial: None,
                    output_step_s: None,
                },
                |_| {},
            )
            .unwrap();
            matches!(h.outcome, Outcome::Overturned(_)) && h.impacts.is_empty()
        };
        let (mut lo, mut hi) = (0.37, 8.0);
        while hi - lo > 1e-7 {
            let m = 0.5 * (lo + hi);
            if out(m) { hi = m } else { lo = m }
        }
        println!("{tp} {hi}");
    }
}
