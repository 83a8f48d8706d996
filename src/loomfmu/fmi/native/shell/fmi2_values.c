/* FMI 2.0: values of variables, and the state as a whole. */

fmi2Status fmi2GetReal(fmi2Component component, const fmi2ValueReference references[], size_t count,
                       fmi2Real values[])
{
    Instance *instance = component;
    size_t i;
    if (!fmu_ready(instance, READING, "fmi2GetReal", references, count, values)
        || fmu_prepare(instance) != OK) {
        return fmi2Error;
    }
    for (i = 0; i < count; i++) {
        if (fmu_get_real(instance, references[i], &values[i]) != OK) {
            return fmi2Error;
        }
    }
    return fmi2OK;
}

fmi2Status fmi2GetInteger(fmi2Component component, const fmi2ValueReference references[], size_t count,
                          fmi2Integer values[])
{
    Instance *instance = component;
    size_t i;
    if (!fmu_ready(instance, READING, "fmi2GetInteger", references, count, values)
        || fmu_prepare(instance) != OK) {
        return fmi2Error;
    }
    for (i = 0; i < count; i++) {
        int64_t value;
        if (fmu_get_integer(instance, references[i], &value) != OK) {
            return fmi2Error;
        }
        if (value < -2147483647 || value > 2147483647) {
            char message[256];
            (void)snprintf(message, sizeof message, "%s = %lld exceeds the range of fmi2Integer",
                           rows[references[i] - FIRST_REFERENCE].name, (long long)value);
            return (fmi2Status)fmu_complain(instance, FAILED, message);
        }
        values[i] = (fmi2Integer)value;
    }
    return fmi2OK;
}

fmi2Status fmi2GetBoolean(fmi2Component component, const fmi2ValueReference references[], size_t count,
                          fmi2Boolean values[])
{
    Instance *instance = component;
    size_t i;
    if (!fmu_ready(instance, READING, "fmi2GetBoolean", references, count, values)
        || fmu_prepare(instance) != OK) {
        return fmi2Error;
    }
    for (i = 0; i < count; i++) {
        bool value;
        if (fmu_get_boolean(instance, references[i], &value) != OK) {
            return fmi2Error;
        }
        values[i] = value ? fmi2True : fmi2False;
    }
    return fmi2OK;
}

/* No component has text variables. */
static fmi2Status fmu_no_text(Instance *instance, int modes, const char *function,
                              const fmi2ValueReference references[], size_t count, const void *values)
{
    if (!fmu_ready(instance, modes, function, references, count, values)) {
        return fmi2Error;
    }
    if (count == 0) {
        return fmi2OK;
    }
    return (fmi2Status)fmu_refuse(instance, "value reference %lu is not a variable of type %s", references[0], "String");
}

fmi2Status fmi2GetString(fmi2Component component, const fmi2ValueReference references[], size_t count,
                         fmi2String values[])
{
    return fmu_no_text(component, READING, "fmi2GetString", references, count, values);
}

fmi2Status fmi2SetString(fmi2Component component, const fmi2ValueReference references[], size_t count,
                         const fmi2String values[])
{
    return fmu_no_text(component, SETTING, "fmi2SetString", references, count, values);
}

#define FMU_SETS(TYPE, MODES_TO_SET, SET)                                                                  \
    fmi2Status fmi2Set##TYPE(fmi2Component component, const fmi2ValueReference references[], size_t count, \
                             const fmi2##TYPE values[])                                                    \
    {                                                                                                      \
        Instance *instance = component;                                                                    \
        Status status = OK;                                                                                \
        size_t i;                                                                                          \
        if (!fmu_ready(instance, MODES_TO_SET, "fmi2Set" #TYPE, references, count, values)) {              \
            return fmi2Error;                                                                              \
        }                                                                                                  \
        for (i = 0; i < count && status == OK; i++) {                                                      \
            status = SET(instance, references[i], values[i]);                                              \
        }                                                                                                  \
        return (fmi2Status)status;                                                                         \
    }

FMU_SETS(Real, CONTINUOUS_SETTING, fmu_set_real)
FMU_SETS(Integer, SETTING, fmu_set_integer)
FMU_SETS(Boolean, SETTING, fmu_set_boolean)

/* ---- the state as a whole */

fmi2Status fmi2GetFMUstate(fmi2Component component, fmi2FMUstate *state)
{
    return (fmi2Status)fmu_save(component, "fmi2GetFMUstate", state);
}

fmi2Status fmi2SetFMUstate(fmi2Component component, fmi2FMUstate state)
{
    return (fmi2Status)fmu_restore(component, "fmi2SetFMUstate", state);
}

fmi2Status fmi2FreeFMUstate(fmi2Component component, fmi2FMUstate *state)
{
    return (fmi2Status)fmu_forget(component, "fmi2FreeFMUstate", state);
}

fmi2Status fmi2SerializedFMUstateSize(fmi2Component component, fmi2FMUstate state, size_t *size)
{
    return (fmi2Status)fmu_packed_size(component, "fmi2SerializedFMUstateSize", state, size);
}

fmi2Status fmi2SerializeFMUstate(fmi2Component component, fmi2FMUstate state, fmi2Byte bytes[], size_t size)
{
    return (fmi2Status)fmu_pack(component, "fmi2SerializeFMUstate", state, bytes, size);
}

fmi2Status fmi2DeSerializeFMUstate(fmi2Component component, const fmi2Byte bytes[], size_t size,
                                   fmi2FMUstate *state)
{
    return (fmi2Status)fmu_unpack(component, "fmi2DeSerializeFMUstate", bytes, size, state);
}
