//! Terms of diagnoses and sweeps.

use super::Term;

/// The terms.
pub const TERMS: &[Term] = &[
    Term {
        name: "alternatives",
        title: "alternatives of a claim",
        text: "Effects that explain the mismatch as well as the claimed one on these recordings. Each comes with what to \
            record to separate it from the claim; record that and diagnose again.",
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
        text: "The share of findings of such a score that were right in proofs on simulated robots; of a \
            class that the data cannot separate the first label is right about every other time. For a \
            real robot, whose noise is not white and whose model lacks several effects at once, it is an \
            upper bound.",
    },
    Term {
        name: "follows",
        title: "what a residual follows",
        text: "The coordinate (position, velocity, load torque, time, another joint's motion …) that predicts \
            most of the residual on held-out stretches of time. It indicates the missing physics: velocity \
            indicates friction, position gravity, a spring or ripple, load an efficiency or load-dependent \
            friction.",
    },
    Term {
        name: "held_out",
        title: "held-out data",
        text: "Rows excluded from selection and fit: the validation recordings or, without any, the last \
            quarter of each questioned recording. Only errors on them show how well a model predicts; \
            errors on fitted rows fall with every added parameter.",
    },
    Term {
        name: "indications",
        title: "indications",
        text: "Effects that describe the recordings but fail a test: their parameters are physically \
            impossible or within two standard deviations of zero, they lower the error of no joint by \
            enough, or held-out data are predicted better without them. They are not claimed and not part \
            of the improved model.",
    },
    Term {
        name: "named",
        title: "verdict: named",
        text: "Something has changed (without targets: is missing), and the claimed effects explain it: each \
            has passed every test, and together they account for most of it, joint by joint and on \
            held-out data. improved.toml has them.",
    },
    Term {
        name: "no_mismatch",
        title: "verdict: no_mismatch",
        text: "These recordings show nothing that the model lacks: the residual is noise. Motions that were \
            not recorded may show more; see not_decidable. `aurt sensitivity` gives the size that an \
            effect could have without being found.",
    },
    Term {
        name: "noise_floor",
        title: "noise floor",
        text: "The residual that a perfect model leaves on a joint: the noise of the measurement after the \
            filter, and the noise of the positions after differentiation and model. No model has less on \
            held-out data. Structure is claimed where a residual exceeds 1.65 times the floor.",
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
        text: "What these recordings do not allow to examine, and why: resting joints, measurements that \
            never change or do not depend on the motion, recordings too short for blocks of time, sampling \
            too slow for impacts and ringing.",
    },
    Term {
        name: "score",
        title: "score of a finding",
        text: "Half the number of independent rows times the logarithm of the error without the effect over \
            that with it, summed over joints, on held-out blocks of time. It has to exceed the threshold \
            beside it.",
    },
    Term {
        name: "shifts",
        title: "shifts",
        text: "Parameters of the rest of the model that moved by more than three standard deviations \
            (autocorrelation and misfit of the residual included) when the claimed effects were added. \
            They had absorbed the missing physics; do not trust their old values.",
    },
    Term {
        name: "stability",
        title: "stability of a finding",
        text: "Share of the blocks of time on which the error of its joints is lower with the finding than \
            without it, everything else in the model. A real effect helps on nearly all of them.",
    },
    Term {
        name: "stands_out",
        title: "windows that stand out",
        text: "Half-second stretches in which the residual exceeds what stationary noise reaches in one recording of a \
            hundred. They indicate contacts, corrupt samples and sudden changes; rows at reversals do not count.",
    },
    Term {
        name: "partly_explained",
        title: "verdict: partly explained",
        text: "The claims hold, each on its own evidence, and something beside them is missing. `explained` is the share \
            of the predictable held-out error that the claims explain; `remainder` shows by joint what the rest follows.",
    },
    Term {
        name: "remainder",
        title: "what is left beside the claims",
        text: "Boosted trees are fitted to the residual of the improved model and judged on held-out rows. What they \
            predict is something that the model lacks; what they do not predict is noise as far as these recordings show.",
    },
    Term {
        name: "structure",
        title: "structure: the second answer",
        text: "With targets, `verdict` says what has changed in them, and `structure`, with the same four \
            words, what the model lacks in all recordings. A change can be clear although the structure is \
            unexplained.",
    },
    Term {
        name: "structure_left",
        title: "structure left",
        text: "More than noise is left of a joint after all claimed effects: boosted trees predict it on held-out rows, or \
            it exceeds 1.65 times the noise floor and shows a pattern. See follows for where to look.",
    },
    Term {
        name: "tied_with_best",
        title: "tied with the best",
        text: "Noise may explain the difference of this variant from the best one, over all joints together. \
            Of tied variants take the one with the fewest coefficients.",
    },
    Term {
        name: "unexplained",
        title: "verdict: unexplained",
        text: "The residual has structure that no known effect explains. The report shows where (joint, time, \
            coordinate), and which registered friction model of a loaded library predicts it \
            (docs/friction-plugin.md). CONTRIBUTING.md says how to add an effect.",
    },
];
