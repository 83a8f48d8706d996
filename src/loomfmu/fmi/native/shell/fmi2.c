/* FMI 2.0: co-simulation, and model exchange where a component has no memory. */
#include "component.c"
#include "fmi2Functions.h"

typedef struct {
    fmi2CallbackLogger logger;
    fmi2CallbackAllocateMemory allocate;
    fmi2CallbackFreeMemory release;
    fmi2ComponentEnvironment environment;
    bool model_exchange;
} Host;

#include "instance.h"

static const char *const kind_names[] = {"Real", "Integer", "Boolean"};

static void *fmu_allocate(const Host *host, size_t size)
{
    return host->allocate != NULL ? host->allocate(1, size) : calloc(1, size);
}

static void fmu_release(const Host *host, void *memory)
{
    if (host->allocate != NULL) {
        host->release(memory);
    } else {
        free(memory);
    }
}

#define MODES                                                                                              \
    (INSTANTIATED | INITIALIZING | STEPPING | STEP_FAILED | TERMINATED | BROKEN | EVENTS | CONTINUOUS_TIME)

#include "messages.c"
#include "instance.c"
#include "values.c"
#include "carry.c"
#include "states.c"
#include "solver.c"

#define TIMED 0 /* the time is not a variable */
#include "component_dual.c"
#include "model_dual.h"
#include "derivatives.c"

/* Where functions may be called: the tables of calling sequences in sections 3.2.3 and 4.2.4 of the standard. Values may
 * be read earlier, as in FMI 3.0: PyFMI does so before it sets up the experiment. */
#define ALWAYS MODES
#define READING MODES
#define SETTING (INSTANTIATED | INITIALIZING | STEPPING | EVENTS)
#define CONTINUOUS_SETTING (SETTING | CONTINUOUS_TIME)
#define STEPPED (STEPPING | STEP_FAILED | TERMINATED)

/* Hosts take the message for a format, as the standard has it, or for a text: with each per cent sign
 * doubled it is safe for both. */
static void fmu_tell(Instance *instance, Status status, const char *category, const char *message)
{
    char format[2 * TEXT_SIZE];
    size_t length = 0;
    if (instance->host.logger == NULL) {
        return;
    }
    for (; *message != '\0' && length < sizeof format - 2; message++) {
        if (*message == '%') {
            format[length++] = '%';
        }
        format[length++] = *message;
    }
    format[length] = '\0';
    instance->host.logger(instance->host.environment, instance->name, (fmi2Status)status, category, format);
}

/* ---- life cycle */

const char *fmi2GetTypesPlatform(void)
{
    return fmi2TypesPlatform;
}

const char *fmi2GetVersion(void)
{
    return fmi2Version;
}

/* Why an instance cannot be made, or NULL. */
static const char *fmu_refusal(fmi2String name, fmi2Type type, fmi2String token)
{
    if (name == NULL || name[strspn(name, " \t\r\n")] == '\0') {
        return "the instance name is empty";
    }
    if (type != fmi2CoSimulation && type != fmi2ModelExchange) {
        return "the type must be fmi2CoSimulation or fmi2ModelExchange";
    }
    if (type == fmi2ModelExchange && !MEMORYLESS) {
        return MODEL_NAME " keeps a state from step to step: it supports co-simulation only";
    }
    if (token == NULL || strcmp(token, MODEL_TOKEN) != 0) {
        return "the GUID must be that of " MODEL_NAME ", " MODEL_TOKEN;
    }
    return NULL;
}

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String token, fmi2String resources,
                              const fmi2CallbackFunctions *functions, fmi2Boolean visible,
                              fmi2Boolean logging)
{
    Host host = {NULL, NULL, NULL, NULL, type == fmi2ModelExchange};
    const char *reason = fmu_refusal(name, type, token);
    Instance *instance = NULL;
    (void)resources; /* there are none */
    (void)visible;
    if (functions == NULL) {
        return NULL;
    }
    host.logger = functions->logger;
    host.environment = functions->componentEnvironment;
    if (functions->allocateMemory != NULL && functions->freeMemory != NULL) {
        host.allocate = functions->allocateMemory;
        host.release = functions->freeMemory;
    }
    if (reason == NULL) {
        instance = fmu_allocate(&host, sizeof *instance + strlen(name) + 1);
        reason = "out of memory for an instance";
    }
    if (instance == NULL) {
        if (host.logger != NULL) {
            host.logger(host.environment, name != NULL ? name : "", fmi2Error, categories[FAILED - 1], reason);
        }
        return NULL;
    }
    instance->host = host;
    instance->name = (char *)(instance + 1);
    memcpy(instance->name, name, strlen(name) + 1);
    fmu_reset(instance);
    (void)fmu_set_logging(instance, logging != fmi2False, 0, NULL);
    return instance;
}

void fmi2FreeInstance(fmi2Component component)
{
    fmu_free(component);
}

fmi2Status fmi2SetDebugLogging(fmi2Component component, fmi2Boolean on, size_t count,
                               const fmi2String names[])
{
    Instance *instance = component;
    if (!fmu_allowed(instance, ALWAYS, "fmi2SetDebugLogging")) {
        return fmi2Error;
    }
    return (fmi2Status)fmu_set_logging(instance, on != fmi2False, count, names);
}

fmi2Status fmi2SetupExperiment(fmi2Component component, fmi2Boolean tolerance_defined, fmi2Real tolerance,
                               fmi2Real start_time, fmi2Boolean stop_time_defined, fmi2Real stop_time)
{
    Instance *instance = component;
    (void)tolerance_defined; /* nothing here is solved to a tolerance */
    (void)tolerance;
    if (!fmu_allowed(instance, INSTANTIATED, "fmi2SetupExperiment")) {
        return fmi2Error;
    }
    return (fmi2Status)fmu_set_times(instance, start_time, stop_time_defined != fmi2False, stop_time);
}

fmi2Status fmi2EnterInitializationMode(fmi2Component component)
{
    Instance *instance = component;
    if (!fmu_allowed(instance, INSTANTIATED, "fmi2EnterInitializationMode")) {
        return fmi2Error;
    }
    if (!instance->state.set_up) {
        return (fmi2Status)fmu_complain(instance, FAILED, "fmi2SetupExperiment must be called first");
    }
    instance->state.mode = INITIALIZING;
    instance->state.stale = true;
    return fmi2OK;
}

fmi2Status fmi2ExitInitializationMode(fmi2Component component)
{
    return (fmi2Status)fmu_exit_initialization(component, "fmi2ExitInitializationMode");
}

fmi2Status fmi2Terminate(fmi2Component component)
{
    return (fmi2Status)fmu_terminate(component, "fmi2Terminate");
}

fmi2Status fmi2Reset(fmi2Component component)
{
    return (fmi2Status)fmu_start_again(component, "fmi2Reset");
}

#include "fmi2_solver.c"
#include "fmi2_values.c"
#include "fmi2_steps.c"
