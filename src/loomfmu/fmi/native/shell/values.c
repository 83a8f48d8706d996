/* Variables by value reference: which there are, who may set them, within which limits. */

static const char *const causality_names[] = {"a fixed parameter", "an input", "an output", "a local variable"};

/* The variable of that reference and kind, or NULL and a message. */
static const Row *fmu_row(Instance *instance, unsigned reference, Kind kind)
{
    if (reference >= FIRST_REFERENCE && reference - FIRST_REFERENCE < VARIABLES) {
        const Row *row = &rows[reference - FIRST_REFERENCE];
        if (row->kind == kind) {
            return row;
        }
    }
    (void)fmu_refuse(instance, "value reference %lu is not a variable of type %s", reference, kind_names[kind]);
    return NULL;
}

static void *fmu_place(Instance *instance, const Row *row)
{
    return (char *)&instance->state.component + row->offset;
}

/* What a host may read: with a start that is up to date. */
static Status fmu_prepare_reading(Instance *instance)
{
    return instance->state.mode == INITIALIZING ? fmu_refresh(instance) : OK;
}

/* Whether the host may set a variable as things stand: inputs always, fixed parameters before the steps. */
static bool fmu_settable(const Instance *instance, const Row *row)
{
    bool starting = instance->state.mode == INSTANTIATED || instance->state.mode == INITIALIZING;
    return row->causality == INPUT
           || (row->causality == PARAMETER && (starting || row->variability == TUNABLE));
}

/* Logs that a value is outside the limits of its variable. */
static Status fmu_tell_limit(Instance *instance, const Row *row, double value, Status status)
{
    Text text;
    fmu_begin(&text);
    fmu_add(&text, row->name);
    fmu_add(&text, " = ");
    fmu_add_value(&text, row, value);
    fmu_add_unit(&text, row);
    fmu_add(&text, " is outside [");
    fmu_add_value(&text, row, row->low);
    fmu_add(&text, ", ");
    fmu_add_value(&text, row, row->high);
    fmu_add(&text, "]");
    fmu_add_unit(&text, row);
    return fmu_complain(instance, status, text.text);
}

static Status fmu_refuse_setting(Instance *instance, const Row *row)
{
    Text text;
    fmu_begin(&text);
    fmu_add(&text, row->name);
    fmu_add(&text, " is ");
    fmu_add(&text, causality_names[row->causality]);
    fmu_add(&text, " and cannot be set");
    fmu_add(&text, row->causality == PARAMETER ? " while stepping" : "");
    return fmu_complain(instance, FAILED, text.text);
}

/* Whether a variable may be set to a value now; logs an error if not. NaN is outside any limits. */
static Status fmu_check_setting(Instance *instance, const Row *row, double value)
{
    if (!fmu_settable(instance, row)) {
        return fmu_refuse_setting(instance, row);
    }
    if (value >= row->low && value <= row->high) {
        return OK;
    }
    return fmu_tell_limit(instance, row, value, FAILED);
}

static Status fmu_get_real(Instance *instance, unsigned reference, double *value)
{
    const Row *row = fmu_row(instance, reference, REAL);
    if (row == NULL) {
        return FAILED;
    }
    *value = *(double *)fmu_place(instance, row);
    return OK;
}

static Status fmu_get_integer(Instance *instance, unsigned reference, int64_t *value)
{
    const Row *row = fmu_row(instance, reference, INTEGER);
    if (row == NULL) {
        return FAILED;
    }
    *value = *(int64_t *)fmu_place(instance, row);
    return OK;
}

static Status fmu_get_boolean(Instance *instance, unsigned reference, bool *value)
{
    const Row *row = fmu_row(instance, reference, BOOLEAN);
    if (row == NULL) {
        return FAILED;
    }
    *value = *(bool *)fmu_place(instance, row);
    return OK;
}

static Status fmu_set_real(Instance *instance, unsigned reference, double value)
{
    const Row *row = fmu_row(instance, reference, REAL);
    if (row == NULL || fmu_check_setting(instance, row, value) != OK) {
        return FAILED;
    }
    *(double *)fmu_place(instance, row) = value;
    instance->state.stale = true;
    return OK;
}

static Status fmu_set_integer(Instance *instance, unsigned reference, int64_t value)
{
    const Row *row = fmu_row(instance, reference, INTEGER);
    if (row == NULL || fmu_check_setting(instance, row, (double)value) != OK) {
        return FAILED;
    }
    *(int64_t *)fmu_place(instance, row) = value;
    instance->state.stale = true;
    return OK;
}

static Status fmu_set_boolean(Instance *instance, unsigned reference, bool value)
{
    const Row *row = fmu_row(instance, reference, BOOLEAN);
    if (row == NULL || fmu_check_setting(instance, row, value ? 1.0 : 0.0) != OK) {
        return FAILED;
    }
    *(bool *)fmu_place(instance, row) = value;
    instance->state.stale = true;
    return OK;
}

/* The n-th derivative of an output, if its declared rates lead to it. */
static Status fmu_output_derivative(Instance *instance, unsigned reference, int order, double *value)
{
    const Row *row = fmu_row(instance, reference, REAL);
    if (row == NULL) {
        return FAILED;
    }
    if (row->causality != OUTPUT || order < 1) {
        return fmu_refuse(instance, "value reference %lu, %s: only outputs have derivatives, of order 1 or more",
                          reference, row->name);
    }
    for (; order > 0 && row->rate != NONE; order--) {
        row = &rows[row->rate];
    }
    if (order > 0) {
        *value = 0.0;
        return fmu_complain(instance, DISCARD, "the output has no derivative of this order");
    }
    *value = fmu_value(instance, row);
    return OK;
}

/* Whether values may be read or set now: the state, and that there is something behind the pointers. */
static bool fmu_ready(Instance *instance, int modes, const char *function, const void *references,
                      size_t count, const void *values)
{
    if (!fmu_allowed(instance, modes, function)) {
        return false;
    }
    if (count > 0 && (references == NULL || values == NULL)) {
        (void)fmu_complain(instance, FAILED, "value references or values are missing");
        return false;
    }
    return true;
}
