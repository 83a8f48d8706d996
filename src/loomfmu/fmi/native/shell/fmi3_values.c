/* FMI 3.0: values of variables, and the state as a whole. */

#define READING MODES
#define TIME_REFERENCE (FIRST_REFERENCE + VARIABLES)
#define CONTINUOUS_SETTING (SETTING | CONTINUOUS_TIME)

/* Whether values may be read or set: as many as there are references, since all variables are scalars. */
static bool fmu_ready_for(Instance *instance, int modes, const char *function, const void *references,
                          size_t count, const void *values, size_t value_count)
{
    if (!fmu_ready(instance, modes, function, references, count, values)) {
        return false;
    }
    if (value_count != count) {
        (void)fmu_complain(instance, FAILED, "there must be as many values as value references");
        return false;
    }
    return true;
}

fmi3Status fmi3GetFloat64(fmi3Instance handle, const fmi3ValueReference references[], size_t count,
                          fmi3Float64 values[], size_t value_count)
{
    Instance *instance = handle;
    Status status;
    size_t i;
    if (!fmu_ready_for(instance, READING, "fmi3GetFloat64", references, count, values, value_count)) {
        return fmi3Error;
    }
    status = fmu_prepare(instance);
    for (i = 0; i < count && status == OK; i++) {
        if (references[i] == TIME_REFERENCE) {
            values[i] = instance->state.time;
        } else {
            status = fmu_get_real(instance, references[i], &values[i]);
        }
    }
    return (fmi3Status)status;
}

fmi3Status fmi3GetInt64(fmi3Instance handle, const fmi3ValueReference references[], size_t count,
                        fmi3Int64 values[], size_t value_count)
{
    Instance *instance = handle;
    Status status;
    size_t i;
    if (!fmu_ready_for(instance, READING, "fmi3GetInt64", references, count, values, value_count)) {
        return fmi3Error;
    }
    status = fmu_prepare(instance);
    for (i = 0; i < count && status == OK; i++) {
        status = fmu_get_integer(instance, references[i], &values[i]);
    }
    return (fmi3Status)status;
}

fmi3Status fmi3GetBoolean(fmi3Instance handle, const fmi3ValueReference references[], size_t count,
                          fmi3Boolean values[], size_t value_count)
{
    Instance *instance = handle;
    Status status;
    size_t i;
    if (!fmu_ready_for(instance, READING, "fmi3GetBoolean", references, count, values, value_count)) {
        return fmi3Error;
    }
    status = fmu_prepare(instance);
    for (i = 0; i < count && status == OK; i++) {
        status = fmu_get_boolean(instance, references[i], &values[i]);
    }
    return (fmi3Status)status;
}

fmi3Status fmi3SetFloat64(fmi3Instance handle, const fmi3ValueReference references[], size_t count,
                          const fmi3Float64 values[], size_t value_count)
{
    Instance *instance = handle;
    Status status = OK;
    size_t i;
    if (!fmu_ready_for(instance, CONTINUOUS_SETTING, "fmi3SetFloat64", references, count, values,
                       value_count)) {
        return fmi3Error;
    }
    for (i = 0; i < count && status == OK; i++) {
        status = fmu_set_real(instance, references[i], values[i]);
    }
    return (fmi3Status)status;
}

fmi3Status fmi3SetInt64(fmi3Instance handle, const fmi3ValueReference references[], size_t count,
                        const fmi3Int64 values[], size_t value_count)
{
    Instance *instance = handle;
    Status status = OK;
    size_t i;
    if (!fmu_ready_for(instance, SETTING, "fmi3SetInt64", references, count, values, value_count)) {
        return fmi3Error;
    }
    for (i = 0; i < count && status == OK; i++) {
        status = fmu_set_integer(instance, references[i], values[i]);
    }
    return (fmi3Status)status;
}

fmi3Status fmi3SetBoolean(fmi3Instance handle, const fmi3ValueReference references[], size_t count,
                          const fmi3Boolean values[], size_t value_count)
{
    Instance *instance = handle;
    Status status = OK;
    size_t i;
    if (!fmu_ready_for(instance, SETTING, "fmi3SetBoolean", references, count, values, value_count)) {
        return fmi3Error;
    }
    for (i = 0; i < count && status == OK; i++) {
        status = fmu_set_boolean(instance, references[i], values[i]);
    }
    return (fmi3Status)status;
}

/* ---- the state as a whole */

fmi3Status fmi3GetFMUState(fmi3Instance handle, fmi3FMUState *state)
{
    return (fmi3Status)fmu_save(handle, "fmi3GetFMUState", state);
}

fmi3Status fmi3SetFMUState(fmi3Instance handle, fmi3FMUState state)
{
    return (fmi3Status)fmu_restore(handle, "fmi3SetFMUState", state);
}

fmi3Status fmi3FreeFMUState(fmi3Instance handle, fmi3FMUState *state)
{
    return (fmi3Status)fmu_forget(handle, "fmi3FreeFMUState", state);
}

fmi3Status fmi3SerializedFMUStateSize(fmi3Instance handle, fmi3FMUState state, size_t *size)
{
    return (fmi3Status)fmu_packed_size(handle, "fmi3SerializedFMUStateSize", state, size);
}

fmi3Status fmi3SerializeFMUState(fmi3Instance handle, fmi3FMUState state, fmi3Byte bytes[], size_t size)
{
    return (fmi3Status)fmu_pack(handle, "fmi3SerializeFMUState", state, bytes, size);
}

fmi3Status fmi3DeserializeFMUState(fmi3Instance handle, const fmi3Byte bytes[], size_t size,
                                   fmi3FMUState *state)
{
    return (fmi3Status)fmu_unpack(handle, "fmi3DeserializeFMUState", bytes, size, state);
}
