//! Terms and warnings of reading, preprocessing and checking recordings, and of searching shapes.

use super::Term;

/// The terms.
pub const TERMS: &[Term] = &[
    Term {
        name: "combined",
        title: "determined in combinations only",
        text: "The motion determines a weighted sum of these parameters, not each by itself. Their single \
            values are not meaningful; predictions of similar motions are not affected. Motions that move \
            the joints independently of each other separate them.",
    },
    Term {
        name: "corrupt_rows",
        title: "corrupt rows",
        text: "Rows with impossible values (1e150, say). Up to 1 % of a file are left out and reported, and \
            the motion is interpolated across them. More are refused: check the logger.",
    },
    Term {
        name: "decimation",
        title: "decimation",
        text: "After the filter only every F_DS-th row is kept, F_DS = 0.8 / (4 f_dyn T_S): filtered \
            neighbouring rows carry the same information, and counting all of them would make confidence \
            intervals too narrow.",
    },
    Term {
        name: "dropped_samples",
        title: "missing rows",
        text: "Stamps whose distance is a multiple of the usual one: rows that the logger lost. Positions are \
            interpolated across short gaps; gaps longer than max_gap_s split the recording. Log to memory or to \
            a faster disk, or at a lower rate.",
    },
    Term {
        name: "gaps",
        title: "gaps",
        text: "Distances between stamps above max_gap_s (by default 0.1 s or ten periods, whichever is \
            longer). They split a recording in segments that are filtered by themselves, because a filter must \
            not run across what was not recorded.",
    },
    Term {
        name: "irregular_clock",
        title: "irregular clock",
        text: "The distances between stamps vary by more than 2 % of a period. Positions are put on a uniform \
            grid by a cubic spline, measurements linearly. Harmless as long as the jitter is that of the stamps; \
            if samples were taken regularly and stamped late, stamp them where they are taken.",
    },
    Term {
        name: "out_of_reach",
        title: "out of reach",
        text: "Parameters on which this motion does not depend: their columns of the observation matrix are \
            zero. Calibrated on it they stay zero, and motions that depend on them are predicted wrongly. \
            Move the joints concerned.",
    },
    Term {
        name: "own_share",
        title: "own share of a parameter",
        text: "The part of a parameter's torque that no combination of the other parameters can imitate, as a \
            share. Its standard deviation is one over this share times what it would be alone: below 2 % it is \
            hard to tell from the others.",
    },
    Term {
        name: "parallel_filter",
        title: "parallel filter",
        text: "A low-pass at 2 f_dyn that regressor and measurement pass alike, forward and backward. Because \
            both pass it, the fit is not biased by it; without it, noise above the robot's dynamics would \
            dominate.",
    },
    Term {
        name: "search_not_settled",
        title: "the search for shape parameters did not settle",
        text: "The shape parameters were still moving when the search stopped. Their values are the best \
            found. Give a start closer to the solution in the experiment, limit the model to fewer \
            elements, or set fit_shapes = false.",
    },
    Term {
        name: "shape_at_bound",
        title: "shape parameters at a bound",
        text: "The search ended at the bound of a shape parameter, where the model becomes a simpler one or \
            the recordings do not determine it. A simpler model is as good; compare both in a sweep.",
    },
    Term {
        name: "shape_not_determined",
        title: "shape parameters that are not determined",
        text: "The error hardly depends on them: these recordings do not show what the shape parameter \
            describes. Record slow reversals for memory effects, slow creeping for Stribeck velocities.",
    },
    Term {
        name: "shape_parameter",
        title: "shape parameter",
        text: "A parameter in which a friction model is not linear, such as a Stribeck velocity or a \
            presliding distance. It is searched from several starts (variable projection), the linear \
            coefficients following at each step; starts says how many searches agree.",
    },
    Term {
        name: "velocity_scale",
        title: "logged velocity against derivative of position",
        text: "The factor between the logged velocity and the derivative of the position, joint by joint. 1 \
            is right; 57.3 or 0.0175 indicate degrees, −1 a sign, other values swapped columns or gear \
            ratios. aurt uses positions only, so nothing else is affected.",
    },
];
