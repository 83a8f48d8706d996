/* A page in a browser, as WebAssembly: one instance, and steps of some of its parts. Nothing is imported.
 *
 * Variables go by their row. What a start or a run complains of is kept as text.
 */
#include "component.c"

typedef struct {
    bool model_exchange;
} Host;

#include "instance.h"

#define MODES (INSTANTIATED | INITIALIZING | STEPPING | STEP_FAILED | TERMINATED | BROKEN)
#define EXPORT(name) __attribute__((export_name(#name)))

static const char *const kind_names[] = {"Real", "Integer", "Boolean"};
static Instance instance;
static Text messages;

static void fmu_release(const Host *host, void *memory)
{
    (void)host;
    (void)memory; /* the one instance is never freed */
}

#include "messages.c"
#include "instance.c"
#include "values.c"

static void fmu_tell(Instance *it, Status status, const char *category, const char *message)
{
    (void)it;
    (void)status;
    (void)category;
    fmu_add(&messages, message);
    fmu_add(&messages, "\n");
}

EXPORT(allocate) void *page_allocate(size_t size)
{
    return malloc(size);
}

EXPORT(messages) const char *page_messages(void)
{
    return messages.text;
}

/* Start anew from the values of the scene. */
EXPORT(reset) void page_reset(void)
{
    fmu_begin(&messages);
    fmu_reset(&instance);
    (void)fmu_set_logging(&instance, true, 0, NULL);
}

EXPORT(set) int page_set(unsigned row, double value)
{
    unsigned reference = row + FIRST_REFERENCE;
    if (row >= VARIABLES) {
        return FAILED;
    }
    switch (rows[row].kind) {
    case REAL:
        return fmu_set_real(&instance, reference, value);
    case INTEGER:
        return fmu_set_integer(&instance, reference, (int64_t)value);
    case BOOLEAN:
        break;
    }
    return fmu_set_boolean(&instance, reference, value > 0.0);
}

static void page_put(const Row *row, double value)
{
    void *place = fmu_place(&instance, row);
    switch (row->kind) {
    case REAL:
        *(double *)place = value;
        return;
    case INTEGER:
        *(int64_t *)place = (int64_t)value;
        return;
    case BOOLEAN:
        break;
    }
    *(bool *)place = value > 0.0;
}

EXPORT(get) double page_get(unsigned row)
{
    return row < VARIABLES ? fmu_value(&instance, &rows[row]) : 0.0;
}

/* Compute the start from what was set. */
EXPORT(start) int page_start(void)
{
    (void)fmu_set_times(&instance, 0.0, false, 0.0);
    instance.state.mode = INITIALIZING;
    return fmu_exit_initialization(&instance, "start");
}

/* The communication step [s]. */
EXPORT(step) double page_step(void)
{
    return INNER_STEP(&instance.state.component);
}

/* A variable whose samples are kept, the part that computes it, and whether it feeds another part. */
typedef struct {
    unsigned row;
    unsigned part;
    unsigned feeds;
} Signal;

/* What a run does with a part. One that it leaves alone keeps its state. */
enum { LEFT, STEPPED, SAMPLED };

/* What is stepped and sampled. Signals go by their place in the list. */
static struct {
    const Signal *signals;
    size_t count;
    double *samples; /* one signal after the other */
    size_t length;   /* samples of each: one more than there are steps */
    const unsigned char *use; /* of each part: LEFT, STEPPED, or SAMPLED already, so that it feeds the others */
    size_t taken[VARIABLES];  /* signals of the parts that are stepped */
    size_t taken_count;
    size_t fed[VARIABLES]; /* signals by which the others feed them */
    size_t fed_count;
} record;

EXPORT(record) void page_record(const Signal *signals, size_t count, double *samples, size_t length)
{
    record.signals = signals;
    record.count = count;
    record.samples = samples;
    record.length = length;
}

/* Choose what the next runs do with each part. */
EXPORT(choose) void page_choose(const unsigned char *use)
{
    size_t i;
    record.use = use;
    record.taken_count = record.fed_count = 0;
    for (i = 0; i < record.count; i++) {
        unsigned char its = use[record.signals[i].part];
        if (its == STEPPED) {
            record.taken[record.taken_count++] = i;
        } else if (its == SAMPLED && record.signals[i].feeds) {
            record.fed[record.fed_count++] = i;
        }
    }
}

static void page_sample(size_t place)
{
    size_t i;
    for (i = 0; i < record.taken_count; i++) {
        size_t signal = record.taken[i];
        record.samples[signal * record.length + place] = fmu_value(&instance, &rows[record.signals[signal].row]);
    }
}

/* Set what feeds the parts that are stepped, as it was sampled. */
static void page_feed(size_t place)
{
    size_t i;
    for (i = 0; i < record.fed_count; i++) {
        size_t signal = record.fed[i];
        page_put(&rows[record.signals[signal].row], record.samples[signal * record.length + place]);
    }
}

/* One step of the parts that are to take it. */
static Status page_step_parts(double time, double size)
{
    Pass pass = {false, time, size};
    Status status = OK;
    int i;
    for (i = 0; i < PARTS && status == OK; i++) {
        if (record.use[i] == STEPPED) {
            status = fmu_pass_part(&instance, i, pass);
        }
    }
    return status == OK ? fmu_check_finite(&instance, false, time, DISCARD) : status;
}

/* Steps from one sample to another. Returns the sample that was reached: an earlier one if a
 * step failed. */
EXPORT(run) size_t page_run(size_t from, size_t to)
{
    double size = page_step();
    size_t k;
    if (from == 0) {
        page_sample(0);
    }
    for (k = from; k < to; k++) {
        page_feed(k + 1);
        if (page_step_parts((double)k * size, size) != OK) {
            return k;
        }
        page_sample(k + 1);
    }
    return to;
}
