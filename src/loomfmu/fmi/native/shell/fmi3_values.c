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

static Status fmu_get_float(Instance *instance, fmi3ValueReference reference, double *value)
{
    if (reference != TIME_REFERENCE) {
        return fmu_get_real(instance, reference, value);
    }
    *value = instance->state.time;
    return OK;
}

#define FMU_VALUES(TYPE, MODES_TO_SET, GET, SET)                                                           \
    fmi3Status fmi3Get##TYPE(fmi3Instance handle, const fmi3ValueReference references[], size_t count,     \
                             fmi3##TYPE values[], size_t value_count)                                      \
    {                                                                                                      \
        Instance *instance = handle;                                                                       \
        Status status;                                                                                     \
        size_t i;                                                                                          \
        if (!fmu_ready_for(instance, READING, "fmi3Get" #TYPE, references, count, values, value_count)) {  \
            return fmi3Error;                                                                              \
        }                                                                                                  \
        status = fmu_prepare(instance);                                                                    \
        for (i = 0; i < count && status == OK; i++) {                                                      \
            status = GET(instance, references[i], &values[i]);                                             \
        }                                                                                                  \
        return (fmi3Status)status;                                                                         \
    }                                                                                                      \
    fmi3Status fmi3Set##TYPE(fmi3Instance handle, const fmi3ValueReference references[], size_t count,     \
                             const fmi3##TYPE values[], size_t value_count)                                \
    {                                                                                                      \
        Instance *instance = handle;                                                                       \
        Status status = OK;                                                                                \
        size_t i;                                                                                          \
        if (!fmu_ready_for(instance, MODES_TO_SET, "fmi3Set" #TYPE, references, count, values,             \
                           value_count)) {                                                                 \
            return fmi3Error;                                                                              \
        }                                                                                                  \
        for (i = 0; i < count && status == OK; i++) {                                                      \
            status = SET(instance, references[i], values[i]);                                              \
        }                                                                                                  \
        return (fmi3Status)status;                                                                         \
    }

FMU_VALUES(Float64, CONTINUOUS_SETTING, fmu_get_float, fmu_set_real)
FMU_VALUES(Int64, SETTING, fmu_get_integer, fmu_set_integer)
FMU_VALUES(Boolean, SETTING, fmu_get_boolean, fmu_set_boolean)

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
