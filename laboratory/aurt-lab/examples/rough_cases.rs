//! Makes cases of the rough world: `rough_cases PLAN.toml SEED OUT` writes `OUT/cases`, `OUT/sealed` and a line per case.

use std::path::Path;
use std::time::Instant;

use aurt_simulation::case::{Plan, World};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [plan, seed, out] = arguments.as_slice() else {
        return Err("usage: rough_cases PLAN.toml SEED OUT".into());
    };
    let (plan, seed, out) = (Plan::read(plan)?, seed.parse()?, Path::new(out));
    let (cases, sealed) = (out.join("cases"), out.join("sealed"));
    std::fs::create_dir_all(&cases)?;
    std::fs::create_dir_all(&sealed)?;
    for index in 0..plan.requests(seed)?.len() {
        let name = Plan::case_name(index);
        let begun = Instant::now();
        match plan.make_in(World::Rough, seed, index) {
            Ok(case) => {
                case.write(&cases, &sealed)?;
                let effects: Vec<&str> = case.truth.effects.iter().map(|e| e.effect.as_str()).collect();
                let recordings = case.files.len() - 2;
                let seconds = begun.elapsed().as_secs_f64();
                println!("{name} {} {recordings} recordings, {seconds:.1} s: {effects:?}", case.truth.robot);
            }
            Err(error) => println!("{name} could not be made: {error}"),
        }
    }
    Ok(())
}
