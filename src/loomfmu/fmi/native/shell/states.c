/* The state of an instance as bytes: the same on every machine, and refused if it is not ours.
 *
 * Layout, all numbers little-endian: "LOOMFMU" and the version of the layout, the token, the mode and
 * flags, the times, all variables in the order of their references with what carries the inputs, what a loop
 * has learnt, the same variables of the origin of the outputs, a checksum.
 */

#define LAYOUT "LOOMFMU\2"
#define TOKEN_SIZE (sizeof MODEL_TOKEN - 1)
#define DERIVATIVES_SIZE ((size_t)VARIABLES * (1 + 8 * HIGHEST_ORDER))
#define ORIGIN_SIZE (2 + 2 * 8 + (size_t)VARIABLES * (8 + 1))
#if LOOP_VALUES > 0
#define LOOP_SIZE sizeof(LoopMemory) /* of numbers alone */
#else
#define LOOP_SIZE 0
#endif
#define STATE_SIZE (8 + TOKEN_SIZE + 4 + 2 * 8 + (size_t)VARIABLES * 8 + DERIVATIVES_SIZE + LOOP_SIZE + ORIGIN_SIZE + 8)

/* Bytes that are written, or read back in the same order. */
typedef struct {
    unsigned char *bytes;
    bool writing;
} Stream;

static uint64_t fmu_pass_bits(Stream *stream, uint64_t bits, int count)
{
    uint64_t found = 0;
    int i;
    for (i = 0; i < count; i++) {
        if (stream->writing) {
            stream->bytes[i] = (unsigned char)(bits >> (8 * i) & 255U);
        }
        found |= (uint64_t)stream->bytes[i] << (8 * i);
    }
    stream->bytes += count;
    return found;
}

static double fmu_pass_real(Stream *stream, double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    bits = fmu_pass_bits(stream, bits, 8);
    memcpy(&value, &bits, sizeof value);
    return value;
}

static int64_t fmu_pass_integer(Stream *stream, int64_t value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    bits = fmu_pass_bits(stream, bits, 8);
    memcpy(&value, &bits, sizeof value);
    return value;
}

/* One variable, in eight bytes whatever its kind. */
static void fmu_pass_variable(Stream *stream, Component *component, const Row *row)
{
    void *place = (char *)component + row->offset;
    if (row->kind == REAL) {
        *(double *)place = fmu_pass_real(stream, *(double *)place);
    } else if (row->kind == INTEGER) {
        *(int64_t *)place = fmu_pass_integer(stream, *(int64_t *)place);
    } else {
        *(bool *)place = fmu_pass_bits(stream, *(bool *)place ? 1 : 0, 8) != 0;
    }
}

static void fmu_pass_origin(Stream *stream, Origin *origin)
{
    int i;
    origin->kind = (int)fmu_pass_bits(stream, (uint64_t)origin->kind, 1);
    origin->carried = fmu_pass_bits(stream, origin->carried ? 1 : 0, 1) != 0;
    origin->time = fmu_pass_real(stream, origin->time);
    origin->size = fmu_pass_real(stream, origin->size);
    for (i = 0; i < VARIABLES; i++) {
        fmu_pass_variable(stream, &origin->component, &rows[i]);
        origin->given[i] = (unsigned char)fmu_pass_bits(stream, origin->given[i], 1);
    }
}

/* Writes a state, or reads one: the same walk, so that both agree. */
static void fmu_pass_state(Stream *stream, State *state)
{
    int i, order;
    state->mode = (int)fmu_pass_bits(stream, (uint64_t)state->mode, 1);
    state->set_up = fmu_pass_bits(stream, state->set_up ? 1 : 0, 1) != 0;
    state->stale = fmu_pass_bits(stream, state->stale ? 1 : 0, 1) != 0;
    state->carried = fmu_pass_bits(stream, state->carried ? 1 : 0, 1) != 0;
    state->time = fmu_pass_real(stream, state->time);
    state->stop_time = fmu_pass_real(stream, state->stop_time);
    for (i = 0; i < VARIABLES; i++) {
        fmu_pass_variable(stream, &state->component, &rows[i]);
        state->given[i] = (unsigned char)fmu_pass_bits(stream, state->given[i], 1);
        for (order = 0; order < HIGHEST_ORDER; order++) {
            state->derivatives[i][order] = fmu_pass_real(stream, state->derivatives[i][order]);
        }
    }
#if LOOP_VALUES > 0
    for (i = 0; i < (int)(LOOP_SIZE / sizeof(double)); i++) {
        double *numbers = (double *)&state->component.loop;
        numbers[i] = fmu_pass_real(stream, numbers[i]);
    }
#endif
    fmu_pass_origin(stream, &state->origin);
}

/* FNV-1a: enough to find what was damaged on the way. */
static uint64_t fmu_checksum(const unsigned char *bytes, size_t count)
{
    uint64_t sum = UINT64_C(14695981039346656037);
    while (count-- > 0) {
        sum = (sum ^ *bytes++) * UINT64_C(1099511628211);
    }
    return sum;
}

static void fmu_write_state(const State *state, unsigned char *bytes)
{
    State copy = *state;
    Stream stream = {bytes + 8 + TOKEN_SIZE, true};
    memcpy(bytes, LAYOUT, 8);
    memcpy(bytes + 8, MODEL_TOKEN, TOKEN_SIZE);
    fmu_pass_state(&stream, &copy);
    (void)fmu_pass_bits(&stream, fmu_checksum(bytes, STATE_SIZE - 8), 8);
}

/* Whether a variable is within its limits. */
static bool fmu_is_within(const Component *component, const Row *row)
{
    const char *place = (const char *)component + row->offset;
    double value = 0.0;
    if (row->kind == REAL) {
        value = *(const double *)(const void *)place;
    } else if (row->kind == INTEGER) {
        value = (double)*(const int64_t *)(const void *)place;
    }
    return value >= row->low && value <= row->high;
}

/* Whether a state is one that an instance can have been in. */
static bool fmu_is_possible(const State *state)
{
    const Origin *origin = &state->origin;
    int i, order;
    bool known = state->mode > 0 && (state->mode & ~MODES) == 0 && (state->mode & (state->mode - 1)) == 0;
    if (!known || !isfinite(state->time) || isnan(state->stop_time) || origin->kind > STEP
        || !isfinite(origin->time) || !isfinite(origin->size)) {
        return false;
    }
    for (i = 0; i < VARIABLES; i++) {
        if (!fmu_is_within(&state->component, &rows[i]) || !fmu_is_within(&origin->component, &rows[i])
            || state->given[i] >= 1 << HIGHEST_ORDER || origin->given[i] >= 1 << HIGHEST_ORDER) {
            return false;
        }
        for (order = 0; order < HIGHEST_ORDER; order++) {
            if (!isfinite(state->derivatives[i][order])) {
                return false;
            }
        }
    }
    return true;
}

/* The state that bytes hold; false if they hold none of this component. */
static bool fmu_read_state(State *state, const unsigned char *bytes, size_t size)
{
    unsigned char copy[STATE_SIZE];
    Stream stream = {copy, false};
    if (size != STATE_SIZE) {
        return false;
    }
    memcpy(copy, bytes, STATE_SIZE);
    memset(state, 0, sizeof *state);
    if (memcmp(copy, LAYOUT, 8) != 0 || memcmp(copy + 8, MODEL_TOKEN, TOKEN_SIZE) != 0) {
        return false;
    }
    stream.bytes += 8 + TOKEN_SIZE;
    fmu_pass_state(&stream, state);
    if (fmu_pass_bits(&stream, 0, 8) != fmu_checksum(copy, STATE_SIZE - 8)) {
        return false;
    }
    return fmu_is_possible(state);
}

/* A copy of the state in the host's hands. */
typedef struct {
    char mark[TOKEN_SIZE]; /* of this build: what another one has saved may be laid out otherwise */
    State state;
} Saved;

/* Copies a state; the derivatives of inputs, most of its bytes, where a host has given some. */
static void fmu_copy_state(State *to, const State *from)
{
    memcpy(to, from, from->carried ? sizeof *to : offsetof(State, derivatives));
}

/* The copy behind a handle, or NULL and a message. A pointer that was never a handle cannot be recognised. */
static Saved *fmu_saved(Instance *instance, void *handle)
{
    Saved *saved = handle;
    if (saved != NULL && memcmp(saved->mark, MODEL_TOKEN, sizeof saved->mark) == 0) {
        return saved;
    }
    (void)fmu_complain(instance, FAILED, "the FMU state is damaged, or of another FMU or another version of this one");
    return NULL;
}

/* A new copy for a handle that is NULL. */
static Saved *fmu_provide(Instance *instance, void **handle)
{
    if (handle == NULL) {
        (void)fmu_complain(instance, FAILED, "the pointer to the FMU state is NULL");
        return NULL;
    }
    if (*handle == NULL) {
        Saved *saved = fmu_allocate(&instance->host, sizeof *saved);
        if (saved == NULL) {
            (void)fmu_complain(instance, FAILED, "out of memory for an FMU state");
            return NULL;
        }
        memcpy(saved->mark, MODEL_TOKEN, sizeof saved->mark);
        *handle = saved;
    }
    return fmu_saved(instance, *handle);
}

/* The functions of both standards, which may be called always; `function` is the standard's own name. */

static Status fmu_save(Instance *instance, const char *function, void **handle)
{
    Saved *saved = fmu_allowed(instance, MODES, function) ? fmu_provide(instance, handle) : NULL;
    if (saved == NULL) {
        return FAILED;
    }
    fmu_copy_state(&saved->state, &instance->state);
    return OK;
}

/* Whether an instance of this interface can have been in a state: each has modes of its own. */
static bool fmu_fits(const Instance *instance, const State *state)
{
    int others = instance->host.model_exchange ? STEPPING | STEP_FAILED : EVENTS | CONTINUOUS_TIME;
    return (state->mode & others) == 0;
}

static Status fmu_restore(Instance *instance, const char *function, void *handle)
{
    const Saved *saved = fmu_allowed(instance, MODES, function) ? fmu_saved(instance, handle) : NULL;
    if (saved == NULL) {
        return FAILED;
    }
    if (!fmu_fits(instance, &saved->state)) {
        return fmu_complain(instance, FAILED, "the FMU state belongs to another interface type");
    }
    fmu_copy_state(&instance->state, &saved->state);
    return OK;
}

static Status fmu_forget(Instance *instance, const char *function, void **handle)
{
    Saved *saved;
    if (!fmu_allowed(instance, MODES, function)) {
        return FAILED;
    }
    if (handle == NULL || *handle == NULL) {
        return OK;
    }
    saved = fmu_saved(instance, *handle);
    if (saved == NULL) {
        return FAILED;
    }
    memset(saved->mark, 0, sizeof saved->mark);
    fmu_release(&instance->host, saved);
    *handle = NULL;
    return OK;
}

static Status fmu_packed_size(Instance *instance, const char *function, void *handle, size_t *size)
{
    if (!fmu_allowed(instance, MODES, function) || fmu_saved(instance, handle) == NULL) {
        return FAILED;
    }
    if (size == NULL) {
        return fmu_complain(instance, FAILED, "the pointer to the size is NULL");
    }
    *size = STATE_SIZE;
    return OK;
}

static Status fmu_pack(Instance *instance, const char *function, void *handle, void *bytes, size_t size)
{
    const Saved *saved = fmu_allowed(instance, MODES, function) ? fmu_saved(instance, handle) : NULL;
    if (saved == NULL) {
        return FAILED;
    }
    if (bytes == NULL || size < STATE_SIZE) {
        return fmu_refuse(instance, "an FMU state needs %lu bytes%s", (unsigned long)STATE_SIZE, "");
    }
    fmu_write_state(&saved->state, bytes);
    return OK;
}

static Status fmu_unpack(Instance *instance, const char *function, const void *bytes, size_t size, void **handle)
{
    State read;
    Saved *saved;
    if (!fmu_allowed(instance, MODES, function)) {
        return FAILED;
    }
    if (bytes == NULL || !fmu_read_state(&read, bytes, size)) {
        return fmu_complain(instance, FAILED, "the FMU state is damaged, or of another FMU or another version of this one");
    }
    saved = fmu_provide(instance, handle);
    if (saved == NULL) {
        return FAILED;
    }
    saved->state = read;
    return OK;
}
