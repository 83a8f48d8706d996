/* Steps the FMUs of a scene along a plan that was prepared in Python: the same calls in the same order. */

#include <stddef.h>
#include <stdint.h>
#include <string.h>

#if defined(_WIN32)
#define EXPORT __declspec(dllexport)
#else
#define EXPORT __attribute__((visibility("default")))
#endif

enum { REALS, INTEGERS, STEP }; /* what a call moves; a step moves time */
enum { OK = 0, WARNING = 1 };   /* the statuses with which a run goes on */

typedef int (*real_function)(void *, const unsigned *, size_t, double *);
typedef int (*integer_function)(void *, const unsigned *, size_t, int32_t *);
typedef int (*step_function)(void *, double, double, int);

struct call {
    int64_t kind;
    void (*function)(void);
    void *instance;
    const unsigned *references;
    size_t count;
    void *values;
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
};

struct outcome {
    int64_t call; /* the call that failed, if one did */
    int64_t status;
};

static int perform(const struct call *call, double start, double size)
{
    switch (call->kind) {
    case REALS:
        return ((real_function)call->function)(
            call->instance, call->references, call->count, (double *)call->values);
    case INTEGERS:
        return ((integer_function)call->function)(
            call->instance, call->references, call->count, (int32_t *)call->values);
    default:
        return ((step_function)call->function)(call->instance, start, size, 1);
    }
}

/* Take steps; return how many were taken. A row of all values is written after each. */
EXPORT int64_t advance(const struct plan *plan, int64_t steps, const double *starts, const double *sizes,
                       const double *driven_reals, const int32_t *driven_integers, double *real_rows,
                       int32_t *integer_rows, struct outcome *outcome)
{
    for (int64_t step = 0; step < steps; step++) {
        if (*(const volatile int32_t *)plan->interrupted)
            return step;
        for (size_t place = 0; place < plan->driven_real_count; place++)
            plan->reals[plan->driven_reals[place]] = *driven_reals++;
        for (size_t place = 0; place < plan->driven_integer_count; place++)
            plan->integers[plan->driven_integers[place]] = *driven_integers++;
        for (size_t place = 0; place < plan->call_count; place++) {
            int status = perform(&plan->calls[place], starts[step], sizes[step]);
            if (status < OK || status > WARNING) {
                outcome->call = (int64_t)place;
                outcome->status = status;
                return step;
            }
        }
        memcpy(real_rows, plan->reals, plan->real_count * sizeof(double));
        memcpy(integer_rows, plan->integers, plan->integer_count * sizeof(int32_t));
        real_rows += plan->real_count;
        integer_rows += plan->integer_count;
    }
    return steps;
}
