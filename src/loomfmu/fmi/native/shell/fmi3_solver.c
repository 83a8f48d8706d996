/* FMI 3.0: model exchange of a component without memory. */

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
        return (fmi3Status)fmu_complain(instance, FAILED, "a pointer to a result is NULL");
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
        return (fmi3Status)fmu_complain(instance, FAILED, "a pointer to a result is NULL");
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
    return (fmi3Status)fmu_set_time(instance, time);
}

/* ---- there are no continuous states */

static fmi3Status fmu_none(fmi3Instance handle, int modes, const char *function, size_t count)
{
    Instance *instance = handle;
    return fmu_allowed(instance, modes, function) ? (fmi3Status)fmu_no_states(instance, count) : fmi3Error;
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

fmi3Status fmi3GetEventIndicators(fmi3Instance handle, fmi3Float64 values[], size_t count)
{
    Instance *instance = handle;
    if (!fmu_allowed(instance, SOLVING, "fmi3GetEventIndicators")) {
        return fmi3Error;
    }
    return (fmi3Status)fmu_get_indicators(instance, values, count);
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
        *count = INDICATORS;
    }
    return status;
}
