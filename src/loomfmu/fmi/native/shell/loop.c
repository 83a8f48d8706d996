/* A system with an algebraic loop: the loop is iterated, with the arithmetic of the master that runs it. */
#include "broyden.h"

#define LOOP_WHOLES ((int)(sizeof loop_wholes / sizeof loop_wholes[0]) - 1)

static const struct rule loop_rule = LOOP_RULE;

/* Where the solver's numbers stand in what a system keeps of its loop. */
static struct solver fmu_solver(LoopMemory *memory)
{
    struct solver solver = {LOOP_REALS, memory->largest, memory->differences, memory->inverse};
    return solver;
}

/* The loop knows nothing yet; its slopes are taken for -1. */
static void fmu_forget_loop(LoopMemory *memory)
{
    int i;
    memset(memory, 0, sizeof *memory);
    for (i = 0; i < 4 * LOOP_REALS; i++) {
        memory->differences[i] = NAN;
    }
    for (i = 0; i < LOOP_REALS; i++) {
        memory->inverse[i * LOOP_REALS + i] = -1.0;
    }
}

static void fmu_values(const Instance *instance, const int *sources, int count, double *values)
{
    int i;
    for (i = 0; i < count; i++) {
        values[i] = fmu_value(instance, &rows[sources[i]]);
    }
}

/* Repeats the parts of the loop until they agree with themselves. */
static Status fmu_settle(Instance *instance, Pass pass, bool *settled)
{
    Component *component = &instance->state.component;
    const Component before = *component;
    LoopMemory memory = before.loop;
    struct solver solver = fmu_solver(&memory);
    double room[VECTORS * LOOP_REALS + 1] = {0.0}, wholes[2][LOOP_WHOLES + 1] = {{0.0}};
    struct search search = broyden_begin(&loop_rule, &solver, memory.values, room);
    enum progress progress = AGAIN;
    Status status = OK;
    fmu_values(instance, loop_wholes, LOOP_WHOLES, wholes[1]);
    while (progress == AGAIN && status == OK) {
        *component = before;
        memcpy(memory.values, search.guess, LOOP_REALS * sizeof(double));
        memcpy(component->loop.values, memory.values, sizeof memory.values);
        memcpy(wholes[0], wholes[1], sizeof wholes[0]);
        status = fmu_pass_parts(instance, LOOP_FIRST, LOOP_END, pass);
        fmu_values(instance, loop_sources, LOOP_VALUES, memory.values);
        fmu_values(instance, loop_wholes, LOOP_WHOLES, wholes[1]);
        memcpy(search.found, memory.values, LOOP_REALS * sizeof(double));
        progress = broyden_next(&loop_rule, &solver, &search, wholes[0], wholes[1], sizeof wholes[0]);
    }
    *settled = progress == SETTLED;
    component->loop = memory;
    return status;
}

/* Makes the loop agree at the start; where it cannot, its values are handed on once. */
static Status fmu_start_loop(Instance *instance, Pass pass)
{
    LoopMemory *memory = &instance->state.component.loop;
    double first[LOOP_VALUES];
    bool settled = false;
    Status status;
    fmu_forget_loop(memory);
    status = fmu_pass_parts(instance, LOOP_FIRST, LOOP_END, pass);
    if (status != OK) {
        return status;
    }
    fmu_values(instance, loop_sources, LOOP_VALUES, first);
    memcpy(memory->values, first, sizeof first);
    status = fmu_settle(instance, pass, &settled);
    fmu_forget_loop(memory);
    if (status == OK && !settled) {
        memcpy(memory->values, first, sizeof first);
        status = fmu_pass_parts(instance, LOOP_FIRST, LOOP_END, pass);
        (void)fmu_complain(instance, WARNING, "loop " LOOP_WIRES ": the start values did not converge");
    }
    fmu_values(instance, loop_sources, LOOP_VALUES, memory->values);
    return status;
}

/* Starts the loop, or takes a step of it. */
static Status fmu_pass_loop(Instance *instance, Pass pass)
{
    bool settled = false;
    Status status;
    if (pass.start) {
        return fmu_start_loop(instance, pass);
    }
    status = fmu_settle(instance, pass, &settled);
    if (status == OK && !settled) {
        status = fmu_check_finite(instance, false, pass.time, DISCARD);
    }
    if (status == OK && !settled) {
        return fmu_complain_of_step(instance, DISCARD, pass.time, pass.size, " s: loop " LOOP_WIRES " did not converge");
    }
    return status;
}
