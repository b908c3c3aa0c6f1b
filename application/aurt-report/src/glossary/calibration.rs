//! Terms of models, calibration and validation.

use super::Term;

/// The terms.
pub const TERMS: &[Term] = &[
    Term {
        name: "badly_excited",
        title: "badly excited parameters",
        text: "The standard deviation of these parameters exceeds half their value, and a tenth of the \
            largest value of their unit: the motions hardly depend on them. `aurt check` reports them \
            before a calibration by the same rule. Predictions of similar motions are not affected, but \
            the values are not meaningful by themselves, and motions that depend on them are predicted \
            badly. Record motions that move these joints faster, further, or together with others.",
    },
    Term {
        name: "base_parameters",
        title: "base inertial parameters",
        text: "The minimal set of inertial parameters that joint torques depend on. Mass, first moments and \
            inertia of neighbouring links act in fixed combinations, so torques determine only these; \
            `stands_for` in the model file, and `aurt compile-rbd`, say which standard parameters each one \
            collects. How many there are depends on geometry and on the direction of gravity.",
    },
    Term {
        name: "condition_number",
        title: "condition number",
        text: "How much the least-squares solution can amplify errors of the measurement: the ratio of the \
            largest to the smallest singular value of the weighted observation matrix, its columns scaled to \
            equal length so that units do not matter. Below 100 a recording excites the model well; far above \
            it, some combination of parameters is nearly undetermined.",
    },
    Term {
        name: "extrapolation",
        title: "extrapolation",
        text: "A joint moves faster, or carries more, than in the calibration recordings (by more than 5 %). \
            Friction laws are fitted within the range that was recorded; outside it a polynomial, the cubic \
            term above all, can be far off. Record the faster or heavier motion for calibration too, or use a \
            model with fewer powers.",
    },
    Term {
        name: "f_dyn",
        title: "f_dyn, frequency of the robot's dynamics",
        text: "The highest frequency of the motion that the fit uses. Positions are low-passed at 5 f_dyn, \
            regressor and measurement at 2 f_dyn, and only every F_DS-th row is kept, F_DS = 0.8 / (4 \
            f_dyn T_S). The paper uses 10 Hz at 500 Hz sampling; slow motions sampled at 100 Hz need less, \
            for instance 2.5 Hz. 5 f_dyn must stay below half the sampling rate.",
    },
    Term {
        name: "load_torque",
        title: "load torque τ_J",
        text: "The torque that a joint transmits, on which the Coulomb models `square` and `absolute` depend. \
            `fitted` (default): from the rigid-body coefficients of a first fit. `literal`: the sum of the \
            base regressor's row, as in the paper, which mixes units and is kept for comparison. The \
            measured torque is never used: a prediction would depend on the quantity that it predicts.",
    },
    Term {
        name: "moving",
        title: "moving samples",
        text: "Samples at which the joint's own |q̇| exceeds the rest velocity (0.03 rad/s unless set). Errors over \
            them are robust; errors over all samples depend on what a model says of a resting joint, where \
            the sign of the velocity is that of rounding noise.",
    },
    Term {
        name: "mse",
        title: "MSE, mean squared error",
        text: "The mean of (measured − predicted)², on the filtered and decimated rows, in the unit of the \
            measurement squared.",
    },
    Term {
        name: "nmse",
        title: "NMSE, normalised mean squared error",
        text: "MSE divided by the mean of |measured|, the paper's normalisation (its Table II). It has the unit \
            of the measurement, so it compares recordings of one joint, not currents with torques.",
    },
    Term {
        name: "not_excited",
        title: "parameters that are not excited",
        text: "The calibration recordings do not determine these parameters at all: the joint did not move, \
            or moved in a way that another parameter explains as well. They are zero and have no standard \
            deviation. The model cannot predict motions that depend on them.",
    },
    Term {
        name: "nrms",
        title: "normalised RMS error",
        text: "√(Σ (measured − predicted)² / Σ measured²), in the terminal in percent, in files as a fraction \
            (`nrmse`). 0 is perfect; a model that predicts zero has 100 %.",
    },
    Term {
        name: "position_bias",
        title: "noise of the positions",
        text: "The regressor is computed from measured positions, and their noise (white noise, quantisation) \
            biases estimates, however long the recordings are. The noise is drawn and added once more; the \
            resulting shift (2.4 times it for friction) counts as an error in standard deviations and \
            intervals. A lower f_dyn lets less noise through; shapes at low velocities need fine encoders \
            and motions that do not hover at rest.",
    },
    Term {
        name: "rest",
        title: "rest",
        text: "A joint rests where |q̇| is at or below the rest velocity. There the sign of its velocity is that \
            of noise, while the friction that holds it can have any value up to the break-away level. With \
            `rest = \"keep\"` (the paper, default) such rows are fitted like all others; with \"exclude\" a \
            joint's rows are left out while it rests. Rest before and after the motion is cut either way \
            (`trim_rest`).",
    },
    Term {
        name: "sigma",
        title: "σ, residual standard deviation",
        text: "Of each joint's residual after ordinary least squares (equation 14); its inverse square \
            weights the joint's rows in weighted least squares (equation 13), so that large residuals of a \
            strong joint do not dominate a weak one.",
    },
    Term {
        name: "std_dev",
        title: "standard deviation of a parameter",
        text: "From the covariance of weighted least squares, corrected for the correlation that the parallel \
            filter leaves between rows, for autocorrelated noise and for the bias by position noise. \
            `relative_std_dev_percent` is the same over |value|; `lower_95` and `upper_95` bound the 95 % \
            interval. They do not cover missing physics, with which the true values can lie outside.",
    },
    Term {
        name: "torque_constants",
        title: "torque constants",
        text: "Torque per motor current of each joint's drive, gear included, in Nm/A. With them currents are \
            converted, and all parameters have SI units; without them each joint's coefficients carry its \
            own factor 1/K. If the joints' constants differ, a model without them is wrong, for the links' \
            parameters are shared by several joints.",
    },
    Term {
        name: "wls",
        title: "WLS, weighted least squares",
        text: "The estimator of the paper (equation 13): rows weighted by 1/σ² of their joint. `ols` weights \
            all rows alike. Both are solved by orthogonal factorisation of the rows as they come, so that a \
            recording of any length fits in memory.",
    },
];
