/* FMI 3.0: model exchange of a component without memory. */

fmi3Status fmi3EnterEventMode(fmi3Instance handle)
{
    return (fmi3Status)fmu_enter_events(handle, CONTINUOUS_TIME, "fmi3EnterEventMode");
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
    return (fmi3Status)fmu_enter_continuous_time(handle, "fmi3EnterContinuousTimeMode");
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
    return (fmi3Status)fmu_set_time(handle, "fmi3SetTime", time);
}

/* ---- there are no continuous states */

fmi3Status fmi3SetContinuousStates(fmi3Instance handle, const fmi3Float64 states[], size_t count)
{
    (void)states;
    return (fmi3Status)fmu_no_states(handle, CONTINUOUS_TIME, "fmi3SetContinuousStates", count);
}

fmi3Status fmi3GetContinuousStates(fmi3Instance handle, fmi3Float64 states[], size_t count)
{
    (void)states;
    return (fmi3Status)fmu_no_states(handle, SOLVING, "fmi3GetContinuousStates", count);
}

fmi3Status fmi3GetContinuousStateDerivatives(fmi3Instance handle, fmi3Float64 derivatives[], size_t count)
{
    (void)derivatives;
    return (fmi3Status)fmu_no_states(handle, SOLVING, "fmi3GetContinuousStateDerivatives", count);
}

fmi3Status fmi3GetNominalsOfContinuousStates(fmi3Instance handle, fmi3Float64 nominals[], size_t count)
{
    (void)nominals;
    return (fmi3Status)fmu_no_states(handle, SOLVING, "fmi3GetNominalsOfContinuousStates", count);
}

fmi3Status fmi3GetEventIndicators(fmi3Instance handle, fmi3Float64 values[], size_t count)
{
    return (fmi3Status)fmu_get_indicators(handle, "fmi3GetEventIndicators", values, count);
}

fmi3Status fmi3GetNumberOfContinuousStates(fmi3Instance handle, size_t *count)
{
    Status status = fmu_no_states(handle, ALWAYS, "fmi3GetNumberOfContinuousStates", count == NULL);
    if (status == OK) {
        *count = 0;
    }
    return (fmi3Status)status;
}

fmi3Status fmi3GetNumberOfEventIndicators(fmi3Instance handle, size_t *count)
{
    Status status = fmu_no_states(handle, ALWAYS, "fmi3GetNumberOfEventIndicators", count == NULL);
    if (status == OK) {
        *count = INDICATORS;
    }
    return (fmi3Status)status;
}
