/* FMI 2.0: steps, derivatives of inputs and outputs, and what a host may ask about a step. */

fmi2Status fmi2DoStep(fmi2Component component, fmi2Real time, fmi2Real size, fmi2Boolean no_return)
{
    Instance *instance = component;
    Status status;
    (void)no_return; /* nothing is kept for a return */
    if (!fmu_allowed(instance, STEPPING, "fmi2DoStep")) {
        return fmi2Error;
    }
    status = fmu_check_step(instance, time, size);
    if (status == OK) {
        status = fmu_is_carried(instance) ? fmu_carried_step(instance, time, size)
                                          : fmu_step(instance, time, size);
    }
    if (status == DISCARD) {
        instance->state.mode = STEP_FAILED;
    }
    instance->last_step = status;
    return (fmi2Status)status;
}

fmi2Status fmi2CancelStep(fmi2Component component)
{
    /* a step is never under way when this can be called */
    (void)fmu_allowed(component, 0, "fmi2CancelStep");
    return fmi2Error;
}

fmi2Status fmi2SetRealInputDerivatives(fmi2Component component, const fmi2ValueReference references[],
                                       size_t count, const fmi2Integer orders[], const fmi2Real values[])
{
    Instance *instance = component;
    Status status = OK;
    size_t i;
    if (!fmu_ready(instance, INSTANTIATED | INITIALIZING | STEPPING, "fmi2SetRealInputDerivatives", references,
                   count, values)) {
        return fmi2Error;
    }
    if (count > 0 && orders == NULL) {
        return (fmi2Status)fmu_complain(instance, FAILED, "the orders of the derivatives are missing");
    }
    for (i = 0; i < count && status == OK; i++) {
        status = fmu_set_derivative(instance, references[i], orders[i], values[i]);
    }
    return (fmi2Status)status;
}

fmi2Status fmi2GetRealOutputDerivatives(fmi2Component component, const fmi2ValueReference references[],
                                        size_t count, const fmi2Integer orders[], fmi2Real values[])
{
    Instance *instance = component;
    Status status = OK;
    size_t i;
    if (!fmu_ready(instance, STEPPED | BROKEN, "fmi2GetRealOutputDerivatives", references, count, values)) {
        return fmi2Error;
    }
    if (count > 0 && orders == NULL) {
        return (fmi2Status)fmu_complain(instance, FAILED, "the orders of the derivatives are missing");
    }
    for (i = 0; i < count && status != FAILED; i++) {
        Status found = fmu_output_derivative(instance, references[i], orders[i], &values[i]);
        status = found > status ? found : status;
    }
    return (fmi2Status)status;
}

fmi2Status fmi2GetDirectionalDerivative(fmi2Component component, const fmi2ValueReference unknowns[],
                                        size_t unknown_count, const fmi2ValueReference knowns[],
                                        size_t known_count, const fmi2Real seed[], fmi2Real values[])
{
    Derivative wanted = {unknowns, unknown_count, knowns, known_count};
    return (fmi2Status)fmu_get_directional(component, "fmi2GetDirectionalDerivative", wanted, seed, values);
}

/* ---- what a host may ask about a step */

/* Whether a status of this kind can be queried now, and the caller has a place for it. */
static fmi2Status fmu_status(Instance *instance, const char *function, bool known, const void *value)
{
    if (!fmu_allowed(instance, STEPPED, function)) {
        return fmi2Error;
    }
    if (value == NULL) {
        return (fmi2Status)fmu_complain(instance, FAILED, "the pointer to the status is NULL");
    }
    if (!known) {
        return (fmi2Status)fmu_complain(instance, DISCARD, "this status is not available");
    }
    return fmi2OK;
}

fmi2Status fmi2GetStatus(fmi2Component component, const fmi2StatusKind kind, fmi2Status *value)
{
    Instance *instance = component;
    fmi2Status status = fmu_status(instance, "fmi2GetStatus", kind == fmi2DoStepStatus, value);
    if (status == fmi2OK) {
        *value = (fmi2Status)instance->last_step;
    }
    return status;
}

fmi2Status fmi2GetRealStatus(fmi2Component component, const fmi2StatusKind kind, fmi2Real *value)
{
    Instance *instance = component;
    fmi2Status status = fmu_status(instance, "fmi2GetRealStatus", kind == fmi2LastSuccessfulTime, value);
    if (status == fmi2OK) {
        *value = instance->state.time;
    }
    return status;
}

fmi2Status fmi2GetIntegerStatus(fmi2Component component, const fmi2StatusKind kind, fmi2Integer *value)
{
    (void)kind;
    return fmu_status(component, "fmi2GetIntegerStatus", false, value);
}

fmi2Status fmi2GetBooleanStatus(fmi2Component component, const fmi2StatusKind kind, fmi2Boolean *value)
{
    fmi2Status status = fmu_status(component, "fmi2GetBooleanStatus", kind == fmi2Terminated, value);
    if (status == fmi2OK) {
        *value = fmi2False; /* a component never ends a run */
    }
    return status;
}

fmi2Status fmi2GetStringStatus(fmi2Component component, const fmi2StatusKind kind, fmi2String *value)
{
    (void)kind;
    return fmu_status(component, "fmi2GetStringStatus", false, value);
}
