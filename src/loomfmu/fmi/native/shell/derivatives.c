/* Derivatives of outputs: what gave the outputs is repeated with dual numbers, one direction at a time.
 *
 * Outputs are those of the start, of the last step, or of this instant in model exchange. What a step found when
 * it began is held; so parameters count at the start, and everywhere for a component without memory.
 */

#define DIFFERENTIATED (INITIALIZING | STEPPING | STEP_FAILED | TERMINATED | BROKEN | EVENTS | CONTINUOUS_TIME)

/* The size of the component with dual numbers, where its variables are, and how it is started and stepped. */
typedef struct {
    size_t size;
    const size_t *offsets;
    const DualPart *part;
} Dual;

const Dual *loomfmu_dual(void);

/* Its knowns and unknowns, by value reference. */
typedef struct {
    const unsigned *unknowns;
    size_t unknown_count;
    const unsigned *knowns;
    size_t known_count;
} Derivative;

static double *fmu_tangent(DualComponent *component, const Row *row)
{
    return &((dual *)(void *)((char *)component + dual_offsets[row - rows]))->tangent;
}

static bool fmu_is_time(unsigned reference)
{
    return TIMED && reference == FIRST_REFERENCE + VARIABLES;
}

/* Whether an unknown is an output that changes as things stand; logs an error if not. */
static bool fmu_is_unknown(Instance *instance, unsigned reference)
{
    const Row *row = fmu_row(instance, reference, REAL);
    if (row == NULL) {
        return false;
    }
    if (row->causality != OUTPUT || (row->variability == DISCRETE && instance->state.mode == CONTINUOUS_TIME)) {
        (void)fmu_refuse(instance, "value reference %lu, %s, is not an output with a derivative now", reference,
                         row->name);
        return false;
    }
    return true;
}

/* Whether outputs are differentiated by a known as things stand; logs an error if not. */
static bool fmu_is_known(Instance *instance, unsigned reference)
{
    bool settable = MEMORYLESS || instance->state.mode == INITIALIZING;
    const Row *row = fmu_is_time(reference) ? NULL : fmu_row(instance, reference, REAL);
    if (row == NULL) {
        return fmu_is_time(reference);
    }
    if (row->causality != INPUT && !(row->causality == PARAMETER && settable)) {
        (void)fmu_refuse(instance, "value reference %lu, %s: there is no derivative by it now", reference, row->name);
        return false;
    }
    return true;
}

/* Whether derivatives can be computed: logs the reason if not. */
static Status fmu_check_derivative(Instance *instance, const char *function, const Derivative *wanted,
                                   const double *seed, const double *found)
{
    size_t i;
    if (LOOP_VALUES > 0 && fmu_allowed(instance, DIFFERENTIATED, function)) {
        return fmu_complain(instance, FAILED, "an FMU with an algebraic loop gives no derivatives");
    }
    if (!fmu_ready(instance, DIFFERENTIATED, function, wanted->unknowns, wanted->unknown_count, wanted->unknowns)
        || !fmu_ready(instance, DIFFERENTIATED, function, wanted->knowns, wanted->known_count, wanted->knowns)) {
        return FAILED;
    }
    if (wanted->unknown_count > 0 && wanted->known_count > 0 && (seed == NULL || found == NULL)) {
        return fmu_complain(instance, FAILED, "seeds or sensitivities are missing");
    }
    for (i = 0; i < wanted->unknown_count; i++) {
        if (!fmu_is_unknown(instance, wanted->unknowns[i])) {
            return FAILED;
        }
    }
    for (i = 0; i < wanted->known_count; i++) {
        if (!fmu_is_known(instance, wanted->knowns[i])) {
            return FAILED;
        }
    }
    if (fmu_prepare(instance) != OK) {
        return FAILED;
    }
    if (instance->state.origin.kind == NOWHERE) {
        return fmu_complain(instance, DISCARD, "the last step failed: there are no outputs to differentiate");
    }
    return OK;
}

/* ---- the component with dual numbers */

static void fmu_make_dual(DualComponent *made, const Component *component)
{
    int i;
    memset(made, 0, sizeof *made);
    for (i = 0; i < VARIABLES; i++) {
        const void *place = (const char *)component + rows[i].offset;
        void *copy = (char *)made + dual_offsets[i];
        if (rows[i].kind == REAL) {
            *(dual *)copy = dual_of(*(const double *)place);
        } else {
            memcpy(copy, place, fmu_size(&rows[i]));
        }
    }
}

/* The row in which the n-th time derivative of an input is read, or NONE where it was given or is 0. */
static int fmu_rate_of(const Origin *origin, int place, int order)
{
    for (; order > 0 && place != NONE; order--) {
        bool given = (origin->given[place] & (1 << (order - 1))) != 0;
        place = given ? NONE : rows[place].rate;
        if (place != NONE && rows[place].causality != INPUT) {
            place = NONE;
        }
    }
    return place;
}

/* Carries the tangents of the inputs as `fmu_carry_inputs` did their values. */
static void fmu_carry_tangents(DualComponent *component, const Origin *origin)
{
    DualComponent given = *component;
    int i, order;
    for (i = 0; i < VARIABLES; i++) {
        double factor = 1.0;
        for (order = 1; order <= HIGHEST_ORDER && rows[i].causality == INPUT && rows[i].kind == REAL; order++) {
            int rate = fmu_rate_of(origin, i, order);
            factor *= origin->size / order;
            if (rate != NONE) {
                *fmu_tangent(component, &rows[i]) += factor * *fmu_tangent(&given, &rows[rate]);
            }
        }
    }
}

static void fmu_start_dual(DualComponent *component, dual time)
{
    int i;
    for (i = 0; i < PARTS; i++) {
        (void)dual_parts[i].initialize(component, time);
    }
}

/* A step of all parts, on their grid if they have one. It was made before, so no problem is reported. */
static void fmu_step_dual(DualComponent *component, const Origin *origin, dual time)
{
    double inner = INNER_STEP(&origin->component), before = time.tangent;
    Walk walk = grid_walk(time.value, origin->size, inner);
    while (grid_next(&walk)) {
        double after = walk.at < walk.end ? 0.0 : time.tangent;
        int i;
        for (i = 0; i < PARTS; i++) {
            (void)dual_parts[i].step(component, dual_made(walk.time, before), dual_made(walk.size, after - before));
        }
        before = after;
    }
}

/* Repeats what gave the outputs in one direction of the knowns. */
static void fmu_repeat(const Instance *instance, const Derivative *wanted, const double *seed, DualComponent *found)
{
    const Origin *origin = &instance->state.origin;
    dual time = dual_of(origin->time);
    size_t i;
    fmu_make_dual(found, &origin->component);
    for (i = 0; i < wanted->known_count; i++) {
        if (fmu_is_time(wanted->knowns[i])) {
            time.tangent += seed[i];
        } else {
            *fmu_tangent(found, &rows[wanted->knowns[i] - FIRST_REFERENCE]) += seed[i];
        }
    }
    if (origin->carried) {
        fmu_carry_tangents(found, origin);
    }
    if (origin->kind == START || MEMORYLESS) {
        fmu_start_dual(found, time); /* what is computed once from the parameters */
    }
    if (origin->kind == STEP) {
        fmu_step_dual(found, origin, time);
    }
}

static Status fmu_check_tangent(Instance *instance, double value)
{
    return isfinite(value) ? OK : fmu_complain(instance, DISCARD, "the derivative is not finite here");
}

/* ---- the same in both standards; `function` is the standard's own name */

static Status fmu_get_directional(Instance *instance, const char *function, Derivative wanted, const double *seed,
                                  double *found)
{
    Status status = fmu_check_derivative(instance, function, &wanted, seed, found);
    DualComponent component;
    size_t i;
    if (status != OK || wanted.unknown_count == 0) {
        return status;
    }
    fmu_repeat(instance, &wanted, seed, &component);
    for (i = 0; i < wanted.unknown_count && status == OK; i++) {
        found[i] = *fmu_tangent(&component, &rows[wanted.unknowns[i] - FIRST_REFERENCE]);
        status = fmu_check_tangent(instance, found[i]);
    }
    return status;
}

/* ---- the component with dual numbers, for a master that carries tangents from step to step */

#if defined(_WIN32)
__declspec(dllexport)
#else
__attribute__((visibility("default")))
#endif
const Dual *loomfmu_dual(void)
{
    static const Dual table = {sizeof(DualComponent), dual_offsets, &dual_parts[0]};
    return &table;
}
