/* A page in a browser, as WebAssembly: one instance, and a whole run in one call. Nothing is imported.
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

static void page_sample(double *samples, size_t length, size_t place, const unsigned *wanted, size_t count)
{
    size_t i;
    for (i = 0; i < count; i++) {
        samples[i * length + place] = fmu_value(&instance, &rows[wanted[i]]);
    }
}

/* All steps, and the samples at their ends, the start included: one signal after the other. Returns the number
 * of steps that were made; fewer if one of them failed. */
EXPORT(run) size_t page_run(size_t steps, const unsigned *wanted, size_t count, double *samples)
{
    double size = page_step();
    size_t i;
    page_sample(samples, steps + 1, 0, wanted, count);
    for (i = 0; i < steps; i++) {
        if (fmu_step_parts(&instance, (double)i * size, size) != OK) {
            return i;
        }
        page_sample(samples, steps + 1, i + 1, wanted, count);
    }
    return steps;
}
