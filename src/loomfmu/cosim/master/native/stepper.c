/* Steps the FMUs of a scene along a plan that was prepared in Python: the same calls in the same order, and
 * the same arithmetic for a loop that is iterated. calls.py and steppers.py have the same structs. */

#include <fenv.h>
#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#if defined(_WIN32)
#define EXPORT __declspec(dllexport)
#else
#define EXPORT __attribute__((visibility("default")))
#endif

#include "../../../fmi/native/shell/broyden.h"
#include "tangents.h"

/* what a call does: FMI 2.0, FMI 3.0, on a wire, FMI 2.0 before the steps */
enum { VALUES, STEP, SET_3, GET_3, STEP_3, CONVERT, SET_UP, PLAIN };
enum { OK = 0, WARNING = 1, DISCARD = 2 };     /* with the first two a run goes on */
enum { REFUSED = 1000 };                       /* a value that does not fit is not handed over */
enum { NOT_SETTLED = -1, NOT_SAVED = -2, NOT_RESTORED = -3 }; /* what else may end an iterated step */

/* the FMI 3.0 types that differ from the master's double and int32_t */
enum { FLOAT32, BOOLEAN, INT8, INT16, INT64, UINT8, UINT16, UINT32, UINT64, ENUMERATION };

typedef int (*values_function)(void *, const unsigned *, size_t, void *);
typedef int (*values_function_3)(void *, const unsigned *, size_t, void *, size_t);
typedef int (*step_function)(void *, double, double, int);
typedef int (*plain_function)(void *);
typedef int (*set_up_function)(void *, int, double, double, int, double);
typedef int (*step_function_3)(void *, double, double, bool, bool *, bool *, bool *, double *);

struct flags {
    bool event, terminate, early;
    double reached;
};

struct silent { /* warnings that came without a message */
    int64_t count;
    double first; /* s */
};

struct call {
    int64_t kind;
    void (*function)(void);
    void *instance;
    const unsigned *references;
    size_t count;
    void *values;     /* what the FMU reads or writes; the flags of an FMI 3.0 step */
    void *masters;    /* the master's memory, where its types are others */
    int64_t type;     /* the FMU's, where it is another one */
    double low, high; /* what fits the other side; the factor and the offset of a conversion */
    const volatile int64_t *logged; /* warnings of the instance so far */
    struct silent *silent;
};

struct rollback {
    int (*save)(void *, void **);
    int (*restore)(void *, void *);
    void *instance;
    void **state;
};

struct loop { /* calls that are repeated until they agree with themselves */
    size_t first, end;
    const struct rollback *rollbacks;
    size_t rollback_count;
    const int64_t *slots; /* where the values on its wires stand among the reals */
    struct rule rule;
    struct solver solver;
    double *room; /* for the vectors of a search */
    int32_t *integers;
};

struct plan {
    const struct call *calls;
    size_t call_count;
    double *reals;
    size_t real_count;
    int32_t *integers;
    size_t integer_count;
    const int64_t *driven_reals; /* where the driven inputs stand among the reals */
    size_t driven_real_count;
    const int64_t *driven_integers; /* and among the integers */
    size_t driven_integer_count;
    const int32_t *interrupted; /* set by whoever wants the end of the run */
    const struct loop *loop;    /* NULL where nothing is iterated */
    const fenv_t *environment;  /* what third-party FMUs may not change; NULL where there are none */
    uint64_t control;           /* the words of it that count, once the plan is carried out */
};

struct outcome {
    int64_t call; /* the call that failed, or the rollback, if one did */
    int64_t status;
};

static double read_own(const struct call *call, size_t place)
{
    switch (call->type) {
    case FLOAT32: return ((const float *)call->values)[place];
    case BOOLEAN: return ((const bool *)call->values)[place];
    case INT8: return ((const int8_t *)call->values)[place];
    case INT16: return ((const int16_t *)call->values)[place];
    case UINT8: return ((const uint8_t *)call->values)[place];
    case UINT16: return ((const uint16_t *)call->values)[place];
    case UINT32: return ((const uint32_t *)call->values)[place];
    case UINT64: return (double)((const uint64_t *)call->values)[place];
    default: return (double)((const int64_t *)call->values)[place];
    }
}

static void write_own(const struct call *call, size_t place, double value)
{
    switch (call->type) {
    case FLOAT32: ((float *)call->values)[place] = (float)value; break;
    case BOOLEAN: ((bool *)call->values)[place] = value != 0.0; break;
    case INT8: ((int8_t *)call->values)[place] = (int8_t)value; break;
    case INT16: ((int16_t *)call->values)[place] = (int16_t)value; break;
    case UINT8: ((uint8_t *)call->values)[place] = (uint8_t)value; break;
    case UINT16: ((uint16_t *)call->values)[place] = (uint16_t)value; break;
    case UINT32: ((uint32_t *)call->values)[place] = (uint32_t)value; break;
    case UINT64: ((uint64_t *)call->values)[place] = (uint64_t)value; break;
    default: ((int64_t *)call->values)[place] = (int64_t)value;
    }
}

/* Copy values between the FMU's type and the master's; false, and nothing copied, if one does not fit. */
static bool moved(const struct call *call)
{
    bool to_fmu = call->kind == SET_3, real = call->type == FLOAT32;
    for (int copying = 0; copying < 2; copying++) {
        for (size_t place = 0; place < call->count; place++) {
            double masters = real ? ((double *)call->masters)[place] : ((int32_t *)call->masters)[place];
            double value = to_fmu ? masters : read_own(call, place);
            if (!copying && (value < call->low || value > call->high))
                return false;
            if (copying && to_fmu)
                write_own(call, place, value);
            else if (copying && real)
                ((double *)call->masters)[place] = value;
            else if (copying)
                ((int32_t *)call->masters)[place] = (int32_t)value;
        }
    }
    return true;
}

static int step_3(const struct call *call, double start, double size)
{
    struct flags *flags = call->values;
    flags->reached = start;
    int status = ((step_function_3)call->function)(
        call->instance, start, size, true, &flags->event, &flags->terminate, &flags->early, &flags->reached);
    bool sound = status == OK || status == WARNING;
    return sound && (flags->terminate || flags->early) ? DISCARD : status;
}

static int perform(const struct call *call, double start, double size)
{
    if (call->kind == STEP)
        return ((step_function)call->function)(call->instance, start, size, 1);
    if (call->kind == STEP_3)
        return step_3(call, start, size);
    if (call->kind == CONVERT) {
        double scaled = call->low * *(const double *)call->values;
        *(double *)call->masters = scaled + call->high;
        return OK;
    }
    if (call->kind == PLAIN)
        return ((plain_function)call->function)(call->instance);
    if (call->kind == SET_UP) {
        const double *experiment = call->values;
        int limited = call->type != 0;
        return ((set_up_function)call->function)(call->instance, limited, call->low, experiment[0], 1, experiment[1]);
    }
    if (call->kind == VALUES)
        return ((values_function)call->function)(call->instance, call->references, call->count, call->values);
    if (call->masters && call->kind == SET_3 && !moved(call))
        return REFUSED;
    int status = ((values_function_3)call->function)(
        call->instance, call->references, call->count, call->values, call->count);
    bool sound = status == OK || status == WARNING;
    return call->masters && call->kind == GET_3 && sound && !moved(call) ? REFUSED : status;
}

/* How this thread rounds, what it traps and flushes to zero. Setting the environment takes longer than
 * many a call, looking whether it is another one a few nanoseconds. */
static uint64_t control(void)
{
#if defined(__x86_64__)
    uint32_t vectors;
    uint16_t stack;
    __asm__ volatile("stmxcsr %0\n\tfnstcw %1" : "=m"(vectors), "=m"(stack));
    return (uint64_t)(vectors & ~0x3fu) << 16 | stack; /* without the flags of what has happened */
#elif defined(__aarch64__)
    uint64_t word;
    __asm__ volatile("mrs %0, fpcr" : "=r"(word));
    return word;
#else
#error "for this processor the words that control its arithmetic are not known"
#endif
}

static void restore_environment(const struct plan *plan)
{
    if (plan->environment && control() != plan->control)
        fesetenv(plan->environment);
}

/* Make the calls from first to end; whether all of them went well. */
static bool perform_all(const struct plan *plan, size_t first, size_t end, double start, double size,
                        struct outcome *outcome)
{
    for (size_t place = first; place < end; place++) {
        const struct call *call = &plan->calls[place];
        int64_t logged = *call->logged;
        int status = perform(call, start, size);
        restore_environment(plan);
        if (status == WARNING && *call->logged == logged && !call->silent->count++)
            call->silent->first = start;
        if (status < OK || status > WARNING) {
            outcome->call = (int64_t)place;
            outcome->status = status;
            return false;
        }
    }
    return true;
}

static bool roll(const struct plan *plan, bool back, struct outcome *outcome)
{
    const struct loop *loop = plan->loop;
    for (size_t place = 0; place < loop->rollback_count; place++) {
        const struct rollback *each = &loop->rollbacks[place];
        int status = back ? each->restore(each->instance, *each->state) : each->save(each->instance, each->state);
        restore_environment(plan);
        if (status != OK && status != WARNING) {
            outcome->call = (int64_t)place;
            outcome->status = back ? NOT_RESTORED : NOT_SAVED;
            return false;
        }
    }
    return true;
}

/* Copy the values on the wires of the loop out of the reals, or into them. */
static void move_values(const struct plan *plan, double *values, bool out)
{
    const struct loop *loop = plan->loop;
    for (size_t place = 0; place < loop->solver.count; place++) {
        double *real = &plan->reals[loop->slots[place]];
        *(out ? &values[place] : real) = *(out ? real : &values[place]);
    }
}

/* Repeat the calls of the loop until what comes out of them is what went in. */
static bool settle(const struct plan *plan, double start, double size, struct outcome *outcome)
{
    const struct loop *loop = plan->loop;
    const size_t wholes = plan->integer_count * sizeof(int32_t);
    enum progress progress = AGAIN;

    if (!roll(plan, false, outcome))
        return false;
    move_values(plan, loop->room, true);
    struct search search = broyden_begin(&loop->rule, &loop->solver, loop->room, loop->room);
    while (progress == AGAIN) {
        if (search.exchanges && !roll(plan, true, outcome))
            return false;
        move_values(plan, search.guess, false);
        memcpy(loop->integers, plan->integers, wholes);
        if (!perform_all(plan, loop->first, loop->end, start, size, outcome))
            return false;
        move_values(plan, search.found, true);
        progress = broyden_next(&loop->rule, &loop->solver, &search, loop->integers, plan->integers, wholes);
    }
    if (progress == UNSETTLED)
        outcome->status = NOT_SETTLED;
    return progress == SETTLED;
}

static bool take_step(const struct plan *plan, double start, double size, struct outcome *outcome)
{
    const struct loop *loop = plan->loop;
    if (!loop)
        return perform_all(plan, 0, plan->call_count, start, size, outcome);
    return perform_all(plan, 0, loop->first, start, size, outcome) && settle(plan, start, size, outcome) &&
           perform_all(plan, loop->end, plan->call_count, start, size, outcome);
}

/* Take steps; return how many were taken. A row of all values is written after each. */
EXPORT int64_t advance(struct plan *plan, int64_t steps, const double *starts, const double *sizes,
                       const double *driven_reals, const int32_t *driven_integers, double *real_rows,
                       int32_t *integer_rows, struct outcome *outcome)
{
    plan->control = control();
    for (int64_t step = 0; step < steps; step++) {
        if (*(const volatile int32_t *)plan->interrupted)
            return step;
        for (size_t place = 0; place < plan->driven_real_count; place++)
            plan->reals[plan->driven_reals[place]] = *driven_reals++;
        for (size_t place = 0; place < plan->driven_integer_count; place++)
            plan->integers[plan->driven_integers[place]] = *driven_integers++;
        if (!take_step(plan, starts[step], sizes[step], outcome))
            return step;
        memcpy(real_rows, plan->reals, plan->real_count * sizeof(double));
        memcpy(integer_rows, plan->integers, plan->integer_count * sizeof(int32_t));
        real_rows += plan->real_count;
        integer_rows += plan->integer_count;
    }
    return steps;
}

#include "compose.h"
#include "rows.h"
