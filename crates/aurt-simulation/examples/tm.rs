//! timing
use aurt_simulation::fit::*;
use aurt_simulation::*;
fn main() -> Result<(), SimulationError> {
    let robot = robots::ur10e();
    let cpu = || {
        let s = std::fs::read_to_string("/proc/self/stat").unwrap();
        let f: Vec<&str> = s.split(' ').collect();
        (f[13].parse::<f64>().unwrap() + f[14].parse::<f64>().unwrap()) / 100.0
    };
    let m = Motion::MultiSine { duration_s: 30.0, harmonics: 10, top_hz: 1.0, share: 0.7 };
    let sc = Scenario::new(robot.clone(), m.plan(&robot, 1)?, 1);
    let t = cpu();
    for _ in 0..10 {
        trace(&sc)?;
    }
    println!("trace {}", (cpu() - t) / 10.0); let x = trace(&sc)?; println!("evals {} events {} step {}", x.evaluations, x.events, x.step_s);
    let t = cpu();
    for _ in 0..10 {
        m.plan(&robot, 1)?;
    }
    println!("plan {}", (cpu() - t) / 10.0);
    let (rec, _) = simulate_with_traces(&sc)?;
    let t = cpu();
    for _ in 0..10 {
        rec.csv();
    }
    println!("csv {}", (cpu() - t) / 10.0);
    let t = cpu();
    for _ in 0..10 {
        processed_motion(&rec, &robot, 10.0)?;
    }
    println!("preprocess {}", (cpu() - t) / 10.0);
    let p = processed_motion(&rec, &robot, 10.0)?;
    let t = cpu();
    for _ in 0..10 {
        Structure::of(&robot).without_absorbed_rotors(&robot)?;
    }
    println!("structure {}", (cpu() - t) / 10.0);
    let t = cpu();
    for _ in 0..10 {
        ProcessedFit::new(&robot, &Structure::of(&robot), &[&p])?;
    }
    println!("fit {}", (cpu() - t) / 10.0);
    let f = ProcessedFit::new(&robot, &Structure::of(&robot), &[&p])?;
    let t = cpu();
    for _ in 0..10 {
        f.residuals(&p)?;
    }
    println!("residuals {}", (cpu() - t) / 10.0);
    Ok(())
}
