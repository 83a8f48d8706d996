/* FMI 3.0: what a component does not have: variables of other types, clocks, partitions. */

/* Reading or setting no variables is allowed where reading or setting is; there are none of the type. */
static fmi3Status fmu_no_variables(fmi3Instance handle, int modes, const char *function, const char *type,
                                   const fmi3ValueReference references[], size_t count)
{
    Instance *instance = handle;
    if (!fmu_allowed(instance, modes, function)) {
        return fmi3Error;
    }
    if (count == 0) {
        return fmi3OK;
    }
    return (fmi3Status)fmu_refuse(instance, "value reference %lu is not a variable of type %s",
                                  references != NULL ? references[0] : 0UL, type);
}

#define FMU_NO_VARIABLES(TYPE)                                                                             \
    fmi3Status fmi3Get##TYPE(fmi3Instance handle, const fmi3ValueReference references[], size_t count,     \
                             fmi3##TYPE values[], size_t value_count)                                      \
    {                                                                                                      \
        (void)values;                                                                                      \
        (void)value_count;                                                                                 \
        return fmu_no_variables(handle, READING, "fmi3Get" #TYPE, #TYPE, references, count);               \
    }                                                                                                      \
    fmi3Status fmi3Set##TYPE(fmi3Instance handle, const fmi3ValueReference references[], size_t count,     \
                             const fmi3##TYPE values[], size_t value_count)                                \
    {                                                                                                      \
        (void)values;                                                                                      \
        (void)value_count;                                                                                 \
        return fmu_no_variables(handle, SETTING, "fmi3Set" #TYPE, #TYPE, references, count);               \
    }

FMU_NO_VARIABLES(Float32)
FMU_NO_VARIABLES(Int8)
FMU_NO_VARIABLES(UInt8)
FMU_NO_VARIABLES(Int16)
FMU_NO_VARIABLES(UInt16)
FMU_NO_VARIABLES(Int32)
FMU_NO_VARIABLES(UInt32)
FMU_NO_VARIABLES(UInt64)
FMU_NO_VARIABLES(String)

fmi3Status fmi3GetBinary(fmi3Instance handle, const fmi3ValueReference references[], size_t count,
                         size_t sizes[], fmi3Binary values[], size_t value_count)
{
    (void)sizes;
    (void)values;
    (void)value_count;
    return fmu_no_variables(handle, READING, "fmi3GetBinary", "Binary", references, count);
}

fmi3Status fmi3SetBinary(fmi3Instance handle, const fmi3ValueReference references[], size_t count,
                         const size_t sizes[], const fmi3Binary values[], size_t value_count)
{
    (void)sizes;
    (void)values;
    (void)value_count;
    return fmu_no_variables(handle, SETTING, "fmi3SetBinary", "Binary", references, count);
}

/* ---- clocks */

fmi3Status fmi3GetClock(fmi3Instance handle, const fmi3ValueReference references[], size_t count,
                        fmi3Clock values[])
{
    (void)values;
    return fmu_no_variables(handle, ALWAYS, "fmi3GetClock", "Clock", references, count);
}

fmi3Status fmi3SetClock(fmi3Instance handle, const fmi3ValueReference references[], size_t count,
                        const fmi3Clock values[])
{
    (void)values;
    return fmu_no_variables(handle, ALWAYS, "fmi3SetClock", "Clock", references, count);
}

fmi3Status fmi3GetIntervalDecimal(fmi3Instance handle, const fmi3ValueReference references[], size_t count,
                                  fmi3Float64 intervals[], fmi3IntervalQualifier qualifiers[])
{
    (void)intervals;
    (void)qualifiers;
    return fmu_no_variables(handle, ALWAYS, "fmi3GetIntervalDecimal", "Clock", references, count);
}

fmi3Status fmi3GetIntervalFraction(fmi3Instance handle, const fmi3ValueReference references[], size_t count,
                                   fmi3UInt64 counters[], fmi3UInt64 resolutions[],
                                   fmi3IntervalQualifier qualifiers[])
{
    (void)counters;
    (void)resolutions;
    (void)qualifiers;
    return fmu_no_variables(handle, ALWAYS, "fmi3GetIntervalFraction", "Clock", references, count);
}

fmi3Status fmi3GetShiftDecimal(fmi3Instance handle, const fmi3ValueReference references[], size_t count,
                               fmi3Float64 shifts[])
{
    (void)shifts;
    return fmu_no_variables(handle, ALWAYS, "fmi3GetShiftDecimal", "Clock", references, count);
}

fmi3Status fmi3GetShiftFraction(fmi3Instance handle, const fmi3ValueReference references[], size_t count,
                                fmi3UInt64 counters[], fmi3UInt64 resolutions[])
{
    (void)counters;
    (void)resolutions;
    return fmu_no_variables(handle, ALWAYS, "fmi3GetShiftFraction", "Clock", references, count);
}

fmi3Status fmi3SetIntervalDecimal(fmi3Instance handle, const fmi3ValueReference references[], size_t count,
                                  const fmi3Float64 intervals[])
{
    (void)intervals;
    return fmu_no_variables(handle, ALWAYS, "fmi3SetIntervalDecimal", "Clock", references, count);
}

fmi3Status fmi3SetIntervalFraction(fmi3Instance handle, const fmi3ValueReference references[], size_t count,
                                   const fmi3UInt64 counters[], const fmi3UInt64 resolutions[])
{
    (void)counters;
    (void)resolutions;
    return fmu_no_variables(handle, ALWAYS, "fmi3SetIntervalFraction", "Clock", references, count);
}

fmi3Status fmi3SetShiftDecimal(fmi3Instance handle, const fmi3ValueReference references[], size_t count,
                               const fmi3Float64 shifts[])
{
    (void)shifts;
    return fmu_no_variables(handle, ALWAYS, "fmi3SetShiftDecimal", "Clock", references, count);
}

fmi3Status fmi3SetShiftFraction(fmi3Instance handle, const fmi3ValueReference references[], size_t count,
                                const fmi3UInt64 counters[], const fmi3UInt64 resolutions[])
{
    (void)counters;
    (void)resolutions;
    return fmu_no_variables(handle, ALWAYS, "fmi3SetShiftFraction", "Clock", references, count);
}

/* ---- other capabilities */

fmi3Status fmi3EvaluateDiscreteStates(fmi3Instance handle)
{
    return fmu_not_provided(handle, "the evaluation of discrete states is");
}

fmi3Status fmi3GetNumberOfVariableDependencies(fmi3Instance handle, fmi3ValueReference reference, size_t *count)
{
    (void)reference;
    (void)count;
    return fmu_not_provided(handle, "dependencies of elements are");
}

fmi3Status fmi3GetVariableDependencies(fmi3Instance handle, fmi3ValueReference dependent, size_t elements[],
                                       fmi3ValueReference independents[], size_t independent_elements[],
                                       fmi3DependencyKind kinds[], size_t count)
{
    (void)dependent;
    (void)elements;
    (void)independents;
    (void)independent_elements;
    (void)kinds;
    (void)count;
    return fmu_not_provided(handle, "dependencies of elements are");
}

fmi3Status fmi3EnterConfigurationMode(fmi3Instance handle)
{
    return fmu_not_provided(handle, "structural parameters are");
}

fmi3Status fmi3ExitConfigurationMode(fmi3Instance handle)
{
    return fmu_not_provided(handle, "structural parameters are");
}

fmi3Status fmi3ActivateModelPartition(fmi3Instance handle, fmi3ValueReference clock, fmi3Float64 time)
{
    (void)clock;
    (void)time;
    return fmu_not_provided(handle, "scheduled execution is");
}
