/* Model exchange of a component without memory: no states, all it tells is a function of now. */

#define SOLVING (INITIALIZING | EVENTS | CONTINUOUS_TIME | TERMINATED | BROKEN)

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
    Status status;
    if (!state->stale) {
        return OK;
    }
    fmu_begin_at(state, STEP, state->time, 0.0);
    status = fmu_step_parts(instance, state->time, 0.0);
    if (status != OK) {
        state->component = state->origin.component;
        state->origin.kind = NOWHERE;
        return status;
    }
    if (state->mode == CONTINUOUS_TIME) {
        fmu_hold_discrete(&state->component, &state->origin.component);
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
    if (parts[0].step(&now, instance->state.time, 0.0) != 0) { /* it has no other part */
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

static Status fmu_set_time(Instance *instance, const char *function, double time)
{
    if (!fmu_allowed(instance, CONTINUOUS_TIME | EVENTS, function)) {
        return FAILED;
    }
    if (!isfinite(time)) {
        return fmu_complain(instance, FAILED, "the time must be finite");
    }
    instance->state.time = time;
    instance->state.stale = true;
    return OK;
}

static Status fmu_enter_events(Instance *instance, int modes, const char *function)
{
    if (!fmu_allowed(instance, modes, function)) {
        return FAILED;
    }
    instance->state.mode = EVENTS;
    instance->state.stale = true;
    return OK;
}

static Status fmu_enter_continuous_time(Instance *instance, const char *function)
{
    Status status = fmu_allowed(instance, EVENTS, function) ? fmu_evaluate(instance) : FAILED;
    if (status == OK) {
        instance->state.mode = CONTINUOUS_TIME;
    }
    return status;
}

/* Whether a host requests 0 continuous states, which is their number. */
static Status fmu_no_states(Instance *instance, int modes, const char *function, size_t count)
{
    if (!fmu_allowed(instance, modes, function)) {
        return FAILED;
    }
    if (!instance->host.model_exchange || count != 0) {
        return fmu_complain(instance, FAILED, "there are no continuous states");
    }
    return OK;
}

static Status fmu_get_indicators(Instance *instance, const char *function, double values[], size_t count)
{
    Status status;
    int i;
    if (!fmu_allowed(instance, SOLVING, function)) {
        return FAILED;
    }
    if (!instance->host.model_exchange || count != INDICATORS || (count > 0 && values == NULL)) {
        return fmu_refuse(instance, "there are %lu event indicators%s, in model exchange only",
                          (unsigned long)INDICATORS, "");
    }
    status = fmu_prepare(instance);
    for (i = 0; i < INDICATORS && status == OK; i++) {
        values[i] = fmu_value(instance, &rows[indicators[i]]);
    }
    return status;
}
