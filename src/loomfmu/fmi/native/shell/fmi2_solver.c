/* FMI 2.0: model exchange of a component without memory. */

fmi2Status fmi2EnterEventMode(fmi2Component component)
{
    Instance *instance = component;
    if (!fmu_allowed(instance, CONTINUOUS_TIME | EVENTS, "fmi2EnterEventMode")) {
        return fmi2Error;
    }
    instance->state.mode = EVENTS;
    instance->state.stale = true;
    return fmi2OK;
}

fmi2Status fmi2NewDiscreteStates(fmi2Component component, fmi2EventInfo *info)
{
    Instance *instance = component;
    if (!fmu_allowed(instance, EVENTS, "fmi2NewDiscreteStates")) {
        return fmi2Error;
    }
    if (info == NULL) {
        return (fmi2Status)fmu_complain(instance, FAILED, "a pointer to a result is NULL");
    }
    info->newDiscreteStatesNeeded = info->terminateSimulation = fmi2False;
    info->nominalsOfContinuousStatesChanged = info->valuesOfContinuousStatesChanged = fmi2False;
    info->nextEventTimeDefined = fmi2False;
    info->nextEventTime = 0.0;
    return (fmi2Status)fmu_evaluate(instance);
}

fmi2Status fmi2EnterContinuousTimeMode(fmi2Component component)
{
    Instance *instance = component;
    Status status;
    if (!fmu_allowed(instance, EVENTS, "fmi2EnterContinuousTimeMode")) {
        return fmi2Error;
    }
    status = fmu_evaluate(instance);
    if (status == OK) {
        instance->state.mode = CONTINUOUS_TIME;
    }
    return (fmi2Status)status;
}

fmi2Status fmi2CompletedIntegratorStep(fmi2Component component, fmi2Boolean no_return, fmi2Boolean *event,
                                       fmi2Boolean *terminate)
{
    Instance *instance = component;
    (void)no_return;
    if (!fmu_allowed(instance, CONTINUOUS_TIME, "fmi2CompletedIntegratorStep")) {
        return fmi2Error;
    }
    if (event == NULL || terminate == NULL) {
        return (fmi2Status)fmu_complain(instance, FAILED, "a pointer to a result is NULL");
    }
    *event = fmu_is_event(instance) ? fmi2True : fmi2False;
    *terminate = fmi2False;
    return fmi2OK;
}

fmi2Status fmi2SetTime(fmi2Component component, fmi2Real time)
{
    Instance *instance = component;
    if (!fmu_allowed(instance, CONTINUOUS_TIME | EVENTS, "fmi2SetTime")) {
        return fmi2Error;
    }
    return (fmi2Status)fmu_set_time(instance, time);
}

fmi2Status fmi2GetEventIndicators(fmi2Component component, fmi2Real values[], size_t count)
{
    Instance *instance = component;
    if (!fmu_allowed(instance, SOLVING, "fmi2GetEventIndicators")) {
        return fmi2Error;
    }
    return (fmi2Status)fmu_get_indicators(instance, values, count);
}

/* ---- there are no continuous states */

static fmi2Status fmu_none(fmi2Component component, int modes, const char *function, size_t count)
{
    Instance *instance = component;
    return fmu_allowed(instance, modes, function) ? (fmi2Status)fmu_no_states(instance, count) : fmi2Error;
}

fmi2Status fmi2SetContinuousStates(fmi2Component component, const fmi2Real states[], size_t count)
{
    (void)states;
    return fmu_none(component, CONTINUOUS_TIME, "fmi2SetContinuousStates", count);
}

fmi2Status fmi2GetDerivatives(fmi2Component component, fmi2Real derivatives[], size_t count)
{
    (void)derivatives;
    return fmu_none(component, SOLVING, "fmi2GetDerivatives", count);
}

fmi2Status fmi2GetContinuousStates(fmi2Component component, fmi2Real states[], size_t count)
{
    (void)states;
    return fmu_none(component, SOLVING, "fmi2GetContinuousStates", count);
}

fmi2Status fmi2GetNominalsOfContinuousStates(fmi2Component component, fmi2Real nominals[], size_t count)
{
    (void)nominals;
    return fmu_none(component, SOLVING, "fmi2GetNominalsOfContinuousStates", count);
}
