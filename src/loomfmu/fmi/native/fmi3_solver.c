/* FMI 3.0: model exchange of a component without memory: no states, all it tells is a function of now. */

static bool fmu_is_discrete_output(const Row *row)
{
    return row->causality == OUTPUT && row->variability == DISCRETE;
}

static size_t fmu_size(const Row *row)
{
    return row->kind == REAL ? sizeof(double) : row->kind == INTEGER ? sizeof(int64_t) : sizeof(bool);
}

/* Puts discrete outputs back to what they were: between events they may not change. */
static void fmu_hold_discrete(Component *component, const Component *before)
{
    int i;
    for (i = 0; i < VARIABLES; i++) {
        if (fmu_is_discrete_output(&rows[i])) {
            size_t offset = rows[i].offset;
            memcpy((char *)component + offset, (const char *)before + offset, fmu_size(&rows[i]));
        }
    }
}

/* Computes the outputs of this instant, if something was set since they were computed last. */
static Status fmu_evaluate(Instance *instance)
{
    State *state = &instance->state;
    Component before = state->component;
    int64_t problem;
    Status status = OK;
    if (!state->stale) {
        return OK;
    }
    problem = component_step(&state->component, state->time, 0.0);
    if (problem != 0) {
        status = fmu_report(instance, problem, DISCARD);
    }
    if (status == OK) {
        status = fmu_check_finite(instance, false, state->time, DISCARD);
    }
    if (status != OK) {
        state->component = before;
        return status;
    }
    if (state->mode == CONTINUOUS_TIME) {
        fmu_hold_discrete(&state->component, &before);
    }
    state->stale = false;
    return OK;
}

/* What a host may read, in whatever mode. */
static Status fmu_prepare(Instance *instance)
{
    bool solving = instance->state.mode == EVENTS || instance->state.mode == CONTINUOUS_TIME;
    return solving ? fmu_evaluate(instance) : fmu_prepare_reading(instance);
}

/* Whether a discrete output would have another value now. */
static bool fmu_is_event(Instance *instance)
{
    const char *held = (const char *)&instance->state.component;
    Component now = instance->state.component;
    int i;
    if (component_step(&now, instance->state.time, 0.0) != 0) {
        return false;
    }
    for (i = 0; i < VARIABLES; i++) {
        size_t offset = rows[i].offset, size = fmu_size(&rows[i]);
        if (fmu_is_discrete_output(&rows[i]) && memcmp((char *)&now + offset, held + offset, size) != 0) {
            return true;
        }
    }
    return false;
}

fmi3Status fmi3EnterEventMode(fmi3Instance handle)
{
    Instance *instance = handle;
    if (!fmu_allowed(instance, CONTINUOUS_TIME, "fmi3EnterEventMode")) {
        return fmi3Error;
    }
    instance->state.mode = EVENTS;
    instance->state.stale = true;
    return fmi3OK;
}

fmi3Status fmi3UpdateDiscreteStates(fmi3Instance handle, fmi3Boolean *again, fmi3Boolean *terminate,
                                    fmi3Boolean *nominals_changed, fmi3Boolean *states_changed,
                                    fmi3Boolean *next_event_defined, fmi3Float64 *next_event)
{
    Instance *instance = handle;
    if (!fmu_allowed(instance, EVENTS, "fmi3UpdateDiscreteStates")) {
        return fmi3Error;
    }
    if (again == NULL || terminate == NULL || nominals_changed == NULL || states_changed == NULL
        || next_event_defined == NULL || next_event == NULL) {
        return (fmi3Status)fmu_complain(instance, FAILED, "there is no place for the results");
    }
    *again = *terminate = *nominals_changed = *states_changed = *next_event_defined = false;
    *next_event = 0.0;
    return (fmi3Status)fmu_evaluate(instance);
}

fmi3Status fmi3EnterContinuousTimeMode(fmi3Instance handle)
{
    Instance *instance = handle;
    Status status;
    if (!fmu_allowed(instance, EVENTS, "fmi3EnterContinuousTimeMode")) {
        return fmi3Error;
    }
    status = fmu_evaluate(instance);
    if (status == OK) {
        instance->state.mode = CONTINUOUS_TIME;
    }
    return (fmi3Status)status;
}

fmi3Status fmi3CompletedIntegratorStep(fmi3Instance handle, fmi3Boolean no_return, fmi3Boolean *event,
                                       fmi3Boolean *terminate)
{
    Instance *instance = handle;
    (void)no_return;
    if (!fmu_allowed(instance, CONTINUOUS_TIME, "fmi3CompletedIntegratorStep")) {
        return fmi3Error;
    }
    if (event == NULL || terminate == NULL) {
        return (fmi3Status)fmu_complain(instance, FAILED, "there is no place for the results");
    }
    *event = fmu_is_event(instance);
    *terminate = false;
    return fmi3OK;
}

fmi3Status fmi3SetTime(fmi3Instance handle, fmi3Float64 time)
{
    Instance *instance = handle;
    if (!fmu_allowed(instance, CONTINUOUS_TIME | EVENTS, "fmi3SetTime")) {
        return fmi3Error;
    }
    if (!isfinite(time)) {
        return (fmi3Status)fmu_complain(instance, FAILED, "the time is not finite");
    }
    instance->state.time = time;
    instance->state.stale = true;
    return fmi3OK;
}

/* ---- there are no states and no event indicators */

static fmi3Status fmu_none(fmi3Instance handle, int modes, const char *function, size_t count)
{
    Instance *instance = handle;
    if (!fmu_allowed(instance, modes, function)) {
        return fmi3Error;
    }
    if (!instance->host.model_exchange || count != 0) {
        return (fmi3Status)fmu_complain(instance, FAILED,
                                        "there are no continuous states and no event indicators");
    }
    return fmi3OK;
}

fmi3Status fmi3SetContinuousStates(fmi3Instance handle, const fmi3Float64 states[], size_t count)
{
    (void)states;
    return fmu_none(handle, CONTINUOUS_TIME, "fmi3SetContinuousStates", count);
}

fmi3Status fmi3GetContinuousStates(fmi3Instance handle, fmi3Float64 states[], size_t count)
{
    (void)states;
    return fmu_none(handle, SOLVING, "fmi3GetContinuousStates", count);
}

fmi3Status fmi3GetContinuousStateDerivatives(fmi3Instance handle, fmi3Float64 derivatives[], size_t count)
{
    (void)derivatives;
    return fmu_none(handle, SOLVING, "fmi3GetContinuousStateDerivatives", count);
}

fmi3Status fmi3GetNominalsOfContinuousStates(fmi3Instance handle, fmi3Float64 nominals[], size_t count)
{
    (void)nominals;
    return fmu_none(handle, SOLVING, "fmi3GetNominalsOfContinuousStates", count);
}

fmi3Status fmi3GetEventIndicators(fmi3Instance handle, fmi3Float64 indicators[], size_t count)
{
    (void)indicators;
    return fmu_none(handle, SOLVING, "fmi3GetEventIndicators", count);
}

fmi3Status fmi3GetNumberOfContinuousStates(fmi3Instance handle, size_t *count)
{
    fmi3Status status = fmu_none(handle, ALWAYS, "fmi3GetNumberOfContinuousStates", count == NULL ? 1 : 0);
    if (status == fmi3OK) {
        *count = 0;
    }
    return status;
}

fmi3Status fmi3GetNumberOfEventIndicators(fmi3Instance handle, size_t *count)
{
    fmi3Status status = fmu_none(handle, ALWAYS, "fmi3GetNumberOfEventIndicators", count == NULL ? 1 : 0);
    if (status == fmi3OK) {
        *count = 0;
    }
    return status;
}
