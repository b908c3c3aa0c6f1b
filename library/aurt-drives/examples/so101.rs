//! development
#![allow(missing_docs, clippy::unwrap_used)]
use aurt_drives::*;
use aurt_rbd::RobotDescription;
fn main() {
    let data = std::path::PathBuf::from(std::env::var("AURT_DATA").unwrap()).join("so101");
    let config: toml::Table =
        toml::from_str(&std::fs::read_to_string(std::env::args().nth(1).unwrap()).unwrap()).unwrap();
    let tip = config.get("tip").map_or("moving_jaw_so101_v1_link", |t| t.as_str().unwrap());
    let robot = aurt_robots::read(data.join("so101_new_calib.urdf"), None, Some(tip)).unwrap();
    let chain = robot.chain([0.0, 0.0, -9.81]).unwrap();
    let n = chain.joints().len();
    let joint = |j: usize| {
        let mut drive = config["drive"].as_table().unwrap().clone();
        let mut mech = config["mechanics"].as_table().unwrap().clone();
        if let Some(o) = config.get(&format!("joint{j}")) {
            for (k, v) in o.as_table().unwrap() {
                if Mechanics::default().numbers().iter().any(|p| p.parameter.name == *k) {
                    mech.insert(k.clone(), v.clone());
                } else {
                    drive.insert(k.clone(), v.clone());
                }
            }
        }
        DrivenJoint { drive: drive.try_into().unwrap(), mechanics: mech.try_into().unwrap() }
    };
    let floor = config.get("floor").map(|f| f.clone().try_into().unwrap());
    let arm = DrivenArm {
        standard_parameters: robot.standard_parameters.clone().unwrap(),
        joints: (0..n).map(joint).collect(),
        chain,
        floor,
    };
    let mut names: Vec<String> = std::fs::read_dir(&data)
        .unwrap()
        .map(|e| e.unwrap().file_name().into_string().unwrap())
        .filter(|n| n.ends_with(".csv"))
        .collect();
    names.sort();
    let read = |name: &String| {
        let text = std::fs::read_to_string(data.join(name)).unwrap();
        let rows: Vec<Vec<f64>> =
            text.lines().skip(1).map(|l| l.split(',').map(|x| x.parse().unwrap()).collect()).collect();
        let col = |c: usize| rows.iter().map(|r| r[c]).collect::<Vec<f64>>();
        DriveRecording {
            time_s: col(0),
            command: (1..1 + n).map(col).collect(),
            position_rad: (7..7 + n).map(col).collect(),
            ..DriveRecording::default()
        }
    };
    let all: Vec<DriveRecording> = names.iter().map(read).collect();
    let swap = config.get("swap").is_some_and(|s| s.as_bool().unwrap()) as usize;
    let fit: Vec<usize> = (0..all.len()).filter(|k| k % 2 == swap).collect();
    let list = |key: &str| {
        config.get(key).map_or(vec![], |l| {
            l.as_array().unwrap().iter().map(|x| x.as_str().unwrap().to_owned()).collect::<Vec<_>>()
        })
    };
    let dev = config.get("deviations").map_or(vec![], |d| {
        d.as_table().unwrap().iter().map(|(k, v)| (k.clone(), v.as_float().unwrap())).collect()
    });
    let selection = Selection { estimate: list("estimate"), shared: list("shared"), deviations: dev };
    let options = Options {
        most_iterations: config.get("iterations").map_or(40, |i| i.as_integer().unwrap() as usize),
        ..Options::default()
    };
    let recs: Vec<DriveRecording> = fit.iter().map(|k| all[*k].clone()).collect();
    let out = output_error(&arm, &selection, &recs, &options).unwrap();
    println!(
        "{} iterations, {} passes, {:.1} s, converged {}",
        out.iterations, out.passes, out.seconds, out.converged
    );
    if config.get("quiet").is_none() {
        for x in &out.numbers {
            println!(
                "  {:34} {:9.4} ± {:<9.4} {} (was {:.4} ± {:.4}){}",
                x.name,
                x.value,
                x.deviation,
                x.unit,
                x.start,
                x.start_deviation,
                if x.at_bound { " at bound" } else { "" }
            );
        }
        for u in &out.undetermined {
            println!("  {u} ({:.3})", u.information);
        }
    }
    if let Some(path) = std::env::args().nth(2) {
        let mut text = String::new();
        for j in 0..n {
            text += &format!("[joint{j}]\n");
            for p in [out.arm.joints[j].drive.parameters(), out.arm.joints[j].mechanics.numbers()].concat() {
                if p.value.abs() < 1e9 {
                    text += &format!("{} = {:?}\n", p.parameter.name, p.value);
                }
            }
        }
        if let Some(f) = &out.arm.floor {
            text += "[floor]\n";
            for p in f.numbers() {
                text += &format!("{} = {:?}\n", p.parameter.name, p.value);
            }
        }
        std::fs::write(path, text).unwrap();
    }
    let judged = 5;
    let mut sums = [[0.0; 2]; 2];
    let mut cmd = [[0.0; 2]; 2];
    for (k, rec) in all.iter().enumerate() {
        let q = out.arm.rollout(rec).unwrap();
        let rms: Vec<f64> = (0..n)
            .map(|j| {
                (q[j].iter().zip(&rec.position_rad[j]).map(|(a, b)| (a - b).powi(2)).sum::<f64>()
                    / q[j].len() as f64)
                    .sqrt()
                    * 1e3
            })
            .collect();
        let held = usize::from(!fit.contains(&k));
        for j in 0..judged {
            sums[held][0] += rms[j].powi(2) * q[j].len() as f64;
            sums[held][1] += q[j].len() as f64;
            cmd[held][0] +=
                rec.command[j].iter().zip(&rec.position_rad[j]).map(|(a, b)| (a - b).powi(2)).sum::<f64>()
                    * 1e6;
        }
        println!(
            "{} {:28} {}  all {:.1}",
            ["fit ", "held"][held],
            names[k],
            rms.iter().map(|r| format!("{r:6.1}")).collect::<Vec<_>>().join(""),
            (rms[..judged].iter().map(|r| r * r).sum::<f64>() / judged as f64).sqrt()
        );
    }
    for h in 0..2 {
        println!(
            "{} {:.2} mrad, command {:.2}",
            ["fit ", "held"][h],
            (sums[h][0] / sums[h][1]).sqrt(),
            (cmd[h][0] / sums[h][1]).sqrt()
        );
    }
}
