/* FMI 3.0: co-simulation, and model exchange where a component has no memory. */
#include "component.c"
#include "fmi3Functions.h"

typedef struct {
    fmi3LogMessageCallback logger;
    fmi3InstanceEnvironment environment;
    bool model_exchange;
} Host;

#include "instance.h"

static const char *const kind_names[] = {"Float64", "Int64", "Boolean"};

static void *fmu_allocate(const Host *host, size_t size)
{
    (void)host;
    return calloc(1, size);
}

static void fmu_release(const Host *host, void *memory)
{
    (void)host;
    free(memory);
}

#define MODES (INSTANTIATED | INITIALIZING | STEPPING | TERMINATED | BROKEN | EVENTS | CONTINUOUS_TIME)

#include "messages.c"
#include "instance.c"
#include "values.c"
#include "states.c"
#include "solver.c"

#define TIMED 1 /* the time is the variable after all others */
#include "component_dual.c"
#include "model_dual.h"
#include "derivatives.c"

/* Where functions may be called: sections 2.3, 3.2 and 4.2 of the standard. */
#define ALWAYS MODES
#define SETTING (INSTANTIATED | INITIALIZING | STEPPING | EVENTS)

static void fmu_tell(Instance *instance, Status status, const char *category, const char *message)
{
    if (instance->host.logger != NULL) {
        instance->host.logger(instance->host.environment, (fmi3Status)status, category, message);
    }
}

/* ---- life cycle */

const char *fmi3GetVersion(void)
{
    return fmi3Version;
}

/* A new instance, or NULL and a reason to the host. */
static Instance *fmu_instantiate(fmi3String name, fmi3String token, bool logging, Host host, const char *reason)
{
    Instance *instance = NULL;
    if (name == NULL || name[strspn(name, " \t\r\n")] == '\0') {
        reason = "the instance name is empty";
    } else if (token == NULL || strcmp(token, MODEL_TOKEN) != 0) {
        reason = "the token must be that of " MODEL_NAME ", " MODEL_TOKEN;
    }
    if (reason == NULL) {
        instance = fmu_allocate(&host, sizeof *instance);
        reason = "out of memory for an instance";
    }
    if (instance == NULL) {
        if (host.logger != NULL) {
            host.logger(host.environment, fmi3Error, categories[FAILED - 1], reason);
        }
        return NULL;
    }
    instance->host = host;
    fmu_reset(instance);
    (void)fmu_set_logging(instance, logging, 0, NULL);
    return instance;
}

fmi3Instance fmi3InstantiateCoSimulation(
    fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible, fmi3Boolean logging,
    fmi3Boolean event_mode, fmi3Boolean early_return, const fmi3ValueReference intermediate[],
    size_t intermediate_count, fmi3InstanceEnvironment environment, fmi3LogMessageCallback logger,
    fmi3IntermediateUpdateCallback update)
{
    Host host = {logger, environment, false};
    (void)resources; /* there are none */
    (void)visible;
    (void)early_return; /* a step is always made to its end */
    (void)intermediate;
    (void)intermediate_count;
    (void)update;
    return fmu_instantiate(name, token, logging, host, event_mode ? "event mode is not supported" : NULL);
}

fmi3Instance fmi3InstantiateModelExchange(fmi3String name, fmi3String token, fmi3String resources,
                                          fmi3Boolean visible, fmi3Boolean logging,
                                          fmi3InstanceEnvironment environment, fmi3LogMessageCallback logger)
{
    Host host = {logger, environment, true};
    (void)resources;
    (void)visible;
    return fmu_instantiate(name, token, logging, host,
                           MEMORYLESS ? NULL : MODEL_NAME " keeps a state from step to step: it supports co-simulation only");
}

fmi3Instance fmi3InstantiateScheduledExecution(
    fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible, fmi3Boolean logging,
    fmi3InstanceEnvironment environment, fmi3LogMessageCallback logger, fmi3ClockUpdateCallback update,
    fmi3LockPreemptionCallback lock, fmi3UnlockPreemptionCallback unlock)
{
    Host host = {logger, environment, false};
    (void)resources;
    (void)visible;
    (void)update;
    (void)lock;
    (void)unlock;
    return fmu_instantiate(name, token, logging, host, "scheduled execution is not supported");
}

void fmi3FreeInstance(fmi3Instance handle)
{
    fmu_free(handle);
}

fmi3Status fmi3SetDebugLogging(fmi3Instance handle, fmi3Boolean on, size_t count, const fmi3String names[])
{
    Instance *instance = handle;
    if (!fmu_allowed(instance, ALWAYS, "fmi3SetDebugLogging")) {
        return fmi3Error;
    }
    return (fmi3Status)fmu_set_logging(instance, on, count, names);
}

fmi3Status fmi3EnterInitializationMode(fmi3Instance handle, fmi3Boolean tolerance_defined,
                                       fmi3Float64 tolerance, fmi3Float64 start_time,
                                       fmi3Boolean stop_time_defined, fmi3Float64 stop_time)
{
    Instance *instance = handle;
    (void)tolerance_defined; /* nothing here is solved to a tolerance */
    (void)tolerance;
    if (!fmu_allowed(instance, INSTANTIATED, "fmi3EnterInitializationMode")) {
        return fmi3Error;
    }
    if (fmu_set_times(instance, start_time, stop_time_defined, stop_time) != OK) {
        return fmi3Error;
    }
    instance->state.mode = INITIALIZING;
    instance->state.stale = true;
    return fmi3OK;
}

fmi3Status fmi3ExitInitializationMode(fmi3Instance handle)
{
    return (fmi3Status)fmu_exit_initialization(handle, "fmi3ExitInitializationMode");
}

fmi3Status fmi3Terminate(fmi3Instance handle)
{
    return (fmi3Status)fmu_terminate(handle, "fmi3Terminate");
}

fmi3Status fmi3Reset(fmi3Instance handle)
{
    return (fmi3Status)fmu_start_again(handle, "fmi3Reset");
}

/* A function of the standard for what this FMU does not have. */
static fmi3Status fmu_not_provided(fmi3Instance handle, const char *what)
{
    Instance *instance = handle;
    Text text;
    if (instance == NULL) {
        return fmi3Error;
    }
    fmu_begin(&text);
    fmu_add(&text, what);
    fmu_add(&text, " not supported");
    return (fmi3Status)fmu_complain(instance, FAILED, text.text);
}

#include "fmi3_solver.c"
#include "fmi3_values.c"
#include "fmi3_steps.c"
#include "fmi3_absent.c"
