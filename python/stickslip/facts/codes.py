"""Codes of all facts."""

from __future__ import annotations

from enum import Enum


class Code(str, Enum):
    """What a `Fact` says; the values are those of report.json, and of sentences.toml."""

    # What of the tables is not used.
    ROWS_LEFT_OUT = "rows-left-out"  #: More than a few rows of a table are not used.
    CELL_COUNT = "cell-count"  #: Rows with fewer or more cells than the table has columns.
    NOT_A_NUMBER = "not-a-number"  #: Rows whose cell should be a number and is none.
    REPEATED_ROW = "repeated-row"  #: Rows that repeat an earlier one.
    SETTING_REFUSED = "setting-refused"  #: Rows with a setting that no scenario can have.
    SETTING_TOO_LARGE = "setting-too-large"  #: Rows with a setting so large that its unit is wrong.
    SETTING_TOO_SMALL = "setting-too-small"  #: Rows with a setting so small that its unit is wrong.
    EQUAL_SETTINGS = "equal-settings"  #: Values of a setting that count as one.
    OUTLIER = "outlier"  #: A trial absurdly far from the others of its condition.
    TOO_FAST = "too-fast"  #: Velocities so large that their unit must be wrong.
    BAD_CELLS = "bad-cells"  #: Rows with a cell that is no number, too few cells or too many.
    COMMENTS = "comments"  #: Lines between the rows that are comments.
    EMPTY_COLUMNS = "empty-columns"  #: Columns without a name and without a cell.
    COLUMNS_NOT_USED = "columns-not-used"  #: Columns that say nothing to the diagnosis.
    GAPS = "gaps"  #: An optional column has cells that are no number.
    NO_SOUND_ROW = "no-sound-row"  #: A table without a row that can be used.
    FRAMES_SORTED = "frames-sorted"  #: Frames were put in the order of time.
    REPEATED_TIMES = "repeated-times"  #: Frames whose time an earlier one has.
    FRAMES_AFTER_DRIVE = "frames-after-drive"  #: Frames after the last pulse.
    FRAMES_NOT_NEEDED = "frames-not-needed"  #: Frames beyond those that are enough.
    FRAME_RATE_NOT_USED = "frame-rate-not-used"  #: The stated rate contradicts the times of frames.
    RUN_TOO_SHORT = "run-too-short"  #: A film with too few sound frames.
    RUN_TIME_UNIT = "run-time-unit"  #: A film whose times can only be in ms or numbers of frames.
    RUN_ANGLE_UNIT = "run-angle-unit"  #: A film whose angles can only be in degrees.
    RUN_LENGTH_UNIT = "run-length-unit"  #: A film whose places can only be in mm or um.
    RUN_STANDS_STILL = "run-stands-still"  #: A film in which nothing changes.
    COLUMN_TOO_SHORT = "column-too-short"  #: An optional column of a film with too few numbers.
    COLUMN_SIZE = "column-size"  #: A column of a film that is far from the stated model's.
    WILD_FRAMES = "wild-frames"  #: Frames far from all others of their phase.
    ANGLE_BEYOND_TURN = "angle-beyond-turn"  #: An angle of more than half a turn.
    LONELY_ANGLE = "lonely-angle"  #: An angle far from both its neighbours, which agree.
    PROBES_ON_WIRE = "probes-on-wire"  #: Rows of a field table that lie on the wire of a coil.
    FAR_FIELD = "far-field"  #: A field that no gain of the coils gives.
    CONDITION_NOT_COMPUTED = "condition-not-computed"  #: The stated model cannot compute it.

    # What is known of the noise.
    NOISE_STATED = "noise-stated"  #: Too few repeats; the stated relative error is used.
    NOISE_UNKNOWN = "noise-unknown"  #: Too few repeats, and no stated error.
    SETUPS = "setups"  #: Scatter between the set-ups of the apparatus.
    #: The table does not say which trials belong to one set-up.
    NO_BLOCK_COLUMN = "no-block-column"
    ONE_BLOCK = "one-block"  #: There is one set-up only.
    SETUPS_NOT_CROSSED = "setups-not-crossed"  #: No condition was repeated in another set-up.
    ERRORS_CORRELATED = "errors-correlated"  #: Neighbouring readings of a run share their error.
    ERRORS_INDEPENDENT = "errors-independent"  #: No correlation within runs is seen.
    CORRELATION_UNKNOWN = "correlation-unknown"  #: Too few readings in runs tell it.
    CURVES_NOT_SMOOTH = "curves-not-smooth"  #: Nor do runs that smooth curves do not follow.
    UNEVEN_SETUP = "uneven-setup"  #: The trials of one set-up scatter more than all others.
    MODEL_JUMPS = "model-jumps"  #: The model itself jumps by more than the noise.
    NO_RESPONSE = "no-response"  #: Causes that change no prediction.
    FEW_PULSES = "few-pulses"  #: Drives so short that their velocities include the start-up.
    STATED_RUNS = "stated-runs"  #: What the runs of the stated model are noted for.
    STANDS_STILL = "stands-still"  #: Conditions that read zero where the stated model moves.
    READING_NOISE = "reading-noise"  #: Noise of an angle or a field, widened as it is an estimate.
    #: The noise found is below what a reading can have, which is taken.
    READING_NOISE_SMALL = "reading-noise-small"
    #: Too few rows tell the noise; what a reading can have is taken.
    READING_NOISE_UNKNOWN = "reading-noise-unknown"
    FRAME_NOISE = "frame-noise"  #: Noise of a frame from repeats of a phase.
    FRAME_NOISE_ABOVE_STATED = "frame-noise-above-stated"  #: Frames scatter more than was stated.
    #: Nothing tells the noise of a frame; the whole misfit counts as noise.
    FRAME_NOISE_UNKNOWN = "frame-noise-unknown"
    FRAMES_CORRELATED = "frames-correlated"  #: Frames that follow each other share their error.
    ROUNDED_COLUMN = "rounded-column"  #: A film is rounded to steps wider than its noise.
    PERIODS_DIFFER = "periods-differ"  #: Periods of a film differ by more than the noise of frames.
    ADVANCE_SCATTERS = "advance-scatters"  #: Periods of a film advance by different distances.

    # Why the data allow no diagnosis.
    STATED_PROBLEM = "stated-problem"  #: A problem that the caller stated.
    ALL_ZERO = "all-zero"  #: Every reading is zero.
    TOO_FEW_CONDITIONS = "too-few-conditions"  #: Too few conditions to tell causes apart.
    NO_NOISE = "no-noise"  #: No error is known by which a misfit could be judged.
    CONDITIONS_ALIKE = "conditions-alike"  #: The conditions differ by no more than their trials do.
    ROUNDED = "rounded"  #: Repeated trials read alike too often.
    DRIFT = "drift"  #: Velocities change with the order in which they were measured.
    NOTHING_COMPUTED = "nothing-computed"  #: The stated model can compute no condition.
    VELOCITIES_SIZE = "velocities-size"  #: The velocities are far from what the stated model gives.
    VELOCITY_SIZE = "velocity-size"  #: A velocity is far above the stated model's fastest.
    OPPOSITE_SIGN = "opposite-sign"  #: The velocities have the opposite sign of the stated model's.
    SPEEDS = "speeds"  #: The velocities have no sign.
    REVERSED = "reversed"  #: The velocities of one direction or mode have the reverse sign.

    # Why a verdict is what it is, and no more definite one.
    NOTHING_DETECTED = "nothing-detected"  #: Both tests pass.
    RUNNER_UP = "runner-up"  #: The best of the others, which is behind.
    OTHER_LEADS = "other-leads"  #: Another candidate leads.
    #: Another candidate leads, but does not explain the data.
    OTHER_LEADS_UNEXPLAINED = "other-leads-unexplained"
    NEAREST = "nearest"  #: The candidate with the least misfit, where none explains the data.
    ALIKE = "alike"  #: The effects of the candidates on these data are alike.
    NOT_SEPARATED = "not-separated"  #: The evidence does not separate the candidates.
    SEVERAL_PAIRS = "several-pairs"  #: Several pairs explain the data about as well.
    LITTLE_EVIDENCE = "little-evidence"  #: The log-evidence is hardly above that of no cause.
    STARTS_DISAGREE = "starts-disagree"  #: Fits from different starts do not agree.
    NOT_PREDICTED_BETTER = "not-predicted-better"  #: Left-out conditions are not predicted better.
    AT_LIMIT = "at-limit"  #: An amplitude is at the end of its physical range.
    TABLE_CONTRADICTS = "table-contradicts"  #: One kind of table contradicts the candidate.
    TRAINING_SUBSET = "training-subset"  #: Without the held-out conditions another would lead.
    SMOOTH_REST = "smooth-rest"  #: The candidate leaves too much that is smooth.
    NO_EXPLANATION = "no-explanation"  #: No cause and no pair brings the misfit down to the noise.
    LESS_LIKELY = "less-likely"  #: What explains the data is less likely than what does not.
    LAW_BESIDE_CAUSES = "law-beside-causes"  #: One law of another shape explains as much.
    #: No single cause is adequate, and a pair leads by too little.
    PAIR_LEADS_TOO_LITTLE = "pair-leads-too-little"
    ERRORS_CONTRADICTED = "errors-contradicted"  #: A residual is too large for the error model.
    #: With correlated errors, which are not excluded, it would lead by too little.
    MAY_BE_CORRELATED = "may-be-correlated"
    CONSTANT_PULLED = "constant-pulled"  #: The fit needs a constant far from its prior.
    NOTHING_LEFT = "nothing-left"  #: No second cause is seen beside the named one.
    NO_FREE_SHAPE = "no-free-shape"  #: No law of a free shape explains the data.
    FREE_SHAPE = "free-shape"  #: A law of another shape explains the data.
    FREE_SHAPE_MEANING = "free-shape-meaning"  #: What f(u) is, and for which u it is known.
    FREE_TERM_MEANING = "free-term-meaning"  #: The same of a curve that is no factor.
    FREE_SHAPE_RIVALS = "free-shape-rivals"  #: Others explain them about as well.
    FREE_SHAPE_GAIN = "free-shape-gain"  #: What it gains on held-out conditions.
    FREE_SHAPE_FORMULA = "free-shape-formula"  #: A formula in the place of the curve.
    PAIR_NEEDED = "pair-needed"  #: No single cause explains the data as well as the pair.

    # What to measure next.
    NAME_SAFE = "name-safe"  #: What is claimed leads all that lack it by enough.
    NEAR_RIVAL = "near-rival"  #: A candidate is too near to what is claimed.
    NO_SAFE_NAME = "no-safe-name"  #: The verdict is ambiguous.
    NOTHING_TO_SEPARATE = "nothing-to-separate"  #: The verdict leaves no candidates.
    SEPARATES = "separates"  #: A drive tells two candidates apart.
    #: A drive is the best of those that were tried, and does not tell two candidates apart.
    SEPARATES_TOO_LITTLE = "separates-too-little"
    NONE_SEPARATES = "none-separates"  #: No drive that was tried tells the candidates apart.
    LOOK_AT_CURRENTS = "look-at-currents"  #: The coil currents would tell members of a set apart.
    LOOK_AT_FIELD = "look-at-field"  #: The field at the robot would tell members of a set apart.
    LOOK_AT_TILT = "look-at-tilt"  #: Tilting the stage would tell members of a set apart.
    LOOK_AT_SCALE = "look-at-scale"  #: A scale in the film would tell members of a set apart.
    LOOK_AT_CLOCK = "look-at-clock"  #: A clock in the film would tell members of a set apart.
    LOOK_AT_REST = "look-at-rest"  #: The robot without a field would tell members of a set apart.
    #: Static tilts in held fields would tell members of a set apart.
    LOOK_AT_STATIC_TILT = "look-at-static-tilt"

    # What the verdict rests on.
    MISFIT_EVEN = "misfit-even"  #: The misfit is about the same in all parts of the data.
    MISFIT_UNEVEN = "misfit-uneven"  #: The misfit is larger in some parts of the data.
    VELOCITIES_UNCHANGED = "velocities-unchanged"  #: A cause hardly changes the velocities.
    VELOCITIES_FASTER = "velocities-faster"  #: A cause makes all velocities faster.
    VELOCITIES_SLOWER = "velocities-slower"  #: A cause makes all velocities slower.
    VELOCITIES_SHIFTED = "velocities-shifted"  #: A cause shifts all velocities one way.
    VELOCITIES_MIXED = "velocities-mixed"  #: A cause makes some velocities faster or slower.
    CONSTANT_CHANGES = "constant-changes"  #: Two parts of the data do not agree about a constant.
    TRADE_OFF = "trade-off"  #: Constants that can change together without a change of the readings.
    LITTLE_KNOWN = "little-known"  #: The data say little about a constant.

    # What angles, fields and films say of the models.
    ANGLE_MISFIT = "angle-misfit"  #: Errors of the models' angles.
    ANGLE_MODEL = "angle-model"  #: What an angle of the model is.
    NO_ANGLE_WITHOUT_FIELD = "no-angle-without-field"  #: No angle was read without a field.
    FIELD_MISFIT = "field-misfit"  #: Errors of the models' fields.
    NO_SMOOTHED_MOTION = "no-smoothed-motion"  #: A film whose motion over a pulse is not drawn.
    ADVANCE = "advance"  #: Distance that the robot moves in a pulse, measured and of the models.
    #: Nothing drifts from period to period beyond the simulation.
    NO_DRIFT_OF_PERIODS = "no-drift-of-periods"
    DRIFT_OF_TILT = "drift-of-tilt"  #: The tilt drifts from period to period beyond the simulation.
    #: The advance drifts from period to period beyond the simulation.
    DRIFT_OF_ADVANCE = "drift-of-advance"
    DIRECTIONS_TOO_SHORT = "directions-too-short"  #: A film of two directions shows no advance.
    DIRECTIONS_CANCEL = "directions-cancel"  #: Advances of two directions are equal and opposite.
    DIRECTIONS_DIFFER = "directions-differ"  #: The advances of two directions do not cancel.

    # What the page of a diagnosis says first, and its five answers.
    HEADLINE_NAMED = "headline-named"  #: One cause is named.
    HEADLINE_PAIR = "headline-pair"  #: Two causes act together.
    HEADLINE_PERHAPS = "headline-perhaps"  #: One candidate, or one pair, that is not certain.
    HEADLINE_SET = "headline-set"  #: One of several, and the data cannot say which.
    HEADLINE_NEAREST = "headline-nearest"  #: The same where something unknown is more likely.
    HEADLINE_NONE = "headline-none"  #: Nothing is found.
    HEADLINE_NONE_OPEN = "headline-none-open"  #: Nothing was found, and that is not sure.
    HEADLINE_UNEXPLAINED = "headline-unexplained"  #: Nothing that was tried explains the data.
    HEADLINE_NO_CAUSE = "headline-no-cause"  #: The same where no cause was given.
    HEADLINE_LAW = "headline-law"  #: Nor does a cause, but a law of another shape does.
    HEADLINE_REFUSED = "headline-refused"  #: The data allow no diagnosis.
    WHAT_CAUSE = "what-cause"  #: What a cause is.
    WHAT_NOTHING = "what-nothing"  #: The recalibrated model describes the data.
    WHAT_MOVED = "what-moved"  #: Which constants recalibration has moved, and how far.
    WHAT_UNKNOWN = "what-unknown"  #: No cause that was tried.
    WHAT_DATA = "what-data"  #: The data and not the model.
    SIZE_OF_CAUSE = "size-of-cause"  #: A parameter with its error and its interval.
    SIZE_NOT_CERTAIN = "size-not-certain"  #: The same of a fit that did not converge.
    #: The same where the error alone would contradict the interval.
    SIZE_IN_INTERVAL = "size-in-interval"
    SIZE_OF_LAW = "size-of-law"  #: How large a law of another shape is.
    SIZE_LIMITS = "size-limits"  #: How large some causes could be, where nothing was found.
    SIZE_HIDDEN = "size-hidden"  #: The cause that could be largest and not be seen.
    SIZE_UNLIMITED = "size-unlimited"  #: How many causes these data do not limit.
    SIZE_OF_MISFIT = "size-of-misfit"  #: How far the recalibrated model is from the data.
    SIZE_UNKNOWN = "size-unknown"  #: Nothing was fitted.
    SURE_OF_CAUSE = "sure-of-cause"  #: The probability of what is claimed.
    SURE_OF_CLOSE = "sure-of-close"  #: The probabilities are too near each other.
    SURE_OF_ALIKE = "sure-of-alike"  #: The probabilities do not tell the causes of a set apart.
    SURE_OF_RUNNER_UP = "sure-of-runner-up"  #: How much less likely the next best is.
    SURE_OF_MISFIT = "sure-of-misfit"  #: How probable such a misfit is by noise.
    SURE_OF_NOTHING = "sure-of-nothing"  #: The same, and the probability of no cause.
    SURE_OF_LAW = "sure-of-law"  #: How much more probable the data are with the law.
    SURE_OF_REST = "sure-of-rest"  #: The extended model's errors are more than noise explains.
    SURE_OF_REFUSAL = "sure-of-refusal"  #: A refusal says nothing of causes.
    DO_REMEDY = "do-remedy"  #: What to do about one cause.
    DO_KEEP_ROBOT = "do-keep-robot"  #: The same where the readings alone are wrong.
    DO_KEEP = "do-keep"  #: Go on with the extended model.
    DO_VALUES = "do-values"  #: Where the values are of the extended model of one's own.
    DO_EXPERIMENT = "do-experiment"  #: What to measure next.
    DO_MEASURE_MORE = "do-measure-more"  #: No experiment is proposed.
    DO_CONFIRM = "do-confirm"  #: Use the recalibrated model.
    DO_LEADING = "do-leading"  #: Of a set, the extended model has the leading one.
    DO_FREE_SHAPES = "do-free-shapes"  #: Ask for laws of another shape.
    DO_LOOK = "do-look"  #: Where to look for what is unexplained.
    DO_CORRECT = "do-correct"  #: Correct the table and diagnose it again.
    BETTER_FALLS = "better-falls"  #: Errors on held-out conditions surely fall.
    BETTER_NOT_SURE = "better-not-sure"  #: Their fall may be chance.
    BETTER_TOO_FEW = "better-too-few"  #: The fit is sure, and the gain cannot be.
    BETTER_WORSE = "better-worse"  #: They grow.
    BETTER_IN_FIT = "better-in-fit"  #: Nothing was held out; errors of the fit alone.
    BETTER_CONSTANTS = "better-constants"  #: Only the constants are better.
    BETTER_ALONE = "better-alone"  #: No other model is asked for.
    BETTER_UNKNOWN = "better-unknown"  #: No model that was tried explains the data.
    BETTER_NO_MODEL = "better-no-model"  #: No model was fitted.
