/* Inputs that a host gives with their derivatives, carried to the end of the step (FMI 2). */

/* The n-th time derivative of the input in a row: given for this step, or read through its declared rates. */
static double fmu_input_derivative(const Instance *instance, int place, int order)
{
    const State *state = &instance->state;
    while (order > 0) {
        if ((state->given[place] & (1 << (order - 1))) != 0) {
            return state->derivatives[place][order - 1];
        }
        if (rows[place].rate == NONE || rows[rows[place].rate].causality != INPUT) {
            return 0.0;
        }
        place = rows[place].rate;
        order--;
    }
    return fmu_value(instance, &rows[place]);
}

static Status fmu_set_derivative(Instance *instance, unsigned reference, int order, double value)
{
    const Row *row = fmu_row(instance, reference, REAL);
    if (row == NULL) {
        return FAILED;
    }
    if (row->causality != INPUT) {
        return fmu_refuse(instance, "value reference %lu, %s, is not an input", reference, row->name);
    }
    if (INNER_STEPS) {
        return fmu_refuse(instance, "value reference %lu, %s: input derivatives are not supported", reference,
                          row->name);
    }
    if (order < 1 || order > HIGHEST_ORDER || !isfinite(value)) {
        return fmu_refuse(instance, "value reference %lu: the derivative must be finite and of order 1 to 3%s",
                          reference, "");
    }
    instance->state.derivatives[row - rows][order - 1] = value;
    instance->state.given[row - rows] |= (unsigned char)(1 << (order - 1));
    instance->state.carried = true;
    return OK;
}

/* Moves all inputs on by their Taylor polynomials; a limit that one leaves ends the step. */
static Status fmu_carry_inputs(Instance *instance, double size)
{
    Component carried = instance->state.component;
    int i;
    for (i = 0; i < VARIABLES; i++) {
        if (rows[i].causality == INPUT && rows[i].kind == REAL) {
            double first = fmu_input_derivative(instance, i, 1);
            double second = fmu_input_derivative(instance, i, 2);
            double third = fmu_input_derivative(instance, i, 3);
            double value = fmu_value(instance, &rows[i]);
            value += size * (first + size / 2.0 * (second + size / 3.0 * third));
            if (!(value >= rows[i].low && value <= rows[i].high)) {
                return fmu_tell_limit(instance, &rows[i], value, DISCARD);
            }
            *(double *)(void *)((char *)&carried + rows[i].offset) = value;
        }
    }
    instance->state.component = carried;
    return OK;
}

/* Puts the inputs back to what the host has set. */
static void fmu_uncarry_inputs(Instance *instance, const Component *given)
{
    int i;
    for (i = 0; i < VARIABLES; i++) {
        if (rows[i].causality == INPUT && rows[i].kind == REAL) {
            const char *place = (const char *)given + rows[i].offset;
            *(double *)fmu_place(instance, &rows[i]) = *(const double *)(const void *)place;
        }
    }
}

/* A step with the inputs of its end. Derivatives hold for one step, then they are to be given anew. */
static Status fmu_carried_step(Instance *instance, double time, double size)
{
    Component given = instance->state.component;
    bool *at_step_end = NULL;
    Status status = fmu_carry_inputs(instance, size);
    if (INPUTS_AT_STEP_END != NONE) {
        at_step_end = fmu_place(instance, &rows[INPUTS_AT_STEP_END]);
    }
    if (status == OK) {
        if (at_step_end != NULL) {
            *at_step_end = true;
        }
        status = fmu_step(instance, time, size);
        instance->state.origin.carried = true;
        memcpy(instance->state.origin.given, instance->state.given, sizeof instance->state.given);
        if (at_step_end != NULL) {
            *at_step_end = false;
        }
        fmu_uncarry_inputs(instance, &given);
    }
    memset(instance->state.given, 0, sizeof instance->state.given);
    return status;
}

/* Whether the next step is to carry the inputs: not where the host already gives those of its end. */
static bool fmu_is_carried(Instance *instance)
{
    if (!instance->state.carried) {
        return false;
    }
    return INPUTS_AT_STEP_END == NONE || !*(bool *)fmu_place(instance, &rows[INPUTS_AT_STEP_END]);
}
