/* A plain host of native FMUs, without Python: makes the calls of plan.h, step after step. */
#define _POSIX_C_SOURCE 199309L
#include <dlfcn.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

#include "fmi2FunctionTypes.h"

enum action { SET, STEP, GET };
enum kind { REAL, INTEGER, BOOLEAN };

struct made {
    const char *name, *library, *guid;
};

struct setting {
    int instance;
    enum kind kind;
    unsigned reference;
    double value;
};

struct call {
    int instance;
    enum action action;
    enum kind kind;
    int first, count; /* of the moves of its values */
};

#include "plan.h"

enum { MOST = 256 }; /* values in a call */

struct instance {
    fmi2Component component;
    fmi2DoStepTYPE *step;
    fmi2SetRealTYPE *set_real;
    fmi2GetRealTYPE *get_real;
    fmi2SetIntegerTYPE *set_integer[2]; /* integers, booleans: both are ints */
    fmi2GetIntegerTYPE *get_integer[2];
};

static struct instance instances[INSTANCES];
static double values[COLUMNS];

static void logger(fmi2ComponentEnvironment environment, fmi2String name, fmi2Status status,
                   fmi2String category, fmi2String message, ...)
{
    (void)environment;
    (void)status;
    (void)category;
    fprintf(stderr, "%s: %s\n", name, message);
}

static void must(int status)
{
    if (status > fmi2Warning) {
        fprintf(stderr, "an FMU refused a call\n");
        exit(2);
    }
}

static void *symbol(void *library, const char *name)
{
    void *found = library == NULL ? NULL : dlsym(library, name);
    if (found == NULL) {
        fprintf(stderr, "%s is missing\n", name);
        exit(2);
    }
    return found;
}

static void *libraries[INSTANCES];
static fmi2CallbackFunctions callbacks = {logger, calloc, free, NULL, NULL};

static void instantiate(int place)
{
    struct instance *made_here = &instances[place];
    void *library = dlopen(made[place].library, RTLD_NOW | RTLD_LOCAL);
    fmi2InstantiateTYPE *create;
    fmi2SetupExperimentTYPE *set_experiment_up;
    *(void **)&create = symbol(library, "fmi2Instantiate");
    *(void **)&set_experiment_up = symbol(library, "fmi2SetupExperiment");
    *(void **)&made_here->step = symbol(library, "fmi2DoStep");
    *(void **)&made_here->set_real = symbol(library, "fmi2SetReal");
    *(void **)&made_here->get_real = symbol(library, "fmi2GetReal");
    *(void **)&made_here->set_integer[0] = symbol(library, "fmi2SetInteger");
    *(void **)&made_here->get_integer[0] = symbol(library, "fmi2GetInteger");
    *(void **)&made_here->set_integer[1] = symbol(library, "fmi2SetBoolean");
    *(void **)&made_here->get_integer[1] = symbol(library, "fmi2GetBoolean");
    libraries[place] = library;
    made_here->component =
        create(made[place].name, fmi2CoSimulation, made[place].guid, "", &callbacks, fmi2False, fmi2True);
    if (made_here->component == NULL)
        must(fmi2Fatal);
    must(set_experiment_up(made_here->component, fmi2False, 0.0, 0.0, fmi2False, 0.0));
}

static void change_mode(const char *function)
{
    for (int place = 0; place < INSTANCES; place++) {
        fmi2EnterInitializationModeTYPE *change;
        *(void **)&change = symbol(libraries[place], function);
        must(change(instances[place].component));
    }
}

static int make(const struct call *call, double time, double size)
{
    const struct instance *to = &instances[call->instance];
    const unsigned *moved = references + call->first;
    const int *from = slots + call->first;
    size_t count = (size_t)call->count;
    double reals[MOST];
    int integers[MOST], status;
    if (call->action == STEP)
        return to->step(to->component, time, size, fmi2True);
    if (call->action == SET && call->kind == REAL) {
        for (size_t n = 0; n < count; n++)
            reals[n] = values[from[n]];
        return to->set_real(to->component, moved, count, reals);
    }
    if (call->action == SET) {
        for (size_t n = 0; n < count; n++)
            integers[n] = (int)values[from[n]];
        return to->set_integer[call->kind - 1](to->component, moved, count, integers);
    }
    if (call->kind == REAL) /* the outputs of an instance and a kind stand side by side */
        return to->get_real(to->component, moved, count, &values[from[0]]);
    status = to->get_integer[call->kind - 1](to->component, moved, count, integers);
    for (size_t n = 0; n < count; n++)
        values[from[n]] = (double)integers[n];
    return status;
}

static void set_up(void)
{
    for (int place = 0; place < INSTANCES; place++)
        instantiate(place);
    for (size_t n = 0; n < sizeof settings / sizeof settings[0]; n++) {
        const struct setting *given = &settings[n];
        const struct instance *to = &instances[given->instance];
        int whole = (int)given->value;
        must(given->kind == REAL
                 ? to->set_real(to->component, &given->reference, 1, &given->value)
                 : to->set_integer[given->kind - 1](to->component, &given->reference, 1, &whole));
    }
    change_mode("fmi2EnterInitializationMode");
}

static int initialize_all(void)
{
    for (size_t n = 0; n < sizeof calls / sizeof calls[0]; n++)
        if (calls[n].action != STEP)
            must(make(&calls[n], 0.0, 0.0));
    change_mode("fmi2ExitInitializationMode");
    return 0;
}

static int step_all(double time, double size)
{
    for (size_t n = 0; n < sizeof calls / sizeof calls[0]; n++)
        if (make(&calls[n], time, size) > fmi2Warning)
            return 1;
    return 0;
}

static void record(double *row)
{
    for (int n = 0; n < COLUMNS; n++)
        row[n] = values[n];
}

#include "timed_loop.h"
