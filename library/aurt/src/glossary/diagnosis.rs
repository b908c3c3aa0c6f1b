//! Terms of diagnoses and sweeps.

use super::Term;

/// The terms.
pub const TERMS: &[Term] = &[
    Term {
        name: "ambiguous",
        title: "verdict: ambiguous",
        text: "Several effects would explain the mismatch equally well on these recordings, and the model \
            cannot tell them apart. Each finding lists its alternatives and what to record to separate it from \
            them; record that and diagnose again.",
    },
    Term {
        name: "beyond_noise",
        title: "beyond noise",
        text: "The difference of two variants' errors is larger than noise explains: a paired comparison over \
            blocks of time, corrected (Holm) for the number of comparisons in the column. What is not beyond \
            noise should not decide between models.",
    },
    Term {
        name: "confidence",
        title: "confidence of a finding",
        text: "How often findings of such a score were right in proofs on simulated robots; the first label of a \
            class that the data cannot separate is right about every other time. On a real robot, whose noise is \
            not white and whose model lacks several things at once, it is an upper bound.",
    },
    Term {
        name: "follows",
        title: "what a residual follows",
        text: "The coordinate (position, velocity, load torque, time, another joint's motion …) that predicts \
            most of what is left, judged on stretches of time that it was not learned from. It points to the \
            physics that is still missing: what follows velocity is friction, what follows position is gravity, \
            a spring or ripple, what follows load is an efficiency or a load-dependent friction.",
    },
    Term {
        name: "held_out",
        title: "held-out data",
        text: "Rows excluded from selection and fit: the validation recordings or, where \
            there are none, the last quarter of each questioned recording. Only errors on them say how well a \
            model predicts; errors on fitted rows fall with every parameter that is added.",
    },
    Term {
        name: "indications",
        title: "indications",
        text: "Effects that describe the recordings and fail a test: their parameters are none that a machine has, or \
            within two standard deviations of nothing, or they lower the error of no joint by as much as counts, or \
            held-out data are predicted better without them. They are not claimed, and the improved model does \
            without them.",
    },
    Term {
        name: "named",
        title: "verdict: named",
        text: "Something has changed (without targets: is missing), and it has a name: the effects listed explain it \
            better than any other that is known, each has passed every test, and together they account for most of it, \
            joint by joint and on held-out data. improved.toml has them.",
    },
    Term {
        name: "no_mismatch",
        title: "verdict: no_mismatch",
        text: "Nothing is missing that these recordings could show: the residual is noise. It does not say \
            that the model is right for motions that were not recorded; see not_decidable. `aurt sensitivity` says how \
            large an effect could be and stay hidden.",
    },
    Term {
        name: "noise_floor",
        title: "noise floor",
        text: "The residual that a perfect model would leave on a joint: the white noise of the measurement \
            after the filter, and the noise of the positions as it passes through differentiation and model. No \
            model can have less on held-out data. Structure is claimed where a residual exceeds 1.65 \
            times the floor.",
    },
    Term {
        name: "not_decidable",
        title: "not decidable",
        text: "The motions of these recordings can neither show nor exclude the effect: other parameters of \
            the model absorb nearly all of its torque. The report says what to record to decide it.",
    },
    Term {
        name: "not_examined",
        title: "not examined",
        text: "What these recordings do not let anyone look at, and why: joints that stand, measurements that never \
            change or have no relation to the motion, recordings too short to be judged by stretches of time, sampling \
            too slow for impacts and ringing.",
    },
    Term {
        name: "score",
        title: "score of a finding",
        text: "Half the number of independent rows times the logarithm of the error without the effect over \
            that with it, summed over joints, on blocks of time that were not fitted. Twice as much evidence is \
            twice the score. A finding has to exceed the threshold beside it.",
    },
    Term {
        name: "shifts",
        title: "shifts",
        text: "Parameters of the rest of the model that moved by more than three standard deviations (memory and misfit of \
            the residual included) when the found effects were added. They had absorbed the missing physics, and their old values should not be \
            trusted.",
    },
    Term {
        name: "stability",
        title: "stability of a finding",
        text: "Share of the blocks of time on which the error of its joints is lower with the finding than without it, \
            all else in the model. An effect that is there helps nearly everywhere.",
    },
    Term {
        name: "stands_out",
        title: "windows that stand out",
        text: "Half-second stretches in which a residual is at least 3.5 times both its own median and the \
            noise floor. Contacts, corrupt samples and sudden changes show so; windows at reversals speak of \
            friction at low speed.",
    },
    Term {
        name: "structure",
        title: "structure: the second answer",
        text: "Where targets stand beside other recordings, `verdict` says what has changed in them, and `structure`, in \
            the same four words, what the model lacks in all recordings. An arm whose structure nobody can explain can \
            still have a change that is plain.",
    },
    Term {
        name: "structure_left",
        title: "structure left",
        text: "More than noise is left on a joint after all that was found: its residual exceeds 1.65 times the \
            noise floor. See follows for where to look.",
    },
    Term {
        name: "tied_with_best",
        title: "tied with the best",
        text: "Noise may explain by how much this variant is worse than the best one, over all joints \
            together. Of tied variants take the one with the fewest coefficients.",
    },
    Term {
        name: "unexplained",
        title: "verdict: unexplained",
        text: "The residual has structure, and no effect that aurt knows accounts for it. The report says \
            where it is (joint, time, coordinate), and which registered friction model predicts it, if one of a library \
            that is loaded does (docs/friction-plugin.md). An effect of your own can be added: CONTRIBUTING.md.",
    },
];
