/* FMI 2.0: model exchange of a component without memory. */

fmi2Status fmi2EnterEventMode(fmi2Component component)
{
    return (fmi2Status)fmu_enter_events(component, CONTINUOUS_TIME | EVENTS, "fmi2EnterEventMode");
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
    return (fmi2Status)fmu_enter_continuous_time(component, "fmi2EnterContinuousTimeMode");
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
    return (fmi2Status)fmu_set_time(component, "fmi2SetTime", time);
}

fmi2Status fmi2GetEventIndicators(fmi2Component component, fmi2Real values[], size_t count)
{
    return (fmi2Status)fmu_get_indicators(component, "fmi2GetEventIndicators", values, count);
}

/* ---- there are no continuous states */

fmi2Status fmi2SetContinuousStates(fmi2Component component, const fmi2Real states[], size_t count)
{
    (void)states;
    return (fmi2Status)fmu_no_states(component, CONTINUOUS_TIME, "fmi2SetContinuousStates", count);
}

fmi2Status fmi2GetDerivatives(fmi2Component component, fmi2Real derivatives[], size_t count)
{
    (void)derivatives;
    return (fmi2Status)fmu_no_states(component, SOLVING, "fmi2GetDerivatives", count);
}

fmi2Status fmi2GetContinuousStates(fmi2Component component, fmi2Real states[], size_t count)
{
    (void)states;
    return (fmi2Status)fmu_no_states(component, SOLVING, "fmi2GetContinuousStates", count);
}

fmi2Status fmi2GetNominalsOfContinuousStates(fmi2Component component, fmi2Real nominals[], size_t count)
{
    (void)nominals;
    return (fmi2Status)fmu_no_states(component, SOLVING, "fmi2GetNominalsOfContinuousStates", count);
}
