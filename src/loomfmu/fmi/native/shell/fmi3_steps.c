/* FMI 3.0: steps of co-simulation, and derivatives of outputs, by time and by others. */

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

/* ---- derivatives of outputs by inputs, parameters and time */

/* Whether there are as many seeds and sensitivities as variables, since all are scalars. */
static bool fmu_counts_fit(Instance *instance, size_t seeds, size_t seeded, size_t values, size_t wanted)
{
    if (instance != NULL && (seeds != seeded || values != wanted)) {
        (void)fmu_complain(instance, FAILED, "there must be a seed or a sensitivity for each value reference");
        return false;
    }
    return true;
}

fmi3Status fmi3GetDirectionalDerivative(fmi3Instance handle, const fmi3ValueReference unknowns[],
                                        size_t unknown_count, const fmi3ValueReference knowns[],
                                        size_t known_count, const fmi3Float64 seed[], size_t seed_count,
                                        fmi3Float64 values[], size_t value_count)
{
    Derivative wanted = {unknowns, unknown_count, knowns, known_count};
    if (!fmu_counts_fit(handle, seed_count, known_count, value_count, unknown_count)) {
        return fmi3Error;
    }
    return (fmi3Status)fmu_get_directional(handle, "fmi3GetDirectionalDerivative", wanted, seed, values);
}

/* As many directions as there are knowns: an adjoint costs what the whole row of the Jacobian does. */
fmi3Status fmi3GetAdjointDerivative(fmi3Instance handle, const fmi3ValueReference unknowns[],
                                    size_t unknown_count, const fmi3ValueReference knowns[],
                                    size_t known_count, const fmi3Float64 seed[], size_t seed_count,
                                    fmi3Float64 values[], size_t value_count)
{
    Instance *instance = handle;
    Derivative wanted = {unknowns, unknown_count, knowns, known_count};
    const double one = 1.0;
    Status status;
    size_t i, j;
    if (!fmu_counts_fit(instance, seed_count, unknown_count, value_count, known_count)) {
        return fmi3Error;
    }
    status = fmu_check_derivative(instance, "fmi3GetAdjointDerivative", &wanted, seed, values);
    for (i = 0; i < known_count && status == OK; i++) {
        Derivative by = {unknowns, unknown_count, &knowns[i], 1};
        DualComponent component;
        fmu_repeat(instance, &by, &one, &component);
        values[i] = 0.0;
        for (j = 0; j < unknown_count; j++) {
            values[i] += seed[j] * *fmu_tangent(&component, &rows[unknowns[j] - FIRST_REFERENCE]);
        }
        status = fmu_check_tangent(instance, values[i]);
    }
    return (fmi3Status)status;
}
