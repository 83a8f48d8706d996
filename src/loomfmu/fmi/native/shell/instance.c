/* The life of an instance: start, steps, end. */

static void fmu_reset(Instance *instance)
{
    State *state = &instance->state;
    memset(state, 0, sizeof *state);
    memset(instance->warned, 0, sizeof instance->warned);
    component_start(&state->component);
    state->origin.component = state->component;
    state->mode = INSTANTIATED;
    state->stop_time = HUGE_VAL;
    state->stale = true;
    instance->last_step = OK;
}

/* Where the host stands, in words. */
static const char *fmu_mode_name(int mode)
{
    switch (mode) {
    case INSTANTIATED:
        return "instantiated";
    case INITIALIZING:
        return "initialization mode";
    case STEPPING:
        return "step mode";
    case STEP_FAILED:
        return "step failed";
    case TERMINATED:
        return "terminated";
    case EVENTS:
        return "event mode";
    case CONTINUOUS_TIME:
        return "continuous-time mode";
    case BROKEN:
        break;
    }
    return "error";
}

/* Whether a function may be called now; logs an error if not. */
static bool fmu_allowed(Instance *instance, int modes, const char *function)
{
    char message[256];
    if (instance == NULL) {
        return false;
    }
    if ((instance->state.mode & modes) != 0) {
        return true;
    }
    (void)snprintf(message, sizeof message, "%s is not allowed in the state '%s'", function,
                   fmu_mode_name(instance->state.mode));
    (void)fmu_complain(instance, FAILED, message);
    return false;
}

/* Whether all real outputs and locals are finite: at every step, so without branches and in four sums at once.
 * What is not finite makes NaN of its difference from itself. */
static bool fmu_is_finite(const Instance *instance)
{
    const char *component = (const char *)&instance->state.component;
    double sums[4] = {0.0, 0.0, 0.0, 0.0};
    int i, j;
    for (i = 0; i < FINITE; i += 4) {
        for (j = 0; j < 4; j++) {
            double value = *(const double *)(const void *)(component + finite_offsets[i + j]);
            sums[j] += value - value;
        }
    }
    return !isnan(sums[0] + sums[1] + sums[2] + sums[3]);
}

/* A result that is not finite is none: Python would have raised an exception on the way to it. */
static Status fmu_check_finite(Instance *instance, bool at_start, double time, Status status)
{
    int i;
    if (fmu_is_finite(instance)) {
        return OK;
    }
    for (i = 0; i < VARIABLES; i++) {
        const Row *row = &rows[i];
        if (row->kind == REAL && row->causality > INPUT && !isfinite(fmu_value(instance, row))) {
            Text text;
            fmu_begin(&text);
            fmu_add(&text, "at ");
            if (at_start) {
                fmu_add(&text, "the start");
            } else {
                fmu_add_time(&text, time);
                fmu_add(&text, " s");
            }
            fmu_add(&text, ": ");
            fmu_add(&text, row->name);
            fmu_add(&text, " is not finite");
            return fmu_complain(instance, status, text.text);
        }
    }
    return OK;
}

/* Logs a problem that a part reports by its own number, if it reports one. */
static Status fmu_report_part(Instance *instance, const Part *part, int64_t problem, Status status)
{
    if (problem == 0) {
        return OK;
    }
    return fmu_report(instance, problem > 0 && problem <= part->problems ? part->first_problem + problem : 0, status);
}

/* Keeps from where the outputs to come are computed. */
static void fmu_begin_at(State *state, OriginKind kind, double time, double size)
{
    state->origin.kind = kind;
    state->origin.time = time;
    state->origin.size = size;
    state->origin.carried = false;
    state->origin.component = state->component;
}

static Status fmu_complain_of_step(Instance *instance, Status status, double time, double size, const char *why)
{
    Text text;
    fmu_begin(&text);
    fmu_add(&text, "step from ");
    fmu_add_time(&text, time);
    fmu_add(&text, " s by ");
    fmu_add_time(&text, size);
    fmu_add(&text, why);
    return fmu_complain(instance, status, text.text);
}

/* Between a step of the host and that of its parts: so the compiler sees which function a part's step is. */
#if defined(__GNUC__)
#define ALWAYS_INLINE inline __attribute__((always_inline))
#else
#define ALWAYS_INLINE inline
#endif

/* What parts are to do: start at a time, or step from there. */
typedef struct {
    bool start;
    double time;
    double size;
} Pass;

static ALWAYS_INLINE Status fmu_pass_part(Instance *instance, int part, Pass pass)
{
    Component *component = &instance->state.component;
    int64_t problem = pass.start ? parts[part].initialize(component, pass.time)
                                 : parts[part].step(component, pass.time, pass.size);
    return fmu_report_part(instance, &parts[part], problem, pass.start ? FAILED : DISCARD);
}

static ALWAYS_INLINE Status fmu_pass_parts(Instance *instance, int first, int end, Pass pass)
{
    Status status = OK;
    int i;
    for (i = first; i < end && status == OK; i++) {
        status = fmu_pass_part(instance, i, pass);
    }
    return status;
}

#if LOOP_VALUES > 0
#include "loop.c"
#else
#define LOOP_FIRST PARTS
#define LOOP_END PARTS

static Status fmu_pass_loop(Instance *instance, Pass pass)
{
    (void)instance;
    (void)pass;
    return OK;
}
#endif

/* Starts or steps all parts. */
static ALWAYS_INLINE Status fmu_pass_all(Instance *instance, Pass pass)
{
    Status status = fmu_pass_parts(instance, 0, LOOP_FIRST, pass);
    if (status == OK) {
        status = fmu_pass_loop(instance, pass);
    }
    if (status == OK) {
        status = fmu_pass_parts(instance, LOOP_END, PARTS, pass);
    }
    return status == OK ? fmu_check_finite(instance, pass.start, pass.time, pass.start ? FAILED : DISCARD) : status;
}

/* Computes the start from the parameters and inputs as they now stand. */
static Status fmu_refresh(Instance *instance)
{
    State *state = &instance->state;
    Pass pass = {true, state->time, 0.0};
    if (!state->stale) {
        return OK;
    }
    state->stale = false;
    fmu_begin_at(state, START, state->time, 0.0);
    return fmu_pass_all(instance, pass);
}

/* ---- the life cycle, the same in both standards; `function` is the standard's own name */

static Status fmu_set_times(Instance *instance, double start, bool stops, double stop)
{
    if (!isfinite(start) || (stops && !(stop >= start))) {
        return fmu_complain(instance, FAILED, "the start time must be finite and not after the stop time");
    }
    instance->state.time = start;
    instance->state.stop_time = stops ? stop : HUGE_VAL;
    instance->state.set_up = true;
    return OK;
}

static Status fmu_exit_initialization(Instance *instance, const char *function)
{
    if (!fmu_allowed(instance, INITIALIZING, function) || fmu_refresh(instance) != OK) {
        return FAILED;
    }
    instance->state.mode = instance->host.model_exchange ? EVENTS : STEPPING;
    return OK;
}

static Status fmu_terminate(Instance *instance, const char *function)
{
    if (!fmu_allowed(instance, STEPPING | STEP_FAILED | EVENTS | CONTINUOUS_TIME, function)) {
        return FAILED;
    }
    instance->state.mode = TERMINATED;
    return OK;
}

static Status fmu_start_again(Instance *instance, const char *function)
{
    if (!fmu_allowed(instance, MODES, function)) {
        return FAILED;
    }
    fmu_reset(instance);
    return OK;
}

static void fmu_free(Instance *instance)
{
    if (instance != NULL) {
        Host host = instance->host;
        fmu_release(&host, instance);
    }
}

/* Whether a step is one that could be made at all. */
static Status fmu_check_step(Instance *instance, double time, double size)
{
    double slack = 1e-6 * size + 1e-9 * fabs(instance->state.stop_time); /* what a sum of steps may be off */
    if (!isfinite(time) || !isfinite(size) || size < 0.0) {
        return fmu_complain_of_step(instance, DISCARD, time, size, " s: time must be finite and the step not negative");
    }
    if (time + size > instance->state.stop_time + slack) {
        return fmu_complain_of_step(instance, FAILED, time, size, " s goes past the stop time");
    }
    return OK;
}

static Status fmu_step_parts(Instance *instance, double time, double size)
{
    Pass pass = {false, time, size};
    return fmu_pass_all(instance, pass);
}

#define MOST_INNER_STEPS 1e7 /* in one step of the host: half a minute at some microseconds each */

/* Steps on the grid of the components to the end of the host's step. */
static Status fmu_step_on_grid(Instance *instance, double time, double size, double inner)
{
    Walk walk = grid_walk(time, size, inner);
    Status status = OK;
    if (walk.end - walk.at > MOST_INNER_STEPS) {
        return fmu_complain_of_step(instance, DISCARD, time, size,
                                    " s takes more than 1e7 steps of the components; step less or make theirs longer");
    }
    while (status == OK && grid_next(&walk)) {
        status = fmu_step_parts(instance, walk.time, walk.size);
    }
    return status;
}

/* One step of the host. Where it cannot be made the component stays as it was. */
static Status fmu_step(Instance *instance, double time, double size)
{
    State *state = &instance->state;
    double inner = INNER_STEP(&state->component);
    Status status;
    fmu_begin_at(state, STEP, time, size);
    status = inner > 0.0 ? fmu_step_on_grid(instance, time, size, inner) : fmu_step_parts(instance, time, size);
    if (status == OK) {
        state->time = time + size;
    } else {
        state->component = state->origin.component;
        state->origin.kind = NOWHERE;
    }
    return status;
}
