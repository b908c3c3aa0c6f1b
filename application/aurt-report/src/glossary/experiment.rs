//! The sections and keys of an experiment file.

use super::Term;

/// The terms.
pub const TERMS: &[Term] = &[
    Term {
        name: "arm_terms",
        title: "[[arm_terms]]: physics beyond a joint's own friction",
        text: "Each table adds one term to the model: a load on a link, rotor inertia, a spring, coupled wrist motors. \
            `model` names it; `aurt models` lists them, `aurt explain NAME` says which keys it has. With \
            `recordings = [...]` it acts in these alone: a load that was there on Tuesday only.",
    },
    Term {
        name: "base",
        title: "base and tip of the chain",
        text: "Under [robot], with `urdf` or `mjcf`: the links between which the chain of joints lies. Without them it begins at the \
            file's root link and ends where its only moving chain does.",
    },
    Term {
        name: "calibration",
        title: "calibration",
        text: "Under [recordings]: the recordings that the model is fitted to. Let all joints move at once, slowly and fast, \
            through the workspace that matters; `aurt check` says what is missing. In a diagnosis with targets they \
            are of the robot as the model knows it. The section [calibration] says how the fit is made: see \
            estimator, prior, load_torque, rest.",
    },
    Term {
        name: "columns",
        title: "columns of a recording",
        text: "Columns of a file whose header does not tell: `columns = { time = 0, position = [1, 6], \
            measurement = [13, 18] }` counts from 0, first and last of one column per joint; names instead \
            of numbers select columns by their header. Without it columns are found by the usual names: \
            timestamp, actual_q_0, q_0, current_0, torque_0 and others.",
    },
    Term {
        name: "count_ends",
        title: "count_ends",
        text: "Whether rows count that have an end of a recording or a gap, at which the robot moves, within the filters' memory; \
            false by default. Filters have to continue the series there themselves, and predictions and measured rows are off, \
            by several times their noise. true is the treatment of the paper.",
    },
    Term {
        name: "estimator",
        title: "estimator",
        text: "How the estimate is made: \"wls\" (default) weights rows by 1/σ² of their joint, \"ols\" \
            equally (see wls); \"consistent\" gives a physically possible machine, \"essential\" the \
            fewest parameters that predict as well, \"irls\" robust weights for rows with impacts.",
    },
    Term {
        name: "experiment",
        title: "experiment file",
        text: "One TOML file: the robot's geometry ([robot]), friction ([joint_dynamics], [[arm_terms]]), the \
            data ([recordings]), filters ([preprocess]). `aurt run` calibrates and validates it, `aurt \
            diagnose` finds what it lacks. `aurt demo` writes one to start from; docs/experiment-file.md \
            lists every key.",
    },
    Term {
        name: "file",
        title: "file of a recording",
        text: "The file's name, from the folder of the experiment; `$NAME` and `${NAME}` stand for variables of the \
            environment, `$$` for a `$`. An entry of [recordings] is the name alone, or a table with more: \
            { file = \"monday.csv\", window_s = [0.0, 30.0] }.",
    },
    Term {
        name: "gravity",
        title: "gravity_m_s2",
        text: "Gravitational acceleration in the frame of the robot's base, which describes its mounting: [0, \
            0, -9.81] upright, [0, 0, 9.81] hanging from the ceiling, [0, 6.937, -6.937] tilted by 45°.",
    },
    Term {
        name: "instrument",
        title: "[instrument]: what measuring does",
        text: "One entry per joint: the measurement reads gains · τ(t − delay_s) + offsets. It is undone \
            before anything is fitted. Leave it out unless the values are known or a diagnosis wrote them.",
    },
    Term {
        name: "joint_dynamics",
        title: "[joint_dynamics]: friction of the joints",
        text: "Friction is f_C(τ_J) · H(z, q̇) + f_v(q̇): `coulomb` (how it grows with the load), `hysteresis` (what happens \
            at reversals), `viscous` (how it grows with speed), each { model = \"…\" }. [[joint_dynamics.override]] gives \
            other models to the `joints` that it lists. `aurt models` lists them; [sweep] tries many.",
    },
    Term {
        name: "max_gap_s",
        title: "max_gap_s",
        text: "Longer gaps between stamps split a recording: see gaps. By default 0.1 s or ten periods, whichever is \
            longer.",
    },
    Term {
        name: "mdh",
        title: "mdh: the robot's geometry",
        text: "A table of modified Denavit–Hartenberg parameters, one row per joint, columns alpha, a, d and, where a joint \
            slides, type. Instead of it `urdf` or `mjcf` names a robot description file (with `base` and `tip` where it has \
            several chains), or `name` a robot of `aurt robots`. `mdh_rows` says \
            which joint a row's alpha and a lead to: \"next\" (as manufacturers' tables have it; default) or \"previous\" \
            (Craig, Khalil). Read the wrong way the same file silently describes another robot: compare the number of base \
            parameters with what you expect (36 for a UR10e standing upright).",
    },
    Term {
        name: "mjcf",
        title: "mjcf: a MuJoCo model file",
        text: "Under [robot], instead of `mdh`, `urdf` or `name`: an MJCF file, of which the geometry of one serial chain is \
            read; `base` and `tip` choose it by the names of bodies, and the base is the world without. Masses of shapes are \
            not computed; docs/robots.md says what is read.",
    },
    Term {
        name: "name",
        title: "name of a known robot",
        text: "Under [robot], instead of `mdh`, `urdf` or `mjcf`: a robot whose geometry is included, such as \"ur10e\". `aurt robots` \
            lists them.",
    },
    Term {
        name: "parallel_cutoff_hz",
        title: "parallel_cutoff_hz",
        text: "Cut-off of the filter that regressor and measurement pass alike, by default 2 f_dyn: see parallel_filter.",
    },
    Term {
        name: "plugins",
        title: "[plugins]: models of your own",
        text: "`libraries = [\"libmine.so\"]` loads friction models and arm terms from dynamic libraries; `aurt new-plugin \
            NAME` writes one to start from. Loading one runs its code: it has to be trusted (`aurt trust`, `--allow-plugins`).",
    },
    Term {
        name: "position_cutoff_hz",
        title: "position_cutoff_hz",
        text: "Cut-off of the filter of the positions, from which velocity and acceleration are formed, by default 5 f_dyn. \
            It must stay below half the sampling rate.",
    },
    Term {
        name: "preprocess",
        title: "[preprocess]: filters and grid",
        text: "f_dyn_hz is the key that matters; cut-offs and decimation follow from it. `aurt check` names the value that \
            suits a recording. See f_dyn, rest, max_gap_s, sample_rate_hz.",
    },
    Term {
        name: "recordings",
        title: "[recordings]: the data and their parts",
        text: "calibration is fitted; validation is held out; target (diagnoses only) is what may have \
            changed; simulated is another simulator's prediction of it. See each of these.",
    },
    Term {
        name: "prior",
        title: "prior",
        text: "Under [calibration], with estimator = \"consistent\": `prior = \"description\"` takes the inertial parameters of the \
            robot's URDF or MJCF file for what the recordings leave open. `prior_weight` pulls all estimates there, in \
            squared standard deviations for each unit of divergence; docs/estimation.md has the equation.",
    },
    Term {
        name: "robot",
        title: "[robot]",
        text: "Geometry, mounting and drives: see mdh, gravity, torque_constants.",
    },
    Term {
        name: "sample_rate_hz",
        title: "sample_rate_hz",
        text: "Rate of the uniform grid that irregular recordings are put on; by default that of their stamps. \
            Models need neighbouring samples at equal distances, for derivatives and filters.",
    },
    Term {
        name: "simulated",
        title: "simulated: another simulator's prediction",
        text: "Under [recordings], for `aurt diagnose`: one file for each questioned recording with the torques that another \
            simulator predicts at the same time stamps. The question is then what that simulator lacks.",
    },
    Term {
        name: "sweep",
        title: "[sweep]: variants of an experiment",
        text: "Lists of values for keys of the experiment; `aurt sweep` tries all combinations and ranks them \
            on held-out data. Other commands ignore the section.",
    },
    Term {
        name: "target",
        title: "target recordings",
        text: "Under [recordings], for `aurt diagnose`: recordings in which something may have changed, \
            beside calibration recordings of the robot that the model describes. The answer separates what \
            has changed in the target from what the model lacks in all recordings. Without target the \
            question is what the model lacks in its calibration recordings. Validation must then be of the \
            robot as it is in the target.",
    },
    Term {
        name: "tip",
        title: "tip of the chain",
        text: "Under [robot], with `urdf` or `mjcf`: the last link of the chain; see base.",
    },
    Term {
        name: "trim_rest",
        title: "trim_rest",
        text: "Whether rest before and after the motion is cut, from what is fitted and from what a held-out recording is \
            judged by; true by default. See rest.",
    },
    Term {
        name: "unit",
        title: "unit of a measurement",
        text: "\"A\" for motor currents, \"Nm\" for torques, where column names do not tell. All recordings of an experiment \
            measure the same quantity, and the model has its unit; see torque_constants.",
    },
    Term {
        name: "unphysical",
        title: "unphysical parameters",
        text: "A value that is impossible by more than its noise: a body whose inertia violates the triangle \
            inequality, a negative rotor inertia, friction that adds power at recorded speeds and loads. \
            Predictions of similar motions may still be good; simulations can be unstable, and the value \
            stands for something else. Record what determines the parameter, leave it out, or run `aurt \
            diagnose`.",
    },
    Term {
        name: "urdf",
        title: "urdf: a robot description file",
        text: "Under [robot], instead of `mdh`, `mjcf` or `name`: a URDF file, of which the geometry of one serial chain is read; `base` \
            and `tip` choose it. Files of xacro have to be expanded first; docs/robots.md says what is read.",
    },
    Term {
        name: "validation",
        title: "validation recordings",
        text: "Under [recordings]: held-out recordings that judge the model. Use other motions than those of \
            the calibration, of the kind that the model is for. In a diagnosis with targets they are of \
            the robot as it is in the targets, after the change: a part of a target cut off with window_s, \
            or a second recording. Without any, a diagnosis holds out the last quarter of each questioned \
            recording.",
    },
    Term {
        name: "window_s",
        title: "window_s",
        text: "The part of a recording that is used, [begin, end] in s since its first stamp. The same file may stand under \
            calibration and under validation with other windows.",
    },
];
