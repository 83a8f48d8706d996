/* FMI 3.0: steps of co-simulation, and derivatives of outputs. */

fmi3Status fmi3DoStep(fmi3Instance handle, fmi3Float64 time, fmi3Float64 size, fmi3Boolean no_return,
                      fmi3Boolean *event, fmi3Boolean *terminate, fmi3Boolean *early, fmi3Float64 *reached)
{
    Instance *instance = handle;
    Status status;
    (void)no_return; /* nothing is kept for a return */
    if (!fmu_allowed(instance, STEPPING, "fmi3DoStep")) {
        return fmi3Error;
    }
    if (event == NULL || terminate == NULL || early == NULL || reached == NULL) {
        return (fmi3Status)fmu_complain(instance, FAILED, "a pointer to a result is NULL");
    }
    status = fmu_check_step(instance, time, size);
    if (status == OK) {
        status = fmu_step(instance, time, size);
    }
    instance->last_step = status;
    *event = *terminate = *early = false;
    *reached = instance->state.time;
    return (fmi3Status)status;
}

fmi3Status fmi3GetOutputDerivatives(fmi3Instance handle, const fmi3ValueReference references[], size_t count,
                                    const fmi3Int32 orders[], fmi3Float64 values[], size_t value_count)
{
    Instance *instance = handle;
    Status status = OK;
    size_t i;
    if (!fmu_ready(instance, STEPPING | TERMINATED | BROKEN, "fmi3GetOutputDerivatives", references, count,
                   values)) {
        return fmi3Error;
    }
    if (instance->host.model_exchange) {
        return fmu_not_provided(handle, "in model exchange output derivatives are");
    }
    if (value_count != count || (count > 0 && orders == NULL)) {
        return (fmi3Status)fmu_complain(instance, FAILED, "there must be as many orders and values as value references");
    }
    for (i = 0; i < count && status != FAILED; i++) {
        Status found = fmu_output_derivative(instance, references[i], orders[i], &values[i]);
        status = found > status ? found : status;
    }
    return (fmi3Status)status;
}

fmi3Status fmi3EnterStepMode(fmi3Instance handle)
{
    /* it is left for event mode alone, which there is not in co-simulation */
    (void)fmu_allowed(handle, 0, "fmi3EnterStepMode");
    return fmi3Error;
}
