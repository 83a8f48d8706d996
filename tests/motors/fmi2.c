/* The motor as an FMI 2.0 co-simulation FMU of a maker who knows printf and no reset. */

#include <stdlib.h>

#include "fmi2FunctionTypes.h"
#include "motor.h"

#ifndef SINGLE
#define SINGLE 0
#endif
#ifndef LATE /* whether rates are computed on leaving initialization, and not before */
#define LATE 0
#endif

#ifndef CRASHES /* whether it crashes when it is terminated */
#define CRASHES 0
#endif
#ifndef ENDS_AT /* s: when it ends the simulation */
#define ENDS_AT 1.0e300
#endif

typedef struct {
    Motor motor;
    const fmi2CallbackFunctions *functions;
    char name[64];
    int running, touched, ended; /* out of initialization; given an input since the last step; at ENDS_AT */
} Instance;

static int alive = 0;

const char *fmi2GetTypesPlatform(void) { return fmi2TypesPlatform; }
const char *fmi2GetVersion(void) { return "2.0"; }

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                              const fmi2CallbackFunctions *functions, fmi2Boolean visible, fmi2Boolean logging)
{
    Instance *instance;
    (void)resources, (void)visible, (void)logging;
    if (type != fmi2CoSimulation || strcmp(guid, "{motor-2}") != 0 || (SINGLE && alive)) {
        functions->logger(functions->componentEnvironment, name, fmi2Error, "error", "%s: %d alive", guid, alive);
        return NULL;
    }
    instance = functions->allocateMemory(1, sizeof(Instance));
    motor_defaults(&instance->motor);
    instance->functions = functions;
    strncpy(instance->name, name, sizeof instance->name - 1);
    alive++;
    return instance;
}

void fmi2FreeInstance(fmi2Component c)
{
    alive--;
    ((Instance *)c)->functions->freeMemory(c);
}

fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean defined, fmi2Real tolerance, fmi2Real start,
                               fmi2Boolean stop_defined, fmi2Real stop)
{
    (void)stop_defined, (void)stop;
    if (defined && tolerance > 0.1) return fmi2Error;
    ((Instance *)c)->motor.time = start;
    return fmi2OK;
}

fmi2Status fmi2EnterInitializationMode(fmi2Component c)
{
    Instance *i = c;
    if (i->motor.inertia <= 0.0) {
        i->functions->logger(i->functions->componentEnvironment, i->name, fmi2Error, "error",
                             "J = %g %s is not above %d", i->motor.inertia, "kg.m2", 0);
        return fmi2Error;
    }
    if (!LATE) motor_rates(&i->motor);
    return fmi2OK;
}

fmi2Status fmi2ExitInitializationMode(fmi2Component c)
{
    motor_rates(&((Instance *)c)->motor);
    ((Instance *)c)->running = 1;
    return fmi2OK;
}

fmi2Status fmi2Terminate(fmi2Component c)
{
    (void)c;
    if (CRASHES) abort();
    return fmi2OK;
}
fmi2Status fmi2Reset(fmi2Component c) { (void)c; return fmi2Error; }

static double *real(Motor *m, fmi2ValueReference r)
{
    double *all[] = {&m->inertia, &m->stall_torque, &m->free_speed, &m->load, &m->phi, &m->w, &m->a, &m->time};
    return all[r];
}

static int *whole(Motor *m, fmi2ValueReference r)
{
    int *all[] = {&m->steps, &m->at_speed, &m->verbose, &m->mode};
    return all[r];
}

fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference r[], size_t n, fmi2Real v[])
{
    Instance *i = c;
    if (i->touched) {
        i->functions->logger(i->functions->componentEnvironment, i->name, fmi2Error, "error",
                             "no step between fmi2SetReal and fmi2GetReal");
        return fmi2Error;
    }
    for (size_t k = 0; k < n; k++) v[k] = *real(&i->motor, r[k]);
    return fmi2OK;
}

fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference r[], size_t n, const fmi2Real v[])
{
    Instance *i = c;
    i->touched = i->running;
    for (size_t k = 0; k < n; k++) *real(&i->motor, r[k]) = v[k];
    return fmi2OK;
}

fmi2Status fmi2GetInteger(fmi2Component c, const fmi2ValueReference r[], size_t n, fmi2Integer v[])
{
    for (size_t k = 0; k < n; k++) v[k] = *whole(&((Instance *)c)->motor, r[k]);
    return fmi2OK;
}

fmi2Status fmi2SetInteger(fmi2Component c, const fmi2ValueReference r[], size_t n, const fmi2Integer v[])
{
    for (size_t k = 0; k < n; k++) *whole(&((Instance *)c)->motor, r[k]) = v[k];
    return fmi2OK;
}

fmi2Status fmi2GetBoolean(fmi2Component c, const fmi2ValueReference r[], size_t n, fmi2Boolean v[])
{
    return fmi2GetInteger(c, r, n, v);
}

fmi2Status fmi2SetBoolean(fmi2Component c, const fmi2ValueReference r[], size_t n, const fmi2Boolean v[])
{
    return fmi2SetInteger(c, r, n, v);
}

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real time, fmi2Real h, fmi2Boolean keep)
{
    Instance *i = c;
    (void)keep;
    i->touched = 0;
    if (i->motor.verbose) {
        i->functions->logger(i->functions->componentEnvironment, i->name, fmi2Warning, "load",
                             "%s carries %.3f N.m, step %d", i->name, i->motor.load, i->motor.steps);
    }
    if (i->motor.load > i->motor.stall_torque) {
        i->functions->logger(i->functions->componentEnvironment, i->name, fmi2Error, "load",
                             "stalled by %g N.m at %g s", i->motor.load, time);
        return fmi2Discard;
    }
    i->ended = time + h > ENDS_AT - 1e-12;
    motor_step(&i->motor, i->ended ? ENDS_AT - time : h);
    return i->ended ? fmi2Discard : fmi2OK;
}

fmi2Status fmi2GetBooleanStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Boolean *value)
{
    Instance *i = c;
    if (kind != fmi2Terminated || !i->ended) {
        i->functions->logger(i->functions->componentEnvironment, i->name, fmi2Error, "error", "it has not ended");
        return fmi2Error;
    }
    *value = fmi2True;
    return fmi2OK;
}

fmi2Status fmi2GetRealStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Real *value)
{
    *value = ((Instance *)c)->motor.time;
    return kind == fmi2LastSuccessfulTime ? fmi2OK : fmi2Error;
}

/* what the standard wants to be there and the motor has not */

#define NOT_THERE(name) fmi2Status name(void) { return fmi2Error; }

NOT_THERE(fmi2SetDebugLogging)
NOT_THERE(fmi2GetString)
NOT_THERE(fmi2SetString)
NOT_THERE(fmi2GetFMUstate)
NOT_THERE(fmi2SetFMUstate)
NOT_THERE(fmi2FreeFMUstate)
NOT_THERE(fmi2SerializedFMUstateSize)
NOT_THERE(fmi2SerializeFMUstate)
NOT_THERE(fmi2DeSerializeFMUstate)
NOT_THERE(fmi2GetDirectionalDerivative)
NOT_THERE(fmi2SetRealInputDerivatives)
NOT_THERE(fmi2GetRealOutputDerivatives)
NOT_THERE(fmi2CancelStep)
NOT_THERE(fmi2GetStatus)
NOT_THERE(fmi2GetIntegerStatus)
NOT_THERE(fmi2GetStringStatus)
